//! What a recording is about, by its topics.

use std::io::{Cursor, Read};

use super::{
    decode::Kind,
    options::Options,
    raw::Channel,
    records::{Limits, Records},
    registry::Registry,
    unpacking::Ahead,
    window::Recording,
    write::topics::{CROSSING_POINTS, ECHOES},
};
use crate::{
    error::{Error, Result},
    log::{Input, content::Content},
};

/// Bytes of a recording without a summary in which topics are looked for, at most.
const LOOKED_AT: u64 = 4 << 20;

impl Input {
    /// What the recording at `path` is about, by its topics: echoes, else crossings, where [`super::write`] made it, else readings.
    /// One that has readings besides is about these where `readings` are asked for. Its bytes are all still there to be read.
    ///
    /// A recording without a summary, or from a pipe, is judged by its first 4 MiB.
    ///
    /// # Errors
    /// It can't be read.
    pub fn recorded(mut self, path: &str, readings: bool) -> Result<(Content, Self)> {
        let name = self.name.clone();
        let recording = if self.length.is_some() && path != "-" {
            let again = Self { reader: Box::new(std::io::empty()), name: name.clone(), length: self.length };
            Recording::open(path, again)?
        } else {
            let mut start = Vec::new();
            let looked = self.reader.by_ref().take(LOOKED_AT).read_to_end(&mut start);
            looked.map_err(|source| Error::Io { file: name.clone(), source })?;
            self.reader = Box::new(Cursor::new(start.clone()).chain(self.reader));
            Recording::Stream(Box::new(Cursor::new(start)))
        };
        let limits = Limits { max_message: Options::MAX_MESSAGE, everything: false, metadata: false };
        let mut records = Records::open(recording, name, Registry::new(Box::new(|_| false)), limits, Ahead::Never)?;
        // What is wrong with it is told by whoever reads it.
        while !records.is_complete() && records.position() < LOOKED_AT && records.next()?.is_some() {}
        Ok((of(records.registry().channels().map(|channel| &**channel), readings), self))
    }
}

fn of<'a>(channels: impl Iterator<Item = &'a Channel>, readings: bool) -> Content {
    let (mut echoes, mut crossings, mut ranges) = (false, false, false);
    for channel in channels {
        echoes |= channel.topic == ECHOES;
        crossings |= channel.topic == CROSSING_POINTS;
        ranges |= Kind::of(channel).is_some_and(|kind| matches!(kind, Kind::Range | Kind::Ranges));
    }
    match (echoes, crossings) {
        _ if readings && ranges => Content::Readings,
        (true, _) => Content::Points,
        (false, true) => Content::Crossings,
        (false, false) => Content::Readings,
    }
}
