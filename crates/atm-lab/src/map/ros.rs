//! A map as files: for ROS's map server, and as a picture.

use atm::error::{Error, Result};
use atm_core::Point2;

use super::grid::{Cell, Grid};

/// ROS's `map_saver` writes that cells above this probability are occupied.
pub const OCCUPIED_THRESHOLD: f64 = 0.65;
/// ROS's `map_saver` writes that cells below this probability are free.
pub const FREE_THRESHOLD: f64 = 0.196;

/// The shades of `map_saver`: with `negate: 0` a shade s means the probability (255 − s) / 255, so that 205 lies between
/// the two thresholds.
const OCCUPIED: u8 = 0;
const UNKNOWN: u8 = 205;
const FREE: u8 = 254;

/// Which cells are occupied, free, or neither, in a rectangle around those that are known.
#[derive(Debug, Clone, PartialEq)]
pub struct Occupancy {
    resolution: f64,
    /// Lower left corner, in metres.
    corner: Point2<f64>,
    width: u32,
    height: u32,
    /// Row by row from the top, which is +y.
    shades: Vec<u8>,
}

impl Occupancy {
    /// Whether each cell of `grid` is occupied (`Some(true)`), free (`Some(false)`) or neither, as `state` says of its value.
    ///
    /// Without a known cell it is one unknown cell at the origin.
    ///
    /// # Errors
    /// More than 2²⁸ cells in the rectangle: such a picture is of no use.
    pub fn new<T: Copy>(grid: &Grid<T>, state: impl Fn(T) -> Option<bool>) -> Result<Self> {
        const MOST_CELLS: u64 = 1 << 28;
        let known: Vec<(Cell, bool)> =
            grid.cells().filter_map(|(cell, value)| state(value).map(|occupied| (cell, occupied))).collect();
        let rows = || known.iter().map(|(cell, _)| cell.row);
        let columns = || known.iter().map(|(cell, _)| cell.column);
        let low = Cell { row: rows().min().unwrap_or(0), column: columns().min().unwrap_or(0) };
        let high = Cell { row: rows().max().unwrap_or(0), column: columns().max().unwrap_or(0) };
        let (width, height) = (high.column.abs_diff(low.column) + 1, high.row.abs_diff(low.row) + 1);
        if u64::from(width) * u64::from(height) > MOST_CELLS {
            return Err(Error::Map { message: format!("a picture of {width} x {height} cells is too large") });
        }
        let mut shades = vec![UNKNOWN; width as usize * height as usize];
        for (cell, occupied) in known {
            let (row, column) = (high.row.abs_diff(cell.row), cell.column.abs_diff(low.column));
            if let Some(shade) = shades.get_mut(row as usize * width as usize + column as usize) {
                *shade = if occupied { OCCUPIED } else { FREE };
            }
        }
        Ok(Self { resolution: grid.resolution(), corner: grid.corner(low), width, height, shades })
    }

    /// Cells in a row.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// The image that `map_server` reads, as binary PGM.
    pub fn pgm(&self) -> Vec<u8> {
        let mut file = format!("P5\n{} {}\n255\n", self.width, self.height).into_bytes();
        file.extend_from_slice(&self.shades);
        file
    }

    /// The description that `map_server` reads; `image` is the image's name, relative to it.
    pub fn yaml(&self, image: &str) -> String {
        format!(
            "image: {image}\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\noccupied_thresh: {OCCUPIED_THRESHOLD}\nfree_thresh: {FREE_THRESHOLD}\n",
            self.resolution, self.corner.x, self.corner.y,
        )
    }

    /// The same image as PNG, greyscale.
    ///
    /// # Errors
    /// The encoder's, which memory alone could cause.
    pub fn png(&self) -> Result<Vec<u8>> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Eight);
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&self.shades));
        written.map_err(|error| Error::Map { message: error.to_string() })?;
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of three cells of 0.5 m, lower left corner at (−1, 2): occupied lower left, free upper right.
    fn occupancy() -> Occupancy {
        let mut grid = Grid::new(0.5, Point2::origin(), f64::NAN).unwrap();
        *grid.get_mut(Cell { row: 4, column: -2 }).unwrap() = 1.0;
        *grid.get_mut(Cell { row: 5, column: 0 }).unwrap() = 0.0;
        Occupancy::new(&grid, |value: f64| (!value.is_nan()).then_some(value > 0.5)).unwrap()
    }

    #[test]
    fn pgm_begins_at_the_top_and_uses_the_shades_of_map_saver() {
        let expected = [b"P5\n3 2\n255\n".as_slice(), &[205, 205, 254, 0, 205, 205]].concat();
        assert_eq!(occupancy().pgm(), expected);
    }

    #[test]
    fn yaml_names_image_corner_and_thresholds() {
        assert_eq!(
            occupancy().yaml("map.pgm"),
            "image: map.pgm\nresolution: 0.5\norigin: [-1, 2, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        );
    }

    #[test]
    fn shades_mean_what_the_thresholds_say() {
        let probability = |shade: u8| (255.0 - f64::from(shade)) / 255.0;
        assert!(probability(OCCUPIED) > OCCUPIED_THRESHOLD && probability(FREE) < FREE_THRESHOLD);
        assert!((FREE_THRESHOLD..=OCCUPIED_THRESHOLD).contains(&probability(UNKNOWN)));
    }

    #[test]
    fn png_holds_the_same_image() {
        let file = occupancy().png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut shades = vec![0; 6];
        let info = reader.next_frame(&mut shades).unwrap();
        assert_eq!((info.width, info.height, shades), (3, 2, vec![205, 205, 254, 0, 205, 205]));
    }

    #[test]
    fn a_grid_of_which_nothing_is_known_is_one_unknown_cell() {
        let grid = Grid::new(0.5, Point2::origin(), f64::NAN).unwrap();
        let occupancy = Occupancy::new(&grid, |_| None).unwrap();
        assert_eq!(occupancy.pgm(), [b"P5\n1 1\n255\n".as_slice(), &[205]].concat());
    }
}
