//! Recordings, put together record by record, for tests.

use std::io::Write;

use super::{op, records::MAGIC};

/// A record of any kind.
pub(super) fn record(opcode: u8, content: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

/// The description of a channel without a schema.
pub(super) fn channel(id: u16, topic: &str) -> Vec<u8> {
    let name = [&(topic.len() as u32).to_le_bytes()[..], topic.as_bytes()].concat();
    record(op::CHANNEL, &[&id.to_le_bytes()[..], &[0; 2], &name, &[0; 8]].concat())
}

/// A message, sent when it was recorded.
pub(super) fn message(id: u16, time: u64, data: &[u8]) -> Vec<u8> {
    record(op::MESSAGE, &[&id.to_le_bytes()[..], &[0; 4], &time.to_le_bytes(), &time.to_le_bytes(), data].concat())
}

/// A chunk of which the head says this much.
pub(super) fn chunk(compression: &str, unpacked: u64, checksum: u32, packed: &[u8]) -> Vec<u8> {
    let name = [&(compression.len() as u32).to_le_bytes()[..], compression.as_bytes()].concat();
    let sizes = [&unpacked.to_le_bytes()[..], &checksum.to_le_bytes()].concat();
    record(op::CHUNK, &[&[0; 16][..], &sizes, &name, &(packed.len() as u64).to_le_bytes(), packed].concat())
}

/// An index that says how many messages a channel has in the chunk before it.
pub(super) fn index(id: u16, messages: u32) -> Vec<u8> {
    let entries = vec![0; 16 * messages as usize];
    record(op::MESSAGE_INDEX, &[&id.to_le_bytes()[..], &(16 * messages).to_le_bytes(), &entries].concat())
}

/// A recording of these parts without a summary.
pub(super) fn unfinished(parts: &[u8]) -> Vec<u8> {
    let ends = [record(op::HEADER, &[0; 8]), record(op::DATA_END, &[0; 4]), record(op::FOOTER, &[0; 20])];
    let [header, data_end, footer] = &ends;
    [&MAGIC[..], header, parts, data_end, footer, &MAGIC].concat()
}

/// A recording of these parts with a summary of its channels.
pub(super) fn finished(parts: &[u8], channels: &[Vec<u8>]) -> Vec<u8> {
    let data = [&MAGIC[..], &record(op::HEADER, &[0; 8]), parts, &record(op::DATA_END, &[0; 4])].concat();
    let statistics = [&[0; 10][..], &(channels.len() as u32).to_le_bytes(), &[0; 32]].concat();
    let footer = [&(data.len() as u64).to_le_bytes()[..], &[0; 12]].concat();
    let summary = [channels.concat(), record(op::STATISTICS, &statistics), record(op::FOOTER, &footer)];
    [&data[..], &summary.concat(), &MAGIC].concat()
}

pub(super) fn lz4(plain: &[u8]) -> Vec<u8> {
    let mut encoder = lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
    encoder.write_all(plain).unwrap();
    encoder.finish().0
}

/// As a stream, which does not say how long it is.
pub(super) fn zstd(plain: &[u8]) -> Vec<u8> {
    let mut encoder = zstd::Encoder::new(Vec::new(), 1).unwrap();
    let (first, rest) = plain.split_at(plain.len() / 2);
    encoder.write_all(first).unwrap();
    encoder.flush().unwrap();
    encoder.write_all(rest).unwrap();
    encoder.finish().unwrap()
}

pub(super) fn plain(plain: &[u8]) -> Vec<u8> {
    plain.to_vec()
}
