//! A log whose own poses are looked at: those that no robot can have reached are not used.

use std::{collections::VecDeque, sync::Arc};

use super::{Next, Row, Source};
use crate::{
    diagnose::Diagnosis,
    error::{Problem, Reason, Result},
    stamp,
    track::{MotionLimit, Pose, PoseMiss},
};

/// A time in nanoseconds, and where the robot was.
type At = (i64, Pose);

/// A log of which records are left out whose pose can't be reached from the one before.
///
/// Such a record waits for the next pose. A pose near it means that the robot is there: it was moved, or its odometry began anew, and
/// the record is used. One near the pose before means that it was a mistake. Records of one time are not compared, and none of a log
/// that places its readings itself.
pub(crate) struct Plausible<'a> {
    log: &'a mut dyn Source,
    limit: MotionLimit,
    last: Option<At>,
    /// Records of one time that can't be reached.
    suspects: VecDeque<Row>,
    /// Records that were found to be in order.
    ready: VecDeque<Row>,
}

impl<'a> Plausible<'a> {
    pub(crate) fn new(log: &'a mut dyn Source, limit: MotionLimit) -> Self {
        Self { log, limit, last: None, suspects: VecDeque::new(), ready: VecDeque::new() }
    }

    /// Whether the robot can go from one pose to the next. What is not later says nothing of how fast it went.
    fn allows(&self, from: &At, to: &At) -> bool {
        to.0 <= from.0 || self.limit.allows(from.1.step_to(&to.1), to.0.abs_diff(from.0))
    }

    /// When and where the suspects are.
    fn suspect(&self) -> Option<At> {
        self.suspects.front().and_then(|row| Some((row.t, row.pose?)))
    }

    /// Whether a later pose is nearer to the suspects than to the pose before them, and can be reached from there.
    fn confirms(&self, at: &At) -> bool {
        let (Some(suspect), Some(last)) = (self.suspect(), self.last) else { return false };
        let distance = |from: &At| from.1.step_to(&at.1).distance;
        suspect.0 < at.0 && self.allows(&suspect, at) && distance(&suspect) < distance(&last)
    }

    /// Leaves the suspects out.
    fn drop_suspects(&mut self, problems: &mut dyn FnMut(Problem)) {
        for row in self.suspects.drain(..) {
            let (Some(last), Some(pose)) = (self.last, row.pose) else { continue };
            let miss = PoseMiss::TooFast { step: last.1.step_to(&pose), within: row.t.abs_diff(last.0) };
            let value = format!("t {}: after the pose before it, {miss}", stamp::text(row.t));
            problems(Problem { reason: Reason::ImpossibleMotion, place: row.place.clone(), value });
        }
    }

    /// Decides on a record with a pose, and with it on those that wait; `false` where it has to wait itself.
    fn admit(&mut self, row: &mut Row, at: At, problems: &mut dyn FnMut(Problem)) -> bool {
        if !self.confirms(&at) && self.last.is_none_or(|last| self.allows(&last, &at)) {
            // Another sensor of the suspects' time says nothing of them.
            if self.suspect().is_none_or(|suspect| suspect.0 != at.0) {
                self.drop_suspects(problems);
            }
            // Of one time the first pose counts: what comes next is held against it.
            if self.last.is_none_or(|last| last.0 != at.0) {
                self.last = Some(at);
            }
            return true;
        }
        match self.suspect() {
            Some(_) if self.confirms(&at) => {
                self.ready.append(&mut self.suspects);
                self.ready.push_back(std::mem::take(row));
                self.last = Some(at);
            }
            Some(suspect) if suspect.0 == at.0 => self.suspects.push_back(std::mem::take(row)),
            _ => {
                self.drop_suspects(problems);
                self.suspects.push_back(std::mem::take(row));
            }
        }
        false
    }
}

impl Source for Plausible<'_> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        if let Some(front) = self.ready.pop_front() {
            *row = front;
            return Ok(Next::Record);
        }
        let next = self.log.next_row(row, problems)?;
        if next == Next::End {
            self.drop_suspects(problems);
        }
        let Some(pose) = row.pose.filter(|_| next == Next::Record && row.views.is_empty()) else { return Ok(next) };
        let at = (row.t, pose);
        if self.admit(row, at, problems) {
            return Ok(Next::Record);
        }
        match self.ready.pop_front() {
            Some(front) => {
                *row = front;
                Ok(Next::Record)
            }
            None => Ok(Next::Unusable),
        }
    }

    fn drained(&self) -> bool {
        self.ready.is_empty() && self.log.drained()
    }

    fn position(&self) -> u64 {
        self.log.position()
    }

    fn has_poses(&self) -> bool {
        self.log.has_poses()
    }

    fn ids(&self) -> &[Arc<str>] {
        self.log.ids()
    }

    fn diagnoses(&self) -> Vec<Diagnosis> {
        self.log.diagnoses()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: i64 = 1_000_000_000;

    /// A log of nothing but poses: seconds and x.
    struct Poses<'a>(std::slice::Iter<'a, (f64, f64)>);

    impl Source for Poses<'_> {
        fn next_row(&mut self, row: &mut Row, _: &mut dyn FnMut(Problem)) -> Result<Next> {
            let Some(&(t, x)) = self.0.next() else { return Ok(Next::End) };
            row.t = (t * S as f64) as i64;
            row.pose = Some(Pose { x, y: 0.0, yaw: 0.0 });
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

    /// The x of the records that are used.
    fn used(poses: &[(f64, f64)]) -> Vec<f64> {
        let mut log = Poses(poses.iter());
        let mut log = Plausible::new(&mut log, MotionLimit::DEFAULT);
        let (mut row, mut used, mut problems) = (Row::default(), Vec::new(), 0);
        loop {
            match log.next_row(&mut row, &mut |_| problems += 1).unwrap() {
                Next::Record => used.extend(row.pose.map(|pose| pose.x)),
                Next::Unusable => {}
                Next::End => break,
            }
        }
        assert_eq!(used.len() + problems, poses.len());
        used
    }

    #[test]
    fn a_pose_that_no_robot_reaches_is_left_out_and_what_follows_is_used() {
        assert_eq!(used(&[(0.0, 0.0), (0.1, 0.1), (0.2, 41.0), (0.3, 0.3)]), [0.0, 0.1, 0.3]);
    }

    #[test]
    fn of_a_robot_that_was_moved_everything_is_used() {
        let moved = [(0.0, 0.0), (0.1, 9.0), (0.1, 9.0), (0.2, 9.1), (0.3, 9.2)];
        assert_eq!(used(&moved), [0.0, 9.0, 9.0, 9.1, 9.2]);
    }

    #[test]
    fn a_later_pose_speaks_for_the_nearer_one() {
        // Both could be reached by then.
        assert_eq!(used(&[(0.0, 0.0), (0.1, 1.5), (0.2, 1.6)]), [0.0, 1.5, 1.6]);
        assert_eq!(used(&[(0.0, 0.0), (0.1, 1.5), (0.2, 0.1)]), [0.0, 0.1]);
    }

    #[test]
    fn poses_that_jump_to_and_fro_and_one_at_the_end_are_left_out() {
        assert_eq!(used(&[(0.0, 0.0), (0.1, 9.0), (0.2, 30.0), (0.3, 0.1), (0.4, 41.0)]), [0.0, 0.1]);
    }

    #[test]
    fn records_of_one_time_and_a_clock_that_was_set_back_say_nothing_of_speed() {
        let still = [(0.0, 0.0), (0.0, 5.0), (0.0, 9.0), (-50.0, 30.0), (-49.9, 30.1)];
        assert_eq!(used(&still), [0.0, 5.0, 9.0, 30.0, 30.1]);
    }
}
