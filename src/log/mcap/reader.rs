//! What is made of the messages: poses are taken in, readings wait for their turn and are placed.

use std::{collections::BTreeMap, sync::Arc};

use atm_core::Isometry2;

use super::{
    clocks::Clocks,
    decode::{Decoder, Kind, Measured, Said},
    finding::Finding,
    options::{Boresight, Options},
    order::{Order, Out},
    plane::{on_plane, view},
    raw::{Channel, Message},
    rigid::Rigid,
    sensors::{Sensors, Sight},
    topics::{is_clock, kind_of},
    tree::{Frame, Hold},
    whereabouts::{Lost, Seat, Whereabouts, Wish},
};
use crate::{
    error::{Error, Place, Problem, Reason, Result},
    log::{Frames, Next, Row, View, csv::PoseUse},
    pipeline::{AnyTrack, Defaults},
    rig::Rig,
    stamp,
    track::{Pose, time_backwards},
};

/// How long transforms are kept for readings that come behind them, in nanoseconds: 10 s, as tf2 does.
const MEMORY: u64 = 10_000_000_000;
/// Transforms that are kept in case that the clock was set back, at most.
const MOST_LATE: usize = 1 << 13;

/// Frames that are named in one finding, at most.
const MOST_OPTICAL: usize = 64;

/// A reading that waits for its turn.
pub(super) struct Reading {
    t: i64,
    log_time: u64,
    sensor: u16,
    file: Arc<str>,
    frame: Option<Frame>,
    /// Where the boresight points in the frame, where not along its x axis.
    turn: Option<Rigid>,
    pub(super) range: f64,
    pub(super) sight: Sight,
    topic: Arc<str>,
    byte: u64,
}

impl Reading {
    fn place(&self) -> Place {
        Place { file: self.file.clone(), line: 0, byte: self.byte }
    }
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

/// The robot's pose, and the reading with its view, in the plane.
type Taken = (Option<Pose>, f64, View);

/// What is made of the messages.
pub(super) struct Reader {
    name: Arc<str>,
    options: Options,
    lines: BTreeMap<u16, Option<Line>>,
    sensors: Sensors,
    whereabouts: Whereabouts,
    clocks: Clocks,
    order: Order<Reading>,
    late: Vec<Late>,
    /// What the frames are called, once that is decided.
    frames: Option<Arc<Frames>>,
    said: Said,
    saw_ranges: bool,
    /// Sensors of which the message has said something already.
    in_message: Vec<u16>,
    /// Namespaces other than the readings' whose transforms are used.
    borrowed: Vec<String>,
    /// Frames of sensors that by their name look along z, and are read otherwise.
    optical: Vec<String>,
}

impl Reader {
    /// Nothing was read yet.
    pub(super) fn new(name: Arc<str>, rig: Option<Arc<Rig>>, track: Option<AnyTrack>, options: Options) -> Self {
        let wish = Wish {
            topic: options.pose_topic.clone(),
            transforms: options.tf_topics.clone(),
            ranges: options.range_topics.clone(),
            fixed: options.fixed_frame.clone(),
        };
        let memory = i64::try_from(MEMORY.saturating_add(options.reorder.saturating_mul(2))).unwrap_or(i64::MAX);
        Self {
            name,
            lines: BTreeMap::new(),
            sensors: Sensors::new(rig, options.defaults, options.range_unit),
            whereabouts: Whereabouts::new(track, wish, options.limits, memory),
            clocks: Clocks::new(options.clock),
            order: Order::new(options.reorder),
            late: Vec::new(),
            frames: None,
            said: Said::default(),
            saw_ranges: false,
            in_message: Vec::new(),
            borrowed: Vec::new(),
            optical: Vec::new(),
            options,
        }
    }

    pub(super) const fn name(&self) -> &Arc<str> {
        &self.name
    }

    pub(super) const fn options(&self) -> &Options {
        &self.options
    }

    pub(super) const fn sensors(&self) -> &Sensors {
        &self.sensors
    }

    pub(super) fn ids(&self) -> &[Arc<str>] {
        self.sensors.ids()
    }

    /// The topic of a sensor, once it has had a reading.
    pub(super) fn topic(&self, sensor: u16) -> Option<&str> {
        self.sensors.topic(sensor).map(|topic| &**topic)
    }

    pub(super) const fn whereabouts(&self) -> &Whereabouts {
        &self.whereabouts
    }

    /// Whether the poses come from a second file.
    pub(super) fn has_track(&self) -> bool {
        self.whereabouts.has_track()
    }

    /// Whether there was no reading, or nothing that says where anything is.
    pub(super) fn saw_nothing(&self) -> bool {
        !self.saw_ranges || self.whereabouts.is_blank()
    }

    /// There is a channel of this kind.
    pub(super) fn expect(&mut self, channel: &Channel) {
        if is_clock(channel) {
            self.clocks.is_simulated = true;
        }
        if Kind::of(channel).is_some_and(|kind| !kind.is_reading()) {
            self.whereabouts.expect(&channel.topic);
        }
    }

    /// There will be no more messages.
    pub(super) fn end(&mut self) {
        self.order.end();
    }

    /// What comes is of another recording, in this file.
    pub(super) fn restart(&mut self, file: Arc<str>) {
        self.name = file;
        self.lines.clear();
    }

    fn place(&self, byte: u64) -> Place {
        Place { file: self.name.clone(), line: 0, byte }
    }

    /// Reads a message: holds a reading back, or takes a pose in.
    pub(super) fn message(
        &mut self,
        channel: &Arc<Channel>,
        message: Message<'_>,
        byte: u64,
        problems: &mut dyn FnMut(Problem),
    ) {
        self.order.goes_on(message.log_time);
        let (topics, scans) = (&self.options.range_topics, &self.options.scan_topics);
        self.in_message.clear();
        let line = self.lines.entry(channel.id).or_insert_with(|| {
            let kind = kind_of(channel, topics, scans)?;
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
            let added = self.whereabouts.add_transform(&line.topic, said, (0, log_time), Hold::Forever);
            return added.map_err(|words| (Reason::BadTransform, words));
        }
        let t = self
            .clocks
            .time(&line.topic, said.stamp(), message)
            .map_err(|(reason, words)| (reason, words.to_owned()))?;
        if line.kind.is_reading() {
            self.saw_ranges = true;
            return self.readings(line, said, t, (message.log_time, byte));
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
            Kind::Transforms => self.whereabouts.add_transform(topic, said, times, Hold::Moment),
            Kind::Transform => self.whereabouts.add_transform(topic, said, times, Hold::UntilNext),
            Kind::Odometry | Kind::Pose => self.whereabouts.add_pose(topic, kind, said, times),
            Kind::Range | Kind::Ranges | Kind::Scan => Ok(()),
        };
        added.map_err(|words| (Reason::BadTransform, words))
    }

    /// Takes in the reading, or each of the readings, of a message.
    fn readings(&mut self, line: &Line, said: &Said, t: i64, at: (u64, u64)) -> Result<(), (Reason, String)> {
        self.whereabouts.comes_from(&line.topic).map_err(|lost| (lost.reason, lost.words))?;
        if line.kind != Kind::Scan {
            let sensor = self.sensors.find(&line.topic, &said.frame)?;
            if self.in_message.contains(&sensor) {
                let words = "its message has more than one reading of this frame, and no two sensors are at one place";
                return Err((Reason::SharedFrame, format!("`{}`: {words}", said.frame)));
            }
            self.in_message.push(sensor);
            return self.reading(line, said, (sensor, None, said.measured()), t, at);
        }
        let mut outcome = Ok(());
        for (index, direction, measured) in said.scan().beams() {
            let id = index.map_or_else(|| said.frame.clone(), |index| format!("{}/{index}", said.frame));
            let turn = Rigid::flat(0.0, 0.0, libm::cos(direction), libm::sin(direction));
            let sensor = self.sensors.find(&line.topic, &id);
            let taken = sensor.and_then(|sensor| self.reading(line, said, (sensor, Some(turn), measured), t, at));
            outcome = outcome.and(taken);
        }
        outcome
    }

    /// Holds a reading back until its turn.
    fn reading(
        &mut self,
        line: &Line,
        said: &Said,
        (sensor, turn, measured): (u16, Option<Rigid>, Measured),
        t: i64,
        (log_time, byte): (u64, u64),
    ) -> Result<(), (Reason, String)> {
        let measured = self.sensors.in_metres(measured);
        let sight = self.sensors.sight(sensor, measured)?;
        self.note_optical(sensor, &said.frame);
        let frame = match said.frame.is_empty() {
            true => None,
            false => Some(self.whereabouts.frame(&said.frame).map_err(|words| (Reason::NoTransform, words))?),
        };
        if self.order.is_timely(t) {
            self.late.clear();
        }
        let (range, topic, file) = (measured.range, line.topic.clone(), self.name.clone());
        let reading = Reading { t, log_time, sensor, file, frame, turn, range, sight, topic, byte };
        self.order.push(t, log_time, reading);
        Ok(())
    }

    /// Makes a record of what is due, if anything is.
    pub(super) fn next_due(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Option<Next>> {
        while let Some(out) = self.order.pop() {
            if let Some(next) = self.hand_on(out, row, problems)? {
                return Ok(Some(next));
            }
        }
        Ok(None)
    }

    /// Makes a record of what comes out, if it is one.
    fn hand_on(&mut self, out: Out<Reading>, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Option<Next>> {
        let reading = match out {
            Out::Next(reading) => reading,
            Out::Late(reading) => {
                problems(time_backwards(reading.t, self.order.passed(), reading.place()));
                return Ok(Some(Next::Unusable));
            }
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
        row.place = reading.place();
        let placed = self.placed(&reading, problems)?;
        let needed = self.options.poses == PoseUse::Needed;
        let (pose, range, view) = match placed {
            Some(placed) if needed => placed,
            None if needed => return Ok(Some(Next::Unusable)),
            // As it stands in the recording.
            _ => (None, reading.range, view(reading.sight, Isometry2::identity())),
        };
        row.pose = pose;
        row.frames.clone_from(&self.frames);
        row.readings.push((reading.sensor, range));
        row.views.push(view);
        Ok(Some(Next::Record))
    }

    /// Where a reading was taken, and what of it is in the plane; `None` where that can't be said, and was told.
    fn placed(&mut self, reading: &Reading, problems: &mut dyn FnMut(Problem)) -> Result<Option<Taken>> {
        let seat = Seat { frame: reading.frame, mount: self.sensors.mount(reading.sensor), t: reading.t };
        let placed = self.whereabouts.place(seat, problems)?;
        self.compare_clocks(reading, seat);
        if let Err(Lost { words, is_final: true, .. }) = placed {
            return Err(Error::Format { place: reading.place(), message: format!("{}: {words}", reading.topic) });
        }
        if self.frames.is_none() && placed.is_ok() {
            self.frames = Some(Arc::new(self.whereabouts.frames(seat)));
            self.borrowed = self.whereabouts.borrowed(reading.frame).into_iter().map(str::to_owned).collect();
        }
        let projected = placed.and_then(|placed| {
            // A rig's mount is along the boresight already.
            let axis = self.options.boresight.rotation();
            let turns = [axis, reading.turn].into_iter().flatten().filter(|_| seat.mount.is_none());
            let sensor = turns.fold(placed.sensor, |sensor, turn| sensor.of(&turn));
            let (range, view) = on_plane(reading, &sensor)?;
            Ok((Some(placed.robot), range, view))
        });
        Ok(match projected {
            Ok(taken) => Some(taken),
            Err(Lost { reason, words, .. }) => {
                let value = format!("{} at {}: {words}", reading.topic, stamp::text(reading.t));
                problems(Problem { reason, place: reading.place(), value });
                None
            }
        })
    }

    /// Notes a frame that by its name looks along z, where that is not how it is read.
    fn note_optical(&mut self, sensor: u16, frame: &str) {
        let looks_along_z = frame.ends_with("_optical_frame") || frame.ends_with("_optical");
        if looks_along_z
            && self.options.boresight == Boresight::X
            && self.sensors.mount(sensor).is_none()
            && self.optical.len() < MOST_OPTICAL
            && !self.optical.iter().any(|known| known == frame)
        {
            self.optical.push(frame.to_owned());
        }
    }

    /// Takes in how far the clocks of a reading and of its poses are apart.
    fn compare_clocks(&mut self, reading: &Reading, seat: Seat) {
        let own = reading.t.saturating_sub(time(reading.log_time));
        if let Some(poses) = self.whereabouts.offset(seat, own) {
            self.clocks.compare(&reading.topic, own.saturating_sub(poses));
        }
    }

    /// By how much stamps are later than the times of recording, in words.
    pub(super) fn clock_words(&self) -> Option<String> {
        self.clocks.words()
    }

    /// What a person should know of how the recording was read.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let owned = |ids: Vec<&str>| -> Vec<String> { ids.into_iter().map(str::to_owned).collect() };
        let mut findings = Vec::new();
        findings.extend(self.clocks.other());
        findings.extend(self.clocks.lag(self.options.limits.gap.max()));
        let bridged = self.whereabouts.bridged();
        findings.extend(bridged.map(|(within, step)| Finding::SparsePoses { within, step }));
        findings.extend(self.whereabouts.doubted().into_iter().map(|(what, doubts)| Finding::TwoSources {
            what,
            returning: doubts.returning,
            widest: doubts.widest,
            contradicted: doubts.contradicted,
        }));
        let (idle, _) = self.sensors.unmatched();
        if !idle.is_empty() && self.options.range_topics.is_empty() {
            findings.push(Finding::IdleSensors { ids: owned(idle) });
        }
        if !self.borrowed.is_empty() {
            findings.push(Finding::BorrowedTransforms { namespaces: self.borrowed.clone() });
        }
        if !self.optical.is_empty() {
            findings.push(Finding::OpticalFrames { frames: self.optical.clone() });
        }
        let blind = self.sensors.without_beam();
        if !blind.is_empty() {
            let beam = self.options.defaults.field_of_view.map_or(Defaults::FIELD_OF_VIEW, |beam| beam.field_of_view());
            findings.push(Finding::AssumedBeam { ids: owned(blind), beam });
        }
        findings.extend(self.sensors.findings());
        findings
    }
}

/// A time of the file; what is out of reach is as late as can be.
pub(super) fn time(nanoseconds: u64) -> i64 {
    i64::try_from(nanoseconds).unwrap_or(i64::MAX)
}
