//! The same readings as a long table, as a wide one, and as a recording: the same echoes.

use std::sync::{Arc, LazyLock};

use arbitrary::{Result, Unstructured};
use atm::{
    core::{Bounds, Consensus, Held, MinAngle},
    echo::{AnyEcho, AnyEstimator},
    intake::Defaults,
    log::{
        Source,
        csv::{CsvReadings, PoseUse},
        echoes::TableWriter,
        mcap::{McapReadings, Options},
    },
    pipeline::{self, EchoSink, Emit, History, Settings},
    rig::Rig,
};

use crate::{
    messages,
    pieces::{pieces, whole},
};

static RIG: LazyLock<Arc<Rig>> = LazyLock::new(|| {
    let text = "field_of_view = \"60deg\"\nmax_range = \"4m\"\nrange_resolution = \"10mm\"\n[ring]\ncount = 3\nradius = \"0.2m\"\n";
    Arc::new(Rig::parse(text, "ring").expect("a rig"))
});

/// Sensors that look one way: what a recording says of them goes through space, and rounds.
static ROW: LazyLock<Arc<Rig>> = LazyLock::new(|| {
    let sensors = [("0", "0m"), ("1", "0.25m"), ("2", "-0.5m")]
        .map(|(id, y)| format!("[[sensor]]\nid = \"{id}\"\ny = \"{y}\"\n"));
    let text =
        "field_of_view = \"60deg\"\nmax_range = \"4m\"\nrange_resolution = \"10mm\"\n".to_owned() + &sensors.concat();
    Arc::new(Rig::parse(&text, "row").expect("a rig"))
});

/// An instant: nanoseconds since the last, pose, and what each sensor read, if it fired.
struct Instant {
    t: i64,
    pose: [f64; 3],
    ranges: [Option<f64>; 3],
}

/// Any drive.
pub fn check(bytes: &[u8]) {
    let mut input = Unstructured::new(bytes);
    let Ok(options) = input.arbitrary::<u8>() else { return };
    let recorded = options & 16 != 0;
    let Ok(instants) = instants(&mut input, recorded) else { return };
    let emit = if options & 1 == 0 { Emit::Settled } else { Emit::Latest };
    let settings = Settings {
        emit,
        history: History::ByCount(usize::from(options >> 1 & 7) + 1),
        bounds: Bounds::NONE
            .with_held([Held::Keep, Held::Drop, Held::Edges, Held::Keep][usize::from(options >> 5 & 3)]),
        estimator: match options & 128 {
            0 => AnyEstimator::PAPER,
            _ => AnyEstimator::Consensus(Consensus::new(MinAngle::PAPER)),
        },
        strict: false,
    };
    let rig = if recorded { &ROW } else { &RIG };
    let table = |text: &str, pattern| echoes(&mut table(text, pattern, rig), &settings, rig);
    let long = table(&long(&instants), None);
    assert_eq!(long, table(&wide(&instants), None), "long and wide");
    assert_eq!(long, table(&wide(&instants), Some(options)), "whole and in pieces");
    if recorded {
        assert_eq!(long, echoes(&mut recording(&instants), &settings, rig), "table and recording");
    }
}

/// Instants of any drive; for a recording with times that differ, one heading, and ranges that a message can hold.
fn instants(input: &mut Unstructured<'_>, recorded: bool) -> Result<Vec<Instant>> {
    let (mut t, mut instants) = (0i64, Vec::new());
    while !input.is_empty() && instants.len() < 40 {
        let fires = input.arbitrary::<u8>()?;
        t = t.saturating_add(i64::from(input.arbitrary::<u16>()?) * 1000 + i64::from(recorded));
        let metres = |input: &mut Unstructured<'_>| Ok(f64::from(input.arbitrary::<i16>()?) / 8192.0);
        let [x, y, yaw] = [metres(input)?, metres(input)?, metres(input)?];
        let pose = [x, y, if recorded { 0.0 } else { yaw }];
        let mut ranges = [None; 3];
        for (sensor, range) in ranges.iter_mut().enumerate() {
            if fires >> sensor & 1 == 0 {
                continue;
            }
            *range = Some(match fires >> 4 {
                15 => f64::INFINITY,
                14 => f64::NAN,
                13 => -1.0,
                12 if !recorded => 1e-300,
                _ => f64::from(input.arbitrary::<u16>()?) / 16_384.0,
            });
        }
        instants.push(Instant { t, pose, ranges });
    }
    Ok(instants)
}

fn seconds(t: i64) -> String {
    atm::stamp::text(t)
}

fn long(instants: &[Instant]) -> String {
    let mut text = String::from("t,sensor,range,x,y,yaw\n");
    for Instant { t, pose: [x, y, yaw], ranges } in instants {
        for (sensor, range) in ranges.iter().enumerate() {
            if let Some(range) = range {
                text += &format!("{},{sensor},{range},{x},{y},{yaw}\n", seconds(*t));
            }
        }
    }
    text
}

fn wide(instants: &[Instant]) -> String {
    let mut text = String::from("t,x,y,yaw,0,1,2\n");
    for Instant { t, pose: [x, y, yaw], ranges } in instants {
        let cells = ranges.map(|range| range.map(|range| range.to_string()).unwrap_or_default());
        text += &format!("{},{x},{y},{yaw},{}\n", seconds(*t), cells.join(","));
    }
    text
}

struct Table(TableWriter<Vec<u8>>);

impl EchoSink for Table {
    fn echo(&mut self, echo: &AnyEcho) -> atm::error::Result<bool> {
        self.0.echo(echo).expect("memory");
        Ok(true)
    }

    fn flush(&mut self) -> atm::error::Result<()> {
        Ok(())
    }
}

fn table(log: &str, pattern: Option<u8>, rig: &Arc<Rig>) -> CsvReadings<Arc<Rig>> {
    let input = match pattern {
        Some(pattern) => pieces(log.as_bytes(), pattern).0,
        None => whole(log.as_bytes()),
    };
    CsvReadings::new(input, &Default::default(), PoseUse::Needed, None, Arc::clone(rig)).expect("a table")
}

/// Odometry, and each sensor's readings under a topic of its own.
fn recording(instants: &[Instant]) -> McapReadings {
    let bytes = messages::drive(instants.iter().map(|Instant { t, pose: [x, y, _], ranges }| (*t, [*x, *y], ranges)));
    McapReadings::open("-", whole(&bytes), Some(Arc::clone(&ROW)), None, Options::default()).expect("a recording")
}

fn echoes(source: &mut dyn Source, settings: &Settings, rig: &Rig) -> String {
    let sensors = Defaults::default().complete(rig).expect("a rig");
    let ids = rig.sensors().iter().map(|sensor| sensor.id());
    let mut table = Table(TableWriter::echoes(Vec::new(), ids).expect("memory"));
    let (_, result) = pipeline::fuse(source, None, &sensors, settings, &mut table, &mut |_| ());
    result.expect("a log in memory");
    String::from_utf8(table.0.into_inner()).expect("text")
}
