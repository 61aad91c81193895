use super::*;
use crate::error::Reason;

/// Records from a list: time in seconds, x of the pose.
struct Listed<'a>(std::iter::Copied<std::slice::Iter<'a, (f64, Option<f64>)>>);

impl Source for Listed<'_> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        row.readings.clear();
        let Some((t, x)) = self.0.next() else { return Ok(Next::End) };
        if t.is_nan() {
            problems(Problem { reason: Reason::BadNumber, place: row.place.clone(), value: String::new() });
            return Ok(Next::Unusable);
        }
        row.t = (t * 1e9).round() as i64;
        row.pose = x.map(|x| Pose { x, y: 0.0, yaw: 3.0 * x });
        row.readings.push((0, t));
        Ok(Next::Record)
    }

    fn drained(&self) -> bool {
        false
    }

    fn position(&self) -> u64 {
        0
    }

    fn has_poses(&self) -> bool {
        true
    }

    fn ids(&self) -> &[Arc<str>] {
        &[]
    }
}

/// Times and x of what comes out; NaN for a record that is unusable, by which a caller is given back control.
fn joined(records: &[(f64, Option<f64>)]) -> Vec<(f64, Option<f64>)> {
    let mut source = Joined::new(Listed(records.iter().copied()), 500_000_000);
    let (mut row, mut rows, mut problems) = (Row::default(), Vec::new(), 0);
    loop {
        match source.next_row(&mut row, &mut |_| problems += 1).unwrap() {
            Next::Record => rows.push((row.readings[0].1, row.pose.map(|pose| (pose.x * 1e9).round() / 1e9))),
            Next::Unusable => {}
            Next::End => break,
        }
    }
    assert_eq!(problems, records.iter().filter(|(t, _)| t.is_nan()).count());
    rows
}

#[test]
fn records_without_a_pose_take_the_one_between_those_around_them() {
    let records = [(0.0, Some(0.0)), (0.1, None), (0.3, None), (0.4, Some(1.0)), (0.4, None), (0.5, Some(2.0))];
    let expected = [(0.0, 0.0), (0.1, 0.25), (0.3, 0.75), (0.4, 1.0), (0.4, 1.0), (0.5, 2.0)];
    assert_eq!(joined(&records), expected.map(|(t, x)| (t, Some(x))));
}

#[test]
fn poses_are_used_at_their_own_pace_and_not_over_a_gap() {
    let slow =
        [(0.0, Some(0.0)), (0.5, None), (1.0, Some(1.0)), (2.2, None), (2.4, Some(2.4)), (6.0, None), (8.0, Some(8.0))];
    let xs: Vec<_> = joined(&slow).iter().map(|(_, x)| *x).collect();
    assert_eq!(xs, [Some(0.0), Some(0.5), Some(1.0), Some(2.2), Some(2.4), None, Some(8.0)]);
}

#[test]
fn outside_of_all_poses_there_is_one_for_a_tenth_of_the_gap() {
    let records = [(0.0, None), (0.96, None), (1.0, Some(1.0)), (1.05, None), (1.06, None)];
    let xs: Vec<_> = joined(&records).iter().map(|(_, x)| *x).collect();
    assert_eq!(xs, [None, Some(1.0), Some(1.0), Some(1.0), None]);
}

#[test]
fn order_and_unusable_records_stay() {
    let records =
        [(0.0, None), (f64::NAN, None), (0.0, Some(0.0)), (0.1, None), (f64::NAN, None), (0.2, None), (0.3, Some(3.0))];
    let times: Vec<_> = joined(&records).iter().map(|(t, _)| *t).collect();
    assert_eq!(times, [0.0, 0.0, 0.1, 0.2, 0.3]);
}

#[test]
fn a_log_without_another_pose_does_not_wait_for_ever() {
    let records: Vec<_> =
        std::iter::once((0.0, Some(0.0))).chain((1..=WAITING + 10).map(|t| (t as f64, None))).collect();
    let rows = joined(&records);
    assert_eq!(rows.len(), WAITING + 11);
    assert!(rows.iter().skip(1).all(|(_, x)| x.is_none()));
}
