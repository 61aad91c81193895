use super::*;
use crate::log::{
    csv::{CsvReadings, Discover, PoseUse},
    tests::input,
};

/// Time and sensor of each record as it comes out.
fn order(table: &str) -> Vec<(i64, String)> {
    let source =
        CsvReadings::new(input(table), &Default::default(), PoseUse::IfThere, None, Discover::default()).unwrap();
    let mut source = Sorted::new(source);
    let (mut row, mut rows) = (Row::default(), Vec::new());
    loop {
        match source.next_row(&mut row, &mut |_| {}).unwrap() {
            Next::Record => {
                let ids: Vec<&str> =
                    row.readings.iter().map(|(sensor, _)| &*source.ids()[usize::from(*sensor)]).collect();
                rows.push((row.t / 1_000_000_000, ids.join("+")));
            }
            Next::Unusable => {}
            Next::End => return rows,
        }
    }
}

fn long(rows: &str) -> Vec<(i64, String)> {
    let rows: String = rows.split(' ').map(|row| format!("{},{},1\n", &row[1..], &row[..1])).collect();
    order(&format!("t,sensor,range\n{rows}"))
}

fn listed(rows: &str) -> Vec<(i64, String)> {
    rows.split(' ').map(|row| (row[1..].parse().unwrap(), row[..1].to_owned())).collect()
}

#[test]
fn rows_by_sensor_are_put_in_the_order_of_time_those_of_one_time_as_they_came() {
    assert_eq!(long("a0 a1 a2 b0 b1 b2 c0 c1 c2"), listed("a0 b0 c0 a1 b1 c1 a2 b2 c2"));
    assert_eq!(long("a0 a1 b0 b1"), listed("a0 b0 a1 b1"));
}

#[test]
fn any_other_order_stays() {
    for rows in
        ["a0 b0 a1 b1", "a0 a1 b2 b3", "a0 a1 b0 a2 b1", "a0 a1 a0", "a1 a0 b0", "a0", "a0 a1 b0 b1 b0", "a0 b1 b0"]
    {
        assert_eq!(long(rows), listed(rows), "{rows}");
    }
}

#[test]
fn a_wide_table_stays_as_it_is() {
    let rows = order("t,a,b,c\n0,1,2,3\n1,1,,\n0,,2,\n");
    assert_eq!(rows, [(0, "a+b+c".to_owned()), (1, "a".into()), (0, "b".into())]);
}
