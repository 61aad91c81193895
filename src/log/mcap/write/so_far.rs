//! What there has been so far, in bounded size, and written again only when it has grown: all of it together takes a small
//! multiple of what is new in it.

use std::collections::VecDeque;

use atm_core::Point2;

use super::content::Color;
use crate::track::Pose;

/// Echoes that are kept.
const MOST_ECHOES: usize = 50_000;
/// Poses that are kept.
const MOST_POSES: usize = 1024;
/// Distance between poses at first, in metres.
const FIRST_SPACING: f64 = 0.02;

/// The latest echoes.
#[derive(Debug, Default)]
pub(super) struct EchoesSoFar {
    echoes: VecDeque<(Point2<f64>, Color)>,
    new: usize,
}

impl EchoesSoFar {
    pub(super) fn push(&mut self, position: Point2<f64>, color: Color) {
        if self.echoes.len() == MOST_ECHOES {
            self.echoes.pop_front();
        }
        self.echoes.push_back((position, color));
        self.new += 1;
    }

    /// Whether they are to be written: a tenth of them is new, or, at the end, any.
    pub(super) fn take_due(&mut self, at_end: bool) -> bool {
        let due = self.new > 0 && (at_end || self.new * 10 >= self.echoes.len());
        if due {
            self.new = 0;
        }
        due
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &(Point2<f64>, Color)> {
        self.echoes.iter()
    }
}

/// The path, thinned out evenly as it grows.
#[derive(Debug)]
pub(super) struct PathSoFar {
    poses: Vec<(i64, Pose)>,
    spacing: f64,
    /// Where the robot was last, and how far it has come.
    last: Option<(i64, Pose)>,
    length: f64,
    /// The length when it was last written.
    written: f64,
}

impl PathSoFar {
    pub(super) const fn new() -> Self {
        Self { poses: Vec::new(), spacing: FIRST_SPACING, last: None, length: 0.0, written: -1.0 }
    }

    pub(super) fn push(&mut self, t: i64, pose: Pose) {
        let distance = |other: &(i64, Pose)| libm::hypot(pose.x - other.1.x, pose.y - other.1.y);
        self.length += self.last.as_ref().map_or(0.0, distance);
        self.last = Some((t, pose));
        if self.poses.last().is_some_and(|kept| distance(kept) < self.spacing) {
            return;
        }
        if self.poses.len() == MOST_POSES {
            let mut index = 0;
            self.poses.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.spacing *= 2.0;
        }
        self.poses.push((t, pose));
    }

    /// Whether it is to be written: it is a twentieth longer, or, at the end, longer at all.
    pub(super) fn take_due(&mut self, at_end: bool) -> bool {
        const LEAST: f64 = 0.1;
        let grown = self.length - self.written;
        let due = !self.poses.is_empty() && (grown > self.written.abs() / 20.0 + LEAST || at_end && grown > 0.0);
        if due {
            self.written = self.length;
        }
        due
    }

    /// The poses that are kept, and the last one.
    pub(super) fn poses(&self) -> Vec<(i64, Pose)> {
        let end = self.last.filter(|last| self.poses.last() != Some(last));
        self.poses.iter().copied().chain(end).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn east(step: i64) -> Pose {
        Pose { x: 0.01 * step as f64, y: 0.0, yaw: 0.0 }
    }

    #[test]
    fn path_is_bounded_even_and_ends_where_the_robot_is() {
        let mut path = PathSoFar::new();
        let mut written = 0;
        for step in 0..=100_000 {
            path.push(step, east(step));
            written += usize::from(path.take_due(false));
        }
        let poses = path.poses();
        assert!((256..=MOST_POSES + 1).contains(&poses.len()), "{}", poses.len());
        assert_eq!(poses.first(), Some(&(0, east(0))));
        assert_eq!(poses.last(), Some(&(100_000, east(100_000))));
        let steps: Vec<f64> = poses.windows(2).map(|pair| pair[1].1.x - pair[0].1.x).collect();
        let (last, even) = steps.split_last().unwrap();
        let widest = even.iter().copied().fold(0.0, f64::max);
        assert!(even.iter().all(|step| *step > widest * 0.6) && *last <= widest, "{widest}");
        // A kilometre, written each time it is a twentieth longer: ln(1000 / 2) / ln(1.05) = 127, and the first metres.
        assert!((120..200).contains(&written), "{written}");
    }

    #[test]
    fn path_of_a_robot_that_stands_is_written_once() {
        let mut path = PathSoFar::new();
        let due: Vec<bool> = (0..10)
            .map(|t| {
                path.push(t, east(0));
                path.take_due(t == 9)
            })
            .collect();
        assert_eq!(due.iter().filter(|due| **due).count(), 1);
        assert!(due[0]);
    }

    #[test]
    fn echoes_are_bounded_and_written_when_a_tenth_is_new() {
        let mut echoes = EchoesSoFar::default();
        let mut points = 0;
        for index in 0..4 * MOST_ECHOES {
            echoes.push(Point2::new(index as f64, 0.0), Color::new(0, 0xff));
            if echoes.take_due(false) {
                points += echoes.iter().count();
            }
        }
        assert_eq!(echoes.iter().count(), MOST_ECHOES);
        assert!(points <= 11 * 4 * MOST_ECHOES, "{points}");
        echoes.take_due(true);
        echoes.push(Point2::origin(), Color::new(0, 0xff));
        assert!(!echoes.take_due(false) && echoes.take_due(true) && !echoes.take_due(true));
    }
}
