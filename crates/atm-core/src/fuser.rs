//! The orchestrator: Section III as code.

use nalgebra::{Isometry2, Point2, Vector2};

use crate::{
    arc::{Arc, Bearing, ReportedArc},
    columns::{Entry, Waiting},
    error::Rejected,
    estimator::{Estimator, TransversalMedian, Verdict},
    local_map::{Bounds, Held, LocalMap, Newcomer, Span},
    partners::{Partners, Scope},
    pose::{Odometer, Travel, usable},
    scalar::Scalar,
    sensor::{Beam, Range, RangeResolution},
    storage::{SettledStorage, SnapshotStorage, Storage},
};

/// One reading, with all that the fusion has to know of it.
#[derive(Debug, Clone, Copy)]
pub struct Reading<T: Scalar> {
    /// When it was taken, in nanoseconds; not before the reading that came last.
    pub t: i64,
    /// The sensor's index, below the storage's number of sensors.
    pub sensor: u16,
    /// What was measured.
    pub range: Range<T>,
    /// The SENSOR's pose in the fixed frame, boresight along +x: the robot's pose times the mount.
    pub pose: Isometry2<T>,
    /// The robot's position in the fixed frame, in metres: the travelled path is counted along it.
    pub robot: Point2<T>,
    /// The sensor's beam.
    pub beam: Beam<T>,
    /// The sensor's range resolution, at this range.
    pub range_resolution: RangeResolution<T>,
}

impl<T: Scalar> Reading<T> {
    /// The arc that it makes, where it is an echo.
    fn arc(&self) -> Option<ReportedArc<T>> {
        Some(ReportedArc {
            arc: Arc::new(&self.pose, self.range.echo()?, &self.beam),
            t: self.t,
            sensor: self.sensor,
            field_of_view: self.beam.field_of_view(),
            range_resolution: self.range_resolution,
        })
    }
}

impl<T: Scalar> Entry<T> {
    #[inline]
    fn new(reading: &Reading<T>, travel: Travel) -> Self {
        Self {
            sensor_position: Point2::from(reading.pose.translation.vector),
            arc: reading.range.echo().map(|radius| Arc::new(&reading.pose, radius, &reading.beam)),
            boresight: Vector2::new(reading.pose.rotation.re, reading.pose.rotation.im),
            beyond: reading.range.limit(),
            t: reading.t,
            travel,
            arrival: 0,
            beam: reading.beam,
            range_resolution: reading.range_resolution,
        }
    }
}

/// What became of a reading that could be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Arrival {
    /// It is in the local map now.
    Entered,
    /// It is in the local map now, in place of its sensor's previous reading, to which it is equal ([`Held::Edges`]).
    Replaced,
    /// Skipped: equal to its sensor's previous reading ([`Held::Drop`]).
    Held,
    /// Skipped: its sensor has moved too little ([`Bounds::with_min_step`]).
    Still,
    /// Skipped: a second reading of its sensor at one time and place, whose crossings would count twice.
    Duplicate,
}

/// A transversal crossing on a reported arc.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct ArcCrossing<T: Scalar> {
    /// Time of the reported arc's reading, in nanoseconds.
    pub t: i64,
    /// Its sensor.
    pub sensor: u16,
    /// Time of the other arc's reading, in nanoseconds.
    pub t_other: i64,
    /// Its sensor.
    pub sensor_other: u16,
    /// The crossing in the fixed frame, in metres.
    pub position: Point2<T>,
    /// Its direction on the reported arc.
    pub bearing: Bearing<T>,
    /// The crossing angle, folded to \[0, π/2\], in radians.
    pub angle: T,
}

/// Where reports go. Any `FnMut(&E)` is one that takes the echoes alone.
pub trait Sink<T: Scalar, E> {
    /// An arc's echo.
    fn echo(&mut self, echo: &E);

    /// An arc that gave no echo, with its count of crossings.
    fn ignored(&mut self, _crossings: u32) {}

    /// Whether [`Sink::crossing`] is to be called.
    fn wants_crossings(&self) -> bool {
        false
    }

    /// A crossing on the arc that is reported next, by its echo or as ignored. In no particular order.
    fn crossing(&mut self, _crossing: &ArcCrossing<T>) {}
}

impl<T: Scalar, E, F: FnMut(&E)> Sink<T, E> for F {
    fn echo(&mut self, echo: &E) {
        self(echo);
    }
}

/// Turns readings into echoes, one at a time, at a cost that does not grow with their number.
///
/// A const constructor on const storage makes a fuser that can be a `static`:
///
/// ```
/// use atm_core::{Bounds, Fuser, LatestArrays, TransversalMedian};
/// static FUSER: Fuser<f32, LatestArrays<f32, 16, 10>> =
///     Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, LatestArrays::new());
/// ```
#[derive(Debug, Clone)]
pub struct Fuser<T: Scalar, S, E = TransversalMedian<T>> {
    estimator: E,
    bounds: Bounds<T>,
    settled: bool,
    map: LocalMap<S>,
    odometer: Odometer<T>,
    latest: Option<i64>,
}

impl<T: Scalar, S: Storage<T>, E: Estimator<T>> Fuser<T, S, E> {
    /// A fuser that reports each echo at its reading's arrival, from the arcs in the local map then: causal, no delay.
    pub const fn latest(estimator: E, bounds: Bounds<T>, storage: S) -> Self {
        let map = LocalMap::new(storage, false);
        Self { estimator, bounds, settled: false, map, odometer: Odometer::new(), latest: None }
    }

    /// A fuser that reports each echo when its reading leaves the local map, from every arc it met.
    pub const fn settled(estimator: E, bounds: Bounds<T>, storage: S) -> Self
    where
        S: SettledStorage<T>,
    {
        let map = LocalMap::new(storage, true);
        Self { estimator, bounds, settled: true, map, odometer: Odometer::new(), latest: None }
    }

    /// Takes one reading in, and reports what that settles.
    ///
    /// # Errors
    /// A reading that can't be used changes nothing: see [`Rejected`].
    pub fn push(&mut self, reading: &Reading<T>, sink: &mut impl Sink<T, E::Echo>) -> Result<Arrival, Rejected> {
        self.check(reading)?;
        self.latest = Some(reading.t);
        if self.map.repeats(reading.sensor, reading.t, Point2::from(reading.pose.translation.vector)) {
            return Ok(Arrival::Duplicate);
        }
        let (least, most) = self.bounds.steps();
        let travel = self.odometer.advance(reading.robot, least, most);
        let held = self.is_held(reading);
        if let Some(skipped) = self.skip(reading, held) {
            return Ok(skipped);
        }
        let ousts = held && self.bounds.held == Held::Edges;
        let newcomer = Newcomer { sensor: reading.sensor, t: reading.t, travel };
        Ok(match self.bounds.span {
            None => self.arrive_by_count(reading, &newcomer, ousts, sink),
            Some(span) => self.arrive_by_travel(reading, &newcomer, &span, ousts, sink),
        })
    }

    /// The last H readings of every sensor: the leavers leave first, then the newcomer meets all that remain, then it enters.
    #[inline]
    fn arrive_by_count(
        &mut self,
        reading: &Reading<T>,
        newcomer: &Newcomer,
        ousts: bool,
        sink: &mut impl Sink<T, E::Echo>,
    ) -> Arrival {
        let replaces = ousts && self.map.take_back_held(reading.sensor, reading.range.echo());
        while let Some(slot) = self.map.next_leaver(newcomer, &self.bounds) {
            self.leave(slot, sink);
        }
        let entry = Entry::new(reading, newcomer.travel);
        let arrival = self.map.arrivals();
        self.map.enter(reading.sensor, entry);
        if replaces {
            return Arrival::Replaced;
        }
        if let (false, Some(arc)) = (self.settled, reading.arc()) {
            self.report(arrival, &arc, Scope::Present, sink);
        }
        Arrival::Entered
    }

    /// Spaced readings over a travel: whoever has met all that could cross them is reported, the newcomer takes its place
    /// among its sensor's readings, and waits for its report in turn.
    #[inline]
    fn arrive_by_travel(
        &mut self,
        reading: &Reading<T>,
        newcomer: &Newcomer,
        span: &Span<T>,
        ousts: bool,
        sink: &mut impl Sink<T, E::Echo>,
    ) -> Arrival {
        let replaces = self.map.count_run(reading.sensor, ousts) >= 2;
        let entry = Entry::new(reading, newcomer.travel);
        let at = (entry.sensor_position, entry.boresight);
        self.map.expire(newcomer, &self.bounds);
        let place = self.map.place(reading.sensor, at, &reading.beam, span.step, replaces);
        while let Some(waiting) = self.map.next_due(newcomer, &self.bounds, place) {
            self.report_waiting(&waiting, sink);
        }
        if replaces {
            self.map.cancel_newest(reading.sensor);
        }
        let arrival = self.map.arrivals();
        self.map.enter_spaced(reading.sensor, place, entry);
        match reading.arc() {
            Some(arc) if self.settled => {
                let early = self.map.wait(Waiting { arc, arrival, travel: newcomer.travel });
                early.iter().for_each(|waiting| self.report_waiting(waiting, sink));
            }
            Some(arc) if !replaces => self.report(arrival, &arc, Scope::Present, sink),
            _ => {}
        }
        if replaces { Arrival::Replaced } else { Arrival::Entered }
    }

    /// Ends a log: empties the local map, with the echoes of its readings reported where they are due. What is pushed
    /// next begins anew, at any time and place.
    pub fn finish(&mut self, sink: &mut impl Sink<T, E::Echo>) {
        if self.bounds.span.is_some() {
            while let Some(waiting) = self.map.take_waiting() {
                self.report_waiting(&waiting, sink);
            }
            self.map.clear();
        } else {
            while let Some((_, slot)) = self.map.oldest_present() {
                self.leave(slot, sink);
            }
            self.map.forget();
        }
        self.odometer.lift();
        self.latest = None;
    }

    /// The travel that the local map spans, where it is not H readings alone.
    pub const fn span(&self) -> Option<Span<T>> {
        self.bounds.span
    }

    /// Lets the local map span another travel from here on, as where a sensor with a longer range becomes known; or none,
    /// which is H readings alone. Returns whether it does: from one rule to the other only while the map is empty, at the
    /// beginning and after [`Fuser::finish`].
    pub fn set_span(&mut self, span: Option<Span<T>>) -> bool {
        let may = self.bounds.span.is_some() == span.is_some() || self.map.is_empty();
        if may {
            self.bounds.span = span;
        }
        may
    }

    /// Lets the storage grow: `grow` may add sensors behind those it has, and may not move or lose what it holds.
    pub fn grow(&mut self, grow: impl FnOnce(&mut S)) {
        self.map.unroll_log();
        grow(&mut self.map.storage);
        self.map.reroll_log();
    }

    /// Moves the origin of the fixed frame to `by`: every position that is held is reduced by it, in metres.
    ///
    /// For single precision far from the origin; see [`crate::Anchor`].
    pub fn shift_origin(&mut self, by: Vector2<T>) {
        self.map.shift(by);
        self.odometer.shift(by);
    }

    fn check(&mut self, reading: &Reading<T>) -> Result<(), Rejected> {
        if usize::from(reading.sensor) >= self.map.storage.columns().rings.len() {
            return Err(Rejected::UnknownSensor);
        }
        if !(usable(&reading.pose) && reading.robot.x.finite() && reading.robot.y.finite()) {
            return Err(Rejected::Pose);
        }
        if self.latest.is_some_and(|latest| reading.t < latest) {
            return Err(Rejected::TimeBackwards);
        }
        Ok(())
    }

    /// Whether the reading is equal to its sensor's previous one, which it replaces as such.
    fn is_held(&mut self, reading: &Reading<T>) -> bool {
        let ring = self.map.storage.columns().rings.get_mut(usize::from(reading.sensor));
        let range = reading.range.echo().unwrap_or(T::NAN);
        // Total order: all readings without echo are the same NaN, and equal.
        ring.is_some_and(|ring| ring.last.replace(range).is_some_and(|last| last.order(&range).is_eq()))
    }

    /// Whether the reading takes no slot, and why.
    fn skip(&mut self, reading: &Reading<T>, held: bool) -> Option<Arrival> {
        if held && self.bounds.held == Held::Drop {
            return Some(Arrival::Held);
        }
        let columns = self.map.storage.columns();
        let depth = columns.depth;
        let ring = columns.rings.get(usize::from(reading.sensor))?;
        let (min_step, newest) =
            (self.bounds.min_step?, usize::from(reading.sensor) * depth + usize::from(ring.newest));
        if ring.present == 0 {
            return None;
        }
        let step = reading.pose.translation.vector - columns.sensor_position(newest).coords;
        (step.x * step.x + step.y * step.y < min_step * min_step).then_some(Arrival::Still)
    }

    /// Reports the echo of a reading that leaves, if that is when it is due, and takes it out of the local map.
    fn leave(&mut self, slot: usize, sink: &mut impl Sink<T, E::Echo>) {
        if self.settled {
            self.report_stored(slot, Scope::Met, sink);
        }
        self.map.depart(slot);
    }

    /// Reports a reading that has waited, unless another one took its place.
    fn report_waiting(&mut self, waiting: &Waiting<T>, sink: &mut impl Sink<T, E::Echo>) {
        if waiting.arc.arc.radius < T::INFINITY {
            self.report(waiting.arrival, &waiting.arc, Scope::Met, sink);
        }
    }

    fn report_stored(&mut self, slot: usize, scope: Scope, sink: &mut impl Sink<T, E::Echo>) {
        let columns = self.map.storage.columns();
        let at = |column: &[T]| column.get(slot).copied().unwrap_or(T::NAN);
        let (field_of_view, resolution) = (at(columns.field_of_view), at(columns.range_resolution));
        let sensor = slot.checked_div(columns.depth).unwrap_or(0) as u16;
        let (arc, t, arrival) = (columns.arc(slot), columns.time(slot), columns.arrived(slot));
        // A reading without echo has no arc, and nothing to report.
        if let (true, Ok(range_resolution)) = (arc.radius > T::ZERO, RangeResolution::new(resolution)) {
            self.report(arrival, &ReportedArc { arc, t, sensor, field_of_view, range_resolution }, scope, sink);
        }
    }

    /// Sec. III: collect the arc's transversal crossings with the arcs it met, take their median, say so.
    fn report(&mut self, arrival: u32, arc: &ReportedArc<T>, scope: Scope, sink: &mut impl Sink<T, E::Echo>) {
        let estimator = &self.estimator;
        self.map.storage.with_scratch(|columns, scratch| {
            let partners = Partners { columns: &columns, arrival, scope };
            let verdict = estimator.estimate(arc, &partners, scratch, |other, crossing| {
                if sink.wants_crossings() {
                    sink.crossing(&ArcCrossing {
                        t: arc.t,
                        sensor: arc.sensor,
                        t_other: columns.time(other),
                        sensor_other: other.checked_div(columns.depth).unwrap_or(0) as u16,
                        position: arc.arc.sensor() + crossing.offset(),
                        bearing: crossing.bearing(),
                        angle: crossing.angle(),
                    });
                }
            });
            match verdict {
                Verdict::Echo(echo) => sink.echo(&echo),
                Verdict::Ignored(crossings) => sink.ignored(crossings),
            }
        });
    }
}

impl<T: Scalar, S: SnapshotStorage<T>, E: Estimator<T>> Fuser<T, S, E> {
    /// Reports every arc of the local map against the others in it, now, in input order: what a planner asks for.
    ///
    /// Changes nothing. In either mode.
    pub fn snapshot(&mut self, sink: &mut impl Sink<T, E::Echo>) {
        let scope = if self.settled { Scope::PresentOfKept } else { Scope::Present };
        if self.bounds.span.is_some() {
            let mut age = u32::MAX;
            while let Some((slot, next)) = self.map.next_present(age) {
                self.report_stored(slot, scope, sink);
                age = next;
            }
            return;
        }
        for ordinal in 0..self.map.span() {
            if let Some(slot) = self.map.present_at(ordinal) {
                self.report_stored(slot, scope, sink);
            }
        }
    }
}

/// A fuser may be handed from one task or interrupt to another: what it holds and what comes out of it can be sent.
const _: () = {
    const fn is_send<T: Send>() {}
    is_send::<Fuser<f32, crate::LatestArrays<f32, 1, 1>>>();
    is_send::<Fuser<f64, crate::Arrays<f64, 1, 1, 5>>>();
    is_send::<crate::Echo<f32>>();
};
