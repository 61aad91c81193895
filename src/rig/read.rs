//! Rigs from TOML: one function a section.
use std::{
    collections::{HashMap, HashSet},
    path::Path,
};

use nalgebra::{Isometry2, Translation2};

use super::{Invalid, KIND, LogFormats, MAX_SENSORS, Ranging, Rig, Sensor, TableFormat, direction, ring_sensors};
use crate::{
    error::Result,
    log::table::MAX_FIELDS,
    stamp,
    toml_document::{Document, Entry, Section},
    units::Scale,
};

const TOP: [&str; 4] = ["name", "ring", "sensor", "log"];
/// Keys that stand at the top for all sensors, and under a sensor for itself.
const RANGING: [&str; 4] = ["field_of_view", "min_range", "max_range", "range_resolution"];
const RING: [&str; 3] = ["count", "radius", "first_yaw"];
const SENSOR: [&str; 5] = ["id", "x", "y", "yaw", "topic"];
const TABLE: [&str; 8] =
    ["header", "delimiter", "columns", "time_unit", "range_unit", "pose_unit", "yaw_unit", "no_echo"];
/// Of the table of readings alone.
const PANNING: [&str; 2] = ["angle", "angle_unit"];
/// Where a sensor sits. One of them is enough: the others are 0 then.
const MOUNT: [&str; 3] = ["x", "y", "yaw"];
/// Most values that stand for "no echo": each range is compared with all of them.
const MAX_NO_ECHO: usize = 1000;
/// Poses in a file of their own; only under `[log]`.
const POSES: &str = "poses";

/// Reads a whole rig.
pub(super) fn rig(text: &str, file: &str) -> Result<Rig> {
    let document = Document { file, text, kind: &KIND };
    let root = document.parse()?;
    let top = Section::root(document, &root);
    top.only(&[&TOP, &RANGING])?;
    let name = match top.get("name") {
        Some(name) => name.text()?.to_owned(),
        None => Path::new(file).file_stem().map_or(file.into(), |stem| stem.to_string_lossy()).into_owned(),
    };
    let defaults = ranging(&top, Ranging::default())?;
    // A limit that is given counts even where it excludes nothing.
    let given =
        |sensor: Sensor| sensor.with_given_limits(top.get("min_range").is_some(), top.get("max_range").is_some());
    let all = |sensors: Vec<Sensor>| sensors.into_iter().map(given).collect();
    let rig = match (top.get("ring"), top.get("sensor")) {
        (Some(entry), None) => Rig::new(name, all(ring(&entry.section()?, defaults)?))?,
        (None, Some(entry)) => Rig::new(name, all(sensors(&entry, defaults)?))?,
        (Some(_), Some(second)) => return Err(second.error("a rig has either [ring] or [[sensor]], not both")),
        (None, None) => return Err(top.error("no sensors: expected a [ring] or at least one [[sensor]]".to_owned())),
    };
    Ok(match top.get("log") {
        Some(log) => {
            let section = log.section()?;
            let keys = TABLE.iter().chain([&POSES]).filter(|key| section.get(key).is_some());
            rig.with_log_keys(keys.map(|key| (*key).to_owned()).collect()).with_log(log_formats(&section)?)
        }
        None => rig,
    })
}

/// Beam and ranges as a section gives them, over those it inherits.
fn ranging(section: &Section<'_>, inherited: Ranging) -> Result<Ranging> {
    let mut ranging = inherited;
    if let Some(angle) = section.get("field_of_view") {
        ranging.field_of_view = Some(angle.angle()?);
    }
    if let Some(length) = section.get("min_range") {
        ranging.min_range = length.length()?;
    }
    if let Some(length) = section.get("max_range") {
        ranging.max_range = length.length()?;
    }
    if let Some(length) = section.get("range_resolution") {
        ranging.range_resolution = Some(length.length()?);
    }
    ranging.check().map_err(|Invalid { key, message }| match (section.get(key), section.get("max_range")) {
        (Some(given), _) => given.error(message),
        // What is inherited was in order by itself: only the two bounds can be at odds.
        (None, Some(max)) => max.error(&format!("must be more than min_range, which is {} m", ranging.min_range)),
        (None, None) => section.error(format!("{key} {message}")),
    })?;
    Ok(ranging)
}

/// Reads `[ring]`.
fn ring(section: &Section<'_>, ranging: Ranging) -> Result<Vec<Sensor>> {
    section.only(&[&RING])?;
    let count = section.require("count")?.count()?;
    let radius = section.require("radius")?.length()?;
    let first_yaw = section.get("first_yaw").map_or(Ok(0.0), |yaw| yaw.angle())?;
    ring_sensors(count, radius, first_yaw, ranging).map_err(|Invalid { key, message }| match section.get(key) {
        Some(given) => given.error(message),
        None => section.error(format!("{key} {message}")),
    })
}

/// Reads every `[[sensor]]`.
fn sensors(entry: &Entry<'_>, defaults: Ranging) -> Result<Vec<Sensor>> {
    let sections = entry.sections()?;
    if sections.len() > MAX_SENSORS {
        return Err(entry.error(&format!("{} sensors: at most {MAX_SENSORS}", sections.len())));
    }
    let mut ids = HashMap::with_capacity(sections.len());
    let mut sensors = Vec::with_capacity(sections.len());
    for section in &sections {
        let (id, sensor) = sensor(section, defaults)?;
        sensors.push(sensor);
        if let Some(first) = ids.insert(id.text()?, id.clone()) {
            return Err(id.error(&format!("the sensor of line {} has this id already", first.line())));
        }
    }
    Ok(sensors)
}

/// Reads one `[[sensor]]`; gives the entry of its id, too.
fn sensor<'a>(section: &Section<'a>, defaults: Ranging) -> Result<(Entry<'a>, Sensor)> {
    section.only(&[&SENSOR, &RANGING])?;
    let length = |key| section.get(key).map_or(Ok(0.0), |length| length.length());
    let id = section.require("id")?;
    if id.text()?.is_empty() {
        return Err(id.error("must not be empty"));
    }
    let boresight = direction(section.get("yaw").map_or(Ok(0.0), |yaw| yaw.angle())?);
    let mount = Isometry2::from_parts(Translation2::new(length("x")?, length("y")?), boresight);
    let sensor = Sensor::new(id.text()?, mount, ranging(section, defaults)?)?
        .with_given_limits(section.get("min_range").is_some(), section.get("max_range").is_some());
    let sensor = match MOUNT.iter().any(|key| section.get(key).is_some()) {
        true => sensor,
        false => sensor.with_open_mount(),
    };
    let sensor = match section.get("topic") {
        Some(topic) => sensor.with_topic(topic.text()?),
        None => sensor,
    };
    Ok((id, sensor))
}

/// Reads `[log]` and `[log.poses]`.
fn log_formats(section: &Section<'_>) -> Result<LogFormats> {
    section.only(&[&TABLE, &PANNING, &[POSES]])?;
    let readings = table_format(section, TableFormat::default(), section.get("header"))?;
    let inherited = TableFormat { columns: None, angle: None, ..readings.clone() };
    let poses = match section.get(POSES) {
        Some(poses) => {
            let poses = poses.section()?;
            poses.only(&[&TABLE])?;
            table_format(&poses, inherited, poses.get("header").or(section.get("header")))?
        }
        // Nothing names their columns, so their file has to.
        None => TableFormat { header: true, ..inherited },
    };
    Ok(LogFormats { readings, poses })
}

/// One table's format as a section gives it, over what it inherits. `header` is the entry that counts for it.
fn table_format(section: &Section<'_>, inherited: TableFormat, header: Option<Entry<'_>>) -> Result<TableFormat> {
    let mut format = inherited;
    format.columns = section.get("columns").map(|names| columns(&names)).transpose()?;
    // Who names the columns need not say that the file does not.
    format.header = header.as_ref().map_or(Ok(format.columns.is_none()), Entry::flag)?;
    if !format.header && format.columns.is_none() {
        return Err(section.error("header = false needs `columns`, the names of the columns".to_owned()));
    }
    if let Some(entry) = section.get("delimiter") {
        format.delimiter = Some(delimiter(&entry)?);
    }
    if let Some(unit) = section.get("time_unit") {
        let shift = stamp::decimal_shift(unit.text()?);
        format.time_shift = shift.ok_or_else(|| unit.error("expected one of s, ms, us, ns"))?;
    }
    if let Some(unit) = section.get("range_unit") {
        format.range = length_unit(&unit)?;
    }
    if let Some(unit) = section.get("pose_unit") {
        format.pose = length_unit(&unit)?;
    }
    if let Some(unit) = section.get("yaw_unit") {
        format.yaw = unit.quantity(Scale::angle)?;
    }
    if let Some(name) = section.get("angle") {
        format.angle = Some(name.text()?.to_owned());
    }
    if let Some(unit) = section.get("angle_unit") {
        if format.angle.is_none() {
            return Err(unit.error("needs `angle`, the column that it is the unit of"));
        }
        format.angle_unit = unit.quantity(Scale::angle)?;
    }
    if let Some(values) = section.get("no_echo") {
        format.no_echo = values.items_up_to(MAX_NO_ECHO)?.iter().map(Entry::number).collect::<Result<_>>()?;
    }
    Ok(format)
}

/// Reads the names of the columns: at least one, no two alike.
fn columns(entry: &Entry<'_>) -> Result<Vec<String>> {
    let items = entry.items_up_to(MAX_FIELDS)?;
    if items.is_empty() {
        return Err(entry.error("expected at least one name"));
    }
    let mut seen = HashSet::with_capacity(items.len());
    let name = |item: &Entry<'_>| {
        let name = item.text()?.to_owned();
        if seen.insert(name.clone()) { Ok(name) } else { Err(item.error("this column is named twice")) }
    };
    items.iter().map(name).collect()
}

/// Reads a delimiter: one ASCII character that can't be part of a number, a name or a quoted cell.
fn delimiter(entry: &Entry<'_>) -> Result<u8> {
    let refuse = || entry.error("expected one ASCII character that is not part of a number, like \",\" or \"\\t\"");
    match *entry.text()?.as_bytes() {
        [byte] if !byte.is_ascii_alphanumeric() && !b"+-.\"\r\n\0".contains(&byte) => Ok(byte),
        _ => Err(refuse()),
    }
}

/// Reads the step of a length in a table.
fn length_unit(entry: &Entry<'_>) -> Result<Scale> {
    let scale = entry.quantity(Scale::length)?;
    if scale.is_positive() { Ok(scale) } else { Err(entry.error("must be above zero")) }
}

#[cfg(test)]
mod tests;
