//! What is fused, as a recording.

use std::{collections::BTreeSet, io::Write, sync::Arc};

use atm_core::{ArcCrossing, Isometry2, Reading, UnitComplex, Vector2};

use super::{
    clouds::{color_of, earliest, put_crossing, put_echo, runs},
    content::{Cloud, Content, Transform, pose_of},
    file::{Layout, McapFile},
    merged::Merged,
    options::{Contents, Frames, Options, Transforms},
    pass::{PassThrough, Shared},
    points::{Layouts, Points},
    ros2::qos::Durability,
    schema::Encoder,
    sensors::Sensors,
    so_far::{EchoesSoFar, PathSoFar},
    sweep::{CROSSING_COLOR, CROSSING_GROUP, MOST_POINTS, Placed, Sweep},
    topics::{self, Topic},
};
use crate::{echo::AnyEcho, error::Result, log::Row, pipeline::EchoSink, track::Pose};

/// Writes what is fused as an MCAP recording, a message of each sort for each sweep of the sensors.
///
/// Every message is logged at the time of the record that ended its sweep, at most a tenth of a second after the one that caused
/// its reports; the stamps in it are the readings'. Dropped without [`McapSink::finish`], it leaves a file without a summary.
pub struct McapSink<W: Write> {
    options: Options,
    file: Shared<W>,
    encoder: Encoder,
    /// By [`Topic`]; empty until something is written.
    channels: Vec<(Topic, u16)>,
    layouts: Layouts,
    sensors: Sensors,
    sweep: Sweep,
    echoes: EchoesSoFar,
    path: PathSoFar,
    /// The latest record's log time; never goes back.
    log_time: u64,
    robot: Isometry2<f64>,
    bytes: Vec<u8>,
}

impl<W: Write> McapSink<W> {
    /// A recording, which begins with the first that is written to it; `name` is what errors call the output.
    pub fn new(out: W, name: Arc<str>, options: Options) -> Self {
        let kind = options.kind;
        // A profile promises something of every channel; what another recording's are, it will say itself.
        let profile = if options.pass_window.is_some() { "" } else { kind.profile() };
        let file = McapFile::new(out, name, profile, options.layout);
        // Transforms of both may share a topic.
        let topics: BTreeSet<String> =
            Topic::ALL.iter().filter(|topic| !topic.is_transforms()).map(|topic| topic.name(&options)).collect();
        Self {
            file: Shared::new(Merged::new(file, kind, options.pass_window.unwrap_or(0), topics)),
            encoder: Encoder::new(kind),
            channels: Vec::new(),
            layouts: Layouts::new(kind),
            sensors: Sensors::default(),
            sweep: Sweep::new(options.history),
            echoes: EchoesSoFar::default(),
            path: PathSoFar::new(),
            log_time: 0,
            robot: Isometry2::identity(),
            bytes: Vec::new(),
            options,
        }
    }

    /// Says what the frames are. To be said before the first record: what is written stays.
    pub fn set_frames(&mut self, frames: Frames) {
        self.options.frames = frames;
    }

    /// Takes another recording's contents in, while this one is written. Give [`Options::pass_window`].
    pub fn pass_through(&self) -> PassThrough<W> {
        PassThrough::new(self.file.clone())
    }

    /// Messages of the other recording that came later than the window allows, and stand out of order; 0 once it is finished.
    pub fn late(&self) -> u64 {
        self.file.with(|file| Ok(file.late())).unwrap_or(0)
    }

    /// Writes what is still gathered and the summary, and returns what the recording was written to.
    ///
    /// # Errors
    /// What the output says.
    pub fn finish(mut self) -> Result<W> {
        self.begin(0)?;
        self.end_sweep(true)?;
        self.file.take()?.finish()
    }

    /// Declares the channels and says what holds from the beginning, once, with `t` as the time.
    fn begin(&mut self, t: i64) -> Result<()> {
        if !self.channels.is_empty() {
            return Ok(());
        }
        let options = &self.options;
        let wanted = Topic::ALL.into_iter().filter(|topic| topic.is_wanted(options));
        self.channels = self.file.with(|file| {
            let words = file.agree_on_words()?;
            wanted
                .map(|topic| {
                    let durability =
                        if topic == Topic::Mounts { Durability::TransientLocal } else { Durability::Volatile };
                    let (schema, metadata) =
                        (options.kind.schema(topic.sort()), options.kind.metadata(durability, words));
                    Ok((topic, file.channel(&topic.name(options), &schema, options.kind.encoding(), &metadata)?))
                })
                .collect()
        })?;
        self.say_mounts(t)?;
        // Viewers place a topic in its frame from its first message on, and complain until then.
        for topic in [Topic::Echoes, Topic::Map, Topic::CrossingPoints] {
            self.bytes.clear();
            self.send_cloud(topic, t)?;
        }
        Ok(())
    }

    fn say_mounts(&mut self, t: i64) -> Result<()> {
        let frames = &self.options.frames;
        let sensor = |(sensor, mount)| (self.sensors.frame(sensor, frames), pose_of(mount));
        let mounts: Vec<(String, Pose)> = (0..=u16::MAX).zip(&frames.mounts).map(sensor).collect();
        let transforms: Vec<Transform<'_>> =
            mounts.iter().map(|(child, pose)| Transform { t, parent: &frames.robot, child, pose: *pose }).collect();
        let content = Content::Transforms(&transforms);
        send(&self.file, &mut self.encoder, channel(&self.channels, Topic::Mounts), self.log_time, &content)
    }

    /// Writes what the sweep has gathered, and begins the next.
    fn end_sweep(&mut self, at_end: bool) -> Result<()> {
        self.write_places()?;
        self.write_echoes()?;
        self.write_crossings()?;
        self.write_arcs()?;
        self.write_so_far(at_end)?;
        self.sweep.clear();
        Ok(())
    }

    /// Sends a message, where its topic is written.
    fn send(&mut self, topic: Topic, content: &Content<'_>) -> Result<()> {
        send(&self.file, &mut self.encoder, channel(&self.channels, topic), self.log_time, content)
    }

    /// Transforms and the pose.
    fn write_places(&mut self) -> Result<()> {
        let placed = std::mem::take(&mut self.sweep.placed);
        if placed.is_empty() {
            return Ok(());
        }
        let frames = self.options.frames.clone();
        let children: Vec<Option<String>> =
            placed.iter().map(|placed| placed.sensor.map(|sensor| self.sensors.frame(sensor, &frames))).collect();
        let transforms: Vec<Transform<'_>> = placed
            .iter()
            .zip(&children)
            .map(|(&Placed { t, pose, .. }, sensor)| match sensor {
                Some(child) => Transform { t, parent: &frames.robot, child, pose },
                None => Transform { t, parent: &frames.fixed, child: &frames.robot, pose },
            })
            .collect();
        self.send(Topic::Robot, &Content::Transforms(&transforms))?;
        if let Some((t, pose)) = self.sweep.pose {
            self.send(Topic::Pose, &Content::Pose { t, frame: &frames.fixed, pose })?;
        }
        // The memory is kept.
        self.sweep.placed = placed;
        Ok(())
    }

    fn write_echoes(&mut self) -> Result<()> {
        let echoes = std::mem::take(&mut self.sweep.echoes);
        for run in runs(&echoes, AnyEcho::t) {
            let since = earliest(run, AnyEcho::t);
            let layout = self.layouts.of(Topic::Echoes.points(&self.options));
            self.bytes.clear();
            for echo in run {
                let (place, color) = (echo.position(), color_of(echo.kind()));
                layout.push(&mut self.bytes, place.x, place.y, color, |bytes| put_echo(bytes, echo, since));
            }
            self.send_cloud(Topic::Echoes, since)?;
        }
        self.sweep.echoes = echoes;
        self.sweep.echoes.clear();
        Ok(())
    }

    fn write_crossings(&mut self) -> Result<()> {
        if self.sweep.crossings.is_empty() {
            return Ok(());
        }
        self.sweep.draw_crossings();
        let crossings = std::mem::take(&mut self.sweep.crossings);
        for run in runs(&crossings, |crossing| crossing.t) {
            let since = earliest(run, |crossing| crossing.t);
            let layout = self.layouts.of(Points::Crossings);
            self.bytes.clear();
            for crossing in run {
                let place = crossing.position;
                layout.push(&mut self.bytes, place.x, place.y, CROSSING_COLOR, |bytes| {
                    put_crossing(bytes, crossing, since);
                });
            }
            self.send_cloud(Topic::CrossingPoints, since)?;
        }
        self.sweep.crossings = crossings;
        self.sweep.crossings.clear();
        self.send_scene(Topic::Crossings)
    }

    fn write_arcs(&mut self) -> Result<()> {
        if self.sweep.arcs.drawings.is_empty() {
            return Ok(());
        }
        self.send_scene(Topic::Arcs)?;
        let dots = self.layouts.of(Points::Dots);
        self.bytes.clear();
        for point in &self.sweep.arcs.points {
            dots.push(&mut self.bytes, point.x, point.y, self.sweep.arcs.color, |_| {});
        }
        self.send_cloud(Topic::ArcPoints, self.sweep.t)
    }

    /// Echoes and path so far, where they have grown.
    fn write_so_far(&mut self, at_end: bool) -> Result<()> {
        if self.echoes.take_due(at_end) {
            let dots = self.layouts.of(Points::Dots);
            self.bytes.clear();
            for (place, color) in self.echoes.iter() {
                dots.push(&mut self.bytes, place.x, place.y, *color, |_| {});
            }
            self.send_cloud(Topic::Map, self.sweep.t)?;
        }
        if self.path.take_due(at_end) {
            let poses = self.path.poses();
            let (t, frame) = (self.sweep.t, self.options.frames.fixed.clone());
            self.send(Topic::Path, &Content::Path { t, frame: &frame, poses: &poses })?;
            let dots = self.layouts.of(Points::Dots);
            self.bytes.clear();
            for (_, pose) in &poses {
                dots.push(&mut self.bytes, pose.x, pose.y, topics::PATH_COLOR, |_| {});
            }
            self.send_cloud(Topic::PathPoints, t)?;
        }
        Ok(())
    }

    /// Sends the points that were gathered in `bytes`.
    fn send_cloud(&mut self, topic: Topic, t: i64) -> Result<()> {
        let layout = self.layouts.of(topic.points(&self.options));
        let cloud = Cloud { t, frame: &self.options.frames.fixed, layout, points: &self.bytes };
        let channel = channel(&self.channels, topic);
        send(&self.file, &mut self.encoder, channel, self.log_time, &Content::Cloud(cloud))
    }

    /// Sends the sweep's arcs or marks.
    fn send_scene(&mut self, topic: Topic) -> Result<()> {
        let scene = if topic == Topic::Arcs { &self.sweep.arcs } else { &self.sweep.marks };
        let sensors = &self.sensors;
        let groups = |group| if group == CROSSING_GROUP { "crossings".to_owned() } else { sensors.id(group) };
        let content = Content::Scene { frame: &self.options.frames.fixed, scene, groups: &groups };
        send(&self.file, &mut self.encoder, channel(&self.channels, topic), self.log_time, &content)
    }
}

fn channel(channels: &[(Topic, u16)], topic: Topic) -> Option<u16> {
    channels.iter().find(|(known, _)| *known == topic).map(|(_, number)| *number)
}

fn send<W: Write>(
    file: &Shared<W>,
    encoder: &mut Encoder,
    channel: Option<u16>,
    log_time: u64,
    content: &Content<'_>,
) -> Result<()> {
    match channel {
        Some(channel) => file.with(|file| file.write(channel, log_time, encoder.encode(content))),
        None => Ok(()),
    }
}

impl<W: Write> EchoSink for McapSink<W> {
    fn sensors(&mut self, ids: &[Arc<str>]) -> Result<()> {
        match self.sensors.learn(ids) {
            Some(metadata) => self.file.with(|file| file.metadata(&metadata)),
            None => Ok(()),
        }
    }

    fn record(&mut self, row: &Row, pose: Pose) -> Result<()> {
        let log_time = u64::try_from(row.log_time).unwrap_or(0).max(self.log_time);
        if self.sweep.is_over(row, log_time) {
            self.end_sweep(false)?;
        }
        self.log_time = log_time;
        self.begin(row.t)?;
        self.robot = Isometry2::from_parts(
            Vector2::new(pose.x, pose.y).into(),
            UnitComplex::from_cos_sin_unchecked(libm::cos(pose.yaw), libm::sin(pose.yaw)),
        );
        self.sweep.record(row, log_time, pose);
        if self.options.contents == Contents::Everything {
            self.path.push(row.t, pose);
        }
        Ok(())
    }

    fn reading(&mut self, reading: &Reading<f64>) -> Result<()> {
        if self.options.contents == Contents::Everything {
            self.sweep.draw(reading);
            let frames = &self.options.frames;
            let is_mounted = usize::from(reading.sensor) < frames.mounts.len();
            if frames.transforms == Transforms::All && !is_mounted {
                let pose = pose_of(&self.robot.inv_mul(&reading.pose));
                self.sweep.placed.push(Placed { t: reading.t, sensor: Some(reading.sensor), pose });
            }
        }
        Ok(())
    }

    fn echo(&mut self, echo: &AnyEcho) -> Result<bool> {
        if self.options.contents == Contents::Everything {
            self.sweep.echoes.push(*echo);
            self.echoes.push(echo.position(), color_of(echo.kind()));
            if self.sweep.echoes.len() >= MOST_POINTS {
                self.write_echoes()?;
            }
        }
        Ok(true)
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossings(&mut self, crossings: &[ArcCrossing<f64>]) -> Result<()> {
        self.sweep.crossings.extend_from_slice(crossings);
        if self.sweep.crossings.len() >= MOST_POINTS {
            self.write_crossings()?;
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<()> {
        if self.options.layout != Layout::Immediate || self.channels.is_empty() {
            return Ok(());
        }
        self.end_sweep(false)?;
        self.file.with(Merged::flush)
    }
}

impl<W: Write> Drop for McapSink<W> {
    fn drop(&mut self) {
        // What can still be saved of a run that failed: its error is known already.
        if !self.channels.is_empty() {
            let _ = self.end_sweep(false);
        }
    }
}
