//! A log whose own poses are looked at: those that no robot can have reached are not used.

use std::sync::Arc;

use super::{Next, Row, Source};
use crate::{
    error::{Problem, Reason, Result},
    stamp,
    track::{MotionLimit, Pose, PoseMiss},
};

/// A time in nanoseconds, and where the robot was.
type At = (i64, Pose);

/// A log of which records are left out whose pose can't be reached from the one before.
///
/// A later record near a pose that was left out means that the robot is there: it was moved, or its odometry began anew. Records of
/// one time are not compared, and none of a log that places its readings itself.
pub(crate) struct Plausible<'a> {
    log: &'a mut dyn Source,
    limit: MotionLimit,
    last: Option<At>,
    suspect: Option<At>,
}

impl<'a> Plausible<'a> {
    pub(crate) fn new(log: &'a mut dyn Source, limit: MotionLimit) -> Self {
        Self { log, limit, last: None, suspect: None }
    }

    /// Whether a robot can be there; else how it would have had to move.
    fn check(&mut self, at: At) -> Result<(), PoseMiss> {
        let reached = |from: &Option<At>| from.as_ref().is_none_or(|from| self.allows(from, &at));
        let is_confirmed = || self.suspect.is_some_and(|suspect| suspect.0 < at.0 && self.allows(&suspect, &at));
        match self.last {
            Some(last) if !reached(&self.last) && !is_confirmed() => {
                if self.suspect.is_none_or(|suspect| suspect.0 != at.0) {
                    self.suspect = Some(at);
                }
                Err(PoseMiss::TooFast { step: last.1.step_to(&at.1), within: at.0.abs_diff(last.0) })
            }
            // Of one time the first pose counts: what comes next is held against it.
            Some(last) if last.0 == at.0 => Ok(()),
            _ => {
                (self.last, self.suspect) = (Some(at), None);
                Ok(())
            }
        }
    }

    /// Whether the robot can go from one pose to the next. What is not later says nothing of how fast it went.
    fn allows(&self, from: &At, to: &At) -> bool {
        to.0 <= from.0 || self.limit.allows(from.1.step_to(&to.1), to.0.abs_diff(from.0))
    }
}

impl Source for Plausible<'_> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        let next = self.log.next_row(row, problems)?;
        let Some(pose) = row.pose.filter(|_| next == Next::Record && row.views.is_empty()) else { return Ok(next) };
        let Err(miss) = self.check((row.t, pose)) else { return Ok(next) };
        let value = format!("t {}: after the pose before it, {miss}", stamp::text(row.t));
        problems(Problem { reason: Reason::ImpossibleMotion, place: row.place.clone(), value });
        Ok(Next::Unusable)
    }

    fn drained(&self) -> bool {
        self.log.drained()
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
    fn of_a_robot_that_was_moved_one_time_is_left_out() {
        let moved = [(0.0, 0.0), (0.1, 9.0), (0.1, 9.0), (0.2, 9.1), (0.3, 9.2)];
        assert_eq!(used(&moved), [0.0, 9.1, 9.2]);
    }

    #[test]
    fn records_of_one_time_and_a_clock_that_was_set_back_say_nothing_of_speed() {
        let still = [(0.0, 0.0), (0.0, 5.0), (0.0, 9.0), (-50.0, 30.0), (-49.9, 30.1)];
        assert_eq!(used(&still), [0.0, 5.0, 9.0, 30.0, 30.1]);
    }
}
