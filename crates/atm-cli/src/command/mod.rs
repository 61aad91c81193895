//! One file a command, each a thin adapter over the library.

pub mod compare;
pub mod draw;
pub mod eval;
pub mod fuse;
pub mod info;
pub mod plan;
pub mod simulate;

use std::sync::Arc;

use atm::{
    error::Error,
    log::{
        Input,
        csv::{CsvReadings, EmptyCell, PoseUse},
        format::Format as Found,
        poses::PoseLog,
    },
    pipeline::{AnyTrack, Defaults, SensorModel},
    rig::{Rig, TableFormat},
    track::Track,
};

use crate::{
    Failure,
    args::{Empty, Format, LogArgs},
};

/// What is said of MCAP until it can be read.
const NO_MCAP: &str = "MCAP is not supported yet; atm reads and writes text tables (CSV)";

/// The rig that was asked for, if one was.
fn rig(args: &LogArgs) -> Result<Option<Arc<Rig>>, Failure> {
    Ok(args.rig.as_deref().map(Rig::load).transpose()?.map(Arc::new))
}

/// Opens the log, and refuses what can't be read.
fn open(path: &str, from: Option<Format>) -> Result<Input, Failure> {
    let (found, input) = Input::open(path)?.sniff()?;
    let format = match from {
        Some(Format::Csv) => Found::Csv,
        Some(Format::Mcap) => Found::Mcap,
        None => found,
    };
    match format {
        Found::Csv => Ok(input),
        _ => Err(Failure::Failed(format!("{}: {NO_MCAP}", input.name))),
    }
}

/// A log of readings with all that it takes to use them, for commands that need its rig.
struct Readings {
    source: CsvReadings<Arc<Rig>>,
    track: Option<AnyTrack>,
    sensors: Vec<SensorModel>,
}

impl Readings {
    fn open(input: Input, args: &LogArgs, path: &str) -> Result<Self, Failure> {
        let rig = rig(args)?;
        let rig = rig.ok_or_else(|| {
            Failure::Usage(format!("{path}: a log of readings needs its sensors: name them with --rig"))
        })?;
        let sensors = Defaults { field_of_view: Some(args.fov), range_resolution: None }.complete(&rig)?;
        let (format, poses) = (table_format(Some(&rig)), pose_use(args, PoseUse::Needed));
        let source = CsvReadings::new(input, &format, poses, empty_cell(args), Arc::clone(&rig))?;
        let track = track(args, Some(&rig))?.map(|(track, _)| track);
        Ok(Self { source, track, sensors })
    }
}

/// How the log's table of readings is written, where a rig says so.
fn table_format(rig: Option<&Rig>) -> TableFormat {
    rig.and_then(Rig::log).map(|formats| formats.readings.clone()).unwrap_or_default()
}

fn empty_cell(args: &LogArgs) -> Option<EmptyCell> {
    args.empty.map(|empty| match empty {
        Empty::NoEcho => EmptyCell::NoEcho,
        Empty::Skip => EmptyCell::Skip,
    })
}

/// The second file's poses, where there is one.
fn track(args: &LogArgs, rig: Option<&Rig>) -> Result<Option<(AnyTrack, &'static str)>, Error> {
    let Some(path) = &args.poses else {
        return Ok(None);
    };
    let format = rig.and_then(Rig::log).map(|formats| &formats.poses);
    let log = PoseLog::new(Input::open(path)?, format)?;
    let kind = if log.is_tum() { "TUM" } else { "CSV" };
    Ok(Some((Track::new(Box::new(log), args.max_gap), kind)))
}

fn pose_use(args: &LogArgs, otherwise: PoseUse) -> PoseUse {
    if args.poses.is_some() { PoseUse::Ignored } else { otherwise }
}
