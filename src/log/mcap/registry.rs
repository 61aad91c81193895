//! The schemas and channels of a recording, by their numbers.

use std::{collections::BTreeMap, sync::Arc};

use super::{
    fields::Fields,
    raw::{Channel, Schema},
};

/// Bytes of names and descriptions that are kept of one file, at most.
const MOST: usize = 64 << 20;

/// Whether a channel's messages are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Interest {
    Wanted,
    Unwanted,
    /// The channel was not described yet.
    Unknown,
}

/// Says whether a channel's messages are wanted.
pub(super) type Wants = Box<dyn Fn(&Channel) -> bool>;

/// What is known of a file's channels.
pub(super) struct Registry {
    schemas: BTreeMap<u16, Arc<Schema>>,
    channels: BTreeMap<u16, (Arc<Channel>, bool)>,
    wants: Wants,
    room: usize,
    /// Schemas and channels that a chunk has brought, in case that it turns out to be damaged.
    fresh: (Vec<u16>, Vec<u16>),
}

impl Registry {
    pub(super) fn new(wants: Wants) -> Self {
        let (schemas, channels) = (BTreeMap::new(), BTreeMap::new());
        Self { schemas, channels, wants, room: MOST, fresh: (Vec::new(), Vec::new()) }
    }

    /// Takes a schema record in; the words are what is wrong with it.
    pub(super) fn add_schema(&mut self, record: &[u8]) -> Result<(), String> {
        let mut fields = Fields(record);
        let schema = (|| {
            let id = fields.u16()?;
            let (name, encoding) = (fields.text()?.to_owned(), fields.text()?.to_owned());
            Some(Schema { id, name, encoding, data: fields.counted()?.to_vec() })
        })();
        let schema = schema.ok_or("a schema that ends early or is no text")?;
        match self.schemas.get(&schema.id) {
            Some(known) if **known == schema => return Ok(()),
            Some(known) => {
                return Err(format!("schema {} was {} and is now {}", schema.id, known.name, schema.name));
            }
            None => {}
        }
        self.take_room(record.len())?;
        self.fresh.0.push(schema.id);
        self.schemas.insert(schema.id, Arc::new(schema));
        Ok(())
    }

    /// Takes a channel record in, and returns its number; the words are what is wrong with it.
    pub(super) fn add_channel(&mut self, record: &[u8]) -> Result<u16, String> {
        let mut fields = Fields(record);
        let parts = (|| {
            let (id, schema) = (fields.u16()?, fields.u16()?);
            Some((id, schema, fields.text()?, fields.text()?, fields.map()?))
        })();
        let (id, schema, topic, encoding, metadata) = parts.ok_or("a channel that ends early or is no text")?;
        let schema = match (schema, self.schemas.get(&schema)) {
            (0, _) => None,
            (_, Some(schema)) => Some(schema.clone()),
            (_, None) => return Err(format!("channel {id} ({topic}) has the schema {schema}, which there is not")),
        };
        let channel = Channel { id, schema, topic: topic.to_owned(), encoding: encoding.to_owned(), metadata };
        match self.channels.get(&id) {
            Some((known, _)) if **known == channel => return Ok(id),
            Some((known, _)) => return Err(format!("channel {id} was {} and is now {topic}", known.topic)),
            None => {}
        }
        self.take_room(record.len())?;
        self.fresh.1.push(id);
        let wanted = (self.wants)(&channel);
        self.channels.insert(id, (Arc::new(channel), wanted));
        Ok(id)
    }

    fn take_room(&mut self, bytes: usize) -> Result<(), String> {
        let left = self.room.checked_sub(bytes);
        self.room = left.ok_or_else(|| format!("more than {} MiB of schemas and channels", MOST >> 20))?;
        Ok(())
    }

    /// What came since is of one chunk.
    pub(super) fn begin_chunk(&mut self) {
        self.fresh.0.clear();
        self.fresh.1.clear();
    }

    /// Forgets what the chunk has brought.
    pub(super) fn forget_chunk(&mut self) {
        for id in self.fresh.0.drain(..) {
            self.schemas.remove(&id);
        }
        for id in self.fresh.1.drain(..) {
            self.channels.remove(&id);
        }
    }

    pub(super) fn interest(&self, id: u16) -> Interest {
        match self.channels.get(&id) {
            Some((_, true)) => Interest::Wanted,
            Some((_, false)) => Interest::Unwanted,
            None => Interest::Unknown,
        }
    }

    /// The channels whose messages nobody wants, in the order of their numbers.
    pub(super) fn unwanted(&self) -> Vec<u16> {
        self.channels.iter().filter(|(_, (_, wanted))| !wanted).map(|(id, _)| *id).collect()
    }

    pub(super) fn channel(&self, id: u16) -> Option<&Arc<Channel>> {
        self.channels.get(&id).map(|(channel, _)| channel)
    }

    /// All channels, in the order of their numbers.
    pub(super) fn channels(&self) -> impl Iterator<Item = &Arc<Channel>> {
        self.channels.values().map(|(channel, _)| channel)
    }

    /// Whether what the channels are wanted for has changed.
    pub(super) fn clear(&mut self) {
        self.schemas.clear();
        self.channels.clear();
        self.room = MOST;
    }
}
