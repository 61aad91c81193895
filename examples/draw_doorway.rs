//! Draws the sample log before and after: `cargo run --release --example draw_doorway > docs/doorway.svg`.
//!
//! Left every reading's cone centre, right the medians and single crossings of the same log; in both the walls as they
//! are, and the widest stretch of the opening that the points leave free.
use std::{
    error::Error,
    fmt::{self, Display, Write as _},
    io::{self, Write as _},
    sync::Arc as Shared,
};

use atm::{
    core::{Arc, ArcCrossing, Bounds, Echo, Kind, Point2, Reading, TransversalMedian},
    error::Result,
    log::{
        Input, Next, Row, Source,
        csv::{CsvReadings, PoseUse},
    },
    pipeline::{Defaults, EchoSink, Emit, SensorModel, Settings, fuse, readings},
    rig::{Rig, TableFormat},
    simulate::Scene,
    world::World,
};

const LOG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/doorway.csv");
/// The sample's world, in metres: an opening of 36 in, 70 in from the path.
const SEED: u64 = 1;
const OPENING: f64 = inches(36.0);
const OPENING_START: f64 = inches(102.0);
const OPENING_END: f64 = inches(138.0);
const WALL_DISTANCE: f64 = inches(70.0);
/// Radius of the Nomad's ring of sensors.
const RING_RADIUS: f64 = inches(9.0);

const fn inches(n: f64) -> f64 {
    n * 254.0 / 10_000.0
}

/// H of Sec. IV-D.
const HISTORY: usize = 10;
/// How far from the wall's line a point still says that there is wall.
const MOUTH_DEPTH: f64 = inches(12.0);
/// The sweep whose beams are drawn, and the sensor that hears the far jamb with the edge of its beam.
const SHOWN_SWEEP: i64 = 20 * 1_000_000_000;
const SHOWN_SENSOR: u16 = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let drive = Drive::read()?;
    io::stdout().write_all(picture(&drive)?.as_bytes())?;
    Ok(())
}

/// The readings of the log that are echoes, and what they were fused to.
struct Drive {
    bumps: Vec<Point2<f64>>,
    readings: Vec<Reading<f64>>,
    fused: Fused,
}

#[derive(Default)]
struct Fused {
    echoes: Vec<Echo<f64>>,
    crossings: Vec<ArcCrossing<f64>>,
}

impl EchoSink for Fused {
    fn echo(&mut self, echo: &Echo<f64>) -> Result<bool> {
        self.echoes.push(*echo);
        Ok(true)
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        self.crossings.extend_from_slice(crossings);
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

impl Drive {
    fn read() -> Result<Self, Box<dyn Error>> {
        let rig = Shared::new(Rig::builtin("nomad200").ok_or("no rig nomad200")?);
        let sensors = Defaults::default().complete(&rig)?;
        let settings = Settings {
            emit: Emit::Settled,
            history: HISTORY,
            bounds: Bounds::NONE,
            estimator: TransversalMedian::PAPER,
            strict: true,
        };
        let mut fused = Fused::default();
        fuse(&mut open(&rig)?, None, &sensors, &settings, &mut fused, &mut |_| {}).1?;
        let world = World::load("doorway", &[])?;
        let jambs = world.openings().iter().flat_map(|opening| opening.jambs).collect::<Vec<_>>();
        let bumps = Scene::new(world, SEED).bumps().iter().map(|bump| bump.sides[0]).chain(jambs).collect();
        Ok(Self { bumps, readings: echoing(&mut open(&rig)?, &sensors)?, fused })
    }

    /// What a map marks that takes an echo to lie ahead: every reading's cone centre.
    fn centers(&self) -> Vec<Point2<f64>> {
        self.readings.iter().filter_map(arc).map(|arc| arc.middle()).collect()
    }

    /// The echoes of one kind.
    fn echoes(&self, kind: Kind) -> Vec<Point2<f64>> {
        self.fused.echoes.iter().filter(|echo| echo.kind == kind).map(|echo| echo.position).collect()
    }

    fn reading(&self, t: i64, sensor: u16) -> Option<&Reading<f64>> {
        self.readings.iter().find(|reading| (reading.t, reading.sensor) == (t, sensor))
    }

    /// The readings whose arcs cross the shown one.
    fn partners(&self) -> impl Iterator<Item = &Reading<f64>> {
        let crossings = self.fused.crossings.iter();
        let shown = crossings.filter(|crossing| (crossing.t, crossing.sensor) == (SHOWN_SWEEP, SHOWN_SENSOR));
        shown.filter_map(|crossing| self.reading(crossing.t_other, crossing.sensor_other))
    }
}

fn open(rig: &Shared<Rig>) -> Result<CsvReadings<Shared<Rig>>> {
    CsvReadings::new(Input::open(LOG)?, &TableFormat::default(), PoseUse::Needed, None, Shared::clone(rig))
}

fn echoing(log: &mut impl Source, sensors: &[SensorModel]) -> Result<Vec<Reading<f64>>> {
    let (mut all, mut row) = (Vec::new(), Row::default());
    while log.next_row(&mut row, &mut |_| {})? != Next::End {
        if let Some(pose) = row.pose {
            all.extend(readings(&row, pose, sensors).filter(|reading| reading.range.echo().is_some()));
        }
    }
    Ok(all)
}

fn arc(reading: &Reading<f64>) -> Option<Arc<f64>> {
    Some(Arc::new(&reading.pose, reading.range.echo()?, &reading.beam))
}

/// The widest stretch of the opening, along x, without a point near the wall's line.
fn widest_gap(points: &[Point2<f64>]) -> (f64, f64) {
    let near = points.iter().filter(|point| (point.y - WALL_DISTANCE).abs() <= MOUTH_DEPTH).map(|point| point.x);
    let mut stops: Vec<f64> = near.filter(|x| (OPENING_START..OPENING_END).contains(x)).collect();
    stops.extend([OPENING_START, OPENING_END]);
    stops.sort_by(f64::total_cmp);
    let gaps = stops.iter().zip(stops.iter().skip(1)).map(|(&from, &to)| (from, to));
    gaps.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0))).unwrap_or_default()
}

/// A length as the picture says it: `36 in (0.91 m)`.
fn length(metres: f64) -> String {
    format!("{:.0} in ({metres:.2} m)", metres / inches(1.0))
}

// The picture, in pixels; y grows downwards.
const WIDTH: f64 = 830.0;
const HEIGHT: f64 = 372.0;
const MARGIN: f64 = 16.0;
const PANEL_TOP: f64 = 54.0;
const PIXELS_PER_METRE: f64 = 76.0;
/// What the panels show of the world, in metres.
const X_RANGE: (f64, f64) = (0.5, 5.6);
const Y_RANGE: (f64, f64) = (-0.6, 3.05);
/// Where the kinds of points are named, as a height in the world.
const KEY_Y: f64 = -0.42;
const ORANGE: &str = "#d55e00";
const BLUE: &str = "#0072b2";

const STYLE: &str = "text{font:13px Helvetica,Arial,'DejaVu Sans',sans-serif;fill:#444}\
.title{font-weight:bold;font-size:16px;fill:#111}.middle{text-anchor:middle}\
.free{font-weight:bold;font-size:17px;text-anchor:middle}.wall{stroke:#bdbdbd;stroke-width:8}\
.bump{stroke:#666;stroke-width:2}.thin{stroke:#555;fill:none}.path{stroke:#999;stroke-width:1.5;stroke-dasharray:1 3}\
.robot{fill:#e8e8e8;stroke:#555}.arrow{fill:none;stroke:#333;stroke-width:2}.center{fill:#d55e00}.median{fill:#0072b2;stroke:#fff;stroke-width:.7}\
.single{fill:none;stroke:#111;stroke-width:1.4}.ring{fill:none;stroke:#111;stroke-width:1.6}\
.cone{fill:#777;fill-opacity:.08;stroke:#777;stroke-opacity:.3}.shown{fill:#777;fill-opacity:.2;stroke:#666}";

fn picture(drive: &Drive) -> Result<String, fmt::Error> {
    let mut svg = String::new();
    let size = format!("width=\"{WIDTH}\" height=\"{HEIGHT}\"");
    writeln!(svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" {size}>")?;
    writeln!(svg, "<title>A doorway in sonar readings: centres of the cone, and atm</title>\n<style>{STYLE}</style>")?;
    writeln!(svg, "<rect {size} rx=\"10\" fill=\"#fff\"/>")?;
    let panel_width = (X_RANGE.1 - X_RANGE.0) * PIXELS_PER_METRE;
    centers_panel(&mut Panel { svg: &mut svg, left: MARGIN }, drive)?;
    atm_panel(&mut Panel { svg: &mut svg, left: WIDTH - MARGIN - panel_width }, drive)?;
    legend(&mut Panel { svg: &mut svg, left: MARGIN })?;
    svg.push_str("</svg>\n");
    Ok(svg)
}

fn centers_panel(panel: &mut Panel<'_>, drive: &Drive) -> fmt::Result {
    let centers = drive.centers();
    panel.heading("Centre of the cone", "what range layers see: each echo straight ahead")?;
    panel.walls(&drive.bumps)?;
    panel.free(widest_gap(&centers), ORANGE)?;
    let ring = SHOWN_SENSOR - 1..=SHOWN_SENSOR + 3;
    for reading in ring.filter_map(|sensor| drive.reading(SHOWN_SWEEP, sensor)) {
        panel.cone(reading, if reading.sensor == SHOWN_SENSOR { "shown" } else { "cone" })?;
    }
    panel.marks("center", &centers)?;
    if let Some(shown) = drive.reading(SHOWN_SWEEP, SHOWN_SENSOR) {
        panel.robot(shown.robot)?;
        panel.marks("ring", &arc(shown).map(|arc| arc.middle()).into_iter().collect::<Vec<_>>())?;
    }
    panel.key(&[("center", "centre of the cone")])?;
    panel.dimension((4.5, 5.5), KEY_Y, "middle", "1 m")
}

fn atm_panel(panel: &mut Panel<'_>, drive: &Drive) -> fmt::Result {
    let (medians, singles) = (drive.echoes(Kind::Median), drive.echoes(Kind::Single));
    panel.heading("atm: median and single crossings", "the same readings, placed by the median crossing")?;
    panel.walls(&drive.bumps)?;
    panel.free(widest_gap(&[&medians[..], &singles[..]].concat()), BLUE)?;
    if let Some(shown) = drive.reading(SHOWN_SWEEP, SHOWN_SENSOR) {
        panel.cone(shown, "shown")?;
        panel.robot(shown.robot)?;
    }
    for reading in drive.partners() {
        panel.rim(reading)?;
    }
    // Medians on top: at a bump both stand on one spot.
    panel.marks("single", &singles)?;
    panel.marks("median", &medians)?;
    let shown = drive.fused.echoes.iter().find(|echo| (echo.t, echo.sensor) == (SHOWN_SWEEP, SHOWN_SENSOR));
    panel.marks("ring", &shown.map(|echo| echo.position).into_iter().collect::<Vec<_>>())?;
    panel.key(&[("median", "median"), ("single", "single")])?;
    panel.text(panel.x(2.42), panel.y(KEY_Y) + 4.5, "", "(without a crossing: not drawn)")
}

/// What means the same in both panels.
fn legend(page: &mut Panel<'_>) -> fmt::Result {
    let y = HEIGHT - 18.0;
    writeln!(page.svg, "<path class=\"wall\" d=\"M16 {y}h26\"/><path class=\"bump\" d=\"M29 {}v12\"/>", y - 6.0)?;
    page.text(50.0, y + 4.5, "", "true wall and the bumps that answer")?;
    page.mark("ring", 336.0, y)?;
    page.text(350.0, y + 4.5, "", "one reading in both: its 22.5° beam hears the far jamb")
}

/// One view of the world.
struct Panel<'a> {
    svg: &'a mut String,
    left: f64,
}

impl Panel<'_> {
    fn x(&self, metres: f64) -> f64 {
        self.left + (metres - X_RANGE.0) * PIXELS_PER_METRE
    }

    fn y(&self, metres: f64) -> f64 {
        PANEL_TOP + (Y_RANGE.1 - metres) * PIXELS_PER_METRE
    }

    fn text(&mut self, x: f64, y: f64, class: &str, words: impl Display) -> fmt::Result {
        writeln!(self.svg, "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\">{words}</text>")
    }

    fn heading(&mut self, title: &str, below: &str) -> fmt::Result {
        self.text(self.left, 28.0, "title", title)?;
        self.text(self.left, 47.0, "", below)
    }

    /// A straight line between two points of the world.
    fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64)) -> fmt::Result {
        let (x1, y1, x2, y2) = (self.x(from.0), self.y(from.1), self.x(to.0), self.y(to.1));
        writeln!(self.svg, "<path class=\"{class}\" d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\"/>")
    }

    /// A length along x, and the words for it above.
    fn dimension(&mut self, (from, to): (f64, f64), y: f64, class: &str, words: impl Display) -> fmt::Result {
        const TICK: f64 = 0.06;
        self.line("thin", (from, y), (to, y))?;
        self.line("thin", (from, y - TICK), (from, y + TICK))?;
        self.line("thin", (to, y - TICK), (to, y + TICK))?;
        self.text(self.x(f64::midpoint(from, to)), self.y(y) - 8.0, class, words)
    }

    /// The walls as they are, the opening's width and the path.
    fn walls(&mut self, bumps: &[Point2<f64>]) -> fmt::Result {
        self.line("wall", (X_RANGE.0, WALL_DISTANCE), (OPENING_START, WALL_DISTANCE))?;
        self.line("wall", (OPENING_END, WALL_DISTANCE), (X_RANGE.1, WALL_DISTANCE))?;
        self.marks("bump", bumps)?;
        let words = format!("opening: {}", length(OPENING));
        self.dimension((OPENING_START, OPENING_END), 2.68, "middle", words)?;
        self.line("path", (X_RANGE.0, 0.0), (X_RANGE.1, 0.0))
    }

    /// The stretch between the points, in a band as deep as points count.
    fn free(&mut self, (from, to): (f64, f64), colour: &str) -> fmt::Result {
        let (x, y) = (self.x(from), self.y(WALL_DISTANCE + MOUTH_DEPTH));
        let (width, height) = ((to - from) * PIXELS_PER_METRE, 2.0 * MOUTH_DEPTH * PIXELS_PER_METRE);
        let size = format!("width=\"{width:.1}\" height=\"{height:.1}\"");
        writeln!(self.svg, "<rect x=\"{x:.1}\" y=\"{y:.1}\" {size} fill=\"{colour}\" fill-opacity=\".2\"/>")?;
        let words = format!("<tspan fill=\"{colour}\">free: {}</tspan>", length(to - from));
        self.dimension((from, to), WALL_DISTANCE + MOUTH_DEPTH + 0.1, "free", words)
    }

    fn cone(&mut self, reading: &Reading<f64>, class: &str) -> fmt::Result {
        let (tip, rim) = (reading.pose.translation.vector, self.rim_of(reading));
        writeln!(self.svg, "<path class=\"{class}\" d=\"M{:.1} {:.1}L{rim}Z\"/>", self.x(tip.x), self.y(tip.y))
    }

    fn rim(&mut self, reading: &Reading<f64>) -> fmt::Result {
        let rim = self.rim_of(reading);
        writeln!(self.svg, "<path class=\"thin\" d=\"M{rim}\"/>")
    }

    /// The arc of a reading, from its right end to its left.
    fn rim_of(&self, reading: &Reading<f64>) -> String {
        let (range, half) = (reading.range.echo().unwrap_or_default(), reading.beam.field_of_view() / 2.0);
        let end = |side: f64| {
            let point = reading.pose * Point2::new(range * libm::cos(half), side * range * libm::sin(half));
            format!("{:.1} {:.1}", self.x(point.x), self.y(point.y))
        };
        let radius = range * PIXELS_PER_METRE;
        format!("{}A{radius:.1} {radius:.1} 0 0 0 {}", end(-1.0), end(1.0))
    }

    /// The points within the view.
    fn marks(&mut self, class: &str, points: &[Point2<f64>]) -> fmt::Result {
        let within = |at: f64, range: (f64, f64)| range.0 <= at && at <= range.1;
        for point in points.iter().filter(|point| within(point.x, X_RANGE) && within(point.y, Y_RANGE)) {
            self.mark(class, self.x(point.x), self.y(point.y))?;
        }
        Ok(())
    }

    fn mark(&mut self, class: &str, x: f64, y: f64) -> fmt::Result {
        let circle = |radius: f64| format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>");
        let shape = match class {
            "bump" => format!("<path class=\"bump\" d=\"M{x:.1} {:.1}v12\"/>", y - 6.0),
            "single" => format!("<path class=\"single\" d=\"M{:.1} {y:.1}h10m-5 -5v10\"/>", x - 5.0),
            "ring" => circle(7.5),
            "median" => circle(3.4),
            _ => circle(3.0),
        };
        writeln!(self.svg, "{shape}")
    }

    fn robot(&mut self, at: Point2<f64>) -> fmt::Result {
        let (x, y, radius) = (self.x(at.x), self.y(at.y), RING_RADIUS * PIXELS_PER_METRE);
        writeln!(self.svg, "<circle class=\"robot\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\"/>")?;
        writeln!(self.svg, "<path class=\"arrow\" d=\"M{:.1} {y:.1}h18m-6 -5l6 5l-6 5\"/>", x - 9.0)
    }

    /// What the points of this panel are.
    fn key(&mut self, entries: &[(&str, &str)]) -> fmt::Result {
        let (mut x, y) = (self.left + 6.0, self.y(KEY_Y));
        for (class, words) in entries {
            self.mark(class, x, y)?;
            self.text(x + 10.0, y + 4.5, "", words)?;
            x += 80.0;
        }
        Ok(())
    }
}
