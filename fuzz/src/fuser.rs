//! The fuser itself: any readings, any options, either estimator, both precisions; the same bits on every storage.

use arbitrary::{Result, Unstructured};
use atm::{
    core::{
        ArcCrossing, Arrays, Arrival, Beam, Bounds, Consensus, ConsensusEcho, Echo, Estimator, Fuser, Held, Isometry2,
        Kind, LatestArrays, Limits, MinAngle, OnNone, OnTwo, Point2, RangeResolution, Reading, Reflector, Rejected,
        SETTLED_BLOCKS, Scalar, SettledStorage, Sink, SnapshotStorage, Storage, TransversalMedian, Travel, UnitComplex,
        Vector2,
    },
    echo::AnyEcho,
    storage::{LatestSlots, SettledSlots},
};
use nalgebra::Translation2;

const SENSORS: usize = 3;
/// Most readings of one case.
const MOST: usize = 32;

/// A case from bytes, in the precision that its first one says.
pub fn check(bytes: &[u8]) {
    let mut input = Unstructured::new(bytes);
    let Ok(options) = input.arbitrary::<u8>() else { return };
    let _ = match options & 3 {
        0 => case::<f64, 2>(&mut input, options),
        1 => case::<f32, 2>(&mut input, options),
        2 => case::<f64, 4>(&mut input, options),
        _ => case::<f32, 4>(&mut input, options),
    };
}

/// Between the two precisions and the bytes of a case.
pub trait Number: Scalar + std::fmt::Debug {
    fn of_bits(bits: u64) -> Self;
    fn narrow(number: f64) -> Self;
    fn wide(self) -> f64;
}

impl Number for f64 {
    fn of_bits(bits: u64) -> Self {
        Self::from_bits(bits)
    }
    fn narrow(number: f64) -> Self {
        number
    }
    fn wide(self) -> f64 {
        self
    }
}

impl Number for f32 {
    fn of_bits(bits: u64) -> Self {
        Self::from_bits(bits as u32)
    }
    fn narrow(number: f64) -> Self {
        number as Self
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
}

const EDGES: [f64; 10] =
    [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1e12, 1e-300];

/// A number of a robot mostly, else a decade, an edge, or any bits.
fn number<T: Number>(input: &mut Unstructured<'_>) -> Result<T> {
    Ok(match input.arbitrary::<u8>()? {
        0..=199 => T::narrow(f64::from(input.arbitrary::<i16>()?) / 8192.0),
        200..=219 => T::narrow(libm::exp10(f64::from(input.arbitrary::<i8>()?) / 8.0)),
        220..=239 => T::narrow(*input.choose(&EDGES)?),
        _ => T::of_bits(input.arbitrary()?),
    })
}

fn reading<T: Number>(input: &mut Unstructured<'_>, t: &mut i64) -> Result<Reading<T>> {
    let tag = input.arbitrary::<u8>()?;
    *t = match tag >> 4 {
        15 => input.arbitrary()?,
        14 => i64::MAX,
        13 => i64::MIN,
        12 => t.wrapping_sub(1),
        step => t.wrapping_add(i64::from(step)),
    };
    let sensor = if tag & 15 == 15 { input.arbitrary()? } else { u16::from(tag & 15) % SENSORS as u16 };
    let heading = number::<T>(input)?.wide();
    let rotation = if tag == 255 {
        UnitComplex::from_cos_sin_unchecked(number(input)?, number(input)?)
    } else {
        UnitComplex::from_cos_sin_unchecked(T::narrow(libm::cos(heading)), T::narrow(libm::sin(heading)))
    };
    let position = Translation2::new(number::<T>(input)?, number(input)?);
    let robot = if tag & 1 == 0 { position.vector.into() } else { Point2::new(number(input)?, number(input)?) };
    let range = number::<T>(input)?;
    let (limits, beam, step) = if tag & 2 == 0 {
        (Limits::NONE, T::narrow(1.2), T::narrow(0.01))
    } else {
        (Limits::new(number(input)?, number(input)?).unwrap_or(Limits::NONE), number(input)?, number(input)?)
    };
    Ok(Reading {
        t: *t,
        sensor,
        range: limits.classify(range),
        pose: Isometry2::from_parts(position, rotation),
        robot,
        beam: Beam::new(beam).or(Beam::new(T::narrow(3.0))).expect("below half a turn"),
        range_resolution: RangeResolution::new(step).or(RangeResolution::new(T::narrow(0.02))).expect("positive"),
    })
}

struct Case<T: Scalar, E> {
    estimator: E,
    bounds: Bounds<T>,
    readings: Vec<Reading<T>>,
    /// After every so many readings, a snapshot.
    snapshots: usize,
    /// After every so many readings, another origin.
    shifts: usize,
}

fn case<T: Number, const H: usize>(input: &mut Unstructured<'_>, options: u8) -> Result<()> {
    let min_angle = match options >> 2 & 1 {
        0 => MinAngle::PAPER,
        _ => MinAngle::new(number::<T>(input)?).unwrap_or(MinAngle::PAPER),
    };
    let median = TransversalMedian {
        min_angle,
        on_none: if options & 8 == 0 { OnNone::Center } else { OnNone::Drop },
        on_two: *input.choose(&[OnTwo::Drop, OnTwo::Center, OnTwo::Mean])?,
    };
    let mut bounds = Bounds::NONE.with_held(if options & 16 != 0 { Held::Drop } else { Held::Keep });
    if options & 32 != 0 {
        bounds = bounds.with_max_age(u64::from(input.arbitrary::<u8>()?));
    }
    if options & 64 != 0
        && let Ok(travel) = Travel::from_metres(number::<T>(input)?)
    {
        bounds = bounds.with_max_travel(travel);
    }
    if options & 128 != 0 {
        bounds = bounds.with_min_step(number::<T>(input)?).unwrap_or(bounds);
    }
    let (more, other) = input.arbitrary::<(u8, u8)>()?;
    let (snapshots, shifts) = (usize::from(more % 8), usize::from(other % 8));
    if other & 128 != 0 {
        bounds = bounds.with_held(Held::Edges);
    }
    let consensus = match more & 128 {
        0 => None,
        _ => Some(consensus(min_angle, more, input)?),
    };
    let (mut readings, mut t) = (Vec::new(), 0);
    while !input.is_empty() && readings.len() < MOST {
        let Ok(reading) = reading::<T>(input, &mut t) else { break };
        readings.push(reading);
    }
    match consensus {
        None => Case { estimator: median, bounds, readings, snapshots, shifts }.check::<H>(),
        Some(estimator) => Case { estimator, bounds, readings, snapshots, shifts }.check::<H>(),
    }
    Ok(())
}

fn consensus<T: Number>(min_angle: MinAngle<T>, options: u8, input: &mut Unstructured<'_>) -> Result<Consensus<T>> {
    let mut consensus = Consensus::new(min_angle);
    if options & 64 != 0 {
        consensus = consensus.with_min_confidence(number(input)?).unwrap_or(consensus);
    }
    if options & 32 != 0 {
        consensus = consensus.with_range_error(number(input)?).unwrap_or(consensus);
    }
    Ok(consensus)
}

impl<T: Number, E: Estimator<T, Echo: Said> + Copy> Case<T, E> {
    /// The same bits on every storage, in both modes.
    fn check<const H: usize>(&self) {
        let settled = self.settled(SettledSlots::new(SENSORS, H).expect("small"));
        assert_eq!(settled, self.settled(Arrays::<T, SENSORS, H, SETTLED_BLOCKS>::new()), "settled on arrays");
        assert_eq!(settled, self.settled(SettledSlots::new(1, H).expect("small")), "settled on slots that grow");
        let latest = self.latest(LatestSlots::new(SENSORS, H).expect("small"));
        assert_eq!(latest, self.latest(Arrays::<T, SENSORS, H, 1>::new()), "latest on arrays");
        assert_eq!(latest, self.latest(SettledSlots::new(SENSORS, H).expect("small")), "latest on large slots");
        let causal = self.run(&mut self.latest_fuser(LatestArrays::<T, SENSORS, H>::new()), |_, _| {}, |_| {});
        let said = |report: &&Word| !matches!(report, Word::Snapshot(_));
        assert!(causal.words.iter().eq(latest.words.iter().filter(said)), "latest without snapshots");
        assert_eq!(causal.fates, settled.fates);
    }

    fn latest_fuser<S: Storage<T>>(&self, storage: S) -> Fuser<T, S, E> {
        Fuser::latest(self.estimator, self.bounds, storage)
    }

    fn latest<S: SnapshotStorage<T>>(&self, storage: S) -> Notes {
        self.run(&mut self.latest_fuser(storage), |fuser, notes| fuser.snapshot(notes), |_| {})
    }

    fn settled<S: SettledStorage<T> + Grow>(&self, storage: S) -> Notes {
        let mut fuser = Fuser::settled(self.estimator, self.bounds, storage);
        let notes = self.run(&mut fuser, |fuser, notes| fuser.snapshot(notes), |fuser| fuser.grow(Grow::to_all));
        // Each arc is reported once, sooner or later.
        let entered = notes.fates.iter().zip(&self.readings).filter(|(fate, _)| **fate == Ok(Arrival::Entered));
        let arcs = entered.filter(|(_, reading)| reading.range.echo().is_some()).count();
        let reports = notes.words.iter().filter(|word| matches!(word, Word::Echo(_) | Word::Ignored(_))).count();
        assert_eq!(reports, arcs, "arcs and reports");
        notes
    }

    fn run<S: Storage<T>>(
        &self,
        fuser: &mut Fuser<T, S, E>,
        snapshot: impl Fn(&mut Fuser<T, S, E>, &mut Snapshots<'_>),
        grow: impl Fn(&mut Fuser<T, S, E>),
    ) -> Notes {
        let mut notes = Notes::default();
        for (index, reading) in self.readings.iter().enumerate() {
            // What is not known yet has to become known before it is heard of.
            grow(fuser);
            let fate = fuser.push(reading, &mut notes);
            notes.fates.push(fate);
            if self.snapshots > 0 && index % self.snapshots == 0 {
                snapshot(fuser, &mut Snapshots(&mut notes));
            }
            if self.shifts > 0 && index % self.shifts == 0 {
                fuser.shift_origin(Vector2::new(T::narrow(0.25), T::narrow(-1.5)));
            }
        }
        fuser.finish(&mut notes);
        notes
    }
}

/// Storage that can be made larger, or is large enough.
trait Grow {
    fn to_all(&mut self);
}

impl<T: Scalar, const B: usize> Grow for atm::storage::Slots<T, B> {
    fn to_all(&mut self) {
        self.grow(SENSORS).expect("small");
    }
}

impl<T: Scalar, const S: usize, const H: usize, const B: usize> Grow for Arrays<T, S, H, B> {
    fn to_all(&mut self) {}
}

/// All that was said, as bits.
#[derive(Debug, Default, PartialEq)]
struct Notes {
    fates: Vec<std::result::Result<Arrival, Rejected>>,
    words: Vec<Word>,
    /// Crossings come in no particular order, so theirs are added up until the arc's report.
    crossings: u64,
    count: u32,
}

#[derive(Debug, PartialEq)]
enum Word {
    Echo([u64; 16]),
    Ignored(u32),
    Crossings(u64),
    Snapshot([u64; 16]),
}

/// An echo whose sanity can be insisted on, and whose every bit can be compared.
trait Said {
    fn insist(&self);
    /// Crossings that have been handed out with it.
    fn handed_out(&self) -> u32;
    fn bits(&self) -> [u64; 16];
}

/// Integers and floats of an echo, in sixteen words.
fn words<T: Number, const N: usize>(integers: [u64; 3], floats: [T; N]) -> [u64; 16] {
    let mut words = [0; 16];
    let all = integers.into_iter().chain(floats.into_iter().map(|number| number.wide().to_bits()));
    words.iter_mut().zip(all).for_each(|(word, bits)| *word = bits);
    words
}

impl<T: Number> Said for Echo<T> {
    fn insist(&self) {
        sane(self);
    }

    fn handed_out(&self) -> u32 {
        self.crossings
    }

    fn bits(&self) -> [u64; 16] {
        let sort = u64::from(self.sensor) << 32 | u64::from(self.within) << 16 | self.kind as u64;
        let (place, sin) = (self.position, self.bearing.sin());
        words(
            [self.t as u64, sort, u64::from(self.crossings)],
            [place.x, place.y, self.range, sin, self.resolution, self.significance()],
        )
    }
}

impl<T: Number> Said for ConsensusEcho<T> {
    fn insist(&self) {
        sane_consensus(self);
    }

    fn handed_out(&self) -> u32 {
        0
    }

    fn bits(&self) -> [u64; 16] {
        let sort = u64::from(self.sensor) << 32 | self.kind as u64;
        let counts = u64::from(self.support) << 32 | u64::from(self.against);
        let (place, sin) = (self.position, self.bearing.sin());
        let normal = self.normal.unwrap_or(Vector2::new(T::NAN, T::NAN));
        words(
            [self.t as u64, sort, counts],
            [
                place.x,
                place.y,
                self.range,
                sin,
                self.resolution,
                self.confidence,
                self.sigma_azimuth,
                self.sigma_range,
                normal.x,
                normal.y,
            ],
        )
    }
}

impl<T: Number, E: Said> Sink<T, E> for Notes {
    fn echo(&mut self, echo: &E) {
        echo.insist();
        assert_eq!(self.count, echo.handed_out(), "crossings handed out and counted");
        self.words.extend([Word::Crossings(self.crossings), Word::Echo(echo.bits())]);
        (self.crossings, self.count) = (0, 0);
    }

    fn ignored(&mut self, crossings: u32) {
        assert_eq!(self.count, crossings, "crossings handed out and counted");
        self.words.extend([Word::Crossings(self.crossings), Word::Ignored(crossings)]);
        (self.crossings, self.count) = (0, 0);
    }

    fn wants_crossings(&self) -> bool {
        true
    }

    fn crossing(&mut self, crossing: &ArcCrossing<T>) {
        let angle = crossing.angle.wide();
        assert!((0.0..=std::f64::consts::FRAC_PI_2 + 1e-3).contains(&angle), "{crossing:?}");
        let numbers = [crossing.position.x, crossing.position.y, crossing.bearing.sin(), crossing.angle];
        let mixed = numbers
            .into_iter()
            .zip([3, 17, 31, 47])
            .fold(crossing.t_other as u64, |mixed, (number, turn)| mixed ^ number.wide().to_bits().rotate_left(turn));
        self.crossings = self.crossings.wrapping_add(mixed);
        self.count += 1;
    }
}

struct Snapshots<'a>(&'a mut Notes);

impl<T: Number, E: Said> Sink<T, E> for Snapshots<'_> {
    fn echo(&mut self, echo: &E) {
        echo.insist();
        self.0.words.push(Word::Snapshot(echo.bits()));
    }
}

/// What holds of every echo, of whichever estimator.
pub fn sane_either(echo: &AnyEcho) {
    match echo {
        AnyEcho::Median(echo) => sane(echo),
        AnyEcho::Consensus(echo) => sane_consensus(echo),
    }
}

/// What holds of every echo of the median, whatever it was made from.
pub fn sane<T: Number>(echo: &Echo<T>) {
    let azimuth = echo.azimuth().wide();
    assert!(azimuth.abs() <= std::f64::consts::FRAC_PI_2 + 1e-6, "{echo:?}");
    assert!(echo.range.wide() > 0.0 && echo.range.finite(), "{echo:?}");
    assert!(echo.resolution.wide() >= 0.0, "{echo:?}");
    assert!((0.0..=1.0).contains(&echo.significance().wide()), "{} of {echo:?}", echo.significance());
    assert!((0.0..=1.0).contains(&echo.scan_significance().wide()), "{} of {echo:?}", echo.scan_significance());
    let fits = match echo.kind {
        Kind::Median => echo.crossings >= 3,
        Kind::Single => echo.crossings == 1,
        Kind::Center => echo.crossings == 0,
        Kind::Pair => echo.crossings == 2,
        _ => true,
    };
    assert!(fits, "{echo:?}");
}

/// What holds of every echo of the consensus, whatever it was made from.
pub fn sane_consensus<T: Number>(echo: &ConsensusEcho<T>) {
    let azimuth = echo.azimuth().wide();
    assert!(azimuth.abs() <= std::f64::consts::FRAC_PI_2 + 1e-6, "{echo:?}");
    assert!(echo.range.wide() > 0.0 && echo.range.finite(), "{echo:?}");
    assert!(echo.resolution.wide() >= 0.0, "{echo:?}");
    assert!((0.0..=1.0).contains(&echo.confidence.wide()), "{echo:?}");
    assert!((0.0..=1.0).contains(&echo.significance().wide()), "{echo:?}");
    assert!(echo.sigma_azimuth.wide() >= 0.0 && echo.sigma_range.wide() >= 0.0, "{echo:?}");
    assert_eq!(echo.normal.is_some(), echo.kind == Reflector::Wall, "{echo:?}");
    if let Some(normal) = echo.normal {
        assert!((normal.norm().wide() - 1.0).abs() < 1e-3, "{echo:?}");
    }
    // Of the arc's centre nothing is claimed but what the reading says.
    assert!(echo.kind == Reflector::Center || echo.support >= 2, "{echo:?}");
}
