//! The frames of a recording and how they hang together: what ROS calls tf.

use std::{collections::BTreeMap, sync::Arc};

use super::{
    history::{Doubts, History, Keep},
    namespace,
    rigid::Rigid,
};
use crate::track::{PoseLimits, PoseMiss, Step};

/// Frames of a recording, at most.
const MOST: usize = 4096;
/// Longest name of a frame, in bytes.
const LONGEST: usize = 255;

/// Namespaces with transforms, at most.
const MOST_GROUPS: usize = 256;

/// A frame by its number.
pub(super) type Frame = usize;
/// The transforms of one namespace, by its number.
pub(super) type Group = usize;

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
    group: Group,
    parent: Frame,
    motion: Motion,
}

impl Link {
    const fn history(&self) -> Option<&History> {
        match &self.motion {
            Motion::Fixed(_) => None,
            Motion::Moving(history) | Motion::Said(history) => Some(history),
        }
    }
}

#[derive(Debug)]
struct Node {
    name: Arc<str>,
    /// One for each namespace whose transforms have the frame: two robots may call theirs the same.
    links: Vec<Link>,
}

#[derive(Debug)]
struct Namespace {
    name: Arc<str>,
    /// How near it is to whose readings are placed; `None` where it is another robot's.
    nearness: Option<usize>,
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
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Miss {
    /// A frame has no pose in its parent at that time; their names, and why.
    Gap(String, PoseMiss),
    /// The frames do not hang together; in words, with what is missing.
    Apart(String),
    /// Which of several transforms counts can't be told; in words.
    Contested(String),
}

/// Where a frame is, and how long and far its robot moved between poses that were farther apart than usual.
pub(super) type Found = (Rigid, Option<(u64, Step)>);

/// The frames.
#[derive(Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    by_name: BTreeMap<Arc<str>, Frame>,
    groups: Vec<Namespace>,
    /// The namespace of whose readings are placed.
    view: Arc<str>,
}

impl Default for Tree {
    fn default() -> Self {
        Self { nodes: Vec::new(), by_name: BTreeMap::new(), groups: Vec::new(), view: "".into() }
    }
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
        self.nodes.push(Node { name, links: Vec::new() });
        Ok(frame)
    }

    /// The frame of this name, if there is one.
    pub(super) fn find(&self, name: &str) -> Option<Frame> {
        self.by_name.get(name.strip_prefix('/').unwrap_or(name)).copied()
    }

    pub(super) fn name(&self, frame: Frame) -> &str {
        self.nodes.get(frame).map_or("", |node| &node.name)
    }

    /// The transforms of a namespace, new or not; the words are why there can't be any.
    pub(super) fn group(&mut self, name: &str) -> Result<Group, String> {
        if let Some(group) = self.groups.iter().position(|group| &*group.name == name) {
            return Ok(group);
        }
        if self.groups.len() >= MOST_GROUPS {
            return Err(format!("more than {MOST_GROUPS} namespaces with transforms"));
        }
        self.groups.push(Namespace { name: name.into(), nearness: namespace::nearness(name, &self.view) });
        Ok(self.groups.len() - 1)
    }

    /// From now on transforms are looked up for readings of this namespace.
    pub(super) fn look_from(&mut self, view: &str) {
        self.view = view.into();
        for group in &mut self.groups {
            group.nearness = namespace::nearness(&group.name, view);
        }
    }

    fn nearness(&self, link: &Link) -> Option<usize> {
        self.groups.get(link.group)?.nearness
    }

    /// Where a frame is, as the nearest namespace has it; `None` where none has, or several that are equally far.
    fn link(&self, frame: Frame) -> Option<&Link> {
        match &self.nodes.get(frame)?.links[..] {
            [] => None,
            [link] => self.nearness(link).map(|_| link),
            links => {
                let (nearness, nearest) = links
                    .iter()
                    .filter_map(|link| Some((self.nearness(link)?, link)))
                    .max_by_key(|(nearness, _)| *nearness)?;
                (nearness > 0 || self.rivals(frame).count() == 1).then_some(nearest)
            }
        }
    }

    /// The namespaces that have a frame and do not enclose whose readings are placed.
    fn rivals(&self, frame: Frame) -> impl Iterator<Item = &str> {
        let links = self.nodes.get(frame).map(|node| &node.links[..]).unwrap_or_default();
        let groups = links.iter().filter_map(|link| self.groups.get(link.group));
        groups.filter(|group| group.nearness == Some(0)).map(|group| &*group.name)
    }

    /// That several namespaces have the frame at which the way up from this one ends, in words.
    pub(super) fn contested(&self, frame: Frame) -> Option<String> {
        let top = self.path(frame).last()?;
        let rivals: Vec<&str> = self.rivals(top).collect();
        let several = rivals.len() > 1;
        several.then(|| {
            format!(
                "the frame `{}` is in transforms of {}, and which of them the readings belong to can't be told; name them with \
                 --tf-topics, like --tf-topics {}/tf,{}/tf_static",
                self.name(top),
                rivals.join(" and "),
                rivals.first().unwrap_or(&""),
                rivals.first().unwrap_or(&""),
            )
        })
    }

    /// Namespaces that do not enclose whose readings are placed, and whose transforms are used on the way up.
    pub(super) fn borrowed(&self, frame: Frame) -> Vec<&str> {
        let links = self.path(frame).filter_map(|frame| self.link(frame));
        let far = links.filter_map(|link| self.groups.get(link.group)).filter(|group| group.nearness == Some(0));
        let mut names: Vec<&str> = far.map(|group| &*group.name).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Frames for whose poses there seem to be two sources, with their parents and what speaks for that.
    pub(super) fn doubted(&self) -> impl Iterator<Item = (&str, &str, Doubts)> {
        self.nodes.iter().flat_map(|node| node.links.iter().map(move |link| (node, link))).filter_map(|(node, link)| {
            let doubts = link.history()?.doubts();
            (self.nearness(link).is_some() && doubts.are_serious())
                .then(|| (&*node.name, self.name(link.parent), doubts))
        })
    }

    /// By how much the stamps of the moving frames on the way up are later than their times of recording, in nanoseconds.
    pub(super) fn offsets(&self, frame: Frame, fixed: Frame) -> impl Iterator<Item = i64> {
        let path = self.path(frame).take_while(move |frame| *frame != fixed);
        path.filter_map(|frame| self.link(frame)?.history()?.offset())
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
        self.nodes.iter().all(|node| node.links.is_empty())
    }

    /// Takes in where `child` is in `parent`; the words are why that can't be.
    pub(super) fn add(
        &mut self,
        group: Group,
        [parent, child]: [Frame; 2],
        (t, log_time): (i64, i64),
        pose: Rigid,
        hold: Hold,
        keep: Keep,
    ) -> Result<(), String> {
        let links = self.nodes.get(child).map(|node| &node.links[..]).unwrap_or_default();
        let known = links.iter().position(|link| link.group == group);
        match known.and_then(|at| links.get(at)).map(|link| link.parent) {
            Some(known) if known == parent => {}
            Some(known) => {
                let (child, known, parent) = (self.name(child), self.name(known), self.name(parent));
                return Err(format!("`{child}` is in `{known}` already, and can't be in `{parent}` as well"));
            }
            None => {
                if let Some(loops) = self.way_up(parent, child) {
                    let loops: Vec<&str> = loops.into_iter().map(|frame| self.name(frame)).collect();
                    return Err(format!("`{}` in `{}` closes a loop", self.name(child), loops.join("` in `")));
                }
            }
        }
        let Some(node) = self.nodes.get_mut(child) else { return Ok(()) };
        let at = known.unwrap_or(node.links.len());
        if known.is_none() {
            node.links.push(Link { group, parent, motion: Motion::Moving(History::default()) });
        }
        let Some(link) = node.links.get_mut(at) else { return Ok(()) };
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
        for link in self.nodes.iter_mut().flat_map(|node| &mut node.links) {
            if let Motion::Moving(history) = &mut link.motion {
                history.clear();
            }
        }
    }

    /// The way from a frame up to another, whichever namespaces' transforms it takes; `None` where there is none.
    fn way_up(&self, frame: Frame, to: Frame) -> Option<Vec<Frame>> {
        let (mut open, mut below) = (vec![frame], BTreeMap::from([(frame, frame)]));
        while let Some(last) = open.pop() {
            if last == to {
                let down = std::iter::successors(Some(last), |at| below.get(at).copied().filter(|next| next != at));
                let mut way: Vec<Frame> = down.collect();
                way.reverse();
                return Some(way);
            }
            for link in self.nodes.get(last).map(|node| &node.links[..]).unwrap_or_default() {
                below.entry(link.parent).or_insert_with(|| {
                    open.push(link.parent);
                    last
                });
            }
        }
        None
    }

    /// Where `frame` is in `other` at `t`.
    pub(super) fn lookup(&self, frame: Frame, other: Frame, t: i64, limits: &PoseLimits) -> Result<Found, Miss> {
        let above: Vec<Frame> = self.path(other).collect();
        let Some(meeting) = self.path(frame).find(|frame| above.contains(frame)) else {
            let contested = self.contested(frame).or_else(|| self.contested(other));
            return Err(contested.map_or_else(|| Miss::Apart(self.apart(frame, other)), Miss::Contested));
        };
        let (up, mut wide) = self.climb(frame, meeting, t, limits)?;
        if meeting == other {
            return Ok((up, wide));
        }
        let (down, more) = self.climb(other, meeting, t, limits)?;
        if let Some((within, step)) = more {
            Step::note(&mut wide, within, step);
        }
        Ok((down.inverse().of(&up), wide))
    }

    /// Where `frame` is in `ancestor`.
    fn climb(&self, frame: Frame, ancestor: Frame, t: i64, limits: &PoseLimits) -> Result<Found, Miss> {
        let (mut pose, mut wide) = (Rigid::IDENTITY, None);
        for frame in self.path(frame).take_while(|frame| *frame != ancestor) {
            let Some(link) = self.link(frame) else { break };
            let step = match &link.motion {
                Motion::Fixed(pose) => Ok((*pose, None)),
                Motion::Moving(history) => history.at(t, limits),
                Motion::Said(history) => match history.only() {
                    Some(pose) => Ok((pose, None)),
                    None => history.at(t, limits),
                },
            };
            let (step, more) = step
                .map_err(|miss| Miss::Gap(format!("`{}` in `{}`", self.name(frame), self.name(link.parent)), miss))?;
            if let Some((within, step)) = more {
                Step::note(&mut wide, within, step);
            }
            pose = step.of(&pose);
        }
        Ok((pose, wide))
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
