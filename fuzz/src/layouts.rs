//! The same readings as a long table, as a wide one, and pushed directly: the same echoes.

use std::sync::{Arc, LazyLock};

use arbitrary::{Result, Unstructured};
use atm::{
    core::Bounds,
    echo::{AnyEcho, AnyEstimator},
    intake::Defaults,
    log::{
        Source,
        csv::{CsvReadings, PoseUse},
        echoes::TableWriter,
    },
    pipeline::{self, EchoSink, Emit, Settings},
    rig::Rig,
};

use crate::pieces::{pieces, whole};

static RIG: LazyLock<Arc<Rig>> = LazyLock::new(|| {
    let text = "field_of_view = \"60deg\"\nmax_range = \"4m\"\nrange_resolution = \"10mm\"\n[ring]\ncount = 3\nradius = \"0.2m\"\n";
    Arc::new(Rig::parse(text, "ring").expect("a rig"))
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
    let Ok(instants) = instants(&mut input) else { return };
    let emit = if options & 1 == 0 { Emit::Settled } else { Emit::Latest };
    let settings = Settings {
        emit,
        history: usize::from(options >> 1 & 7) + 1,
        bounds: Bounds::NONE,
        estimator: AnyEstimator::PAPER,
        strict: false,
    };
    let long = echoes(&long(&instants), &settings, None);
    assert_eq!(long, echoes(&wide(&instants), &settings, None), "long and wide");
    assert_eq!(long, echoes(&wide(&instants), &settings, Some(options)), "whole and in pieces");
}

fn instants(input: &mut Unstructured<'_>) -> Result<Vec<Instant>> {
    let (mut t, mut instants) = (0i64, Vec::new());
    while !input.is_empty() && instants.len() < 40 {
        let fires = input.arbitrary::<u8>()?;
        t = t.saturating_add(i64::from(input.arbitrary::<u16>()?) * 1000);
        let metres = |input: &mut Unstructured<'_>| Ok(f64::from(input.arbitrary::<i16>()?) / 8192.0);
        let pose = [metres(input)?, metres(input)?, metres(input)?];
        let mut ranges = [None; 3];
        for (sensor, range) in ranges.iter_mut().enumerate() {
            if fires >> sensor & 1 == 0 {
                continue;
            }
            *range = Some(match fires >> 4 {
                15 => f64::INFINITY,
                14 => f64::NAN,
                13 => -1.0,
                12 => 1e-300,
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

fn echoes(log: &str, settings: &Settings, pattern: Option<u8>) -> String {
    let input = match pattern {
        Some(pattern) => pieces(log.as_bytes(), pattern).0,
        None => whole(log.as_bytes()),
    };
    let format = Default::default();
    let mut source = CsvReadings::new(input, &format, PoseUse::Needed, None, Arc::clone(&RIG)).expect("a table");
    let sensors = Defaults::default().complete(&RIG).expect("a rig");
    let ids = RIG.sensors().iter().map(|sensor| sensor.id());
    let mut table = Table(TableWriter::echoes(Vec::new(), ids).expect("memory"));
    let source: &mut dyn Source = &mut source;
    let (_, result) = pipeline::fuse(source, None, &sensors, settings, &mut table, &mut |_| ());
    result.expect("a log in memory");
    String::from_utf8(table.0.into_inner()).expect("text")
}
