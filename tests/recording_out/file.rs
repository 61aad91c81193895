//! What holds of every file: order, checksums, the same bytes, and what is left of one that was not finished.

use std::{
    io::{self, Write},
    sync::{
        Arc, Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use atm::{
    error::Error,
    log::mcap::write::{Layout, McapSink, Options},
    pipeline::Emit,
};
use mcap::{
    read::{LinearReader, Options as ReadOptions},
    records::Record,
};

use crate::{
    cloud::Cloud,
    sample::{
        KINDS, Logged, Recorded, doorway, fuse, messages, nomad, of_topic, options, recorded, sink, summary, tables,
    },
};

/// The clouds of echoes that are not empty, with their messages.
fn echo_clouds(file: &[u8]) -> Vec<(Logged, Cloud)> {
    let clouds = of_topic(file, "/atm/echoes").into_iter().map(|message| (message.clone(), Cloud::of(&message)));
    clouds.filter(|(_, cloud)| !cloud.points.is_empty()).collect()
}

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

#[test]
fn the_same_input_gives_the_same_bytes() {
    for kind in KINDS {
        let file = recorded(&doorway(), options(kind));
        assert!(file == recorded(&doorway(), options(kind)), "{kind:?}");
        // Whenever the input paused: a file is read when it is whole.
        let mut paused = sink(options(kind));
        let mut pause = |sink: &mut McapSink<_>, _: &_| atm::pipeline::EchoSink::flush(sink).unwrap();
        fuse(&doorway(), Emit::Settled, &mut Recorded { sink: &mut paused, after_record: &mut pause }).unwrap();
        assert!(file == paused.finish().unwrap(), "{kind:?}");
    }
}

#[test]
fn messages_stand_in_the_order_of_their_log_times() {
    for kind in KINDS {
        let file = recorded(&doorway(), options(kind));
        let all = messages(&file);
        assert!(all.is_sorted_by_key(|message| message.log_time));
        assert!(all.iter().all(|message| message.publish_time == message.log_time));
        for topic in ["/atm/echoes", "/atm/arcs", "/tf"] {
            let sequences = all.iter().filter(|message| message.topic == topic).map(|message| message.sequence);
            assert!(sequences.eq(0..all.iter().filter(|message| message.topic == topic).count() as u32), "{topic}");
        }
    }
}

#[test]
fn echoes_are_logged_when_they_are_reported() {
    // In `latest` an echo is reported by its own reading, so both times are the same.
    let mut sink = sink(options(KINDS[0]));
    fuse(&doorway(), Emit::Latest, &mut sink).unwrap();
    let file = sink.finish().unwrap();
    let clouds = echo_clouds(&file);
    assert!(clouds.len() > 30);
    for (message, cloud) in clouds {
        assert_eq!(cloud.t as u64, message.log_time);
        assert!(cloud.points.iter().all(|point| point["t"] == 0.0));
    }
}

#[test]
fn a_message_holds_a_sweep_of_sensors_that_fire_one_after_another() {
    // Sixteen sensors, one every 5 ms, round and round: 80 ms make a sweep.
    let row = |index: usize| {
        let t = index as f64 * 0.005;
        format!("{t},{},1.0,{},0,0\n", index % 16, t * 0.1)
    };
    let table = format!("t,sensor,range,x,y,yaw\n{}", (0..160).map(row).collect::<String>());
    let mut sink = sink(options(KINDS[0]));
    fuse(&table, Emit::Latest, &mut sink).unwrap();
    let file = sink.finish().unwrap();
    let clouds = echo_clouds(&file);
    assert_eq!(clouds.len(), 10);
    for (sweep, (message, cloud)) in clouds.iter().enumerate() {
        let sensors: Vec<usize> = cloud.points.iter().map(|point| point["sensor"] as usize).collect();
        assert_eq!(sensors, Vec::from_iter(0..16));
        assert_eq!(cloud.t, sweep as i64 * 80_000_000);
        assert_eq!(message.log_time, sweep as u64 * 80_000_000 + 75_000_000, "that of its last record");
    }
    // One every 30 ms: nobody waits longer than a tenth of a second.
    let slow = table.lines().map(|line| match line.split_once(',') {
        Some((t, rest)) if t != "t" => format!("{},{rest}\n", t.parse::<f64>().unwrap() * 6.0),
        _ => format!("{line}\n"),
    });
    let mut sink = crate::sample::sink(options(KINDS[0]));
    fuse(&slow.collect::<String>(), Emit::Latest, &mut sink).unwrap();
    let clouds = echo_clouds(&sink.finish().unwrap());
    assert!(clouds.len() >= 40);
    for (message, cloud) in clouds {
        assert!(message.log_time - cloud.t as u64 <= 100_000_000 && cloud.points.len() <= 4);
    }
}

#[test]
fn there_are_a_summary_indexes_and_statistics() {
    for kind in KINDS {
        let file = recorded(&doorway(), options(kind));
        let (all, summary) = (messages(&file), summary(&file));
        let statistics = summary.stats.as_ref().expect("statistics");
        assert_eq!(statistics.message_count, all.len() as u64);
        assert_eq!(statistics.message_end_time, all.last().unwrap().log_time);
        assert!(!summary.chunk_indexes.is_empty());
        let indexed = summary.chunk_indexes.iter().flat_map(|index| summary.stream_chunk(&file, index).unwrap());
        assert_eq!(indexed.count(), all.len());
        assert!(
            summary.chunk_indexes.iter().all(|index| index.compression == "zstd" && index.message_index_length > 0)
        );
        assert_eq!(summary.channels.len(), 11);
    }
}

#[test]
fn what_is_not_finished_is_cut_off_and_all_it_had_can_be_read() {
    struct Kept(Arc<Mutex<Vec<u8>>>);
    impl Write for Kept {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let bytes = Arc::new(Mutex::new(Vec::new()));
    let mut sink = McapSink::new(Kept(Arc::clone(&bytes)), "out".into(), options(KINDS[0]));
    let table = doorway() + "bad\n";
    assert!(matches!(fuse(&table, Emit::Latest, &mut sink), Err(Error::Strict { .. })));
    drop(sink);
    let left = bytes.lock().unwrap().clone();
    assert!(!left.ends_with(MAGIC), "it must not look whole");
    let stream = mcap::MessageStream::new_with_options(&left, ReadOptions::IgnoreEndMagic.into()).unwrap();
    let echoes = stream.map_while(Result::ok).filter(|message| message.channel.topic == "/atm/echoes");
    let points: usize = echoes.map(|message| Cloud::of(&message.into()).points.len()).sum();
    let mut whole = crate::sample::sink(options(KINDS[0]));
    fuse(&doorway(), Emit::Latest, &mut whole).unwrap();
    let whole = messages(&whole.finish().unwrap());
    let expected = whole.iter().filter(|message| message.topic == "/atm/echoes");
    assert_eq!(points, expected.map(|message| Cloud::of(message).points.len()).sum::<usize>());
}

/// What everybody sees who reads while it is written.
#[derive(Clone, Default)]
struct Piped(Arc<Mutex<Vec<u8>>>);

impl Write for Piped {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_reader_at_a_pipe_has_each_echo_when_the_input_pauses() {
    let pipe = Piped::default();
    let immediate = Options { layout: Layout::Immediate, ..options(KINDS[1]) };
    let mut sink = McapSink::new(pipe.clone(), "pipe".into(), immediate);
    let so_far = |pipe: &Piped| {
        let bytes = pipe.0.lock().unwrap().clone();
        let stream = mcap::MessageStream::new_with_options(&bytes, ReadOptions::IgnoreEndMagic.into()).unwrap();
        let echoes = stream.map_while(Result::ok).filter(|message| message.channel.topic == "/atm/echoes");
        echoes.map(|message| Cloud::of(&message.into()).points.len()).sum::<usize>()
    };
    let mut seen = Vec::new();
    let mut rows = 0;
    let mut pause = |sink: &mut McapSink<_>, _: &_| {
        rows += 1;
        // Beyond these, reading it all again each time only takes long.
        if rows <= 100 {
            atm::pipeline::EchoSink::flush(sink).unwrap();
            seen.push(so_far(&pipe));
        }
    };
    fuse(&doorway(), Emit::Latest, &mut Recorded { sink: &mut sink, after_record: &mut pause }).unwrap();
    sink.finish().unwrap();
    // After each reading there is its echo, or none.
    assert!(seen.windows(2).all(|pair| pair[1] - pair[0] <= 1), "{seen:?}");
    assert!(*seen.last().unwrap() > 60, "{seen:?}");
    let bytes = pipe.0.lock().unwrap().clone();
    assert!(bytes.ends_with(MAGIC));
    assert!(!LinearReader::new(&bytes).unwrap().any(|record| matches!(record.unwrap(), Record::Chunk { .. })));
    assert!(summary(&bytes).chunk_indexes.is_empty(), "nothing that grows with the stream");
}

#[test]
fn a_full_disk_is_named_and_nothing_panics() {
    struct Full(AtomicUsize);
    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let left = self.0.load(Ordering::Relaxed);
            if left == 0 {
                return Err(io::Error::from(io::ErrorKind::StorageFull));
            }
            let written = bytes.len().min(left);
            self.0.store(left - written, Ordering::Relaxed);
            Ok(written)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    for layout in [Layout::Chunked, Layout::Immediate] {
        let options = Options { layout, ..options(KINDS[0]) };
        let whole = recorded(&doorway(), options.clone()).len();
        for room in (0..whole).step_by(whole / 7) {
            let mut sink = McapSink::new(Full(AtomicUsize::new(room)), "out.mcap".into(), options.clone());
            let failed = fuse(&doorway(), Emit::Settled, &mut sink).and_then(|()| sink.finish());
            match failed {
                Err(Error::Io { file, source }) => {
                    assert_eq!((&*file, source.kind()), ("out.mcap", io::ErrorKind::StorageFull));
                }
                Err(other) => panic!("{other}"),
                Ok(_) => panic!("{room} of {whole} bytes were enough"),
            }
        }
    }
}

#[test]
fn a_log_without_a_reading_gives_a_whole_file_with_its_topics() {
    for kind in KINDS {
        let file = recorded("t,sensor,range,x,y,yaw\n", options(kind));
        assert_eq!(summary(&file).channels.len(), 11);
        let topics: Vec<String> = messages(&file).into_iter().map(|message| message.topic).collect();
        // Empty clouds: viewers know what there will be, and in which frame.
        assert_eq!(topics, ["/tf_static", "/atm/echoes", "/atm/map", "/atm/crossings/points"]);
        assert_eq!(crate::sample::sensor_names(&file).len(), nomad().sensors().len());
    }
    let [echoes, _] = tables("t,sensor,range,x,y,yaw\n");
    assert!(echoes.is_empty());
}
