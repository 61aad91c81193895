//! Recordings in chunks: from a file, whose chunks are unpacked ahead on threads, the same rows as from a pipe, one after the other.

use std::{collections::BTreeMap, fs, io::Cursor, path::PathBuf, sync::LazyLock};

use arbitrary::Unstructured;
use atm::log::Input;
use mcap::{Channel, Compression, MessageStream, WriteOptions, Writer, records::MessageHeader};

use crate::{
    mcap::{open, read},
    messages,
    pieces::whole,
};

/// Where the file is: in memory, where that can be had.
static FILE: LazyLock<PathBuf> = LazyLock::new(|| {
    let memory = PathBuf::from("/dev/shm");
    let directory = if memory.is_dir() { memory } else { std::env::temp_dir() };
    directory.join(format!("atm-unpacked-{}.mcap", std::process::id()))
});

/// Messages from bytes, in chunks of a size and a compression that the second byte says.
pub fn check(bytes: &[u8]) {
    let Some((&[options, chunks], rest)) = bytes.split_first_chunk() else { return };
    let Ok(messages) = messages::recording(&mut Unstructured::new(rest)) else { return };
    let Some(file) = chunked(&messages, chunks) else { return };
    fs::write(&*FILE, &file).expect("room for a small file");
    let path = FILE.to_str().expect("a plain name");
    let input = Input { name: "whole".into(), ..Input::open(path).expect("just written") };
    let at_once = read(open(options & !32, "-", whole(&file)), file.len(), || 0);
    match open(options & !32, path, input) {
        // A summary tells at once what a pipe tells at its end.
        Err(error) => assert!(at_once.words.contains(&error.to_string()), "{error}: {at_once:?}"),
        ahead => assert_eq!(at_once, read(ahead, file.len(), || 0)),
    }
}

/// The same messages in chunks, with a summary; `None` where the writer refuses them.
fn chunked(messages: &[u8], chunks: u8) -> Option<Vec<u8>> {
    let compression = [None, Some(Compression::Zstd), Some(Compression::Lz4), None][usize::from(chunks & 3)];
    let size = [100, 500, 2000, 1 << 20][usize::from(chunks >> 2 & 3)];
    let options = WriteOptions::new().compression(compression).chunk_size(Some(size));
    let mut writer = Writer::with_options(Cursor::new(Vec::new()), options).ok()?;
    let mut ids: BTreeMap<u16, u16> = BTreeMap::new();
    for message in MessageStream::new(messages).ok()? {
        let message = message.ok()?;
        let Channel { id, topic, schema, message_encoding, metadata } = &*message.channel;
        let channel_id = match ids.get(id) {
            Some(&known) => known,
            None => {
                let schema = schema.as_ref()?;
                let schema = writer.add_schema(&schema.name, &schema.encoding, &schema.data).ok()?;
                let added = writer.add_channel(schema, topic, message_encoding, metadata).ok()?;
                *ids.entry(*id).or_insert(added)
            }
        };
        let (log_time, publish_time) = (message.log_time, message.publish_time);
        let head = MessageHeader { channel_id, sequence: 0, log_time, publish_time };
        writer.write_to_known_channel(&head, &message.data).ok()?;
    }
    writer.finish().ok()?;
    Some(writer.into_inner().into_inner())
}
