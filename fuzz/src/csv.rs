//! Long and wide tables of readings: the same rows, problems and errors whole and in pieces; echoes from whatever can be used.

use std::sync::{Arc, LazyLock, atomic::Ordering};

use atm::{
    core::Bounds,
    echo::{AnyEcho, AnyEstimator},
    error::{Error, Problem},
    intake::Defaults,
    log::{
        Input, Next, Row, Source,
        csv::{CsvReadings, Discover, EmptyCell, PoseUse, SensorNames},
        echoes::TableWriter,
    },
    pipeline::{self, EchoSink, Emit, History, Settings},
    rig::{Rig, TableFormat},
};

use crate::pieces::{pieces, whole};

static NOMAD: LazyLock<Arc<Rig>> = LazyLock::new(|| Arc::new(Rig::builtin("nomad200").expect("built in")));
static ROBOND: LazyLock<Arc<Rig>> = LazyLock::new(|| Arc::new(Rig::builtin("robond8").expect("built in")));
static PAIR: LazyLock<Arc<Rig>> = LazyLock::new(|| {
    let text = "[[sensor]]\nid = \"a\"\n[[sensor]]\nid = \"b\"\nyaw = \"90deg\"\n[log]\nno_echo = [9.5]\nrange_unit = \"cm\"\n";
    Arc::new(Rig::parse(text, "pair").expect("a rig"))
});

/// The first byte chooses rig and reading, the second the pieces, none of which is the fuser; the rest is the file.
pub fn check(bytes: &[u8]) {
    let Some((&[options, pattern], file)) = bytes.split_first_chunk() else { return };
    let rig = match options & 3 {
        0 => &NOMAD,
        1 => &ROBOND,
        2 => &PAIR,
        _ => return agree(options, pattern, file, &TableFormat::default(), Discover::default()),
    };
    let format = rig.log().map(|log| log.readings.clone()).unwrap_or_default();
    match pattern {
        0 => fuse(options, file, &format, rig),
        _ => agree(options, pattern, file, &format, Arc::clone(rig)),
    }
}

/// What a reader says of a file until its end or its error.
#[derive(Debug, PartialEq)]
struct Said {
    rows: Vec<Row>,
    problems: Vec<Problem>,
    ids: Vec<Arc<str>>,
    error: Option<String>,
}

fn open<N: SensorNames>(options: u8, input: Input, format: &TableFormat, names: N) -> Result<CsvReadings<N>, Error> {
    let poses = [PoseUse::Needed, PoseUse::IfThere, PoseUse::Ignored, PoseUse::Needed][usize::from(options >> 2 & 3)];
    let empty = [None, Some(EmptyCell::NoEcho), Some(EmptyCell::Skip), None][usize::from(options >> 4 & 3)];
    CsvReadings::new(input, format, poses, empty, names)
}

fn agree<N: SensorNames + Clone>(options: u8, pattern: u8, file: &[u8], format: &TableFormat, names: N) {
    let at_once = read(open(options, whole(file), format, names.clone()), || 0);
    let (input, reads) = pieces(file, pattern);
    let in_pieces = read(open(options, input, format, names), || reads.load(Ordering::Relaxed));
    assert_eq!(at_once, in_pieces);
}

fn read<N: SensorNames>(opened: Result<CsvReadings<N>, Error>, reads: impl Fn() -> u64) -> Said {
    let mut said = Said { rows: Vec::new(), problems: Vec::new(), ids: Vec::new(), error: None };
    let mut source = match opened {
        Ok(source) => source,
        Err(error) => return Said { error: Some(error.to_string()), ..said },
    };
    let mut row = Row::default();
    loop {
        let (drained, before) = (source.drained(), reads());
        let next = source.next_row(&mut row, &mut |problem| said.problems.push(problem));
        // Whoever is told that a record is there must not have to wait for it.
        assert!(drained || reads() == before, "not drained, and yet it read on");
        match next {
            Ok(Next::Record) => said.rows.push(tidied(&row)),
            Ok(Next::Unusable) => {}
            Ok(Next::End) => break,
            Err(error) => {
                said.error = Some(error.to_string());
                break;
            }
        }
    }
    said.ids = source.ids().to_vec();
    said
}

/// The row with all its NaNs alike, so that rows can be compared.
fn tidied(row: &Row) -> Row {
    let mut row = row.clone();
    for (_, range) in &mut row.readings {
        if range.is_nan() {
            *range = f64::MIN;
        }
    }
    row
}

/// Writes echoes, and insists that they are sane.
struct Table(TableWriter<Vec<u8>>);

impl EchoSink for Table {
    fn echo(&mut self, echo: &AnyEcho) -> atm::error::Result<bool> {
        crate::fuser::sane_either(echo);
        self.0.echo(echo).map_err(|source| Error::Io { file: "echoes".into(), source })?;
        Ok(true)
    }

    fn flush(&mut self) -> atm::error::Result<()> {
        Ok(())
    }
}

fn fuse(options: u8, file: &[u8], format: &TableFormat, rig: &Arc<Rig>) {
    let Ok(sensors) = Defaults::default().complete(rig) else { return };
    let emit = if options & 64 == 0 { Emit::Settled } else { Emit::Latest };
    let settings = Settings {
        emit,
        history: History::ByCount(2),
        bounds: Bounds::NONE,
        estimator: AnyEstimator::PAPER,
        strict: options & 128 != 0,
    };
    let Ok(mut source) = open(options & !0b1100, whole(file), format, Arc::clone(rig)) else { return };
    let ids = rig.sensors().iter().map(|sensor| sensor.id());
    let mut table = Table(TableWriter::echoes(Vec::new(), ids).expect("memory"));
    let (summary, result) = pipeline::fuse(&mut source, None, &sensors, &settings, &mut table, &mut |_| ());
    assert!(settings.strict || result.is_ok());
    assert_eq!(summary.written, summary.echoes.total());
    let written = table.0.into_inner();
    let lines = written.iter().filter(|&&byte| byte == b'\n').count() as u64;
    assert_eq!(lines, summary.written + 1, "a line for each echo, and the header");
}
