use std::{
    fs,
    time::{Duration, Instant},
};

use tempfile::{TempDir, tempdir};

use super::super::{
    built::{channel, chunk, finished, index, lz4, message, plain, record, zstd},
    raw::Channel,
    records::{Limits, MAGIC, Records},
    registry::Registry,
};
use super::*;

const WANTED: u16 = 1;
const UNWANTED: u16 = 2;

fn channels() -> Vec<Vec<u8>> {
    vec![channel(WANTED, "range"), channel(UNWANTED, "camera")]
}

/// Two messages of each channel, `size` bytes each that no compressor makes less of.
fn content(seed: u64, size: usize) -> Vec<u8> {
    let mut state = seed;
    let mut noise = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 56) as u8
    };
    let mut messages = channels().concat();
    for (time, id) in [WANTED, UNWANTED, WANTED, UNWANTED].into_iter().enumerate() {
        let data: Vec<u8> = (0..size).map(|_| noise()).collect();
        messages.extend(message(id, seed + time as u64, &data));
    }
    messages
}

fn indexes() -> Vec<u8> {
    [index(WANTED, 2), index(UNWANTED, 2)].concat()
}

/// The known compressions.
type Pack = fn(&[u8]) -> Vec<u8>;
const PACKS: [(&str, Pack); 3] = [("zstd", zstd), ("lz4", lz4), ("", plain)];

/// A chunk of some content, with its checksum and its indexes.
fn packed(name: &str, pack: Pack, content: &[u8]) -> Vec<u8> {
    [chunk(name, content.len() as u64, crc32fast::hash(content), &pack(content)), indexes()].concat()
}

/// A file, and the folder that goes with it.
struct Scene {
    path: String,
    _folder: TempDir,
}

impl Scene {
    fn new(bytes: &[u8]) -> Self {
        let folder = tempdir().unwrap();
        let path = folder.path().join("drive.mcap").to_str().unwrap().to_owned();
        fs::write(&path, bytes).unwrap();
        Self { path, _folder: folder }
    }

    fn recording(&self) -> Recording {
        let file = File::open(&self.path).unwrap();
        let length = file.metadata().unwrap().len();
        Recording::File(file, length)
    }

    /// All that is told of the file, and how far it is each time. Something may happen to the file when its summary was read.
    fn told(&self, ahead: Ahead, happens: impl FnOnce(&str)) -> Vec<String> {
        let registry = Registry::new(Box::new(|channel: &Channel| channel.topic == "range"));
        let limits = Limits { max_message: 1 << 20, everything: false, metadata: false };
        let opened = Records::open(self.recording(), "drive.mcap".into(), registry, limits, ahead);
        happens(&self.path);
        let mut records = match opened {
            Ok(records) => records,
            Err(error) => return vec![error.to_string()],
        };
        let mut told = Vec::new();
        loop {
            let words = match records.next() {
                Ok(Some((item, byte))) => format!("{byte}: {item:?}"),
                Ok(None) => return told,
                Err(error) => return [told, vec![error.to_string()]].concat(),
            };
            told.push(format!("{} {words}", records.position()));
        }
    }

    fn ahead(&self) -> Ahead {
        Ahead::NotYet(self.path.clone().into())
    }

    /// What was unpacked ahead of each chunk that can be.
    fn unpacked(&self) -> Vec<Option<Vec<u8>>> {
        let recording = self.recording();
        let (mut ahead, mut window) = (self.ahead(), Window::new(self.recording(), false));
        let mut all = Vec::new();
        window.skip(MAGIC.len() as u64).unwrap();
        while let Some(head) = window.peek().unwrap() {
            let frame = framed(head, window.position());
            if frame.opcode == op::CHUNK {
                let head = ChunkHead::read(&mut window, &frame).unwrap().ok().unwrap();
                all.push(ahead.take(&head, &recording, || vec![UNWANTED]));
            }
            window.go_to(frame.end()).unwrap();
        }
        all
    }
}

/// The same is told whether a file's chunks are unpacked ahead or not; that is returned.
#[track_caller]
fn same(bytes: &[u8], case: &str) -> Vec<String> {
    let scene = Scene::new(bytes);
    let plain = scene.told(Ahead::Never, |_| ());
    assert_eq!(scene.told(scene.ahead(), |_| ()), plain, "{case}");
    plain
}

fn messages(told: &[String]) -> usize {
    told.iter().filter(|words| words.contains(" Message(")).count()
}

#[test]
fn every_chunk_that_is_not_passed_over_is_unpacked_once() {
    let contents: Vec<_> = (0..12).map(|seed| content(10 * seed, 30_000)).collect();
    let mut parts = Vec::new();
    for (which, content) in contents.iter().enumerate() {
        let (name, pack) = PACKS[which % 3];
        parts.extend(packed(name, pack, content));
        // Nobody wants it.
        parts.extend(chunk("", 3, 0, b"xyz"));
        parts.extend(index(UNWANTED, 1));
    }
    let bytes = finished(&parts, &channels());
    let expected: Vec<_> = contents.into_iter().flat_map(|content| [Some(content), None]).collect();
    assert_eq!(Scene::new(&bytes).unpacked(), expected);
    assert_eq!(messages(&same(&bytes, "whole")), 24);
}

#[test]
fn whichever_byte_is_wrong_the_same_is_told() {
    let parts: Vec<_> = PACKS.iter().flat_map(|(name, pack)| packed(name, *pack, &content(7, 10))).collect();
    let bytes = finished(&parts, &channels());
    assert_eq!(messages(&same(&bytes, "whole")), 6);
    let mut fewer = 0;
    for at in 0..bytes.len() {
        for mask in [0x01, 0x80] {
            let mut wrong = bytes.clone();
            wrong[at] ^= mask;
            fewer += usize::from(messages(&same(&wrong, &format!("byte {at}, {mask:02x}"))) < 6);
        }
    }
    assert!(fewer > bytes.len(), "{fewer} of {}", 2 * bytes.len());
}

#[test]
fn where_a_file_is_cut_the_same_is_told() {
    let parts: Vec<_> = PACKS.iter().flat_map(|(name, pack)| packed(name, *pack, &content(7, 10))).collect();
    let bytes = finished(&parts, &channels());
    for end in 0..bytes.len() {
        same(&bytes[..end], &format!("{end} bytes"));
    }
}

#[test]
fn chunks_that_are_not_what_they_say_are_left_to_the_reader() {
    let (right, other) = (content(3, 2000), content(4, 2000));
    let (length, checksum) = (right.len() as u64, crc32fast::hash(&right));
    let two = [zstd(&right[..1000]), zstd(&right[1000..])].concat();
    let behind = |pack: Pack| [&pack(&right)[..], b"more"].concat();
    let mut vast = zstd(&right);
    assert_eq!(vast[4] & 0x20, 0, "its head says how large its window is");
    vast[5] = 17 << 3;
    let largest = [&right[..], &message(UNWANTED, 0, &vec![0; 8 << 20])].concat();
    let (large, hash) = (largest.len() as u64, crc32fast::hash(&largest));
    // Whether all messages of it are read all the same.
    let cases = [
        ("a checksum of something else", chunk("zstd", length, crc32fast::hash(&other), &zstd(&right)), false),
        ("less than it says", chunk("zstd", length + 1, checksum, &zstd(&right)), false),
        ("more than it says", chunk("zstd", length - 1, checksum, &zstd(&right)), false),
        ("less than it says, lz4", chunk("lz4", length + 1, checksum, &lz4(&right)), false),
        ("more than it says, lz4", chunk("lz4", length - 1, checksum, &lz4(&right)), false),
        ("less than it says, as it is", chunk("", length + 1, checksum, &right), false),
        ("more than it says, as it is", chunk("", length - 1, checksum, &right), false),
        ("cut", chunk("zstd", length, checksum, &zstd(&right)[..1000]), false),
        ("two frames", chunk("zstd", length, checksum, &two), true),
        ("a window of 128 MiB", chunk("zstd", length, checksum, &vast), false),
        ("something behind the frame", chunk("zstd", length, checksum, &behind(zstd)), false),
        ("too large", chunk("zstd", large, hash, &zstd(&largest)), true),
        ("nobody knows how it is packed", chunk("xz", length, checksum, &right), false),
    ];
    for (case, wrong, is_read) in cases {
        let around = packed("zstd", zstd, &other);
        let bytes = finished(&[&around[..], &wrong, &indexes(), &around].concat(), &channels());
        assert_eq!(Scene::new(&bytes).unpacked(), [Some(other.clone()), None, Some(other.clone())], "{case}");
        assert_eq!(messages(&same(&bytes, case)), if is_read { 6 } else { 4 }, "{case}");
    }
}

#[test]
fn what_is_wrong_within_a_chunk_is_found_in_what_was_unpacked() {
    let right = content(3, 50);
    let nested = [&right[..], &chunk("", 3, 0, b"xyz")].concat();
    let beyond = [&right[..], &record(op::MESSAGE, &[0; 40])[..20]].concat();
    let stranger = [&right[..], &message(3, 0, b"who")].concat();
    for (case, wrong, words) in [
        ("nested", nested, "there is a chunk in it"),
        ("beyond", beyond, "a record reaches beyond its end"),
        ("stranger", stranger, "a message of channel 3, which there is not"),
    ] {
        for (name, pack) in PACKS {
            let bytes = finished(&packed(name, pack, &wrong).repeat(2), &channels());
            assert_eq!(Scene::new(&bytes).unpacked(), [Some(wrong.clone()), Some(wrong.clone())], "{case}");
            let told = same(&bytes, case);
            assert_eq!(told.iter().filter(|line| line.contains(words)).count(), 2, "{told:?}");
        }
    }
    // Nothing to compare with, and more behind the frame: both are as good as no chunk at all.
    for bare in [chunk("zstd", right.len() as u64, 0, &zstd(&right)), chunk("lz4", right.len() as u64, 0, &lz4(&right))]
    {
        let bytes = finished(&[bare, indexes()].concat(), &channels());
        assert_eq!(Scene::new(&bytes).unpacked(), [Some(right.clone())]);
        assert_eq!(messages(&same(&bytes, "no checksum")), 2);
    }
}

#[test]
fn a_file_that_shrinks_or_grows_while_it_is_read_is_told_the_same_of() {
    let parts: Vec<_> =
        PACKS.iter().flat_map(|(name, pack)| packed(name, *pack, &content(9, 60_000)).repeat(2)).collect();
    let bytes = finished(&parts, &channels());
    let scene = Scene::new(&bytes);
    let length = bytes.len() as u64;
    for step in 1..=40 {
        let resize = |path: &str| File::options().write(true).open(path).unwrap().set_len(length * step / 32).unwrap();
        let plain = scene.told(Ahead::Never, resize);
        fs::write(&scene.path, &bytes).unwrap();
        assert_eq!(scene.told(scene.ahead(), resize), plain, "{step}/32 of it");
        fs::write(&scene.path, &bytes).unwrap();
        // The last message is one that nobody wants.
        assert_eq!(messages(&plain) < 12, step < 31, "{step}/32 of it");
    }
}

#[test]
fn a_file_that_is_replaced_by_another_is_not_mixed_with_it() {
    // The same chunk, if nobody looks into it: the file that is read has no checksums.
    let [one, other] = [1, 2].map(|seed| {
        let content = content(seed, 60_000);
        finished(&chunk("", content.len() as u64, 0, &content).repeat(3), &channels())
    });
    let scene = Scene::new(&one);
    let plain = scene.told(Ahead::Never, |_| ());
    let replace = |path: &str| {
        let new = format!("{path}.new");
        fs::write(&new, &other).unwrap();
        fs::rename(new, path).unwrap();
    };
    assert_eq!(scene.told(scene.ahead(), replace), plain);
    assert_ne!(scene.told(scene.ahead(), |_| ()), plain);
}

#[test]
fn a_chunk_that_is_overwritten_after_its_head_was_read_is_not_mixed_with_the_new_one() {
    // So small that the reader has all of it.
    let [one, other] = [1, 2].map(|seed| finished(&packed("zstd", zstd, &content(seed, 100)), &channels()));
    let scene = Scene::new(&one);
    let plain = scene.told(Ahead::Never, |_| ());
    assert_eq!(scene.told(scene.ahead(), |path| fs::write(path, &other).unwrap()), plain);
    assert_ne!(scene.told(scene.ahead(), |_| ()), plain);
}

#[test]
fn threads_end_when_nobody_takes_their_chunks_any_more() {
    let bytes = finished(&packed("zstd", zstd, &content(1, 10_000)).repeat(40), &channels());
    let scene = Scene::new(&bytes);
    let (file, from) = (File::open(&scene.path).unwrap(), MAGIC.len() as u64);
    let unpacking = Unpacking::begin(Path::new(&scene.path), (&file, bytes.len() as u64), from, vec![]).unwrap();
    let spare = unpacking.spare.clone();
    drop(unpacking);
    let begin = Instant::now();
    // The scout has the other end, and the threads have the scout.
    while spare.send(Vec::new()).is_ok() {
        assert!(begin.elapsed() < Duration::from_secs(30), "they wait still");
        thread::sleep(Duration::from_millis(1));
    }
}
