use super::*;
use crate::{
    log::tests::{broken, input, message, stuttering},
    rig::Ranging,
    track::Pose,
    units::Scale,
};

const HEADER: &str = "t,sensor,range,x,y,yaw\n";

fn ring(count: usize) -> Arc<Rig> {
    Arc::new(Rig::ring(count, 0.1, 0.0, Ranging::default()).unwrap())
}

fn open(text: &str, format: &TableFormat) -> Result<CsvReadings<Arc<Rig>>> {
    CsvReadings::new(input(text), format, PoseUse::Needed, None, ring(4))
}

/// All usable rows, and the problems as text.
fn read_all(log: &mut impl Source) -> (Vec<Row>, Vec<String>) {
    let (mut rows, mut problems) = (Vec::new(), Vec::new());
    let mut row = Row::default();
    loop {
        match log.next_row(&mut row, &mut |problem| problems.push(problem.to_string())).unwrap() {
            Next::Record => rows.push(row.clone()),
            Next::Unusable => assert!(row.readings.is_empty()),
            Next::End => return (rows, problems),
        }
    }
}

/// One usable row, without its place: nanoseconds, pose, readings as text (so that NaN equals NaN), empty cells.
fn row_of(row: &Row) -> (i64, Option<(f64, f64, f64)>, String, u64) {
    let pose = row.pose.map(|Pose { x, y, yaw }| (x, y, yaw));
    let readings: Vec<_> = row.readings.iter().map(|(sensor, range)| format!("{sensor}:{range}")).collect();
    (row.t, pose, readings.join(" "), row.empty)
}

/// What one long row of a 4-sensor ring gives: its readings, or its problem without the place.
fn long(row: &str) -> Result<String, String> {
    let (rows, problems) = read_all(&mut open(&format!("{HEADER}{row}\n"), &TableFormat::default()).unwrap());
    match (&rows[..], &problems[..]) {
        ([row], []) => Ok(row_of(row).2),
        ([], [problem]) => Err(problem.strip_prefix("log.csv:2: ").unwrap().to_owned()),
        _ => panic!("{rows:?} {problems:?}"),
    }
}

/// The same of a wide row of a 4-sensor ring, which has readings and problems.
fn wide(row: &str) -> (String, u64, Vec<String>) {
    let text = format!("t,x,y,yaw,0,1,2,3\n{row}\n");
    let (rows, problems) = read_all(&mut open(&text, &TableFormat::default()).unwrap());
    let (_, _, readings, empty) = rows.first().map(row_of).unwrap_or_default();
    (readings, empty, problems)
}

#[test]
fn a_long_row_is_read_with_time_pose_and_place() {
    let mut log = open(&format!("{HEADER}1.5,2,0.75,1,-2,0.5\n"), &TableFormat::default()).unwrap();
    assert!(log.has_poses() && !log.is_wide());
    let (rows, problems) = read_all(&mut log);
    assert_eq!(problems, [""; 0]);
    assert_eq!(row_of(&rows[0]), (1_500_000_000, Some((1.0, -2.0, 0.5)), "2:0.75".into(), 0));
    assert_eq!((&*rows[0].place.file, rows[0].place.line, rows[0].place.byte), ("log.csv", 2, 23));
}

#[test]
fn columns_come_in_any_order_and_more_are_ignored() {
    let text = "note;yaw;range;t;y;extra;x;sensor\nhi;0.5;0.75;1.5;-2;;1;\"3\"\n";
    let (rows, _) = read_all(&mut open(text, &TableFormat::default()).unwrap());
    assert_eq!(row_of(&rows[0]), (1_500_000_000, Some((1.0, -2.0, 0.5)), "3:0.75".into(), 0));
}

#[test]
fn a_wide_row_has_its_readings_in_the_order_of_the_columns() {
    let text = "yaw,3,t,1,note,x,0,y,2\n0.5,0.3,1.5,0.1,hi,1,0,-2,0.2\n";
    let mut log = open(text, &TableFormat::default()).unwrap();
    assert!(log.is_wide());
    let (rows, _) = read_all(&mut log);
    assert_eq!(row_of(&rows[0]), (1_500_000_000, Some((1.0, -2.0, 0.5)), "3:0.3 1:0.1 0:0 2:0.2".into(), 0));
}

#[test]
fn spelled_non_finite_ranges_are_readings_without_an_echo() {
    for (cell, range) in [("nan", "NaN"), ("-NaN", "NaN"), ("Inf", "inf"), ("-inf", "-inf"), ("+INFINITY", "inf")] {
        assert_eq!(long(&format!("1,0,{cell},0,0,0")), Ok(format!("0:{range}")));
    }
    assert_eq!(wide("1,0,0,0,nan,INF,-inf,1"), ("0:NaN 1:inf 2:-inf 3:1".into(), 0, vec![]));
}

#[test]
fn an_empty_cell_is_no_echo_in_long_and_skipped_in_wide() {
    assert_eq!(long("1,0,,0,0,0"), Ok("0:NaN".into()));
    assert_eq!(wide("1,0,0,0,, ,2,"), ("2:2".into(), 3, vec![]));
}

#[test]
fn an_option_says_what_an_empty_cell_is() {
    let read = |text: &str, empty| {
        let format = TableFormat::default();
        let mut log = CsvReadings::new(input(text), &format, PoseUse::Ignored, Some(empty), ring(2)).unwrap();
        row_of(&read_all(&mut log).0[0])
    };
    assert_eq!(read("t,sensor,range\n1,0,\n", EmptyCell::Skip), (1_000_000_000, None, "".into(), 1));
    assert_eq!(read("t,0,1\n1,,2\n", EmptyCell::NoEcho), (1_000_000_000, None, "0:NaN 1:2".into(), 0));
}

#[test]
fn a_bad_cell_makes_a_long_record_unusable() {
    assert_eq!(long("1,0,abc,0,0,0"), Err("bad_number: range \"abc\"".into()));
    assert_eq!(long("1,0,1e999,0,0,0"), Err("bad_number: range \"1e999\"".into()));
    assert_eq!(long("x,0,1,0,0,0"), Err("bad_number: t \"x\"".into()));
    assert_eq!(long(",0,1,0,0,0"), Err("bad_number: t \"\"".into()));
    assert_eq!(long("nan,0,1,0,0,0"), Err("bad_number: t \"nan\"".into()));
    assert_eq!(long("1,0,1,0,a\x07,0"), Err("bad_number: y \"a\\u{7}\"".into()));
    assert_eq!(long("1,0,1,,0,0"), Err("bad_number: x \"\"".into()));
    assert_eq!(long("1,0,1,0,0,nan"), Err("bad_pose: yaw \"nan\"".into()));
    assert_eq!(long("1,0,1,-inf,0,0"), Err("bad_pose: x \"-inf\"".into()));
    assert_eq!(long("1,4,1,0,0,0"), Err("unknown_sensor: sensor \"4\"".into()));
    assert_eq!(long("1,00,1,0,0,0"), Err("unknown_sensor: sensor \"00\"".into()));
    assert_eq!(long("1,0,1,0,0"), Err("missing_field: 5 fields, 6 needed".into()));
}

#[test]
fn a_quote_left_open_is_suspected() {
    assert_eq!(
        long("1,\"0,1,0,0,0\n2,0,1,0,0,0"),
        Err("missing_field: 2 fields, 6 needed; it extends over 2 lines: is a quote left open?".into())
    );
}

#[test]
fn a_bad_cell_of_a_wide_record_costs_that_reading_alone() {
    let problems =
        vec!["log.csv:2: bad_number: 1 \"oops\"".to_owned(), "log.csv:2: bad_number: 3 \"1e999\"".to_owned()];
    assert_eq!(wide("1,0,0,0,0.5,oops,0.7,1e999"), ("0:0.5 2:0.7".into(), 0, problems));
    let problems = vec!["log.csv:2: bad_pose: x \"inf\"".to_owned()];
    assert_eq!(wide("1,inf,0,0,1,2,3,4"), ("".into(), 0, problems));
    let problems = vec!["log.csv:2: missing_field: 7 fields, 8 needed".to_owned()];
    assert_eq!(wide("1,0,0,0,1,2,3"), ("".into(), 0, problems));
}

#[test]
fn reading_goes_on_after_an_unusable_record_and_a_line_without_end() {
    let text = format!("{HEADER}1,0,1,0,0,0\n2,0,x,0,0,0\n{}\n\n3,1,1,0,0,0\n4,1,", "y".repeat(3 << 20));
    let (rows, problems) = read_all(&mut open(&text, &TableFormat::default()).unwrap());
    assert_eq!(
        rows.iter().map(|row| (row.t, row.place.line)).collect::<Vec<_>>(),
        [(1_000_000_000, 2), (3_000_000_000, 6)]
    );
    let [bad, long, cut] = &problems[..] else { panic!("{problems:?}") };
    assert_eq!(bad, "log.csv:3: bad_number: range \"x\"");
    assert!(long.starts_with("log.csv:4: too_long: a record of 3145728 bytes"), "{long}");
    assert_eq!(cut, "log.csv:7: missing_field: 3 fields, 6 needed");
}

#[test]
fn a_stuttering_reader_gives_the_same_rows() {
    let text = format!("\u{feff}{HEADER}\r\n# c\r\n1,0,1,0,0,0\r\n2,\"1\",x,0,0,0\r\n\r\n3,2,,1,2,3");
    let read = |input| {
        let format = TableFormat::default();
        let (rows, problems) = read_all(&mut CsvReadings::new(input, &format, PoseUse::Needed, None, ring(4)).unwrap());
        (rows.iter().map(|row| (row.place.clone(), row_of(row))).collect::<Vec<_>>(), problems)
    };
    let whole = read(input(text.clone()));
    assert_eq!((whole.0.len(), whole.1.len()), (2, 1));
    assert_eq!(whole, read(stuttering(text)));
}

#[test]
fn an_error_of_the_reader_comes_after_the_rows_before_it() {
    let format = TableFormat::default();
    let text = format!("{HEADER}1,0,1,0,0,0\n2,0");
    let mut log = CsvReadings::new(broken(text), &format, PoseUse::Needed, None, ring(4)).unwrap();
    let mut row = Row::default();
    assert_eq!(log.next_row(&mut row, &mut |_| ()).unwrap(), Next::Record);
    assert_eq!(message(log.next_row(&mut row, &mut |_| ())), "log.csv: the disk is on fire");
}

#[test]
fn missing_columns_are_named_and_the_header_shown() {
    let refused = |text: &str| message(open(text, &TableFormat::default()));
    assert_eq!(
        refused("time,sensor,range,x,y,yaw\n"),
        "log.csv:1: no column `t`; the columns are: time, sensor, range, x, y, yaw"
    );
    assert_eq!(refused("\nt,sensor,dist\n"), "log.csv:2: no column `range`; the columns are: t, sensor, dist");
    assert_eq!(refused("t,range,x,y,yaw\n"), "log.csv:1: no column `sensor`; the columns are: t, range, x, y, yaw");
    let poses = refused("t,sensor,range,x\n");
    assert!(poses.contains("no column for the pose (y, yaw)") && poses.contains("--poses"), "{poses}");
    let twice = refused("t,sensor,range,x,y,yaw,x\n");
    assert!(twice.contains("two columns are named `x`"), "{twice}");
    let twice = refused("t,x,y,yaw,0,1,2,3,1\n");
    assert!(twice.contains("two columns are named `1`"), "{twice}");
    let wrong_rig = refused("t,x,y,yaw,0,2\n");
    assert!(wrong_rig.contains("no column for the sensors 1, 3: another rig's log"), "{wrong_rig}");
    let neither = refused("t,x,y,yaw,front\n");
    assert!(neither.contains("neither a long table"), "{neither}");
    let numbers = refused("1686487 5110 5110 2320\n");
    assert!(numbers.contains("neither a long table") && numbers.contains("[log]"), "{numbers}");
    let comments = refused("# nothing\n\n");
    assert!(comments.contains("holds no header"), "{comments}");
    let endless = refused(&format!("{}\n1,2\n", "t".repeat(2 << 20)));
    assert!(endless.contains("the header is a record of 2097152 bytes"), "{endless}");
}

#[test]
fn a_header_alone_is_a_log_without_rows() {
    assert_eq!(read_all(&mut open(HEADER.trim_end(), &TableFormat::default()).unwrap()), (vec![], vec![]));
}

#[test]
fn poses_that_come_from_elsewhere_are_not_looked_at() {
    for (poses, text) in
        [(PoseUse::Ignored, "t,sensor,range,x\n1,0,2,oops\n"), (PoseUse::IfThere, "t,sensor,range,x\n1,0,2,oops\n")]
    {
        let mut log = CsvReadings::new(input(text), &TableFormat::default(), poses, None, ring(4)).unwrap();
        assert!(!log.has_poses());
        assert_eq!(row_of(&read_all(&mut log).0[0]), (1_000_000_000, None, "0:2".into(), 0));
    }
    let format = TableFormat::default();
    assert!(CsvReadings::new(input(HEADER), &format, PoseUse::IfThere, None, ring(4)).unwrap().has_poses());
}

#[test]
fn a_foreign_table_is_read_by_its_format() {
    let format = TableFormat {
        header: false,
        delimiter: Some(b' '),
        columns: Some(["t", "0", "1", "2", "3", "x", "y", "yaw"].map(str::to_owned).to_vec()),
        time_shift: 6,
        range: Scale::length("mm").unwrap(),
        pose: Scale::length("cm").unwrap(),
        yaw: Scale::angle("0.1deg").unwrap(),
        no_echo: vec![5110.0],
        ..TableFormat::default()
    };
    let text = "1686487\t5110   2320 5110.0 -inf  100 -250 1800\n";
    let (rows, problems) = read_all(&mut open(text, &format).unwrap());
    assert_eq!(problems, [""; 0]);
    let pose = Some((1.0, -2.5, std::f64::consts::PI));
    assert_eq!(row_of(&rows[0]), (1_686_487_000_000, pose, "0:inf 1:2.32 2:inf 3:-inf".into(), 0));
    assert_eq!((rows[0].place.line, rows[0].place.byte), (1, 0));
}

#[test]
fn names_given_with_a_header_replace_it() {
    let columns = ["t", "sensor", "range", "x", "y", "yaw"].map(str::to_owned).to_vec();
    let format = TableFormat { columns: Some(columns), ..TableFormat::default() };
    let (rows, _) = read_all(&mut open("Zeit,Sensor,Abstand,X,Y,Winkel\n1,0,2,0,0,0\n", &format).unwrap());
    assert_eq!(rows.iter().map(|row| row.t).collect::<Vec<_>>(), [1_000_000_000]);
}

#[test]
fn sensors_are_discovered_as_they_come() {
    let format = TableFormat::default();
    let text = "t,sensor,range\n1,left,1\n2,right,2\n3,left,3\n4,bad,x\n5,\u{fc}ber,1\n";
    let mut log = CsvReadings::new(input(text), &format, PoseUse::IfThere, None, Discover::default()).unwrap();
    let (rows, problems) = read_all(&mut log);
    assert_eq!(rows.iter().map(|row| row.readings[0].0).collect::<Vec<_>>(), [0, 1, 0, 2]);
    assert_eq!(problems.len(), 1);
    assert_eq!(log.names().ids().iter().map(|id| &**id).collect::<Vec<_>>(), ["left", "right", "\u{fc}ber"]);
}

#[test]
fn every_other_column_of_a_wide_log_is_discovered_as_a_sensor() {
    let text = "t,front,x,y,yaw,rear,\n1,0.5,0,0,0,0.75,\n";
    let format = TableFormat::default();
    let mut log = CsvReadings::new(input(text), &format, PoseUse::IfThere, None, Discover::default()).unwrap();
    assert!(log.is_wide() && log.has_poses());
    assert_eq!(row_of(&read_all(&mut log).0[0]).2, "0:0.5 1:0.75");
    assert_eq!(log.names().ids().iter().map(|id| &**id).collect::<Vec<_>>(), ["front", "rear"]);
}

#[test]
fn no_more_than_65535_sensors_are_discovered_and_none_with_an_endless_name() {
    let mut names = Discover::default();
    for index in 0..u16::MAX {
        assert_eq!(names.index(&index.to_string()), Some(index));
    }
    assert_eq!(names.index("one more"), None);
    assert_eq!(names.index("7"), Some(7));
    assert_eq!(Discover::default().index(&"x".repeat(MAX_ID)), Some(0));
    assert_eq!(Discover::default().index(&"x".repeat(MAX_ID + 1)), None);
}
