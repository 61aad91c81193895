//! Pixels from the same drawing: SVG first, PNG from it.
use atm::error::{Error, Result};
use resvg::{tiny_skia, usvg};

use super::page::Picture;

/// Most pixels of a PNG.
const MOST_PIXELS: f64 = 1e8;

impl Picture {
    /// The picture as PNG, with `scale` pixels for each of [`Picture::svg`]. It needs no fonts: letters are drawn as outlines.
    ///
    /// # Errors
    /// A scale that is not positive, and more than 100 million pixels.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>> {
        let failed = |message: String| Error::Settings { message };
        let (svg, width, height) = self.outlined();
        let (width, height) = ((width * scale).round(), (height * scale).round());
        if !(width >= 1.0 && height >= 1.0 && width * height <= MOST_PIXELS) {
            return Err(failed(format!(
                "a picture of {width} x {height} pixels: it may have 1 to {MOST_PIXELS} of them"
            )));
        }
        let tree = usvg::Tree::from_str(&svg, &usvg::Options::default());
        let tree = tree.map_err(|error| failed(format!("the drawing can't be rendered: {error}")))?;
        let mut pixels = tiny_skia::Pixmap::new(width as u32, height as u32)
            .ok_or_else(|| failed(format!("no room for {width} x {height} pixels")))?;
        let scale = tiny_skia::Transform::from_scale(scale as f32, scale as f32);
        resvg::render(&tree, scale, &mut pixels.as_mut());
        pixels.encode_png().map_err(|error| failed(format!("the pixels can't be written as PNG: {error}")))
    }
}
