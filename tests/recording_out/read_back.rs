//! Echoes and crossings, written and read back: the same as from the tables of the same run, to the last bit.

use std::{io::Cursor, sync::Arc};

use atm::{
    core::Point2,
    error::{Problem, Result},
    log::{
        Input,
        crossing_log::CrossingLog,
        crossing_table::Crossing,
        echo_log::EchoLog,
        echo_table::Estimate,
        echoes::{CROSSING_COLUMNS, ECHO_COLUMNS},
        format::Format,
        mcap::write::{Contents, Layout, Options},
    },
    pipeline::{EchoSink, Emit},
};

use crate::sample::{KINDS, doorway, fuse, nomad, options, recorded, sink, tables};

fn input(bytes: Vec<u8>) -> Input {
    Input { reader: Box::new(Cursor::new(bytes)), name: Arc::from("echoes"), length: None }
}

/// All echoes of a file, none of which is unusable.
fn echoes(format: Format, bytes: Vec<u8>) -> Vec<Estimate> {
    let echoes = EchoLog::new("-", format, input(bytes)).expect("echoes");
    let problem = |problem: Problem| panic!("{problem}");
    echoes.estimates(problem).collect::<Result<_>>().expect("they can be read")
}

/// All crossings of a file, none of which is unusable.
fn crossings(format: Format, bytes: Vec<u8>) -> Vec<Crossing> {
    let mut log = CrossingLog::new("-", format, input(bytes)).expect("crossings");
    let next = || log.next_crossing(&mut |problem| panic!("{problem}")).expect("they can be read");
    std::iter::from_fn(next).collect()
}

fn table(header: &str, rows: &[String]) -> Vec<u8> {
    format!("{header}\n{}\n", rows.join("\n")).into_bytes()
}

/// Bits of what a point says: -0 is not 0.
fn bits(estimate: &Estimate) -> [Option<u64>; 4] {
    let Point2 { coords } = estimate.position;
    [Some(coords.x), Some(coords.y), estimate.azimuth, estimate.range].map(|number| number.map(f64::to_bits))
}

#[test]
fn what_is_written_in_either_kind_is_read_back_as_its_table_is() {
    let [echo_rows, crossing_rows] = tables(&doorway());
    let expected = echoes(Format::Csv, table(ECHO_COLUMNS, &echo_rows));
    let expected_crossings = crossings(Format::Csv, table(CROSSING_COLUMNS, &crossing_rows));
    assert!(expected.len() > 500 && expected_crossings.len() > 500, "the case is empty");
    for kind in KINDS {
        let file = recorded(&doorway(), options(kind));
        let found = echoes(Format::Mcap, file.clone());
        assert!(found == expected, "{kind:?}");
        assert!(found.iter().map(bits).eq(expected.iter().map(bits)), "{kind:?}");
        assert!(crossings(Format::Mcap, file) == expected_crossings, "{kind:?}");
        let alone = recorded(&doorway(), Options { contents: Contents::Crossings, ..options(kind) });
        assert!(crossings(Format::Mcap, alone) == expected_crossings, "{kind:?}");
    }
}

#[test]
fn a_recording_without_chunks_gives_the_same() {
    for kind in KINDS {
        let mut sink = sink(Options { layout: Layout::Immediate, ..options(kind) });
        fuse(&doorway(), Emit::Settled, &mut sink).unwrap();
        let immediate = sink.finish().unwrap();
        assert!(
            echoes(Format::Mcap, immediate) == echoes(Format::Mcap, recorded(&doorway(), options(kind))),
            "{kind:?}"
        );
    }
}

/// A sweep in which the same sensors fire again after more nanoseconds than 32 bits hold, before and after 1970.
#[test]
fn times_are_read_back_to_the_nanosecond() {
    let rows = ["-3000.000000001,0,2,0,0,0", "-1,3,2,0,0,0", "1.5,0,2,0.01,0,0", "9.123456789,0,2,0.02,0,0"];
    let log = format!("t,sensor,range,x,y,yaw\n{}\n", rows.join("\n"));
    for kind in KINDS {
        let found = echoes(Format::Mcap, recorded(&log, options(kind)));
        let keys: Vec<(i64, &str)> =
            found.iter().flat_map(|echo| &echo.key).map(|(t, sensor)| (*t, &**sensor)).collect();
        assert_eq!(
            keys,
            [(-3_000_000_000_001, "0"), (-1_000_000_000, "3"), (1_500_000_000, "0"), (9_123_456_789, "0")]
        );
    }
}

#[test]
fn a_run_that_was_killed_gives_the_echoes_that_it_had_written() {
    for kind in KINDS {
        let whole = recorded(&doorway(), options(kind));
        let expected = echoes(Format::Mcap, whole.clone());
        let mut most = 0;
        for cut in (0..whole.len()).step_by(whole.len() / 40) {
            let mut log = EchoLog::new("-", Format::Mcap, input(whole[..cut].to_vec())).expect("the beginning of one");
            let (mut problems, mut found) = (Vec::new(), Vec::new());
            while let Some(echo) = log.next_estimate(&mut |problem| problems.push(problem)).expect("it is read on") {
                found.push(echo);
            }
            assert!(expected.starts_with(&found), "{kind:?} cut at {cut}");
            assert!(found.len() >= most, "more of the file is no less");
            most = found.len();
            assert!(problems.iter().any(|problem| problem.reason.key() == "truncated"), "{problems:?}");
        }
        assert_eq!(most, expected.len());
    }
}

/// Sensors that are known by the sink alone, as `atm` has no other way to name them.
#[test]
fn ids_of_sensors_are_those_that_were_said() {
    let names: Vec<Arc<str>> = (0..16).map(|sensor| Arc::from(format!("left, \"{sensor}\"\n"))).collect();
    let mut sink = sink(options(KINDS[0]));
    sink.sensors(&names).unwrap();
    // The ring's own ids come second, and are known already.
    fuse(&doorway(), Emit::Settled, &mut sink).unwrap();
    let found = echoes(Format::Mcap, sink.finish().unwrap());
    let ids = nomad().ids().len();
    let index = |echo: &Estimate| names.iter().position(|name| echo.key.as_ref().is_some_and(|(_, id)| id == name));
    let seen: std::collections::BTreeSet<usize> = found.iter().map(|echo| index(echo).expect("one of them")).collect();
    assert!(seen.len() > ids / 2);
}
