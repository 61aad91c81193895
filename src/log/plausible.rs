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

/// Records of one time that wait for the next, at most: more are used as they are.
const MOST: usize = 1 << 12;

/// A log of which records are left out whose pose lies off the way: it can't be reached from the one before, and the one behind it
/// can't be reached from it.
///
/// A later record near such a pose means that the robot was moved, or that its odometry began anew: then both are used. Records of
/// one time are not compared, and none of a log that places its readings itself.
pub(crate) struct Plausible<'a> {
    log: &'a mut dyn Source,
    limit: MotionLimit,
    last: Option<At>,
    suspect: Option<At>,
    /// Records of the suspect pose's time.
    held: Vec<Row>,
    /// Records that turned out to be in order, before the log goes on.
    ready: VecDeque<Row>,
}

impl<'a> Plausible<'a> {
    pub(crate) fn new(log: &'a mut dyn Source, limit: MotionLimit) -> Self {
        Self { log, limit, last: None, suspect: None, held: Vec::new(), ready: VecDeque::new() }
    }

    /// Takes a record in: into [`Self::ready`] once it is known to be in order.
    fn take(&mut self, row: &Row, pose: Pose, problems: &mut dyn FnMut(Problem)) {
        let at = (row.t, pose);
        if self.suspect.is_some_and(|suspect| suspect.0 == at.0) && self.held.len() < MOST {
            self.held.push(row.clone());
            return;
        }
        let is_reached = self.last.is_none_or(|last| self.allows(&last, &at));
        // With time enough it may be reached from both: then the nearer one tells where the robot is.
        let far = |from: At| {
            let step = from.1.step_to(&at.1);
            step.distance + step.turn
        };
        let is_nearer = |suspect: At| self.last.is_none_or(|last| far(suspect) < far(last));
        if self.suspect.is_some_and(|suspect| self.allows(&suspect, &at) && is_nearer(suspect)) {
            self.ready.extend(self.held.drain(..));
        } else {
            self.drop_held(problems);
            if !is_reached {
                self.suspect = Some(at);
                self.held.push(row.clone());
                return;
            }
        }
        self.suspect = None;
        // Of one time the first pose counts: what comes next is held against it.
        if self.last.is_none_or(|last| last.0 != at.0) {
            self.last = Some(at);
        }
        self.ready.push_back(row.clone());
    }

    /// What is held is off the way.
    fn drop_held(&mut self, problems: &mut dyn FnMut(Problem)) {
        let Some((last, suspect)) = self.last.zip(self.suspect.take()) else { return };
        let miss = PoseMiss::TooFast { step: last.1.step_to(&suspect.1), within: suspect.0.abs_diff(last.0) };
        for row in self.held.drain(..) {
            let value = format!("t {}: after the pose before it, {miss}", stamp::text(row.t));
            problems(Problem { reason: Reason::ImpossibleMotion, place: row.place, value });
        }
    }

    /// Whether the robot can go from one pose to the next. What is not later says nothing of how fast it went.
    fn allows(&self, from: &At, to: &At) -> bool {
        to.0 <= from.0 || self.limit.allows(from.1.step_to(&to.1), to.0.abs_diff(from.0))
    }
}

impl Source for Plausible<'_> {
    fn next_row(&mut self, row: &mut Row, problems: &mut dyn FnMut(Problem)) -> Result<Next> {
        if let Some(ready) = self.ready.pop_front() {
            *row = ready;
            return Ok(Next::Record);
        }
        let next = self.log.next_row(row, problems)?;
        if next == Next::End {
            self.drop_held(problems);
            return Ok(next);
        }
        let Some(pose) = row.pose.filter(|_| next == Next::Record && row.views.is_empty()) else { return Ok(next) };
        // The usual case, without a copy.
        let at = (row.t, pose);
        if self.suspect.is_none() && self.last.is_none_or(|last| self.allows(&last, &at)) {
            if self.last.is_none_or(|last| last.0 != at.0) {
                self.last = Some(at);
            }
            return Ok(next);
        }
        self.take(row, pose, problems);
        match self.ready.pop_front() {
            Some(ready) => {
                *row = ready;
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
    fn of_a_robot_that_was_moved_nothing_is_left_out() {
        let moved = [(0.0, 0.0), (0.1, 9.0), (0.1, 9.0), (0.2, 9.1), (0.3, 9.2)];
        assert_eq!(used(&moved), [0.0, 9.0, 9.0, 9.1, 9.2]);
        // Nothing confirms what is last.
        assert_eq!(used(&[(0.0, 0.0), (0.1, 0.1), (0.2, 41.0)]), [0.0, 0.1]);
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
