//! What is made of the messages: poses are taken in, readings wait for their turn and are placed.

use std::{collections::BTreeMap, sync::Arc};

use atm_core::Isometry2;

use super::{
    clocks::Clocks,
    decode::{Decoder, Kind, Said},
    options::Options,
    order::{Order, Out},
    plane::{on_plane, view},
    raw::{Channel, Message},
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
    track::{Pose, seconds, time_backwards},
};

/// How long transforms are kept for readings that come behind them, in nanoseconds: 10 s, as tf2 does.
const MEMORY: u64 = 10_000_000_000;
/// Transforms that are kept in case that the clock was set back, at most.
const MOST_LATE: usize = 1 << 13;

/// A reading that waits for its turn.
pub(super) struct Reading {
    t: i64,
    log_time: u64,
    sensor: u16,
    frame: Option<Frame>,
    pub(super) range: f64,
    pub(super) sight: Sight,
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
            options,
        }
    }

    pub(super) const fn name(&self) -> &Arc<str> {
        &self.name
    }

    pub(super) const fn options(&self) -> &Options {
        &self.options
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
        if Kind::of(channel).is_some_and(|kind| kind != Kind::Range) {
            self.whereabouts.expect(&channel.topic);
        }
    }

    /// There will be no more messages.
    pub(super) fn end(&mut self) {
        self.order.end();
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
            let added = self.whereabouts.add_transform(&line.topic, said, (0, log_time), Hold::Forever);
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
            Kind::Transforms => self.whereabouts.add_transform(topic, said, times, Hold::Moment),
            Kind::Transform => self.whereabouts.add_transform(topic, said, times, Hold::UntilNext),
            Kind::Odometry | Kind::Pose => self.whereabouts.add_pose(topic, kind, said, times),
            Kind::Range => Ok(()),
        };
        added.map_err(|words| (Reason::BadTransform, words))
    }

    /// Holds a reading back until its turn.
    fn reading(&mut self, line: &Line, said: &Said, t: i64, log_time: u64, byte: u64) -> Result<(), (Reason, String)> {
        self.whereabouts.comes_from(&line.topic).map_err(|lost| (lost.reason, lost.words))?;
        let measured = self.sensors.in_metres(said.measured());
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
                problems(time_backwards(reading.t, self.order.passed(), self.place(reading.byte)));
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
        row.place = self.place(reading.byte);
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
            return Err(Error::Format { place: self.place(reading.byte), message: format!("{}: {words}", reading.topic) });
        }
        if self.frames.is_none() && placed.is_ok() {
            self.frames = Some(Arc::new(self.whereabouts.frames(seat)));
        }
        let projected = placed.and_then(|placed| {
            let (range, view) = on_plane(reading, &placed.sensor)?;
            Ok((Some(placed.robot), range, view))
        });
        Ok(match projected {
            Ok(taken) => Some(taken),
            Err(Lost { reason, words, .. }) => {
                let value = format!("{} at {}: {words}", reading.topic, stamp::text(reading.t));
                problems(Problem { reason, place: self.place(reading.byte), value });
                None
            }
        })
    }

    /// Takes in how far the clocks of a reading and of its poses are apart.
    fn compare_clocks(&mut self, reading: &Reading, seat: Seat) {
        let own = reading.t.saturating_sub(time(reading.log_time));
        if let Some(poses) = self.whereabouts.offset(seat, own) {
            self.clocks.compare(&reading.topic, own.saturating_sub(poses));
        }
    }

    /// What a person should know of how the recording was read.
    pub(super) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some(words) = self.clocks.words() {
            notes.push(format!("clock     {words}"));
        }
        notes.extend(self.clocks.lags(self.options.limits.gap.max()));
        notes.extend(self.pose_notes());
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

impl Reader {
    /// What a person should know of the poses.
    fn pose_notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some((within, step)) = self.whereabouts.bridged() {
            notes.push(format!(
                "gaps      poses up to {} apart are used, between which the robot moved {:.2} m and {:.0}deg at most; --max-gap \
                 bounds that",
                seconds(within),
                step.distance,
                step.turn.to_degrees(),
            ));
        }
        for (what, doubts) in self.whereabouts.doubted() {
            let times = |count: u64| format!("{count} times");
            let said = match doubts.returning {
                0 => format!("{} had another value at the same time", times(doubts.contradicted)),
                returning => format!("{} jumped to and fro, by up to {:.2} m", times(returning), doubts.widest),
            };
            notes.push(format!(
                "warning: the {what} {said}: two sources publish them; leave one out with --tf-topics or --pose-topic, or record \
                 it alone"
            ));
        }
        notes
    }
}

/// A time of the file; what is out of reach is as late as can be.
pub(super) fn time(nanoseconds: u64) -> i64 {
    i64::try_from(nanoseconds).unwrap_or(i64::MAX)
}
