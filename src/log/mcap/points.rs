//! The points of all clouds under one topic, one after another, in memory for one message.

use std::sync::Arc;

use super::{
    arena::Item,
    decode::{Cloud, CloudType, Sort, Spot},
    options::Options,
    raw::{Channel, Message},
    reader::time,
    records::{Limits, Records},
    registry::Registry,
    sensor_ids::SensorIds,
    topics,
    unpacking::Ahead,
    window::Recording,
};
use crate::{
    error::{Error, Place, Problem, Reason, Result},
    log::Input,
    stamp,
};

/// A number that every point has to have: the names of its field, the first that is there counts, and what it has to be.
pub(super) type Wanted = (&'static [&'static str], Sort);

/// What can't be used of a point: why, and what stood there.
pub(super) type Fault = (Reason, String);

/// The points under one topic, `N` numbers of each.
pub(super) struct Points<const N: usize> {
    name: Arc<str>,
    records: Records,
    topic: &'static str,
    wanted: &'static [Wanted; N],
    sensors: SensorIds,
    held: Held<N>,
    /// The topic is in the recording.
    is_there: bool,
}

/// The cloud whose points are handed on.
struct Held<const N: usize> {
    points: Vec<u8>,
    stride: usize,
    spots: Option<[Spot; N]>,
    /// Points that were handed on.
    passed: usize,
    t: i64,
    byte: u64,
}

impl<const N: usize> Points<N> {
    /// Opens the recording at `path`, which is read as a file where it is one, else the `input` that was opened for it.
    ///
    /// Errors where it can't be read, is no recording, or, where its summary tells, has no clouds under the topic.
    pub(super) fn open(path: &str, input: Input, topic: &'static str, wanted: &'static [Wanted; N]) -> Result<Self> {
        let name = input.name.clone();
        let registry = Registry::new(Box::new(move |channel| channel.topic == topic));
        let limits = Limits { max_message: Options::MAX_MESSAGE, everything: false, metadata: true };
        let records = Records::open(Recording::open(path, input)?, name.clone(), registry, limits, Ahead::Never)?;
        let held = Held { points: Vec::new(), stride: 0, spots: None, passed: 0, t: 0, byte: 0 };
        let mut points = Self { name, records, topic, wanted, sensors: SensorIds::default(), held, is_there: false };
        if points.records.is_complete() {
            for channel in points.records.registry().channels() {
                points.is_there |= is_cloud(channel, topic).map_err(|words| format_error(&points.name, 0, words))?;
            }
            points.check_topic()?;
        }
        Ok(points)
    }

    /// The numbers of the next point, `None` at the end; what of the recording can't be used goes to `problems`.
    ///
    /// Errors where the recording can't be read on, or has no points with these numbers under the topic.
    pub(super) fn next(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<Option<[f64; N]>> {
        loop {
            if let Some(point) = self.held.next() {
                return Ok(Some(point));
            }
            if !self.take_next(problems)? {
                return Ok(None);
            }
        }
    }

    /// Takes the recording's next item in; `false` at the end.
    fn take_next(&mut self, problems: &mut dyn FnMut(Problem)) -> Result<bool> {
        let Some((item, byte)) = self.records.next()? else {
            // What is lost may have had the topic in it.
            return if self.records.is_damaged() { Ok(false) } else { self.check_topic().map(|()| false) };
        };
        match item {
            Item::Problem(problem) => problems(problem),
            Item::Channel(channel) => {
                self.is_there |=
                    is_cloud(channel, self.topic).map_err(|words| format_error(&self.name, byte, words))?;
            }
            Item::Metadata(metadata) => {
                if let Err(words) = self.sensors.learn(&metadata) {
                    let place = Place { file: self.name.clone(), line: 0, byte };
                    problems(Problem { reason: Reason::BadMessage, place, value: words });
                }
            }
            Item::Message(channel, message) => {
                self.held.byte = byte;
                match self.held.take(channel, message, self.wanted) {
                    Ok(()) => {}
                    Err(Refused::Message(words)) => problems(problem(&self.name, byte, Reason::BadMessage, words)),
                    Err(Refused::Topic(words)) => return Err(format_error(&self.name, byte, words)),
                }
            }
            Item::Header(..) | Item::Attachment(_) | Item::Restart(_) | Item::Nothing => {}
        }
        Ok(true)
    }

    /// Insists that the topic is in the recording.
    fn check_topic(&self) -> Result<()> {
        if self.is_there {
            return Ok(());
        }
        let there = topics::all(self.records.registry().channels().map(|channel| &**channel));
        Err(format_error(&self.name, 0, format!("there is no topic {} (atm fuse writes it); {there}", self.topic)))
    }

    /// A time of the latest point's cloud: so many nanoseconds, a whole number, after its stamp.
    pub(super) fn time(&self, name: &str, since: f64) -> Result<i64, Fault> {
        let t = Some(since).filter(|since| since.is_finite()).and_then(|since| self.held.t.checked_add(since as i64));
        t.ok_or_else(|| (Reason::BadNumber, format!("{name} {since}")))
    }

    /// The id of the sensor with this index.
    pub(super) fn sensor(&self, index: f64) -> Result<Arc<str>, Fault> {
        self.sensors.get(index).map_err(|words| (Reason::UnknownSensor, words))
    }

    /// What is to be told of the latest point.
    pub(super) fn problem(&self, (reason, words): Fault) -> Problem {
        let (at, point) = (stamp::text(self.held.t), self.held.passed);
        problem(&self.name, self.held.byte, reason, format!("{} at {at}: {words} in point {point}", self.topic))
    }
}

/// Why a cloud gives no points.
enum Refused {
    /// It can't be read.
    Message(String),
    /// It is none of those that are looked for.
    Topic(String),
}

impl<const N: usize> Held<N> {
    /// Takes a message in.
    fn take(&mut self, channel: &Channel, message: Message<'_>, wanted: &[Wanted; N]) -> Result<(), Refused> {
        let said = |words: String| format!("{} at {}: {words}", channel.topic, stamp::text(time(message.log_time)));
        let read = CloudType::of(channel).ok_or_else(|| "no cloud".to_owned()).and_then(|kind| kind.read(message.data));
        let cloud: Cloud<'_> = read.map_err(|words| Refused::Message(said(words)))?;
        let mut spots = Vec::with_capacity(N);
        for (names, sort) in wanted {
            spots.push(cloud.find(names, *sort).map_err(|words| Refused::Topic(said(words)))?);
        }
        self.points.clear();
        self.points.extend_from_slice(cloud.points);
        self.spots = spots.try_into().ok();
        (self.stride, self.passed, self.t) = (cloud.stride, 0, cloud.t);
        Ok(())
    }

    /// The next point's numbers.
    fn next(&mut self) -> Option<[f64; N]> {
        let start = self.passed.checked_mul(self.stride)?;
        let point = self.points.get(start..start.checked_add(self.stride)?).filter(|point| !point.is_empty())?;
        let numbers = self.spots?.map(|spot| spot.read(point));
        self.passed += 1;
        Some(numbers)
    }
}

/// Whether the channel is under the topic; refuses one that is and has no clouds, in words.
fn is_cloud(channel: &Channel, topic: &str) -> Result<bool, String> {
    if channel.topic != topic {
        return Ok(false);
    }
    let name = channel.schema.as_deref().map_or("of no type", |schema| schema.name.as_str());
    let types = "sensor_msgs/msg/PointCloud2 in cdr or foxglove.PointCloud in protobuf";
    match CloudType::of(channel) {
        Some(_) => Ok(true),
        None => Err(format!("the messages of {topic} are {name} in `{}`, and have to be {types}", channel.encoding)),
    }
}

fn format_error(file: &Arc<str>, byte: u64, message: String) -> Error {
    Error::Format { place: Place { file: file.clone(), line: 0, byte }, message }
}

fn problem(file: &Arc<str>, byte: u64, reason: Reason, value: String) -> Problem {
    Problem { reason, place: Place { file: file.clone(), line: 0, byte }, value }
}
