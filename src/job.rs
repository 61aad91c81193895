//! One run: a log of any format in, files out. What the command does, and what Python does.
mod outputs;
mod watched;

use std::{
    io::{self, Write as _},
    sync::Arc,
};

use atm_core::{Isometry2, Kind};

use self::outputs::Outputs;
pub use self::watched::Watched;
use crate::{
    diagnose::guessed_resolution,
    error::{Error, Place, Result},
    intake::{Defaults, SensorModel},
    log::{
        Input, Source,
        ahead::Ahead,
        csv::{CsvReadings, EmptyCell, PoseUse},
        format::Format,
        joined::Joined,
        mcap::{
            Boresight, ClockChoice, Finding, McapReadings, Options,
            write::{Contents, SchemaKind},
        },
        output::{Output, overwrites, same_file},
        plausible::Plausible,
        poses::PoseLog,
        sorted::Sorted,
    },
    pipeline::{self, AnyTrack, Settings},
    rig::{Rig, TableFormat},
    summary::Summary,
    track::{GapLimit, MotionLimit, PoseLimits, Track},
    units::Scale,
};

/// What is said of how to read recordings; `None` and empty where nothing is.
#[derive(Debug, Clone, Default)]
pub struct McapWishes {
    /// Topics of readings.
    pub range_topics: Vec<String>,
    /// Topics of scans whose beams are cones.
    pub scan_topics: Vec<String>,
    /// The topic of the poses.
    pub pose_topic: Option<String>,
    /// The topics of transforms, with those of static ones around them; all there are where it is empty.
    pub tf_topics: Vec<String>,
    /// The frame of the poses.
    pub fixed_frame: Option<String>,
    /// Which time of a message counts.
    pub clock: Option<ClockChoice>,
    /// How much later than others a message may be recorded and still be put in order, in nanoseconds.
    pub reorder: Option<u64>,
    /// Longest message that is read, in bytes.
    pub max_message: Option<u64>,
    /// From raw ranges and limits to metres, instead of what the rig says.
    pub range_unit: Option<Scale>,
    /// Along which axis of their frames sensors look.
    pub boresight: Option<Boresight>,
}

impl McapWishes {
    /// The first wish that was made, as the command line calls it.
    fn first(&self) -> Option<&'static str> {
        let made = [
            (!self.range_topics.is_empty(), "--range-topics"),
            (!self.scan_topics.is_empty(), "--scan-topics"),
            (self.pose_topic.is_some(), "--pose-topic"),
            (!self.tf_topics.is_empty(), "--tf-topics"),
            (self.fixed_frame.is_some(), "--fixed-frame"),
            (self.clock.is_some(), "--clock"),
            (self.reorder.is_some(), "--reorder"),
            (self.max_message.is_some(), "--max-message"),
            (self.boresight.is_some(), "--boresight"),
        ];
        made.into_iter().find(|(made, _)| *made).map(|(_, name)| name)
    }
}

/// How a log is read.
#[derive(Debug, Clone)]
pub struct LogJob {
    /// The log: a path, or `-` for standard input.
    pub input: String,
    /// Recordings that go on where the log ends: the parts in which a recorder has split it, in their order.
    pub parts: Vec<String>,
    /// What opens the log and the second file's poses: [`Input::open`], or that with something around it.
    pub opens: fn(&str) -> Result<Input>,
    /// Its format, instead of what its content says.
    pub from: Option<Format>,
    /// The sensors, where somebody says them.
    pub rig: Option<Arc<Rig>>,
    /// A trajectory in a second file.
    pub poses: Option<String>,
    /// A reading without a pose within this on both sides, in nanoseconds, has none; `None`: 0.5 s, and more where poses come
    /// less often.
    pub max_gap: Option<u64>,
    /// Fastest motion that is believed of the robot.
    pub max_speed: MotionLimit,
    /// What an empty cell of a table is.
    pub empty: Option<EmptyCell>,
    /// What holds where neither rig nor log says more.
    pub defaults: Defaults,
    /// How a recording is read.
    pub mcap: McapWishes,
}

/// A log that was opened.
pub enum OpenLog {
    /// A table, read ahead.
    Csv(Box<Ahead>, Option<Box<AnyTrack>>),
    /// A recording.
    Mcap(Box<McapReadings>),
}

impl OpenLog {
    /// Within which time it is put in order, in nanoseconds, where it is a recording.
    fn window(&self) -> Option<u64> {
        match self {
            Self::Csv(..) => None,
            Self::Mcap(log) => Some(log.window()),
        }
    }

    /// The log itself, and the second file's poses where it does not see to those.
    pub fn source(&mut self) -> (&mut dyn Source, Option<&mut AnyTrack>) {
        match self {
            Self::Csv(log, track) => (&mut **log, track.as_deref_mut()),
            Self::Mcap(log) => (&mut **log, None),
        }
    }
}

impl LogJob {
    /// The rig's sensors, completed; none without a rig, where a recording says itself what it saw.
    ///
    /// # Errors
    /// As [`Defaults::complete`].
    pub fn sensors(&self) -> Result<Vec<SensorModel>> {
        self.rig.as_deref().map_or_else(|| Ok(Vec::new()), |rig| self.defaults.complete(rig))
    }

    /// Opens the log itself, and says what it is.
    ///
    /// # Errors
    /// It can't be read.
    pub fn open(&self) -> Result<(Format, Input)> {
        let (found, input) = (self.opens)(&self.input)?.recognize(&self.input)?;
        let format = self.from.unwrap_or(found);
        if format != Format::Csv {
            return Ok((Format::Mcap, input));
        }
        if !self.parts.is_empty() {
            let message = format!(
                "{} is a table: only recordings can be read as one; with --out-dir each is fused alone",
                input.name
            );
            return Err(Error::Settings { message });
        }
        match self.mcap.first() {
            Some(name) => Err(Error::Settings { message: format!("{name}: {} is a table, no recording", input.name) }),
            None => Ok((format, input)),
        }
    }

    /// The largest gap between a reading and its poses, in nanoseconds.
    pub fn max_gap(&self) -> u64 {
        GapLimit::of(self.max_gap).max()
    }

    /// What poses have to keep to.
    fn limits(&self) -> PoseLimits {
        PoseLimits { gap: GapLimit::of(self.max_gap), motion: self.max_speed }
    }

    /// Bytes of the log and of its parts, where that is known.
    fn length(&self, input: &Input) -> Option<u64> {
        let sizes = self.parts.iter().map(|part| std::fs::metadata(part).ok().map(|metadata| metadata.len()));
        sizes.sum::<Option<u64>>()?.checked_add(input.length?)
    }

    /// Opens the recordings that go on where the log ends.
    ///
    /// # Errors
    /// One can't be read, or is a table.
    pub fn open_parts(&self) -> Result<Vec<(String, Input)>> {
        let open = |path: &String| {
            let (format, input) = (self.opens)(path)?.recognize(path)?;
            match format {
                Format::Csv => Err(Error::Settings {
                    message: format!(
                        "{path} is a table: only recordings can be read as one; with --out-dir each is fused alone"
                    ),
                }),
                _ => Ok((path.clone(), input)),
            }
        };
        self.parts.iter().map(open).collect()
    }

    /// How a recording is read.
    pub fn options(&self, poses: PoseUse) -> Options {
        let (wishes, default) = (self.mcap.clone(), Options::default());
        Options {
            range_topics: wishes.range_topics,
            scan_topics: wishes.scan_topics,
            pose_topic: wishes.pose_topic,
            fixed_frame: wishes.fixed_frame,
            clock: wishes.clock.unwrap_or(default.clock),
            reorder: wishes.reorder.unwrap_or(default.reorder),
            max_message: wishes.max_message.unwrap_or(default.max_message),
            tf_topics: wishes.tf_topics,
            limits: self.limits(),
            range_unit: wishes.range_unit,
            boresight: wishes.boresight.unwrap_or_default(),
            poses,
            everything: false,
            defaults: self.defaults,
        }
    }

    /// The second file's poses and what kind of file it is, where there is one.
    ///
    /// # Errors
    /// It can't be read, or is no trajectory.
    pub fn track(&self) -> Result<Option<(AnyTrack, &'static str)>> {
        let Some(path) = &self.poses else { return Ok(None) };
        let format = self.rig.as_deref().and_then(Rig::log).map(|formats| &formats.poses);
        let log = PoseLog::new((self.opens)(path)?, format)?;
        let kind = if log.is_tum() { "TUM" } else { "CSV" };
        Ok(Some((Track::new(Box::new(log), self.limits()), kind)))
    }

    /// Whether the range resolution of some sensor is a guess.
    pub fn guesses_resolution(&self) -> bool {
        match &self.rig {
            Some(rig) => self.defaults.guesses_resolution(rig),
            None => self.defaults.range_resolution.is_none(),
        }
    }

    /// The rig's sensors, completed; without a rig one that stands for all.
    ///
    /// # Errors
    /// As [`Defaults::complete`].
    pub fn models(&self) -> Result<Vec<SensorModel>> {
        match &self.rig {
            Some(rig) => self.defaults.complete(rig),
            None => self.defaults.complete(&Rig::ring(1, 0.0, 0.0, crate::rig::Ranging::default())?),
        }
    }

    /// Where the sensors sit, up to the first one of which the rig leaves that to the log.
    fn mounts(&self, sensors: &[SensorModel]) -> Vec<Isometry2<f64>> {
        let rig = self.rig.iter().flat_map(|rig| rig.sensors());
        rig.zip(sensors).take_while(|(sensor, _)| sensor.has_mount()).map(|(_, model)| model.mount).collect()
    }

    /// Refuses a rig whose `[log]` section says what has no effect on a recording.
    fn check_rig(&self) -> Result<()> {
        const TABLES_ONLY: [&str; 6] = ["header", "delimiter", "columns", "time_unit", "pose_unit", "yaw_unit"];
        let Some(rig) = self.rig.as_deref().filter(|_| self.poses.is_none()) else { return Ok(()) };
        let idle = rig.log_keys().iter().find(|key| TABLES_ONLY.contains(&key.as_str()) || *key == "poses");
        idle.map_or(Ok(()), |key| {
            let message = format!(
                "{}: the rig's `[log]` has `{key}`, which says how a table is written and has no effect on a recording; leave it \
                 out (range_unit and no_echo apply)",
                rig.name()
            );
            Err(Error::Settings { message })
        })
    }

    /// How a table of readings is written.
    pub fn table_format(&self) -> TableFormat {
        let format = self.rig.as_deref().and_then(Rig::log).map(|formats| formats.readings.clone()).unwrap_or_default();
        TableFormat { range: self.mcap.range_unit.unwrap_or(format.range), ..format }
    }

    /// The log that was opened, with the sensors and poses it needs. `everything`: what a recording holds besides is wanted, too.
    ///
    /// # Errors
    /// It can't be read, is none, lacks columns or poses; a table without a rig.
    pub fn readings(&self, format: Format, input: Input, everything: bool) -> Result<OpenLog> {
        let track = self.track()?.map(|(track, _)| Box::new(track));
        if format != Format::Csv {
            self.check_rig()?;
            let options = Options { everything, ..self.options(PoseUse::Needed) };
            let log = McapReadings::open(&self.input, input, self.rig.clone(), track.map(|track| *track), options)?;
            let log = log.followed_by(self.open_parts()?)?;
            return Ok(OpenLog::Mcap(Box::new(log)));
        }
        if everything {
            let message = format!("--passthrough: {} is a table, no recording that could be copied", input.name);
            return Err(Error::Settings { message });
        }
        let rig = self.rig.as_ref().ok_or_else(|| no_rig(&input.name))?;
        let poses = if track.is_some() { PoseUse::Ignored } else { PoseUse::Needed };
        let format = self.table_format();
        // Somebody may sit behind the output of what is no file.
        let live = input.length.is_none();
        let log = CsvReadings::new(input, &format, poses, self.empty, Arc::clone(rig))?;
        let log = match live {
            true => Ahead::new(Joined::new(log.joined_midway(), self.max_gap()), true)?,
            false => Ahead::new(Joined::new(Sorted::new(log), self.max_gap()), false)?,
        };
        Ok(OpenLog::Csv(Box::new(log), track))
    }
}

fn no_rig(file: &str) -> Error {
    let built_in = Rig::BUILTIN.join(", ");
    let message = format!(
        "{file}: a table does not say which sensors made it: name the rig with --rig (in Python rig=), a built-in one \
         ({built_in}) or a TOML file"
    );
    Error::Settings { message }
}

/// A run that fuses.
#[derive(Debug, Clone)]
pub struct FuseJob {
    /// The log.
    pub log: LogJob,
    /// The rig's file, so that no output overwrites it.
    pub rig_file: Option<String>,
    /// Where the echoes go; `-` is standard output, and without one they are only counted.
    pub output: Option<String>,
    /// Its format, instead of what its name says.
    pub to: Option<Format>,
    /// Where the crossings go.
    pub crossings: Option<String>,
    /// Where the counts go, as JSON.
    pub summary: Option<String>,
    /// Kinds of echoes to write, by their words, where not all are.
    pub keep: Option<Vec<&'static str>>,
    /// The messages of a recording that is written.
    pub schema: SchemaKind,
    /// Whether the log, a recording, is copied into the output, another one.
    pub passthrough: bool,
}

/// How a run ended.
#[derive(Debug)]
pub struct Ended {
    /// What was counted, whatever came of the run.
    pub summary: Summary,
    /// Where a recording's poses came from.
    pub pose_source: Option<String>,
    /// What a person should know of how the log was read.
    pub notes: Vec<String>,
    /// Why it did not end well.
    pub result: Result<()>,
    /// The files that hold what a run that did not end well had written.
    pub partials: Vec<String>,
}

/// Where a recording's poses come from, in words, and where else they could.
pub fn poses_of(log: &McapReadings) -> Option<String> {
    let others = log.other_poses();
    let others = match others.len() {
        0 => String::new(),
        _ => format!(" (not used: {}; --pose-topic chooses)", others.join(", ")),
    };
    Some(log.pose_source()? + &others)
}

/// Is told bytes read and the log's length, now and then and at the end; `false` ends the run.
pub type Progress<'a> = dyn FnMut(u64, Option<u64>) -> bool + 'a;

impl FuseJob {
    /// Refuses outputs that would destroy an input or one another, outputs that the estimator of `settings` has nothing for, and inputs
    /// that can't be had.
    ///
    /// # Errors
    /// [`Error::Settings`].
    pub fn check(&self, settings: &Settings) -> Result<()> {
        let refuse = |message: String| Err(Error::Settings { message });
        let outputs: Vec<&String> = [&self.output, &self.crossings, &self.summary].into_iter().flatten().collect();
        let inputs: Vec<Option<&String>> = [Some(&self.log.input), self.log.poses.as_ref(), self.rig_file.as_ref()]
            .into_iter()
            .chain(self.log.parts.iter().map(Some))
            .collect();
        for (index, output) in outputs.iter().enumerate() {
            if let Some(input) = inputs.iter().copied().flatten().find(|input| overwrites(output, input)) {
                return refuse(format!("{output}: writing it would overwrite the input {input}"));
            }
            if outputs.iter().take(index).any(|other| other == output || same_file(other, output)) {
                return refuse(format!("{output} is named for two outputs"));
            }
        }
        if self.log.poses.as_deref() == Some("-") && self.log.input == "-" {
            return refuse("standard input can't be both the log and the poses".into());
        }
        if settings.estimator.is_consensus() && self.crossings.is_some() {
            return refuse("--crossings: the estimator consensus has none".into());
        }
        if self.passthrough && (self.output.is_none() || self.format() != Format::Mcap) {
            let output = self.output.as_deref().unwrap_or("no output");
            return refuse(format!("--passthrough: {output} is no recording that the log could be copied into"));
        }
        Ok(())
    }

    /// The outputs of echoes and crossings, in words.
    fn output_names(&self) -> String {
        let names: Vec<&str> = [&self.output, &self.crossings].into_iter().flatten().map(String::as_str).collect();
        names.join(" and ")
    }

    /// What the output is.
    fn format(&self) -> Format {
        self.to.unwrap_or_else(|| self.output.as_deref().map_or(Format::Csv, Format::of_name))
    }

    /// Whether the log is copied into the output of these contents.
    fn passes(&self, contents: Contents) -> bool {
        self.passthrough && contents == Contents::Everything
    }

    /// Runs it, as `settings` say.
    ///
    /// # Errors
    /// What keeps it from beginning; what ends it later is in [`Ended::result`].
    pub fn run(&self, settings: &Settings, progress: &mut Progress<'_>) -> Result<Ended> {
        self.check(settings)?;
        let (format, input) = self.log.open()?;
        let length = self.log.length(&input);
        let mut log = self.log.readings(format, input, self.passthrough)?;
        let sensors = self.log.sensors()?;
        let input = outputs::Input {
            ids: self.log.rig.as_deref().map(Rig::ids).unwrap_or_default(),
            mounts: self.log.mounts(&sensors),
            window: log.window(),
        };
        let mut outputs = Outputs::create(self, settings, &input)?;
        if let (OpenLog::Mcap(log), true, Some(tap)) = (&mut log, self.passthrough, outputs.tap()) {
            log.set_tap(tap);
        }
        let counts = self.summary.as_deref().map(Output::create).transpose()?;
        let (source, track) = log.source();
        let mut plausible = Plausible::new(source, self.log.max_speed);
        let mut watched = Watched::new(&mut plausible, length, progress);
        let (mut summary, result) = pipeline::fuse(&mut watched, track, &sensors, settings, &mut outputs, &mut |_| {});
        let result = result.and_then(|()| watched.finish());
        if self.log.guesses_resolution() {
            let (near, echoes) = (summary.echoes.get(Kind::Near.name()), summary.echoes.total());
            summary.advice.extend(guessed_resolution(near, echoes));
        }
        let (pose_source, mut notes) = match &log {
            OpenLog::Csv(_, track) => {
                let bridged = track.as_ref().and_then(|track| track.bridged());
                let sparse = bridged.map(|(within, step)| Finding::SparsePoses { within, step }.to_string());
                (None, sparse.into_iter().collect())
            }
            OpenLog::Mcap(log) => (poses_of(log), log.notes()),
        };
        notes.extend(outputs.late());
        let partials = outputs.partials();
        let nothing = match (&log, result.as_ref().err()) {
            (OpenLog::Mcap(log), None) => nothing_usable(&self.log.input, log, &summary),
            _ => None,
        };
        // A recording of which nothing can be used, or that breaks off before anything could, leaves nothing.
        let broken = matches!((&log, result.as_ref().err()), (OpenLog::Mcap(_), Some(Error::Format { .. })));
        if nothing.is_some() || (broken && outputs.is_blank()) {
            outputs.discard()?;
            let counted = counts.map_or(Ok(()), |output| write_counts(output, &summary));
            let result = nothing.map_or(result, Err).and(counted);
            return Ok(Ended { summary, pose_source, notes, result, partials: Vec::new() });
        }
        let skipped = summary.skipped.held + summary.skipped.min_step + summary.duplicates;
        let useless = summary.readings + skipped == 0 && summary.dropped.total() > 0 && result.is_ok();
        let result = result.and_then(|()| if useless { outputs.take_back() } else { outputs.commit() });
        if useless && !partials.is_empty() {
            notes.push(format!("no reading could be used: {} is not written", self.output_names()));
        }
        let partials = if result.is_err() { partials } else { Vec::new() };
        // Whatever came of the run: what was counted is true.
        let counted = counts.map_or(Ok(()), |output| write_counts(output, &summary));
        Ok(Ended { summary, pose_source, notes, result: result.and(counted), partials })
    }
}

/// That nothing of a recording could be used though it is whole, and why.
fn nothing_usable(name: &str, log: &McapReadings, summary: &Summary) -> Option<Error> {
    let refuse = |message: String| {
        let file = if name == "-" { "standard input" } else { name };
        Some(Error::Format { place: Place { file: file.into(), line: 0, byte: 0 }, message })
    };
    let (silent, sensors) = log.unmatched();
    if summary.readings > 0 && sensors > 0 && silent.len() == sensors {
        let words = "no sensor of the rig has a reading: a reading belongs to the sensor whose `topic` is its topic or frame, or \
                     whose `id` is its frame";
        return refuse(format!("{words}; there are {}", log.readings_of().join(", ")));
    }
    if summary.readings > 0 || summary.input_damaged {
        return None;
    }
    let worst = summary.dropped.iter().max_by_key(|(_, count, _)| *count);
    refuse(match worst {
        Some((reason, count, first)) => {
            let of = summary.dropped.total();
            format!(
                "no reading can be used: {count} of {of} are {}, first at {}: {}",
                reason.key(),
                first.place,
                first.value
            )
        }
        None => "no reading can be used: there are none".to_owned(),
    })
}

fn write_counts(mut output: Output, summary: &Summary) -> Result<()> {
    let failed = |error: serde_json::Error| output.error(io::Error::other(error));
    let text = serde_json::to_string_pretty(summary).map_err(failed)?;
    writeln!(output, "{text}").map_err(|error| output.error(error))?;
    output.commit()
}
