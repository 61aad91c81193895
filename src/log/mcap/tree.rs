//! The frames of a recording and how they hang together: what ROS calls tf.

use std::{collections::BTreeMap, sync::Arc};

use super::{
    history::{History, Keep},
    rigid::Rigid,
};

/// Frames of a recording, at most.
const MOST: usize = 4096;
/// Longest name of a frame, in bytes.
const LONGEST: usize = 255;

/// A frame by its number.
pub(super) type Frame = usize;

/// How a frame moves in its parent.
#[derive(Debug)]
enum Motion {
    /// Not at all.
    Fixed(Rigid),
    /// As these poses say.
    Moving(History),
    /// As these poses say, and not at all while there is but one.
    Said(History),
}

#[derive(Debug)]
struct Link {
    parent: Frame,
    motion: Motion,
}

#[derive(Debug)]
struct Node {
    name: Arc<str>,
    link: Option<Link>,
}

/// How a transform is to be taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Hold {
    /// Once and for all (`/tf_static`).
    Forever,
    /// At its time.
    Moment,
    /// At its time; for all times where it is the only one (Foxglove, which has nothing else).
    UntilNext,
}

/// Why there is no transform.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Miss {
    /// There is none within the gap on both sides; the frame that lacks it and its parent.
    Gap(String),
    /// The frames do not hang together; in words, with what is missing.
    Apart(String),
}

/// The frames.
#[derive(Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    by_name: BTreeMap<Arc<str>, Frame>,
}

impl Tree {
    /// The frame of this name, new or not; the words are why it is none. A slash before the name, as ROS 1 had it, means nothing.
    pub(super) fn frame(&mut self, name: &str) -> Result<Frame, String> {
        let name = name.strip_prefix('/').unwrap_or(name);
        if let Some(frame) = self.by_name.get(name) {
            return Ok(*frame);
        }
        if name.is_empty() || name.len() > LONGEST {
            return Err(format!("a frame's name has {} bytes, and not 1 to {LONGEST}", name.len()));
        }
        if self.nodes.len() >= MOST {
            return Err(format!("`{name}` would be frame number {}, more than there may be", MOST + 1));
        }
        let (name, frame): (Arc<str>, Frame) = (name.into(), self.nodes.len());
        self.by_name.insert(name.clone(), frame);
        self.nodes.push(Node { name, link: None });
        Ok(frame)
    }

    /// The frame of this name, if there is one.
    pub(super) fn find(&self, name: &str) -> Option<Frame> {
        self.by_name.get(name.strip_prefix('/').unwrap_or(name)).copied()
    }

    pub(super) fn name(&self, frame: Frame) -> &str {
        self.nodes.get(frame).map_or("", |node| &node.name)
    }

    fn link(&self, frame: Frame) -> Option<&Link> {
        self.nodes.get(frame)?.link.as_ref()
    }

    /// Whether the frame moves in its parent.
    pub(super) fn moves(&self, frame: Frame) -> bool {
        match self.link(frame).map(|link| &link.motion) {
            Some(Motion::Moving(history)) => !history.is_empty(),
            Some(Motion::Said(history)) => !history.is_empty() && history.only().is_none(),
            _ => false,
        }
    }

    /// The frame, its parent, and so on up to the root.
    pub(super) fn path(&self, frame: Frame) -> impl Iterator<Item = Frame> {
        std::iter::successors(Some(frame), |frame| self.link(*frame).map(|link| link.parent)).take(MOST)
    }

    /// Frames that move in their parents, in the order in which they became known.
    pub(super) fn moving(&self) -> impl Iterator<Item = Frame> {
        (0..self.nodes.len()).filter(|frame| self.moves(*frame))
    }

    /// Whether any frame has a parent.
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.iter().all(|node| node.link.is_none())
    }

    /// Takes in where `child` is in `parent`; the words are why that can't be.
    pub(super) fn add(
        &mut self,
        [parent, child]: [Frame; 2],
        (t, log_time): (i64, i64),
        pose: Rigid,
        hold: Hold,
        keep: Keep,
    ) -> Result<(), String> {
        match self.link(child).map(|link| link.parent) {
            Some(known) if known == parent => {}
            Some(known) => {
                let (child, known, parent) = (self.name(child), self.name(known), self.name(parent));
                return Err(format!("`{child}` is in `{known}` already, and can't be in `{parent}` as well"));
            }
            None if self.path(parent).any(|above| above == child) => {
                let loops: Vec<&str> = self.path(parent).map(|frame| self.name(frame)).collect();
                return Err(format!("`{}` in `{}` closes a loop", self.name(child), loops.join("` in `")));
            }
            None => {}
        }
        let Some(node) = self.nodes.get_mut(child) else { return Ok(()) };
        let link = node.link.get_or_insert_with(|| Link { parent, motion: Motion::Moving(History::default()) });
        match (&mut link.motion, hold) {
            (motion, Hold::Forever) => *motion = Motion::Fixed(pose),
            // What was said once and for all holds.
            (Motion::Fixed(_), _) => {}
            (Motion::Moving(history), Hold::UntilNext) if history.is_empty() => {
                history.add(t, log_time, pose, keep);
                link.motion = Motion::Said(std::mem::take(history));
            }
            (Motion::Moving(history) | Motion::Said(history), _) => history.add(t, log_time, pose, keep),
        }
        Ok(())
    }

    /// Forgets where moving frames were; how they hang together stays.
    pub(super) fn forget_motion(&mut self) {
        for node in &mut self.nodes {
            if let Some(Link { motion: Motion::Moving(history), .. }) = &mut node.link {
                history.clear();
            }
        }
    }

    /// Where `frame` is in `other` at `t`.
    pub(super) fn lookup(&self, frame: Frame, other: Frame, t: i64, max_gap: u64) -> Result<Rigid, Miss> {
        let above: Vec<Frame> = self.path(other).collect();
        let Some(meeting) = self.path(frame).find(|frame| above.contains(frame)) else {
            return Err(Miss::Apart(self.apart(frame, other)));
        };
        let up = self.climb(frame, meeting, t, max_gap)?;
        if meeting == other {
            return Ok(up);
        }
        Ok(self.climb(other, meeting, t, max_gap)?.inverse().of(&up))
    }

    /// Where `frame` is in `ancestor`.
    fn climb(&self, frame: Frame, ancestor: Frame, t: i64, max_gap: u64) -> Result<Rigid, Miss> {
        let mut pose = Rigid::IDENTITY;
        for frame in self.path(frame).take_while(|frame| *frame != ancestor) {
            let Some(link) = self.link(frame) else { break };
            let step = match &link.motion {
                Motion::Fixed(pose) => Some(*pose),
                Motion::Moving(history) => history.at(t, max_gap),
                Motion::Said(history) => history.only().or_else(|| history.at(t, max_gap)),
            };
            let step =
                step.ok_or_else(|| Miss::Gap(format!("`{}` in `{}`", self.name(frame), self.name(link.parent))))?;
            pose = step.of(&pose);
        }
        Ok(pose)
    }

    /// That two frames do not hang together, and what is missing.
    pub(super) fn apart(&self, frame: Frame, other: Frame) -> String {
        let [root, other_root] = [frame, other].map(|frame| self.path(frame).last().unwrap_or(frame));
        let said = |frame: Frame, root: Frame| match frame == root {
            true => format!("`{}`", self.name(frame)),
            false => format!("`{}` (under `{}`)", self.name(frame), self.name(root)),
        };
        format!(
            "{} and {} do not hang together: no transform between `{}` and `{}`",
            said(frame, root),
            said(other, other_root),
            self.name(other_root),
            self.name(root),
        )
    }
}

#[cfg(test)]
mod tests;
