//! A recording as a source of readings.

use std::sync::Arc;

use super::{
    arena::Item,
    finding::Finding,
    options::Options,
    raw::{Channel, Tap},
    reader::Reader,
    records::{Limits, Part, Records},
    registry::Registry,
    topics::{self, kind_of},
    unpacking::Ahead,
    window::Recording,
};
use crate::{
    diagnose::Diagnosis,
    error::{Error, Place, Problem, Result},
    log::{Input, Next, Row, Source},
    pipeline::AnyTrack,
    rig::Rig,
};

/// Bytes that are read without a reading before a caller hears of it.
const PATIENCE: u64 = 1 << 20;

/// A recording in MCAP: readings with where their sensors were and what they saw.
pub struct McapReadings {
    records: Records,
    reader: Reader,
    tap: Option<Box<dyn Tap>>,
    ended: bool,
}

impl McapReadings {
    /// Opens the recording at `path`, which is read as a file where it is one, else the `input` that was opened for it.
    ///
    /// `track` has the poses where they come from a second file.
    ///
    /// # Errors
    /// It can't be read, is no recording, or, where its summary tells, has no readings, no poses, or none of a topic that was
    /// asked for.
    pub fn open(
        path: &str,
        input: Input,
        rig: Option<Arc<Rig>>,
        track: Option<AnyTrack>,
        options: Options,
    ) -> Result<Self> {
        let name = input.name.clone();
        let recording = Recording::open(path, input)?;
        let everything = options.everything;
        let (topics, scans) = (options.range_topics.clone(), options.scan_topics.clone());
        let wanted = move |channel: &Channel| everything || kind_of(channel, &topics, &scans).is_some();
        let registry = Registry::new(Box::new(wanted));
        let limits = Limits { max_message: options.max_message, everything, metadata: false };
        let records = Records::open(recording, name.clone(), registry, limits, Ahead::of(path))?;
        let mut reader = Reader::new(name, rig, track, options);
        records.registry().channels().for_each(|channel| reader.expect(channel));
        let readings = Self { records, reader, tap: None, ended: false };
        if readings.records.is_complete() {
            readings.check_topics()?;
        }
        Ok(readings)
    }

    /// The same recording, which goes on in others: the parts in which a recorder has split it, in their order.
    ///
    /// # Errors
    /// One of them can't be read.
    pub fn followed_by(mut self, parts: Vec<(String, Input)>) -> Result<Self> {
        for (path, input) in parts {
            let name = input.name.clone();
            let recording = Recording::open(&path, input)?;
            self.records.then(Part { name, recording, ahead: Ahead::Never });
        }
        Ok(self)
    }

    /// How much later than others a message may be recorded and still be put in order, in nanoseconds.
    pub fn window(&self) -> u64 {
        self.reader.options().reorder
    }

    /// From now on `tap` is told all that the recording holds. Give [`Options::everything`], and do it before anything is read.
    pub fn set_tap(&mut self, tap: Box<dyn Tap>) {
        self.tap = Some(tap);
    }

    /// Refuses a recording without readings or without poses, once all channels are known.
    fn check_topics(&self) -> Result<()> {
        let channels = self.records.registry().channels();
        topics::check(channels, self.reader.options(), self.reader.has_track()).map_err(|message| {
            let place = Place { file: self.reader.name().clone(), line: 0, byte: 0 };
            Error::Format { place, message }
        })
    }

    /// The topic of each sensor that has had a reading, by the sensor's index.
    pub fn topic(&self, sensor: u16) -> Option<&str> {
        self.reader.topic(sensor)
    }

    /// Where the poses come from, in words, once that was decided.
    pub fn pose_source(&self) -> Option<String> {
        self.reader.whereabouts().source()
    }

    /// Topics that have poses, too, and are not used.
    pub fn other_poses(&self) -> Vec<&str> {
        self.reader.whereabouts().unused()
    }

    /// Ids of the rig's sensors that have had no reading, and how many sensors the rig has.
    pub fn unmatched(&self) -> (Vec<&str>, usize) {
        self.reader.sensors().unmatched()
    }

    /// The topic and the frame of each sensor that has had a reading, in words.
    pub fn readings_of(&self) -> Vec<String> {
        let ids = (0..=u16::MAX).zip(self.reader.ids());
        ids.filter_map(|(sensor, id)| Some(format!("{} (frame {id})", self.reader.topic(sensor)?))).collect()
    }

    /// What a person should know of how the recording was read: which clocks it has, what was assumed.
    pub fn findings(&self) -> Vec<Finding> {
        self.reader.findings()
    }

    /// The same in words, one line each.
    pub fn notes(&self) -> Vec<String> {
        self.findings().iter().map(ToString::to_string).collect()
    }

    /// By how much stamps are later than the times of recording, in words; `None` where there are none.
    pub fn clock_words(&self) -> Option<String> {
        self.reader.clock_words()
    }

    /// The recording has ended.
    fn end(&mut self) -> Result<()> {
        self.ended = true;
        self.reader.end();
        let nothing = self.reader.saw_nothing();
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
                self.reader.expect(channel);
                if let Some(tap) = tap {
                    tap.channel(channel)?;
                }
            }
            (Item::Restart(file), None) => self.reader.restart(file),
            (Item::Restart(file), Some(_)) => {
                let message =
                    "--passthrough: there is a second recording in it, and what is copied has to be one".to_owned();
                return Err(Error::Format { place: Place { file, line: 0, byte }, message });
            }
            (Item::Header(profile, library), Some(tap)) => tap.header(profile, library)?,
            (Item::Metadata(metadata), Some(tap)) => tap.metadata(&metadata)?,
            (Item::Attachment(attachment), Some(tap)) => tap.attachment(attachment)?,
            (Item::Header(..) | Item::Metadata(_) | Item::Attachment(_), None) | (Item::Nothing, _) => {}
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
            if let Some(next) = self.reader.next_due(row, problems)? {
                return Ok(next);
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
        self.reader.ids()
    }

    fn diagnoses(&self) -> Vec<Diagnosis> {
        self.findings().into_iter().filter(Finding::is_warning).map(Diagnosis::Recording).collect()
    }
}
