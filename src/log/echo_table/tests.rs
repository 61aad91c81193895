use atm_core::{Echo, Kind, Limits};

use super::*;
use crate::log::{
    echo_log::EchoLog,
    echoes::TableWriter,
    format::Format,
    tests::{broken, input, message, stuttering},
};

fn table(input: Input) -> EchoLog {
    EchoLog::new("-", Format::Csv, input).unwrap()
}

fn read_all(input: Input) -> (Vec<Estimate>, Vec<String>) {
    let mut problems = Vec::new();
    let estimates = table(input).estimates(|problem| problems.push(problem.to_string()));
    let estimates = estimates.collect::<Result<_>>().unwrap();
    (estimates, problems)
}

fn point(x: f64, y: f64) -> Estimate {
    Estimate { position: Point2::new(x, y), key: None, azimuth: None, range: None, kind: None }
}

/// An echo of a robot at the origin that hears two posts with one crossing of its arcs.
fn written(ids: &[&str]) -> (Vec<u8>, Vec<Echo<f64>>) {
    use crate::storage::LatestSlots;
    use atm_core::{
        Beam, Bounds, Fuser, Isometry2, Point2 as Point, RangeResolution, Reading, TransversalMedian, Vector2,
    };
    let mut fuser = Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, LatestSlots::new(2, 10).unwrap());
    let mut echoes = Vec::new();
    for step in 0..8_i32 {
        let x = f64::from(step) * 0.37;
        let pose = Isometry2::new(Vector2::new(x, 0.1), 1.2);
        let reading = Reading {
            t: 1_700_000_000_123_456_789 + i64::from(step),
            sensor: (step % 2) as u16,
            range: Limits::NONE.classify((Point::new(1.0, 2.3) - Point::new(x, 0.1)).norm()),
            pose,
            robot: Point::new(x, 0.1),
            beam: Beam::new(2.0).unwrap(),
            range_resolution: RangeResolution::new(0.01).unwrap(),
        };
        fuser.push(&reading, &mut |echo: &Echo<f64>| echoes.push(*echo)).unwrap();
    }
    let mut table = TableWriter::echoes(Vec::new(), ids.iter().copied()).unwrap();
    echoes.iter().for_each(|echo| table.echo(&(*echo).into()).unwrap());
    (table.into_inner(), echoes)
}

#[test]
fn what_is_written_is_read_back_to_the_bit() {
    let ids = ["left, \"low\"", "right"];
    let (bytes, echoes) = written(&ids);
    assert!(echoes.iter().any(|echo| echo.kind == Kind::Median), "the case holds no median");
    for source in [input(bytes.clone()), stuttering(bytes)] {
        let (read, problems) = read_all(source);
        assert_eq!(problems, [""; 0]);
        assert_eq!(read.len(), echoes.len());
        for (read, echo) in read.iter().zip(&echoes) {
            assert_eq!(read.key.as_ref().unwrap().0, echo.t);
            assert_eq!(&*read.key.as_ref().unwrap().1, ids[usize::from(echo.sensor)]);
            assert_eq!(read.position, echo.position);
            assert_eq!((read.azimuth, read.range), (Some(echo.azimuth()), Some(echo.range)));
            assert_eq!(read.kind.as_deref(), Some(echo.kind.name()));
        }
    }
}

#[test]
fn x_and_y_are_enough_in_any_order_and_with_other_columns() {
    assert_eq!(read_all(input("y;name;x\n2;post;1\n-4;;3\n")).0, [point(1.0, 2.0), point(3.0, -4.0)]);
}

#[test]
fn empty_cells_say_nothing() {
    let (read, problems) = read_all(input("t,sensor,x,y,kind,range,azimuth\n,,1,2,,,\n5,,1,2,,,\n,3,1,2,,,\n"));
    assert_eq!(problems, [""; 0]);
    assert_eq!(read, [point(1.0, 2.0), point(1.0, 2.0), point(1.0, 2.0)]);
}

#[test]
fn rows_that_cannot_be_used_are_named_by_line_and_value_and_the_rest_is_read() {
    let text = "t,sensor,x,y,azimuth\n1,a,0,nan,0\n1,a,1e999,0,0\n1,a,0\nsoon,a,0,0,0\n1,a,0,0,inf\n1,a,7,8,0\n";
    let (read, problems) = read_all(input(text));
    assert_eq!(read.len(), 1);
    assert_eq!(read[0].position, Point2::new(7.0, 8.0));
    let expected = [
        "log.csv:2: bad_number: y \"nan\"",
        "log.csv:3: bad_number: x \"1e999\"",
        "log.csv:4: missing_field: 3 fields, 5 needed",
        "log.csv:5: bad_number: t \"soon\"",
        "log.csv:6: bad_number: azimuth \"inf\"",
    ];
    assert_eq!(problems, expected);
}

#[test]
fn a_table_without_coordinates_is_refused_with_what_it_has() {
    let refused = |text: &str| message(EchoTable::new(input(text)));
    assert_eq!(refused("t,y\n"), "log.csv:1: not a table of points: no column x; the columns are: t, y");
    assert!(refused("t,range\n").contains("no column x, y"));
    assert!(refused("x,y,x\n").contains("two columns are named `x`"));
    assert_eq!(refused(""), "log.csv:1: is empty");
}

#[test]
fn an_error_of_the_disk_comes_once_and_ends_the_rows() {
    let mut rows = table(broken("x,y\n1,2\n")).estimates(|_| {});
    assert_eq!(rows.next().unwrap().unwrap(), point(1.0, 2.0));
    assert!(message(rows.next().unwrap()).contains("the disk is on fire"));
    assert!(rows.next().is_none());
}

#[test]
fn ids_are_held_once_and_only_so_many_of_them() {
    let mut words = Words::default();
    let first = words.take(b"a").unwrap();
    assert!(Arc::ptr_eq(&first, &words.take(b"a").unwrap()));
    for word in 0..WORDS + 10 {
        words.take(word.to_string().as_bytes());
    }
    assert_eq!(words.0.len(), WORDS);
}
