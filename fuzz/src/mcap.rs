//! Recordings: the same rows, problems and words whole and in pieces; what can be used is fused.

use std::sync::{Arc, LazyLock, atomic::Ordering};

use atm::{
    core::Bounds,
    echo::{AnyEcho, AnyEstimator},
    error::{Problem, Reason, Result},
    log::{
        Input, Next, Row, Source,
        mcap::{Channel, ClockChoice, McapReadings, Message, Options, Tap},
    },
    pipeline::{self, EchoSink, Emit, History, Settings},
    rig::Rig,
};

use crate::pieces::{pieces, whole};

static RIG: LazyLock<Arc<Rig>> = LazyLock::new(|| {
    let text = "max_range = \"4m\"\n[[sensor]]\nid = \"a\"\n[[sensor]]\nid = \"b\"\ntopic = \"/r1\"\nyaw = \"90deg\"\n";
    Arc::new(Rig::parse(text, "pair").expect("a rig"))
});

/// The first byte chooses how the recording is read, the second the pieces, none of which is the fuser; the rest is the file.
pub fn check(bytes: &[u8]) {
    let Some((&[options, pattern], file)) = bytes.split_first_chunk() else { return };
    match pattern {
        0 => fuse(options, file),
        _ => agree(options, pattern, file),
    }
}

/// What a reader says of a recording until its end or its error.
#[derive(Debug, PartialEq)]
pub struct Said {
    pub rows: Vec<Row>,
    pub problems: Vec<Problem>,
    pub ids: Vec<Arc<str>>,
    pub words: Vec<String>,
}

/// Takes everything that is told, and does nothing with it.
struct Listener;

impl Tap for Listener {
    fn channel(&mut self, channel: &Arc<Channel>) -> Result<()> {
        assert!(channel.topic.len() < 1 << 20);
        Ok(())
    }

    fn message(&mut self, message: Message<'_>) -> Result<()> {
        assert!(message.data.len() < 1 << 20);
        Ok(())
    }
}

pub fn open(options: u8, path: &str, input: Input) -> Result<McapReadings> {
    let everything = options & 2 != 0;
    let choices = Options {
        clock: [ClockChoice::Header, ClockChoice::Log, ClockChoice::Publish, ClockChoice::Header]
            [usize::from(options >> 2 & 3)],
        reorder: if options & 16 == 0 { Options::REORDER } else { 0 },
        max_message: if options & 32 == 0 { 1 << 16 } else { 100 },
        fixed_frame: (options & 64 != 0).then(|| "odom".to_owned()),
        everything,
        ..Options::default()
    };
    let rig = (options & 1 != 0).then(|| Arc::clone(&RIG));
    let mut log = McapReadings::open(path, input, rig, None, choices)?;
    if everything {
        log.set_tap(Box::new(Listener));
    }
    Ok(log)
}

fn agree(options: u8, pattern: u8, file: &[u8]) {
    let at_once = read(open(options, "-", whole(file)), file.len(), || 0);
    let (input, reads) = pieces(file, pattern);
    let in_pieces = read(open(options, "-", input), file.len(), || reads.load(Ordering::Relaxed));
    assert_eq!(at_once, in_pieces);
}

/// Reads to the end or to the error.
pub fn read(opened: Result<McapReadings>, length: usize, reads: impl Fn() -> u64) -> Said {
    let mut said = Said { rows: Vec::new(), problems: Vec::new(), ids: Vec::new(), words: Vec::new() };
    let mut source = match opened {
        Ok(source) => source,
        Err(error) => return Said { words: vec![error.to_string()], ..said },
    };
    let mut row = Row::default();
    loop {
        let (drained, before, position) = (source.drained(), reads(), source.position());
        let next = source.next_row(&mut row, &mut |problem| said.problems.push(worded(problem)));
        // Whoever is told that a record is there must not have to wait for it.
        let after = source.position();
        assert!(
            drained || reads() == before,
            "not drained, and yet it read on from {position} to {after} of {length}: {next:?}"
        );
        match next {
            Ok(Next::Record) => said.rows.push(tidied(&row)),
            Ok(Next::Unusable) => {}
            Ok(Next::End) => break,
            Err(error) => {
                said.words.push(error.to_string());
                break;
            }
        }
    }
    said.ids = source.ids().to_vec();
    said.words.extend(source.pose_source());
    said.words.extend(source.notes());
    said
}

/// What a decompressor says of a chunk that is broken depends on how much of it was there.
fn worded(problem: Problem) -> Problem {
    let value = if problem.reason == Reason::BadChunk { String::new() } else { problem.value };
    Problem { value, ..problem }
}

/// The row with all its NaNs alike, so that rows can be compared.
fn tidied(row: &Row) -> Row {
    let mut row = row.clone();
    for (_, range) in &mut row.readings {
        if range.is_nan() {
            *range = f64::MIN;
        }
    }
    if let Some(pose) = row.pose {
        assert!(pose.x.is_finite() && pose.y.is_finite() && pose.yaw.is_finite(), "{pose:?}");
    }
    for view in &row.views {
        let (at, turn) = (view.pose.translation.vector, view.pose.rotation);
        assert!(at.iter().chain([&turn.re, &turn.im]).all(|part| part.is_finite()), "{view:?}");
    }
    row
}

struct Sane;

impl EchoSink for Sane {
    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        crate::fuser::sane_either(echo);
        Ok(true)
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn fuse(options: u8, file: &[u8]) {
    let Ok(mut source) = open(options, "-", whole(file)) else { return };
    let emit = if options & 128 == 0 { Emit::Settled } else { Emit::Latest };
    let settings = Settings {
        emit,
        history: History::ByCount(2),
        bounds: Bounds::NONE,
        estimator: AnyEstimator::PAPER,
        strict: false,
    };
    let (summary, _) = pipeline::fuse(&mut source, None, &[], &settings, &mut Sane, &mut |_| ());
    assert_eq!(summary.written, summary.echoes.total());
}

/// A recording that is written record by record, without chunks or checksums (mcap.dev/spec).
pub struct Recording(Vec<u8>);

impl Default for Recording {
    fn default() -> Self {
        let mut recording = Self(b"\x89MCAP0\r\n".to_vec());
        recording.record(0x01, &[text(""), text("")].concat());
        recording
    }
}

fn text(text: &str) -> Vec<u8> {
    blob(text.as_bytes())
}

fn blob(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes(), bytes].concat()
}

impl Recording {
    fn record(&mut self, opcode: u8, content: &[u8]) {
        self.0.push(opcode);
        self.0.extend((content.len() as u64).to_le_bytes());
        self.0.extend(content);
    }

    /// A schema and a channel of its own, of this number; schemas count from 1.
    pub fn channel(&mut self, id: u16, topic: &str, encoding: &str, schema: (&str, &str, &[u8])) {
        let (name, language, content) = schema;
        let number = |id: u16| id.to_le_bytes().to_vec();
        self.record(0x03, &[number(id + 1), text(name), text(language), blob(content)].concat());
        self.record(0x04, &[number(id), number(id + 1), text(topic), text(encoding), blob(&[])].concat());
    }

    /// A message, recorded and sent at the same time.
    pub fn message(&mut self, channel: u16, log_time: u64, content: &[u8]) {
        let times = [log_time.to_le_bytes(), log_time.to_le_bytes()].concat();
        self.record(0x05, &[&channel.to_le_bytes()[..], &[0; 4], &times, content].concat());
    }

    /// The bytes with the end of the data behind them.
    pub fn end(mut self) -> Vec<u8> {
        self.record(0x0f, &[0; 4]);
        self.record(0x02, &[0; 20]);
        self.0.extend(b"\x89MCAP0\r\n");
        self.0
    }
}
