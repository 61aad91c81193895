//! Recordings that end too early: all before the cut is used, and the message says how much was lost.

mod support;

use atm::{
    error::{Problem, Reason},
    log::{
        Input, Next, Row, Source,
        mcap::{McapReadings, Options},
    },
};
use mcap::Compression;
use support::{recording::*, *};

/// The drive's beginning, with three of its sensors.
fn short() -> Recording {
    let mut recording = drive();
    let topics = ["/tf_static", "/tf", "/sonar/0", "/sonar/4", "/sonar/9"];
    recording.messages.retain(|message| topics.contains(&message.topic.as_str()));
    recording.messages.truncate(45);
    recording
}

/// Times in nanoseconds and sensors of readings.
type Keys = Vec<(i64, u16)>;

/// The readings of a recording that comes through a pipe, and what was wrong with it.
fn read(bytes: &[u8]) -> Result<(Keys, Vec<Problem>), String> {
    let input =
        Input { reader: Box::new(std::io::Cursor::new(bytes.to_vec())), name: "drive.mcap".into(), length: None };
    let mut log = McapReadings::open("-", input, None, None, Options::default()).map_err(|error| error.to_string())?;
    let (mut row, mut readings, mut problems) = (Row::default(), Vec::new(), Vec::new());
    loop {
        match log.next_row(&mut row, &mut |problem| problems.push(problem)).map_err(|error| error.to_string())? {
            Next::End => return Ok((readings, problems)),
            Next::Record => readings.extend(row.readings.iter().map(|(sensor, _)| (row.t, *sensor))),
            Next::Unusable => {}
        }
    }
}

/// Where the messages of the readings end in a file that holds them as they are.
fn ends(bytes: &[u8], recording: &Recording) -> Vec<usize> {
    let readings = recording.messages.iter().filter(|message| message.schema == RANGE);
    let find = |message: &Message| {
        let found: Vec<usize> = (0..bytes.len()).filter(|at| bytes[*at..].starts_with(&message.data)).collect();
        assert_eq!(found.len(), 1, "each message is there once");
        found[0] + message.data.len()
    };
    readings.map(find).collect()
}

#[track_caller]
fn every_cut(layout: Layout) {
    let recording = short();
    let bytes = recording.laid_out(layout);
    let ends = ends(&bytes, &recording);
    assert!(ends.len() > 30);
    let (whole, problems) = read(&bytes).expect("a whole file");
    assert_eq!((whole.len(), problems.len()), (ends.len(), 0));
    for cut in 0..bytes.len() {
        let before = ends.iter().filter(|end| **end <= cut).count();
        let (readings, problems) = read(&bytes[..cut]).unwrap_or_else(|error| panic!("cut at {cut}: {error}"));
        assert_eq!(readings, whole[..before], "cut at {cut}");
        let truncated: Vec<&Problem> = problems.iter().filter(|problem| problem.reason == Reason::Truncated).collect();
        assert_eq!(truncated.len(), 1, "cut at {cut}: {problems:?}");
        // Readings whose transform was cut off are the only other loss.
        assert!(
            problems.iter().all(|problem| matches!(problem.reason, Reason::Truncated | Reason::NoPose)),
            "{problems:?}"
        );
    }
}

#[test]
fn at_every_byte_of_a_file_without_chunks() {
    every_cut(Layout::Bare);
}

#[test]
fn at_every_byte_of_chunks_that_are_not_compressed() {
    every_cut(Layout::Chunks(None));
}

#[test]
fn at_every_byte_of_compressed_chunks_nothing_is_invented() {
    for compression in [Compression::Zstd, Compression::Lz4] {
        let bytes = short().laid_out(Layout::Chunks(Some(compression)));
        let (whole, _) = read(&bytes).expect("a whole file");
        let mut most = 0;
        for cut in 0..bytes.len() {
            let (readings, problems) = read(&bytes[..cut]).unwrap_or_else(|error| panic!("cut at {cut}: {error}"));
            assert!(whole.starts_with(&readings), "cut at {cut}");
            assert!(readings.len() >= most, "more of the file is no less");
            most = readings.len();
            assert!(problems.iter().any(|problem| problem.reason == Reason::Truncated), "cut at {cut}");
        }
        assert_eq!(most, whole.len());
    }
}

#[test]
fn the_bytes_that_are_lost_are_told_from_a_file_and_from_a_pipe() {
    let recording = drive();
    let bytes = recording.laid_out(Layout::Bare);
    let ends = ends(&bytes, &recording);
    let whole = atm_fed(["fuse", "-"], &bytes).exits(0).echoes();
    let scratch = Scratch::new();
    for (lost, number) in [(1, 300), (8, 301), (20, 302)] {
        let cut = &bytes[..ends[number] + lost];
        let log = scratch.file("drive.mcap", cut);
        let counts = scratch.name("counts.json");
        let words = format!("the last {lost} bytes, the beginning of");
        let file = atm(["fuse", &log, "--summary", &counts]).exits(3).says(&["1 truncated", &words]);
        assert_eq!(read_json(&counts)["input_damaged"], true);
        assert_eq!(tally(&read_json(&counts), "/readings"), number as u64 + 1);
        atm_fed(["fuse", "-"], cut).exits(3).says(&["1 truncated", &words]).writes(&file.stdout);
        assert!(file.echoes().len() > whole.len() / 4);
        atm(["info", &log]).exits(3).says(&["1 truncated"]);
    }
    let log = scratch.file("drive.mcap", &bytes[..ends[300]]);
    atm(["fuse", &log]).exits(3).says(&["the file ends without an end of the data; 0 bytes are lost"]);
}

#[test]
fn a_chunk_that_was_cut_off_gives_what_of_it_is_there() {
    let recording = drive();
    let bytes = recording.laid_out(Layout::Chunks(None));
    let ends = ends(&bytes, &recording);
    let scratch = Scratch::new();
    let log = scratch.file("drive.mcap", &bytes[..ends[500]]);
    let counts = scratch.name("counts.json");
    atm(["fuse", &log, "--summary", &counts])
        .exits(3)
        .says(&["the beginning of a chunk of which", "messages could be read"]);
    assert_eq!(tally(&read_json(&counts), "/readings"), 501);
}

#[test]
fn what_is_behind_the_data_costs_no_reading_and_is_told() {
    let bytes = drive().bytes();
    let whole = atm_fed(["fuse", "-"], &bytes).exits(0).stdout;
    let scratch = Scratch::new();
    for lost in [1, 8, 9, 30, 100] {
        let log = scratch.file("drive.mcap", &bytes[..bytes.len() - lost]);
        atm(["fuse", &log]).exits(3).says(&["1 truncated", "no message is lost"]).writes(&whole);
    }
}
