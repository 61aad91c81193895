use atm::{core::Point2, stamp, units};
use atm_lab::draw::Frame;
use clap::Args;

use super::log::LogArgs;

#[derive(Debug, Args)]
#[command(after_help = "\
Layers: walls and opening (of the world); path, arcs, centerline, robot, beam, beams, partners (of a log); crossings; truth; and \
echoes by their kinds: median, single, center, near, pair. Kinds alone after --only leave the other layers as they are. arcs are \
drawn by themselves where there is a log and nothing else; centerline and beams only where they are named.")]
pub struct Draw {
    /// Logs of readings, echoes, crossings, tables of the truth: which is which is found in their columns or topics
    #[arg(value_name = "INPUT", required_unless_present = "world")]
    pub inputs: Vec<String>,
    /// The picture: a path that ends in .svg or .png, or - for SVG on standard output
    #[arg(short, long, value_name = "PICTURE")]
    pub output: String,
    /// The walls: a built-in world or a TOML file
    #[arg(long, value_name = "NAME|FILE")]
    pub world: Option<String>,
    /// A parameter of the world, such as opening=30in
    #[arg(long, value_name = "KEY=VALUE", value_parser = super::values::parameter, requires = "world")]
    pub set: Vec<(String, String)>,
    /// Draw only these kinds of echoes, or only these layers
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub only: Vec<String>,
    /// What part to show: two corners, or the middle and a width [default: all but a few stray points]
    #[arg(long, value_name = "X0,Y0,X1,Y1|X,Y,WIDTH", value_parser = zoom, allow_hyphen_values = true)]
    pub zoom: Option<Frame>,
    /// A title over the picture
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub title: String,
    /// Width and height in pixels, or the width alone [default: 900]
    #[arg(long, value_name = "WIDTH[xHEIGHT]", value_parser = size)]
    pub size: Option<(f64, Option<f64>)>,
    /// PNG: pixels for each pixel of the size
    #[arg(long, value_name = "N", default_value = "1", value_parser = super::values::positive_number)]
    pub scale: f64,
    /// A panel with its own choice, beside the others: layers, kinds, and inputs where it is not to show all
    #[arg(long, value_name = "TITLE[|SUBTITLE]=NAME,…", value_parser = panel, conflicts_with = "only")]
    pub panel: Vec<PanelSpec>,
    /// Show one reading: its beam, the arcs that cross it, a ring around its echo
    #[arg(long, value_name = "T,SENSOR", value_parser = reading, allow_hyphen_values = true)]
    pub reading: Option<(i64, String)>,
    #[command(flatten)]
    pub log: LogArgs,
}

/// A panel as it stands on the command line.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelSpec {
    pub title: String,
    pub subtitle: String,
    /// Layers, kinds and inputs.
    pub names: Vec<String>,
}

fn panel(text: &str) -> Result<PanelSpec, String> {
    let (heading, names) = text.rsplit_once('=').ok_or_else(|| format!("{text} is not TITLE=NAME,…"))?;
    let (title, subtitle) = heading.split_once('|').unwrap_or((heading, ""));
    let names = names.split(',').filter(|name| !name.is_empty()).map(str::to_owned).collect();
    Ok(PanelSpec { title: title.trim().to_owned(), subtitle: subtitle.trim().to_owned(), names })
}

fn zoom(text: &str) -> Result<Frame, String> {
    let lengths: Result<Vec<f64>, _> = text.split(',').map(units::length).collect();
    let no_area = || format!("{text} shows nothing: it needs a width and a height, within 1e15 m");
    match lengths.map_err(|error| error.to_string())?[..] {
        [x0, y0, x1, y1] => Frame::new(Point2::new(x0, y0), Point2::new(x1, y1)).ok_or_else(no_area),
        [x, y, width] => Frame::about(Point2::new(x, y), width).ok_or_else(no_area),
        _ => Err(format!("{text} is neither X0,Y0,X1,Y1 nor X,Y,WIDTH")),
    }
}

fn size(text: &str) -> Result<(f64, Option<f64>), String> {
    let (low, high) = atm_lab::draw::SIDES;
    let side = |text: &str| match text.trim().parse::<u32>().map(f64::from) {
        Ok(side) if (low..=high).contains(&side) => Ok(side),
        _ => Err(format!("{text} is no number of pixels from {low} to {high}")),
    };
    match text.split_once('x') {
        Some((width, height)) => Ok((side(width)?, Some(side(height)?))),
        None => Ok((side(text)?, None)),
    }
}

fn reading(text: &str) -> Result<(i64, String), String> {
    let found = text.split_once(',').and_then(|(t, sensor)| Some((stamp::parse(t.as_bytes(), 9)?, sensor)));
    let (t, sensor) = found.ok_or_else(|| format!("{text} is not T,SENSOR, such as 12.5,left"))?;
    Ok((t, sensor.to_owned()))
}
