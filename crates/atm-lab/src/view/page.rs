//! The page: its frame, what it says of the drive, and the columns.
use atm::{
    echo::AnyEstimator,
    error::{Error, Result},
    pipeline::History,
    style::{LINES, MARKS, Style},
    summary::Summary,
};
use atm_core::Point2;
use serde_json::{Value, json};

use super::{
    Contents, Method, Units, ViewJob,
    columns::Columns,
    gather::{AZIMUTHS, Found, STEP, TURN, place_of, steps},
};
use crate::world::{Shape, World};

/// The page without its parts; each stands where its marker is.
const FRAME: &str = include_str!("assets/view.html");
const STYLES: &str = include_str!("assets/view.css");
const SCRIPT: &str = include_str!("assets/view.js");

/// Writes the page.
pub(super) fn write(job: &ViewJob, contents: &Contents) -> Result<String> {
    let drive = &contents.drive;
    let Some(first) = drive.places.first() else {
        let message = format!("{}: no usable reading: there is nothing to replay", job.log.input);
        return Err(Error::Settings { message });
    };
    let origin = Point2::new(first.pose.x, first.pose.y);
    let packed = columns(contents, first.t, origin).finish();
    let (columns, data) = packed.map_err(|source| Error::Io { file: "the replay".into(), source })?;
    let mut said = json!({
        "version": 1,
        "name": job.log.input,
        "command": job.command,
        "origin": { "t": first.t.to_string(), "x": origin.x, "y": origin.y },
        "units": if contents.units == Units::Inches { "in" } else { "m" },
        "steps": { "length": STEP, "angle": TURN, "azimuths": AZIMUTHS },
        "sensors": drive.ids.iter().map(AsRef::as_ref).collect::<Vec<&str>>(),
        "resets": drive.resets,
        "thinned": { "stride": drive.stride, "readings": drive.offered },
        "methods": job.methods.iter().map(|method| of_method(*method, contents)).collect::<Vec<Value>>(),
        "settings": of_settings(job),
        "styles": MARKS.iter().chain(&LINES).map(of_style).collect::<Vec<Value>>(),
        "world": job.world.as_ref().map(|world| of_world(world, origin)),
        "columns": columns,
    });
    said["depth"] = json!(crate::world::DOORWAY_DEPTH);
    said["jamb"] = json!(crate::world::JAMB_REACH);
    let name = job.log.input.rsplit(['/', '\\']).next().unwrap_or_default();
    let parts = [
        ("<!--title-->", escaped(name)),
        ("/*style*/", STYLES.to_owned()),
        ("<!--said-->", in_script(&said.to_string())),
        ("<!--data-->", data),
        ("/*script*/", SCRIPT.to_owned()),
    ];
    Ok(filled(FRAME, &parts))
}

/// The frame with each marker's part in its place. What stands in a part is never taken for a marker.
fn filled(frame: &str, parts: &[(&str, String)]) -> String {
    let (mut page, mut rest) = (String::new(), frame);
    for (marker, part) in parts {
        if let Some((before, after)) = rest.split_once(marker) {
            page.push_str(before);
            page.push_str(part);
            rest = after;
        }
    }
    page.push_str(rest);
    page
}

/// Text between tags.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// JSON in a script element, which nothing may end early.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026")
}

fn columns(contents: &Contents, start: i64, origin: Point2<f64>) -> Columns {
    let (drive, mut columns) = (&contents.drive, Columns::default());
    let place = |x: f64, y: f64| place_of(Point2::new(x, y), origin);
    // Microseconds.
    columns.steps("pose.t", drive.places.iter().map(|place| place.t.saturating_sub(start) / 1000));
    columns.steps("pose.x", drive.places.iter().map(|one| place(one.pose.x, one.pose.y)[0]));
    columns.steps("pose.y", drive.places.iter().map(|one| place(one.pose.x, one.pose.y)[1]));
    columns.steps("pose.yaw", drive.places.iter().map(|one| steps(one.pose.yaw, TURN)));
    columns.whole("mount.x", drive.mounts.iter().map(|mount| mount.x));
    columns.whole("mount.y", drive.mounts.iter().map(|mount| mount.y));
    columns.whole("mount.yaw", drive.mounts.iter().map(|mount| mount.yaw));
    columns.whole("mount.half", drive.mounts.iter().map(|mount| mount.half_beam));
    columns.steps("reading.pose", drive.shots.iter().map(|shot| shot.pose.into()));
    columns.whole("reading.mount", drive.shots.iter().map(|shot| shot.mount.into()));
    columns.whole("reading.sensor", drive.shots.iter().map(|shot| shot.sensor.into()));
    columns.whole("reading.range", drive.shots.iter().map(|shot| shot.range.into()));
    columns.whole("reading.left", drive.shots.iter().map(|shot| i64::from(shot.left) - i64::from(shot.pose)));
    let mut meetings = drive.meetings.clone();
    meetings.sort_by_key(|meeting| (meeting.on, meeting.with));
    columns.steps("crossing.on", meetings.iter().map(|meeting| meeting.on.into()));
    columns.whole("crossing.back", meetings.iter().map(|meeting| i64::from(meeting.on) - i64::from(meeting.with)));
    columns.whole("crossing.azimuth", meetings.iter().map(|meeting| meeting.azimuth.into()));
    for (method, kinds, found, _) in &contents.fused {
        of_echoes(method.word(), kinds, found, &mut columns);
    }
    let truth: Vec<[i64; 2]> = contents.truth.iter().map(|point| place_of(*point, origin)).collect();
    columns.whole("truth.x", truth.iter().map(|place| place[0]));
    columns.whole("truth.y", truth.iter().map(|place| place[1]));
    columns
}

fn of_echoes(method: &str, kinds: &[&str], found: &[Found], columns: &mut Columns) {
    let named = |name: &str| format!("{method}.{name}");
    let kind = |found: &Found| kinds.iter().position(|kind| *kind == found.kind).unwrap_or(0) as i64;
    columns.steps(&named("reading"), found.iter().map(|found| found.shot.into()));
    columns.whole(&named("kind"), found.iter().map(kind));
    columns.whole(&named("azimuth"), found.iter().map(|found| found.azimuth.into()));
    columns.whole(&named("crossings"), found.iter().map(|found| found.crossings.into()));
    columns.whole(&named("resolution"), found.iter().map(|found| steps(found.resolution, STEP)));
    columns.single(&named("significance"), found.iter().map(|found| found.significance));
}

fn of_method(method: Method, contents: &Contents) -> Value {
    let fused = contents.fused.iter().find(|(fused, ..)| *fused == method);
    let kinds = fused.map_or(&["centerline"][..], |(_, kinds, ..)| kinds);
    json!({
        "name": method.word(),
        "kinds": kinds,
        "counts": fused.map(|(_, _, _, summary)| of_summary(summary)),
    })
}

fn of_summary(summary: &Summary) -> Value {
    serde_json::to_value(summary).unwrap_or(Value::Null)
}

/// Rows for the table: how it was fused.
fn of_settings(job: &ViewJob) -> Value {
    let degrees = |radians: f64| format!("{}°", (radians.to_degrees() * 1e6).round() / 1e6);
    let local_map = match job.settings.history {
        History::ByCount(most) => format!("the last {most} readings of each sensor"),
        History::ByTravel { reach: Some(reach), most } => {
            format!("the travel of crossings at {reach} m, at most {most} readings of each sensor")
        }
        History::ByTravel { reach: None, most } => {
            format!("the travel of crossings at the sensors' range, at most {most} readings of each")
        }
    };
    let mut rows = vec![json!(["local map", local_map])];
    if let Some(AnyEstimator::Median(median)) = job.estimators.iter().find(|estimator| !estimator.is_consensus()) {
        rows.push(json!(["smallest crossing angle", degrees(median.min_angle.radians())]));
    }
    Value::Array(rows)
}

fn of_style(style: &Style) -> Value {
    let color = |rgb: u32| format!("#{rgb:06x}");
    json!({
        "name": style.name,
        "words": style.words,
        "shape": style.shape.name(),
        "light": color(style.on_light),
        "dark": color(style.on_dark),
    })
}

fn of_world(world: &World, origin: Point2<f64>) -> Value {
    let at = |point: Point2<f64>| [point.x - origin.x, point.y - origin.y];
    let walls = world.surfaces().iter().map(|surface| match surface.shape {
        Shape::Segment { from, to } => {
            json!({ "material": surface.material.name(), "from": at(from), "to": at(to) })
        }
        Shape::Circle { center, radius } => {
            json!({ "material": surface.material.name(), "center": at(center), "radius": radius })
        }
    });
    json!({
        "name": world.name(),
        "walls": walls.collect::<Vec<Value>>(),
        "openings": world.openings().iter().map(|opening| opening.jambs.map(at)).collect::<Vec<_>>(),
    })
}
