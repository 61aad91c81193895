//! A recording as a source of readings.

use std::{collections::BTreeMap, fs::File, sync::Arc};

use atm_core::{Isometry2, UnitComplex, Vector2};

use super::{
    clocks::{ClockChoice, Clocks},
    decode::{Decoder, Kind, Measured, Said},
    order::{Order, Out},
    raw::{Channel, Message, Tap},
    records::{Item, Limits, Records},
    registry::Registry,
    rigid::Rigid,
    sensors::{Sensors, Sight},
    tree::{Frame, Hold},
    whereabouts::{Lost, Seat, Whereabouts, Wish},
    window::Recording,
};
use crate::{
    error::{Error, Place, Problem, Reason, Result},
    log::{Input, Next, Row, Source, View, csv::PoseUse},
    pipeline::{AnyTrack, Defaults},
    rig::Rig,
    stamp,
};

/// Sine of 10°: a boresight that points farther out of the plane is no sensor of the plane.
const STEEPEST: f64 = 0.173_648_177_666_930_33;
/// Bytes that are read without a reading before a caller hears of it.
const PATIENCE: u64 = 1 << 20;
/// How long transforms are kept for readings that come behind them, in nanoseconds: 10 s, as tf2 does.
const MEMORY: u64 = 10_000_000_000;
/// Transforms that are kept in case that the clock was set back, at most.
const MOST_LATE: usize = 1 << 13;

/// How a recording is read.
pub struct Options {
    /// Topics of readings; all there are where it is empty.
    pub range_topics: Vec<String>,
    /// The topic of the poses, instead of a choice.
    pub pose_topic: Option<String>,
    /// The frame of the poses, instead of a choice.
    pub fixed_frame: Option<String>,
    /// Which time of a message counts.
    pub clock: ClockChoice,
    /// How much later than others a message may be recorded and still be put in order, in nanoseconds.
    pub reorder: u64,
    /// Longest message that is read, in bytes.
    pub max_message: u64,
    /// A reading without a pose within this on both sides, in nanoseconds, has none.
    pub max_gap: u64,
    /// What is made of the recording's own poses.
    pub poses: PoseUse,
    /// What holds where neither rig nor recording says more.
    pub defaults: Defaults,
}

impl Options {
    /// 2 s, in nanoseconds.
    pub const REORDER: u64 = 2_000_000_000;
    /// 64 MiB.
    pub const MAX_MESSAGE: u64 = 64 << 20;
}

impl Default for Options {
    fn default() -> Self {
        Self {
            range_topics: Vec::new(),
            pose_topic: None,
            fixed_frame: None,
            clock: ClockChoice::Header,
            reorder: Self::REORDER,
            max_message: Self::MAX_MESSAGE,
            max_gap: 500_000_000,
            poses: PoseUse::Needed,
            defaults: Defaults::default(),
        }
    }
}

/// A reading that waits for its turn.
struct Reading {
    t: i64,
    log_time: u64,
    sensor: u16,
    frame: Option<Frame>,
    range: f64,
    sight: Sight,
    topic: Arc<str>,
    byte: u64,
}

/// A transform or pose that would be of use if the clock was set back.
struct Late {
    topic: Arc<str>,
    kind: Kind,
    said: Said,
    times: (i64, i64),
}

/// How a channel is read; `Err` holds why it can't be.
struct Line {
    topic: Arc<str>,
    kind: Kind,
    decoder: Result<Decoder, String>,
}

/// A recording in MCAP: readings with where their sensors were and what they saw.
pub struct McapReadings {
    records: Records,
    reader: Reader,
    tap: Option<Box<dyn Tap>>,
    ended: bool,
}

/// What is made of the messages.
struct Reader {
    name: Arc<str>,
    options: Options,
    lines: BTreeMap<u16, Option<Line>>,
    sensors: Sensors,
    whereabouts: Whereabouts,
    clocks: Clocks,
    order: Order<Reading>,
    late: Vec<Late>,
    said: Said,
    saw_ranges: bool,
}

impl McapReadings {
    /// Opens the recording at `path`, which is read as a file where it is one, else the `input` that was opened for it.
    ///
    /// `track` has the poses where they come from a second file; `tap` is told all that the recording holds.
    ///
    /// # Errors
    /// It can't be read, is no recording, or, where its summary tells, has no readings, no poses, or none of a topic that was
    /// asked for.
    pub fn open(
        path: &str,
        input: Input,
        rig: Option<Arc<Rig>>,
        track: Option<AnyTrack>,
        tap: Option<Box<dyn Tap>>,
        options: Options,
    ) -> Result<Self> {
        let name = input.name.clone();
        let recording = match input.length {
            Some(length) if path != "-" => {
                let file = File::open(path).map_err(|source| Error::Io { file: name.clone(), source })?;
                Recording::File(file, length)
            }
            _ => Recording::Stream(input.reader),
        };
        let everything = tap.is_some();
        let topics = options.range_topics.clone();
        let registry = Registry::new(Box::new(move |channel| everything || kind_of(channel, &topics).is_some()));
        let limits = Limits { max_message: options.max_message, everything };
        let records = Records::open(recording, name.clone(), registry, limits)?;
        let wish = Wish { topic: options.pose_topic.clone(), fixed: options.fixed_frame.clone() };
        let memory = i64::try_from(MEMORY.saturating_add(options.reorder.saturating_mul(2))).unwrap_or(i64::MAX);
        let reader = Reader {
            name,
            lines: BTreeMap::new(),
            sensors: Sensors::new(rig, options.defaults),
            whereabouts: Whereabouts::new(track, wish, options.max_gap, memory),
            clocks: Clocks::new(options.clock),
            order: Order::new(options.reorder),
            late: Vec::new(),
            said: Said::default(),
            saw_ranges: false,
            options,
        };
        let readings = Self { records, reader, tap, ended: false };
        if readings.records.is_complete() {
            readings.check_topics()?;
        }
        Ok(readings)
    }

    /// Refuses a recording without readings or without poses, once all channels are known.
    fn check_topics(&self) -> Result<()> {
        let kinds: Vec<(&Arc<Channel>, Option<Kind>)> =
            self.records.registry().channels().map(|channel| (channel, Kind::of(channel))).collect();
        let refuse = |message: String| {
            let place = Place { file: self.reader.name.clone(), line: 0, byte: 0 };
            Err(Error::Format { place, message })
        };
        let shown = |channel: &Channel| match &channel.schema {
            Some(schema) => format!("{} ({})", channel.topic, schema.name),
            None => format!("{} (of no type)", channel.topic),
        };
        let all = || match kinds.len() {
            0 => "there are no topics at all".to_owned(),
            _ => {
                format!("there are {}", kinds.iter().map(|(channel, _)| shown(channel)).collect::<Vec<_>>().join(", "))
            }
        };
        let options = &self.reader.options;
        let is_range = |kind: Kind| kind == Kind::Range;
        for (wanted, fits, what) in options
            .range_topics
            .iter()
            .map(|topic| (topic, true, "readings"))
            .chain(options.pose_topic.iter().map(|topic| (topic, false, "poses")))
        {
            let mut named = kinds.iter().filter(|(channel, _)| channel.topic == *wanted).peekable();
            if named.peek().is_none() {
                return refuse(format!("there is no topic {wanted}; {}", all()));
            }
            if !named.any(|(_, kind)| kind.is_some_and(|kind| is_range(kind) == fits)) {
                return refuse(format!("the topic {wanted} has no {what}; {}", all()));
            }
        }
        if !kinds.iter().any(|(_, kind)| kind.is_some_and(is_range)) {
            return refuse(format!("no topic has readings (sensor_msgs/Range); {}", all()));
        }
        let has_poses = kinds.iter().any(|(_, kind)| kind.is_some_and(|kind| !is_range(kind)));
        if !has_poses && options.poses == PoseUse::Needed {
            return refuse(format!(
                "no topic has poses (transforms, nav_msgs/Odometry, geometry_msgs/PoseStamped); give them with --poses; {}",
                all()
            ));
        }
        Ok(())
    }

    /// The topic of each sensor that has had a reading, by the sensor's index.
    pub fn topic(&self, sensor: u16) -> Option<&str> {
        self.reader.sensors.topic(sensor).map(|topic| &**topic)
    }

    /// Where the poses come from, in words, once that was decided.
    pub fn pose_source(&self) -> Option<String> {
        self.reader.whereabouts.source()
    }

    /// The frame in which the poses are, once that was decided and where it has a name.
    pub fn fixed_frame(&self) -> Option<&str> {
        self.reader.whereabouts.fixed_frame()
    }

    /// Topics that have poses, too, and are not used.
    pub fn other_poses(&self) -> Vec<&str> {
        self.reader.whereabouts.unused()
    }

    /// What a person should know of how the recording was read: which clocks it has, what was assumed.
    pub fn notes(&self) -> Vec<String> {
        self.reader.notes()
    }

    /// The recording has ended.
    fn end(&mut self) -> Result<()> {
        self.ended = true;
        self.reader.order.end();
        let nothing = !self.reader.saw_ranges || self.reader.whereabouts.is_blank();
        // Where the summary was not there to tell.
        if nothing && !self.records.is_complete() && !self.records.is_damaged() { self.check_topics() } else { Ok(()) }
    }

    fn take_next(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<()> {
        let Some((item, byte)) = self.records.next()? else { return self.end() };
        let tap = self.tap.as_deref_mut();
        match (item, tap) {
            (Item::Problem(problem), _) => problems(problem),
            (Item::Message(channel, message), tap) => {
                if let Some(tap) = tap {
                    tap.message(message)?;
                }
                self.reader.message(channel, message, byte, problems);
            }
            (Item::Channel(channel), tap) => {
                self.reader.clocks.is_simulated |= is_clock(channel);
                if let Some(tap) = tap {
                    tap.channel(channel)?;
                }
            }
            (Item::Header(profile, library), Some(tap)) => tap.header(profile, library)?,
            (Item::Metadata(metadata), Some(tap)) => tap.metadata(&metadata)?,
            (Item::Attachment(attachment), Some(tap)) => tap.attachment(attachment)?,
            (Item::Header(..) | Item::Metadata(_) | Item::Attachment(_), None) => {}
        }
        Ok(())
    }
}

impl Source for McapReadings {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        row.readings.clear();
        row.views.clear();
        row.pose = None;
        row.empty = 0;
        let start = self.records.position();
        loop {
            if let Some(out) = self.reader.order.pop() {
                match self.reader.hand_on(out, row, problems)? {
                    Some(next) => return Ok(next),
                    None => continue,
                }
            }
            if self.ended {
                return Ok(Next::End);
            }
            self.take_next(problems)?;
            if self.records.drained() || self.records.position() > start + PATIENCE {
                return Ok(Next::Unusable);
            }
        }
    }

    fn drained(&self) -> bool {
        !self.ended && self.records.drained()
    }

    fn position(&self) -> u64 {
        self.records.position()
    }

    fn has_poses(&self) -> bool {
        true
    }

    fn ids(&self) -> &[Arc<str>] {
        self.reader.sensors.ids()
    }
}

/// What of a channel is read, with the topics of readings that were asked for.
fn kind_of(channel: &Channel, topics: &[String]) -> Option<Kind> {
    let asked = |kind: &Kind| *kind != Kind::Range || topics.is_empty() || topics.contains(&channel.topic);
    Kind::of(channel).filter(asked)
}

/// Whether a channel is the time of a simulation.
fn is_clock(channel: &Channel) -> bool {
    channel.topic == "/clock"
        || channel.schema.as_ref().is_some_and(|schema| schema.name.ends_with("rosgraph_msgs/msg/Clock"))
}

impl Reader {
    fn place(&self, byte: u64) -> Place {
        Place { file: self.name.clone(), line: 0, byte }
    }

    /// Reads a message: holds a reading back, or takes a pose in.
    fn message(&mut self, channel: &Arc<Channel>, message: Message<'_>, byte: u64, problems: &mut dyn FnMut(Problem)) {
        self.order.goes_on(message.log_time);
        let topics = &self.options.range_topics;
        let line = self.lines.entry(channel.id).or_insert_with(|| {
            let kind = kind_of(channel, topics)?;
            Some(Line { topic: channel.topic.as_str().into(), kind, decoder: Decoder::for_channel(kind, channel) })
        });
        let Some(line) = line.take() else { return };
        let mut said = std::mem::take(&mut self.said);
        let problem = |reader: &Self, reason, words: &str| {
            let value = format!("{} at {}: {words}", line.topic, stamp::text(time(message.log_time)));
            Problem { reason, place: reader.place(byte), value }
        };
        let read = match &line.decoder {
            Ok(decoder) => decoder.read(message.data, &mut said, &mut |said| {
                if let Err((reason, words)) = self.said(&line, said, &message, byte) {
                    problems(problem(self, reason, &words));
                }
            }),
            Err(words) => {
                problems(problem(self, Reason::BadSchema, words));
                Ok(())
            }
        };
        if let Err(words) = read {
            problems(problem(self, Reason::BadMessage, &words));
        }
        self.said = said;
        self.lines.insert(channel.id, Some(line));
    }

    /// Takes in what one message, or one of a list in it, says.
    fn said(&mut self, line: &Line, said: &Said, message: &Message<'_>, byte: u64) -> Result<(), (Reason, String)> {
        let is_static = matches!(line.kind, Kind::Transform | Kind::Transforms) && line.topic.ends_with("tf_static");
        let log_time = time(message.log_time);
        if is_static {
            let added = self.whereabouts.add_transform(said, (0, log_time), Hold::Forever);
            return added.map_err(|words| (Reason::BadTransform, words));
        }
        let t = self
            .clocks
            .time(&line.topic, said.stamp(), message)
            .map_err(|(reason, words)| (reason, words.to_owned()))?;
        if line.kind == Kind::Range {
            self.saw_ranges = true;
            return self.reading(line, said, t, message.log_time, byte);
        }
        self.where_is(&line.topic, line.kind, said, (t, log_time))?;
        // Earlier than what was asked for already: of no use, except if the clock was set back.
        if self.order.passed().is_some_and(|passed| t < passed) && self.late.len() < MOST_LATE {
            let (topic, said) = (line.topic.clone(), said.clone());
            self.late.push(Late { topic, kind: line.kind, said, times: (t, log_time) });
        }
        Ok(())
    }

    /// Takes a transform or a pose in.
    fn where_is(&mut self, topic: &str, kind: Kind, said: &Said, times: (i64, i64)) -> Result<(), (Reason, String)> {
        let added = match kind {
            Kind::Transforms => self.whereabouts.add_transform(said, times, Hold::Moment),
            Kind::Transform => self.whereabouts.add_transform(said, times, Hold::UntilNext),
            Kind::Odometry | Kind::Pose => self.whereabouts.add_pose(topic, kind, said, times),
            Kind::Range => Ok(()),
        };
        added.map_err(|words| (Reason::BadTransform, words))
    }

    /// Holds a reading back until its turn.
    fn reading(&mut self, line: &Line, said: &Said, t: i64, log_time: u64, byte: u64) -> Result<(), (Reason, String)> {
        let measured: Measured = said.measured();
        let sensor = self.sensors.find(&line.topic, &said.frame)?;
        let sight = self.sensors.sight(sensor, measured)?;
        let frame = match said.frame.is_empty() {
            true => None,
            false => Some(self.whereabouts.frame(&said.frame).map_err(|words| (Reason::NoTransform, words))?),
        };
        if self.order.is_timely(t) {
            self.late.clear();
        }
        let reading =
            Reading { t, log_time, sensor, frame, range: measured.range, sight, topic: line.topic.clone(), byte };
        self.order.push(t, log_time, reading);
        Ok(())
    }

    /// Makes a record of what is due, if there is one.
    fn hand_on(&mut self, out: Out<Reading>, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Option<Next>> {
        let (reading, is_late) = match out {
            Out::Next(reading) => (reading, false),
            Out::Late(reading) => (reading, true),
            Out::SetBack => {
                self.whereabouts.set_back();
                for late in std::mem::take(&mut self.late) {
                    // What is wrong with it was said when it came.
                    let _ = self.where_is(&late.topic, late.kind, &late.said, late.times);
                }
                return Ok(None);
            }
        };
        row.t = reading.t;
        row.log_time = time(reading.log_time);
        row.place = self.place(reading.byte);
        // Whoever takes it counts it as going back in time, before a pose is asked for.
        let placed = if is_late { None } else { self.placed(&reading, problems)? };
        let needed = self.options.poses == PoseUse::Needed;
        let (pose, range, view) = match placed {
            Some(placed) if needed => placed,
            None if needed && !is_late => return Ok(Some(Next::Unusable)),
            // As it stands in the recording.
            _ => (None, reading.range, view(reading.sight, Isometry2::identity())),
        };
        row.pose = pose;
        row.readings.push((reading.sensor, range));
        row.views.push(view);
        Ok(Some(Next::Record))
    }

    /// Where a reading was taken, and what of it is in the plane; `None` where that can't be said, and was told.
    fn placed(&mut self, reading: &Reading, problems: &mut dyn FnMut(Problem)) -> Result<Option<Taken>> {
        let seat = Seat { frame: reading.frame, mount: self.sensors.mount(reading.sensor), t: reading.t };
        let placed = self.whereabouts.place(seat, problems)?;
        let projected = placed.and_then(|placed| {
            let (range, view) = on_plane(reading, &placed.sensor)?;
            Ok((Some(placed.robot), range, view))
        });
        Ok(match projected {
            Ok(taken) => Some(taken),
            Err(Lost { reason, words }) => {
                let value = format!("{} at {}: {words}", reading.topic, stamp::text(reading.t));
                problems(Problem { reason, place: self.place(reading.byte), value });
                None
            }
        })
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(words) = self.clocks.words() {
            notes.push(format!("clock     {words}"));
        }
        let blind = self.sensors.without_beam();
        if !blind.is_empty() {
            let beam = self.options.defaults.field_of_view.map_or(Defaults::FIELD_OF_VIEW, |beam| beam.field_of_view());
            let ids = blind.join(", ");
            notes.push(format!(
                "beam      {:.1}deg is assumed of {ids}, whose messages do not say it",
                beam.to_degrees()
            ));
        }
        notes
    }
}

/// The robot's pose, and the reading with its view, in the plane.
type Taken = (Option<crate::track::Pose>, f64, View);

/// What of a reading is in the plane of the fixed frame: distances are shorter by the cosine of the boresight's elevation.
fn on_plane(reading: &Reading, sensor: &Rigid) -> Result<(f64, View), Lost> {
    let [forward, left, up] = sensor.forward();
    // NaN is out of the plane, too.
    if up.is_nan() || up.abs() > STEEPEST {
        let degrees = libm::asin(up.clamp(-1.0, 1.0)).to_degrees();
        let words = format!("its boresight points {degrees:.1}deg out of the plane, and may 10deg");
        return Err(Lost { reason: Reason::Tilted, words });
    }
    let cosine = (forward * forward + left * left).sqrt();
    let (x, y) = sensor.position();
    let heading = UnitComplex::from_cos_sin_unchecked(forward / cosine, left / cosine);
    let pose = Isometry2::from_parts(Vector2::new(x, y).into(), heading);
    let mut view = view(reading.sight, pose);
    if up == 0.0 {
        return Ok((reading.range, view));
    }
    let (min, max) = (reading.sight.limits.min() * cosine, reading.sight.limits.max() * cosine);
    let limits = atm_core::Limits::new(min, max);
    view.limits = limits.map_err(|error| Lost { reason: Reason::BadLimits, words: error.to_string() })?;
    Ok((reading.range * cosine, view))
}

const fn view(sight: Sight, pose: Isometry2<f64>) -> View {
    View { pose, limits: sight.limits, beam: sight.beam, range_resolution: sight.range_resolution }
}

/// A time of the file; what is out of reach is as late as can be.
fn time(nanoseconds: u64) -> i64 {
    i64::try_from(nanoseconds).unwrap_or(i64::MAX)
}
