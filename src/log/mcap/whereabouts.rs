//! Where the robot and its sensors are: from transforms, from odometry, from poses, or from a second file.

use super::{
    decode::{Kind, Said},
    history::{Doubts, History, Keep},
    home::Home,
    namespace,
    rigid::Rigid,
    tree::{Frame, Hold, Miss, Tree},
};
use crate::{
    error::{Problem, Reason, Result},
    log::Frames,
    pipeline::AnyTrack,
    track::{Pose, PoseLimits, PoseMiss, Step},
};

/// Frames that are the robot by convention (REP 105), the more usual one first.
const ROBOT: [&str; 2] = ["base_link", "base_footprint"];
/// The frame in which a robot moves without jumps, by the same convention.
const ODOMETRY: &str = "odom";
/// Topics with poses, at most.
const MOST_TOPICS: usize = 64;

/// A topic that says where the robot is.
struct Topic {
    name: String,
    kind: Kind,
    frame: Frame,
    /// The frame that is the robot, where the topic says it.
    child: Option<Frame>,
    history: History,
}

/// Where the poses come from.
enum Chosen {
    /// Transforms, up to this frame.
    Tree(Frame),
    /// The topic of this number.
    Topic(usize),
    /// A second file.
    Track(Box<AnyTrack>),
}

/// What of the poses is asked for by name.
#[derive(Debug, Clone, Default)]
pub(super) struct Wish {
    /// The topic of the poses.
    pub(super) topic: Option<String>,
    /// The topics of the transforms.
    pub(super) transforms: Vec<String>,
    /// Topics of readings.
    pub(super) ranges: Vec<String>,
    /// The frame in which they are.
    pub(super) fixed: Option<String>,
}

/// How far apart the poses were that a reading lies between, and how far the robot moved, where that is more than usual.
type Wide = Option<(u64, Step)>;

/// One sensor at one time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seat {
    /// Its frame; `None` where the reading names none.
    pub(super) frame: Option<Frame>,
    /// Where it is on the robot, where a rig says that.
    pub(super) mount: Option<Rigid>,
    pub(super) t: i64,
}

/// Where a sensor and its robot are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placed {
    pub(super) robot: Pose,
    pub(super) sensor: Rigid,
}

/// Why a reading has no place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Lost {
    pub(super) reason: Reason,
    pub(super) words: String,
    /// Nothing that is read later can change that, and what would come of it could be wrong.
    pub(super) is_final: bool,
}

impl Lost {
    pub(super) fn new(reason: Reason, words: impl Into<String>) -> Self {
        Self { reason, words: words.into(), is_final: false }
    }

    fn apart(words: impl Into<String>) -> Self {
        Self::new(Reason::NoTransform, words)
    }

    fn refused(words: impl Into<String>) -> Self {
        Self { is_final: true, ..Self::apart(words) }
    }

    /// There is no pose of `what`.
    fn missing(what: &str, miss: PoseMiss) -> Self {
        let reason = if miss.is_impossible() { Reason::ImpossibleMotion } else { Reason::NoPose };
        Self::new(reason, format!("no {what}: {miss}"))
    }

    fn missed(miss: Miss) -> Self {
        match miss {
            Miss::Gap(frames, miss) => Self::missing(&format!("transform of {frames} at that time"), miss),
            Miss::Apart(words) => Self::apart(words),
            Miss::Contested(words) => Self::refused(words),
        }
    }
}

/// All that is known of where things are.
pub(super) struct Whereabouts {
    tree: Tree,
    topics: Vec<Topic>,
    chosen: Option<Chosen>,
    wish: Wish,
    home: Home,
    limits: PoseLimits,
    /// Longest time between poses that were used though they are farther apart than usual, and the farthest step between them.
    bridged: Option<(u64, Step)>,
    memory: i64,
    /// The latest time that was asked for since the clock was set back.
    asked: Option<i64>,
    /// Times the clock was set back.
    epoch: u32,
}

impl Whereabouts {
    /// Nothing is known yet. `memory`: how long after its recording a pose may still be of use, in nanoseconds.
    pub(super) fn new(track: Option<AnyTrack>, wish: Wish, limits: PoseLimits, memory: i64) -> Self {
        let home = Home::new(&wish);
        Self {
            tree: Tree::default(),
            topics: Vec::new(),
            chosen: track.map(|track| Chosen::Track(Box::new(track))),
            wish,
            home,
            limits,
            bridged: None,
            memory,
            asked: None,
            epoch: 0,
        }
    }

    /// There is a topic that says where things are.
    pub(super) fn expect(&mut self, topic: &str) {
        self.home.expect(topic);
    }

    /// A reading comes under this topic; the words are why it can't be used, which is that it is another robot's.
    pub(super) fn comes_from(&mut self, topic: &str) -> Result<(), Lost> {
        if let Some(view) = self.home.settle(topic) {
            self.tree.look_from(&view);
        }
        if self.has_track() {
            return Ok(());
        }
        self.home.check(topic).map_err(|words| Lost::new(Reason::OtherRobot, words))
    }

    /// The frame of this name; the words are why it is none.
    pub(super) fn frame(&mut self, name: &str) -> Result<Frame, String> {
        self.tree.frame(name)
    }

    const fn keep(&self) -> Keep {
        Keep { from: self.asked, memory: self.memory }
    }

    /// Takes in a transform of a topic at its time and the time of its recording; the words are why it can't be.
    pub(super) fn add_transform(
        &mut self,
        topic: &str,
        said: &Said,
        times: (i64, i64),
        hold: Hold,
    ) -> Result<(), String> {
        let Some(group) = self.home.group(topic) else { return Ok(()) };
        let group = self.tree.group(group)?;
        let (translation, quaternion) = said.placement();
        let described = |words| format!("`{}` in `{}`: {words}", said.child, said.frame);
        let pose = Rigid::new(translation, quaternion).map_err(described)?;
        let frames = [self.tree.frame(&said.frame)?, self.tree.frame(&said.child)?];
        let keep = self.keep();
        self.tree.add(group, frames, times, pose, hold, keep)
    }

    /// Takes in a pose of the robot under a topic; the words are why it can't be.
    pub(super) fn add_pose(&mut self, topic: &str, kind: Kind, said: &Said, times: (i64, i64)) -> Result<(), String> {
        let (position, quaternion) = said.placement();
        let pose = Rigid::new(position, quaternion)?;
        let frame = self.tree.frame(&said.frame)?;
        let child = (!said.child.is_empty()).then(|| self.tree.frame(&said.child)).transpose()?;
        let keep = self.keep();
        let topic = self.topic(Topic { name: topic.to_owned(), kind, frame, child, history: History::default() })?;
        topic.history.add(times.0, times.1, pose, keep);
        Ok(())
    }

    /// The topic of this name, new or not, in the order in which they are tried; the words are why it can't be taken in.
    fn topic(&mut self, new: Topic) -> Result<&mut Topic, String> {
        let known = self.topics.iter().position(|known| known.name == new.name);
        let at = match known {
            Some(at) => at,
            None if self.topics.len() >= MOST_TOPICS => {
                return Err(format!("more than {MOST_TOPICS} topics with poses"));
            }
            None => {
                let at = self.topics.partition_point(|known| rank(known) <= rank(&new));
                if let Some(Chosen::Topic(chosen)) = &mut self.chosen {
                    *chosen += usize::from(at <= *chosen);
                }
                self.topics.insert(at, Topic { name: new.name.clone(), history: History::default(), ..new });
                at
            }
        };
        let (tree, known) = (&self.tree, self.topics.get_mut(at).ok_or("no topic")?);
        if known.frame != new.frame || known.child != new.child {
            let [was, is] = [known.frame, new.frame].map(|frame| tree.name(frame));
            return Err(format!("its poses were in `{was}` and are now in `{is}`, or of another frame"));
        }
        Ok(known)
    }

    /// The clock was set back: where things were does not matter any more.
    pub(super) fn set_back(&mut self) {
        self.tree.forget_motion();
        for topic in &mut self.topics {
            topic.history.clear();
        }
        self.asked = None;
        self.epoch = self.epoch.saturating_add(1);
    }

    /// Where a sensor and its robot are. Times must not go back, but for [`Whereabouts::set_back`]. Unusable poses of a second
    /// file go to `problems`; errors where it can't be read.
    pub(super) fn place(&mut self, seat: Seat, problems: &mut dyn FnMut(Problem)) -> Result<Result<Placed, Lost>> {
        self.asked = Some(seat.t);
        if let Some(Chosen::Track(track)) = &mut self.chosen {
            let Some(pose) = track.pose_at(self.epoch, seat.t, problems)? else {
                return Ok(Err(Lost::missing("pose at that time", track.miss())));
            };
            let robot = Rigid::flat(pose.x, pose.y, libm::cos(pose.yaw), libm::sin(pose.yaw));
            let mount = self.mount(seat, None);
            return Ok(mount.map(|mount| Placed { robot: pose, sensor: robot.of(&mount.0) }));
        }
        if self.chosen.is_none() {
            match self.choose(seat) {
                Ok(chosen) => self.chosen = Some(chosen),
                Err(lost) => return Ok(Err(lost)),
            }
        }
        let placed = match &self.chosen {
            Some(Chosen::Topic(index)) => match self.topics.get(*index) {
                Some(topic) => self.by_topic(seat, topic),
                None => Err(Lost::apart("no poses")),
            },
            Some(Chosen::Tree(fixed)) => self.by_tree(seat, *fixed),
            Some(Chosen::Track(_)) | None => Err(Lost::apart("no poses")),
        };
        Ok(placed.map(|(placed, wide)| {
            if let Some((within, step)) = wide {
                Step::note(&mut self.bridged, within, step);
            }
            placed
        }))
    }

    /// By how much the poses' stamps are later than the times of their recording, in nanoseconds, where a sensor is placed;
    /// `None` where that is not known. Of several frames on the way the one that comes nearest to `other` counts: a frame that is
    /// dated ahead on purpose, as localisation does it, is no other clock.
    pub(super) fn offset(&self, seat: Seat, other: i64) -> Option<i64> {
        let nearest = |offsets: &mut dyn Iterator<Item = i64>| offsets.min_by_key(|offset| offset.abs_diff(other));
        match &self.chosen {
            Some(Chosen::Topic(index)) => self.topics.get(*index)?.history.offset(),
            Some(Chosen::Tree(fixed)) => {
                let start = match (seat.mount, seat.frame) {
                    (None, Some(frame)) => frame,
                    _ => self.robot_frame(seat).ok()?,
                };
                nearest(&mut self.tree.offsets(start, *fixed))
            }
            Some(Chosen::Track(_)) | None => None,
        }
    }

    /// Longest time between poses that were used though they are farther apart than usual, and the farthest step between them.
    pub(super) fn bridged(&self) -> Option<(u64, Step)> {
        match &self.chosen {
            Some(Chosen::Track(track)) => track.bridged(),
            _ => self.bridged,
        }
    }

    /// Whose poses seem to have two sources, and what speaks for that.
    pub(super) fn doubted(&self) -> Vec<(String, Doubts)> {
        match &self.chosen {
            Some(Chosen::Tree(_)) => {
                let shown = |(child, parent, doubts)| (format!("transforms of `{child}` in `{parent}`"), doubts);
                self.tree.doubted().map(shown).collect()
            }
            Some(Chosen::Topic(index)) => {
                let topic = self.topics.get(*index).filter(|topic| topic.history.doubts().are_serious());
                topic.map(|topic| (format!("poses of {}", topic.name), topic.history.doubts())).into_iter().collect()
            }
            _ => Vec::new(),
        }
    }

    /// Namespaces other than the readings' whose transforms are used for a sensor.
    pub(super) fn borrowed(&self, frame: Option<Frame>) -> Vec<&str> {
        match (&self.chosen, frame) {
            (Some(Chosen::Tree(_)), Some(frame)) => self.tree.borrowed(frame),
            _ => Vec::new(),
        }
    }

    /// Decides where the poses come from, once that can be told for one sensor.
    fn choose(&self, seat: Seat) -> Result<Chosen, Lost> {
        let is_wished = |topic: &Topic| self.wish.topic.as_ref().is_none_or(|wish| *wish == topic.name);
        let by_topic = || {
            let topics = self.topics.iter().enumerate().filter(|(_, topic)| is_wished(topic));
            let near = topics.filter_map(|(index, topic)| Some((self.home.nearness(&topic.name)?, index, topic)));
            let mut near: Vec<_> = near.collect();
            near.sort_by_key(|(nearness, _, topic)| (rank(topic).0, rank(topic).1, std::cmp::Reverse(*nearness)));
            if let [(0, _, first), rest @ ..] = &near[..]
                && let Some((.., twin)) = rest.iter().find(|(_, _, other)| {
                    other.kind == first.kind
                        && namespace::are_twins(namespace::of(&other.name), namespace::of(&first.name))
                })
            {
                return Err(Lost::refused(format!(
                    "{} and {} are of two robots, and to which of them the readings belong can't be told; choose with \
                     --pose-topic",
                    first.name, twin.name
                )));
            }
            let mut usable =
                near.into_iter().map(|(_, index, topic)| self.mount(seat, topic.child).map(|_| Chosen::Topic(index)));
            usable.next().unwrap_or_else(|| Err(Lost::new(Reason::NoPose, "no poses yet")))
        };
        // A wish for a topic of transforms is one for the tree; that there is such a topic was checked.
        if self.wish.topic.as_ref().is_some_and(|wish| self.topics.iter().any(|topic| topic.name == *wish)) {
            return by_topic();
        }
        match self.tree_for(seat) {
            Ok(fixed) => Ok(Chosen::Tree(fixed)),
            Err(lost) if self.topics.is_empty() => Err(lost),
            Err(lost) => match by_topic() {
                Err(other) if self.tree.moving().next().is_none() => Err(other),
                Err(_) => Err(lost),
                chosen => chosen,
            },
        }
    }

    /// The fixed frame in which transforms have the sensor, if they do.
    fn tree_for(&self, seat: Seat) -> Result<Frame, Lost> {
        let start = match (seat.mount, seat.frame) {
            (Some(_), _) => self.robot_frame(seat)?,
            (None, Some(frame)) => frame,
            (None, None) => return Err(Lost::apart("the reading names no frame; give the sensor's mount with --rig")),
        };
        if let Some(words) = self.tree.contested(start) {
            return Err(Lost::refused(words));
        }
        let path: Vec<Frame> = self.tree.path(start).collect();
        let fixed = match &self.wish.fixed {
            Some(name) => {
                let known = self.tree.find(name);
                known.ok_or_else(|| Lost::apart(format!("there is no frame `{name}`")))?
            }
            None => {
                let odometry = path.iter().find(|frame| is_odometry(self.tree.name(**frame)));
                odometry.or(path.last()).copied().unwrap_or(start)
            }
        };
        if !self.tree.path(fixed).any(|frame| path.contains(&frame)) {
            return Err(Lost::apart(self.tree.apart(start, fixed)));
        }
        let robot = path.iter().position(|frame| is_robot(self.tree.name(*frame))).unwrap_or(0);
        let moves = path.iter().skip(robot).take_while(|frame| **frame != fixed).any(|frame| self.tree.moves(*frame));
        if moves || self.wish.fixed.is_some() {
            return Ok(fixed);
        }
        let name = self.tree.name(start);
        Err(Lost::apart(match self.tree.path(start).count() {
            1 => format!("the frame `{name}` is in no transform; give the sensor's mount with --rig"),
            _ => match self.tree.moving().map(|frame| self.tree.path(frame).last().unwrap_or(frame)).next() {
                Some(other) if !path.contains(&other) => self.tree.apart(start, other),
                _ => format!("`{name}` does not move: no transform changes between it and `{}`", self.tree.name(fixed)),
            },
        }))
    }

    /// The robot's frame, where a rig needs one. A sensor whose frame has a prefix is on the robot of that prefix.
    fn robot_frame(&self, seat: Seat) -> Result<Frame, Lost> {
        let prefix = seat.frame.and_then(|frame| self.tree.name(frame).rsplit_once('/'));
        let prefixed = |name: &&str| prefix.and_then(|(prefix, _)| self.tree.find(&format!("{prefix}/{name}")));
        let own = ROBOT.iter().find_map(prefixed);
        let named = own.or_else(|| ROBOT.iter().find_map(|name| self.tree.find(name)));
        let mut moving = self.tree.moving();
        match (named, moving.next(), moving.next()) {
            (Some(frame), ..) | (None, Some(frame), None) => Ok(frame),
            (None, None, _) => Err(Lost::apart("no frame moves in the transforms")),
            _ => Err(Lost::apart(format!("no frame is the robot: none of {} is there", ROBOT.join(", ")))),
        }
    }

    fn by_tree(&self, seat: Seat, fixed: Frame) -> Result<(Placed, Wide), Lost> {
        if let Some(mount) = seat.mount {
            let robot = self.tree.lookup(self.robot_frame(seat)?, fixed, seat.t, &self.limits);
            let (robot, wide) = robot.map_err(|miss| self.missed(seat, fixed, miss))?;
            return Ok((Placed { robot: robot.on_plane(), sensor: robot.of(&mount) }, wide));
        }
        let frame = seat.frame.ok_or_else(|| Lost::apart("the reading names no frame"))?;
        let sensor = self.tree.lookup(frame, fixed, seat.t, &self.limits);
        let (sensor, wide) = sensor.map_err(|miss| self.missed(seat, fixed, miss))?;
        let robot = self.tree.lookup(self.robot_below(frame, fixed), fixed, seat.t, &self.limits);
        let (robot, _) = robot.map_err(Lost::missed)?;
        Ok((Placed { robot: robot.on_plane(), sensor }, wide))
    }

    /// Why a sensor is not placed. One that moves in a frame of its own is on another robot.
    fn missed(&self, seat: Seat, fixed: Frame, miss: Miss) -> Lost {
        let name = |frame| self.tree.name(frame);
        match (&miss, self.tree_for(seat)) {
            (Miss::Apart(_), Ok(own)) if own != fixed && self.wish.fixed.is_none() => Lost::new(
                Reason::OtherRobot,
                format!(
                    "`{}` moves in `{}`, which is not connected to `{}`: another robot? Fuse its readings with --fixed-frame {}",
                    seat.frame.map_or("the sensor", name),
                    name(own),
                    name(fixed),
                    name(own),
                ),
            ),
            (Miss::Apart(words), _) if seat.mount.is_none() => {
                Lost::apart(format!("{words}; give the sensor's mount with --rig"))
            }
            _ => Lost::missed(miss),
        }
    }

    /// The robot above a sensor's frame: by its name, else what moves in the fixed frame, whatever moves on the robot. Not the frame
    /// of its odometry, which moves in a map where localisation corrects it.
    fn robot_below(&self, frame: Frame, fixed: Frame) -> Frame {
        let below = || self.tree.path(frame).take_while(|frame| *frame != fixed);
        let named = below().filter(|frame| is_robot(self.tree.name(*frame))).last();
        let is_moved = |frame: &Frame| self.tree.moves(*frame) && !is_odometry(self.tree.name(*frame));
        named.or_else(|| below().filter(is_moved).last()).unwrap_or(frame)
    }

    fn by_topic(&self, seat: Seat, topic: &Topic) -> Result<(Placed, Wide), Lost> {
        let robot = topic.history.at(seat.t, &self.limits);
        let (robot, wide) =
            robot.map_err(|miss| Lost::missing(&format!("pose of {} at that time", topic.name), miss))?;
        let robot = match self.wish.fixed.as_deref() {
            Some(name) => {
                let fixed = self.tree.find(name).ok_or_else(|| Lost::apart(format!("there is no frame `{name}`")))?;
                let outer = self.tree.lookup(topic.frame, fixed, seat.t, &self.limits);
                outer.map_err(Lost::missed)?.0.of(&robot)
            }
            None => robot,
        };
        let (mount, _) = self.mount(seat, topic.child)?;
        Ok((Placed { robot: robot.on_plane(), sensor: robot.of(&mount) }, wide))
    }

    /// Where the sensor is on the robot, whose frame is `child` where that is known.
    fn mount(&self, seat: Seat, child: Option<Frame>) -> Result<(Rigid, Wide), Lost> {
        if let Some(mount) = seat.mount {
            return Ok((mount, None));
        }
        let none = || Lost::apart("the reading names no frame; give the sensor's mount with --rig");
        let frame = seat.frame.ok_or_else(none)?;
        let child = match child {
            Some(child) => child,
            None => self.robot_of(frame)?,
        };
        let mount = self.tree.lookup(frame, child, seat.t, &self.limits);
        mount.map_err(|miss| match miss {
            Miss::Apart(words) => Lost::apart(format!("{words}; give the sensor's mount with --rig")),
            other => Lost::missed(other),
        })
    }

    /// The robot's frame above a sensor's: by its name, else the topmost in which the sensor does not move.
    fn robot_of(&self, frame: Frame) -> Result<Frame, Lost> {
        let path: Vec<Frame> = self.tree.path(frame).collect();
        if path.len() == 1 && !is_robot(self.tree.name(frame)) {
            let name = self.tree.name(frame);
            return Err(Lost::apart(format!(
                "the frame `{name}` is in no transform; give the sensor's mount with --rig"
            )));
        }
        let named = path.iter().find(|frame| is_robot(self.tree.name(**frame)));
        let fixed = path.iter().find(|frame| self.tree.moves(**frame)).or(path.last());
        Ok(named.or(fixed).copied().unwrap_or(frame))
    }

    /// Where the poses come from, in words; `None` where that was not decided.
    pub(super) fn source(&self) -> Option<String> {
        Some(match self.chosen.as_ref()? {
            Chosen::Track(_) => "a second file".to_owned(),
            Chosen::Tree(fixed) => format!("transforms up to the frame {}", self.tree.name(*fixed)),
            Chosen::Topic(index) => {
                let topic = self.topics.get(*index)?;
                let frame = self.wish.fixed.as_deref().unwrap_or_else(|| self.tree.name(topic.frame));
                format!("{} in the frame {frame}", topic.name)
            }
        })
    }

    /// What the frames are called in which a sensor was placed.
    pub(super) fn frames(&self, seat: Seat) -> Frames {
        let (fixed, robot) = match &self.chosen {
            Some(Chosen::Tree(fixed)) => {
                let robot = match (seat.mount, seat.frame) {
                    (None, Some(frame)) => Some(self.robot_below(frame, *fixed)),
                    _ => self.robot_frame(seat).ok(),
                };
                (Some(*fixed), robot)
            }
            Some(Chosen::Topic(index)) => {
                let topic = self.topics.get(*index);
                let fixed = self.wish.fixed.as_deref().and_then(|name| self.tree.find(name));
                (fixed.or(topic.map(|topic| topic.frame)), topic.and_then(|topic| topic.child))
            }
            Some(Chosen::Track(_)) | None => (self.wish.fixed.as_deref().and_then(|name| self.tree.find(name)), None),
        };
        let robot = robot.or_else(|| self.robot_of(seat.frame?).ok());
        let name =
            |frame: Option<Frame>, otherwise: &str| frame.map_or(otherwise, |frame| self.tree.name(frame)).into();
        Frames {
            fixed: name(fixed, ODOMETRY),
            robot: name(robot, ROBOT[0]),
            has_robot: robot.zip(fixed).is_some_and(|(robot, fixed)| self.tree.path(robot).any(|frame| frame == fixed)),
            has_mounts: seat.mount.is_none(),
        }
    }

    /// Topics with poses that are not used.
    pub(super) fn unused(&self) -> Vec<&str> {
        let used = match self.chosen {
            Some(Chosen::Topic(index)) => Some(index),
            _ => None,
        };
        self.topics
            .iter()
            .enumerate()
            .filter(|(index, _)| Some(*index) != used)
            .map(|(_, topic)| &*topic.name)
            .collect()
    }

    /// Whether the poses come from a second file.
    pub(super) const fn has_track(&self) -> bool {
        matches!(self.chosen, Some(Chosen::Track(_)))
    }

    /// Whether nothing was said of where anything is.
    pub(super) fn is_blank(&self) -> bool {
        self.topics.is_empty() && self.tree.is_empty() && !self.has_track()
    }
}

/// Whether a frame is the robot by its name, of whichever robot.
fn is_robot(name: &str) -> bool {
    ROBOT.contains(&last_part(name))
}

fn is_odometry(name: &str) -> bool {
    last_part(name) == ODOMETRY
}

fn last_part(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// In which order topics are tried: odometry before poses, what is called `odom` first, goals last.
fn rank(topic: &Topic) -> (bool, bool, bool, &str) {
    let name = last_part(&topic.name);
    (topic.kind != Kind::Odometry, name.contains("goal"), name != ODOMETRY, &topic.name)
}
