use std::f64::consts::PI;

use super::*;

const S: i64 = 1_000_000_000;

/// Gives out poses (seconds, x, y, yaw) from memory.
struct Stream(std::vec::IntoIter<(i64, f64, f64, f64)>);

impl PoseStream for Stream {
    fn next_pose(&mut self, _: &mut dyn FnMut(Problem)) -> Result<Option<StampedPose>> {
        Ok(self.0.next().map(|(t, x, y, yaw)| {
            let place = Place { file: "poses.csv".into(), line: 1, byte: 0 };
            StampedPose { t, pose: Pose { x, y, yaw }, place }
        }))
    }
}

fn track(poses: &[(i64, f64, f64, f64)], max_gap: i64) -> Track<Stream> {
    Track::new(Stream(Vec::from(poses).into_iter()), max_gap.unsigned_abs())
}

/// Poses at whole seconds, moving along x at 1 m/s.
fn line(seconds: impl IntoIterator<Item = i64>) -> Vec<(i64, f64, f64, f64)> {
    seconds.into_iter().map(|s| (s * S, s as f64, 0.0, 0.0)).collect()
}

fn x_at(track: &mut Track<Stream>, epoch: u32, t: i64) -> Option<f64> {
    track.pose_at(epoch, t, &mut |_| ()).unwrap().map(|pose| pose.x)
}

#[test]
fn position_is_interpolated_linearly() {
    let mut track = track(&[(0, 1.0, 10.0, 0.0), (4 * S, 3.0, 2.0, 1.0)], 10 * S);
    let pose = track.pose_at(0, S, &mut |_| ()).unwrap();
    assert_eq!(pose, Some(Pose { x: 1.5, y: 8.0, yaw: 0.25 }));
}

#[test]
fn yaw_goes_the_shorter_way() {
    let yaw = |from: f64, to: f64| {
        let mut track = track(&[(0, 0.0, 0.0, from), (2 * S, 0.0, 0.0, to)], 10 * S);
        track.pose_at(0, S, &mut |_| ()).unwrap().unwrap().yaw
    };
    // 170° to −170°: by 180°, not by 0°.
    assert!((yaw(PI * 17.0 / 18.0, -PI * 17.0 / 18.0) - PI).abs() < 1e-12);
    assert!((yaw(-PI * 17.0 / 18.0, PI * 17.0 / 18.0) + PI).abs() < 1e-12);
    // Whole turns do not count.
    assert!((yaw(0.1, 0.3 + 6.0 * PI) - 0.2).abs() < 1e-12);
}

#[test]
fn an_exact_hit_needs_no_second_pose() {
    let mut track = track(&line([1, 2, 5]), 0);
    assert_eq!(x_at(&mut track, 0, S), Some(1.0));
    assert_eq!(x_at(&mut track, 0, S), Some(1.0));
    assert_eq!(x_at(&mut track, 0, S + 1), None);
    assert_eq!(x_at(&mut track, 0, 5 * S), Some(5.0));
    assert_eq!(x_at(&mut track, 0, 5 * S), Some(5.0));
}

#[test]
fn the_gap_holds_on_both_sides_and_is_inclusive() {
    let gap = S / 2;
    assert_eq!(x_at(&mut track(&line([0, 1]), gap), 0, S / 2), Some(0.5));
    assert_eq!(x_at(&mut track(&line([0, 1]), gap - 1), 0, S / 2), None);
    assert_eq!(x_at(&mut track(&line([0, 2]), gap), 0, S / 2), None);
    assert_eq!(x_at(&mut track(&line([0, 2]), gap), 0, 3 * S / 2), None);
}

#[test]
fn there_is_no_pose_before_the_first_and_after_the_last() {
    let mut track = track(&line([1, 2]), 10 * S);
    assert_eq!(x_at(&mut track, 0, S - 1), None);
    assert_eq!(x_at(&mut track, 0, 3 * S / 2), Some(1.5));
    assert_eq!(x_at(&mut track, 0, 2 * S), Some(2.0));
    assert_eq!(x_at(&mut track, 0, 2 * S + 1), None);
    assert_eq!(x_at(&mut Track::new(Stream(vec![].into_iter()), 1), 0, 0), None);
}

#[test]
fn extreme_times_do_not_overflow() {
    let poses = [(i64::MIN, 0.0, 0.0, 0.0), (i64::MAX, 2.0, 0.0, 0.0)];
    let mut wide = Track::new(Stream(Vec::from(poses).into_iter()), u64::MAX);
    assert_eq!(x_at(&mut wide, 0, 0), Some(1.0));
    let mut narrow = Track::new(Stream(Vec::from(poses).into_iter()), S as u64);
    assert_eq!(x_at(&mut narrow, 0, 0), None);
    assert_eq!(x_at(&mut narrow, 0, i64::MAX), Some(2.0));
}

#[test]
fn positions_too_far_apart_for_a_number_give_no_pose() {
    let mut track = track(&[(0, -1.5e308, 0.0, 0.0), (2 * S, 1.5e308, 0.0, 0.0)], 10 * S);
    assert_eq!(x_at(&mut track, 0, S), None);
}

#[test]
fn poses_are_read_no_further_than_needed() {
    let mut track = track(&line(0..10), 10 * S);
    x_at(&mut track, 0, 3 * S / 2);
    assert_eq!(track.stream.0.len(), 7);
    x_at(&mut track, 0, 2 * S);
    assert_eq!(track.stream.0.len(), 7);
}

#[test]
fn a_pose_that_goes_back_is_a_problem_and_not_used() {
    let mut track = track(&line([0, 10, 3, 20]), 100 * S);
    let mut problems = Vec::new();
    let pose = track.pose_at(0, 15 * S, &mut |problem| problems.push(problem.to_string())).unwrap();
    assert_eq!(pose.map(|pose| pose.x), Some(15.0));
    assert_eq!(problems, ["poses.csv:1: time_backwards: t 3 after 10"]);
}

#[test]
fn epochs_of_readings_and_poses_are_matched_by_number() {
    // Epoch 0 is 100..=104 s; 0..=15 s are the clock reset; epoch 1 begins with 16 s.
    let poses = line((100..105).chain(0..30));
    let mut track = track(&poses, S);
    let mut count = 0;
    assert_eq!(track.pose_at(0, 207 * S / 2, &mut |_| count += 1).unwrap().map(|pose| pose.x), Some(103.5));
    assert_eq!(track.pose_at(0, 104 * S, &mut |_| count += 1).unwrap().map(|pose| pose.x), Some(104.0));
    assert_eq!((count, track.resets()), (0, 0));
    // Past the last pose of epoch 0: nothing, though the next epoch is there.
    assert_eq!(track.pose_at(0, 209 * S / 2, &mut |_| count += 1).unwrap(), None);
    assert_eq!((count, track.resets()), (16, 1));
    assert_eq!(x_at(&mut track, 1, 31 * S / 2), None);
    assert_eq!(x_at(&mut track, 1, 33 * S / 2), Some(16.5));
    assert_eq!(x_at(&mut track, 1, 20 * S), Some(20.0));
    assert_eq!(x_at(&mut track, 2, 21 * S), None);
}

#[test]
fn a_reading_of_a_later_epoch_skips_the_poses_of_the_earlier() {
    let mut track = track(&line((100..105).chain(0..30)), S);
    assert_eq!(x_at(&mut track, 1, 35 * S / 2), Some(17.5));
}

fn ticks(times: impl IntoIterator<Item = i64>) -> Vec<Tick> {
    let mut clock = Clock::new();
    times.into_iter().map(|t| clock.admit(t)).collect()
}

#[test]
fn equal_times_go_forward() {
    assert_eq!(ticks([i64::MIN, 5, 5, i64::MAX, i64::MAX]), [Tick::Forward; 5]);
}

#[test]
fn the_16th_record_back_in_order_resets_the_clock() {
    let mut clock = Clock::new();
    clock.admit(100);
    for t in 1..16 {
        assert_eq!(clock.admit(t), Tick::Backward);
        assert_eq!(clock.now(), Some(100));
    }
    assert_eq!((clock.admit(16), clock.now()), (Tick::Reset, Some(16)));
    assert_eq!((clock.admit(16), clock.admit(15)), (Tick::Forward, Tick::Backward));
}

#[test]
fn fifteen_records_back_are_no_reset() {
    let ticks = ticks([100].into_iter().chain(1..16).chain([100]).chain(1..16));
    assert!(!ticks.contains(&Tick::Reset));
    assert_eq!((ticks[15], ticks[16]), (Tick::Backward, Tick::Forward));
}

#[test]
fn a_run_out_of_order_begins_anew() {
    // Eight in order, one before them, and fifteen more: the run of sixteen begins with the one before.
    let times = [100].into_iter().chain(51..59).chain([50]).chain(51..66);
    let ticks = ticks(times);
    assert_eq!(ticks.iter().position(|tick| *tick == Tick::Reset), Some(1 + 8 + 15));
}

#[test]
fn equal_times_within_a_run_are_in_order() {
    assert_eq!(ticks([9].into_iter().chain([1; 16])).last(), Some(&Tick::Reset));
}

#[test]
fn a_time_far_ahead_does_not_use_up_the_poses() {
    for poses in [10, 100_000] {
        let mut track = Track::new(Stream(line(0..poses).into_iter()), S.unsigned_abs());
        assert_eq!(x_at(&mut track, 0, S / 2), Some(0.5));
        assert_eq!(x_at(&mut track, 0, i64::MAX), None);
        assert_eq!(x_at(&mut track, 0, 3 * S / 2), Some(1.5), "{poses}");
        assert_eq!(x_at(&mut track, 0, 8 * S), Some(8.0));
    }
}

#[test]
fn a_long_pause_of_the_readings_is_caught_up_with() {
    let mut track = Track::new(Stream(line(0..200_000).into_iter()), S.unsigned_abs());
    assert_eq!(x_at(&mut track, 0, S), Some(1.0));
    // 150,000 poses are more than are read ahead for one reading: the next one shows that the time was right.
    assert_eq!(x_at(&mut track, 0, 150_000 * S), None);
    assert_eq!(x_at(&mut track, 0, 150_001 * S), Some(150_001.0));
    assert_eq!(x_at(&mut track, 0, 150_002 * S), Some(150_002.0));
}

#[test]
fn poses_that_begin_long_before_the_readings_cost_no_reading() {
    let mut track = Track::new(Stream(line(0..200_000).into_iter()), S.unsigned_abs());
    assert_eq!(x_at(&mut track, 0, 150_000 * S), Some(150_000.0));
}
