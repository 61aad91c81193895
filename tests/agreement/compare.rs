//! What the fuser said against what the reference says.

use atm::core::{ArcCrossing, Arrival, Fuser, Kind, Point2, Rejected};
use atm::storage::{LatestSlots, SettledSlots};

use crate::{
    history::{Fate, distance},
    log::{Float, Log},
    record::{Report, run},
    reference::{Placed, Reference, Statement},
    tally::Tally,
};

/// Runs both modes over one log, snapshots included, and compares every report.
pub fn compare<T: Float>(log: &Log, tally: &mut Tally) {
    let reference = Reference::of(log, T::MARGINS);
    tally.logs += 1;
    if reference.history.doubtful {
        tally.logs_left_out += 1;
        return;
    }
    tally.count_history(&reference.history, log);
    let rules = &log.rules;
    let (sensors, history) = (rules.sensors, rules.history);

    let storage = match rules.span {
        Some(_) => SettledSlots::by_travel(sensors, history),
        None => SettledSlots::new(sensors, history),
    };
    let storage = storage.expect("small");
    let mut fuser = Fuser::<T, _>::settled(rules.estimator(), rules.bounds(), storage);
    let settled = run(log, &mut fuser, |fuser, recorder| fuser.snapshot(recorder));
    for (index, (fate, reports)) in settled.pushes.iter().enumerate() {
        agree_on_fate(*fate, reference.history.fates[index]);
        Matching { reference: &reference, tally, mode: 0 }.agree(reports, &reference.settled(Some(index)));
    }
    Matching { reference: &reference, tally, mode: 0 }.agree(&settled.rest, &reference.settled(None));

    let storage = match rules.span {
        Some(_) => LatestSlots::by_travel(sensors, history),
        None => LatestSlots::new(sensors, history),
    };
    let storage = storage.expect("small");
    let mut fuser = Fuser::<T, _>::latest(rules.estimator(), rules.bounds(), storage);
    let latest = run(log, &mut fuser, |fuser, recorder| fuser.snapshot(recorder));
    for (index, (fate, reports)) in latest.pushes.iter().enumerate() {
        agree_on_fate(*fate, reference.history.fates[index]);
        Matching { reference: &reference, tally, mode: 1 }.agree(reports, &reference.latest(index));
    }
    assert!(latest.rest.is_empty(), "latest has nothing left to say at the end");

    for (index, reports) in settled.snapshots.iter().chain(&latest.snapshots) {
        Matching { reference: &reference, tally, mode: 2 }.agree(reports, &reference.snapshot(*index));
    }
}

fn agree_on_fate(fate: Result<Arrival, Rejected>, expected: Fate) {
    let agrees = match expected {
        Fate::UnknownSensor => fate == Err(Rejected::UnknownSensor),
        Fate::BadPose => fate == Err(Rejected::Pose),
        Fate::TimeBackwards => fate == Err(Rejected::TimeBackwards),
        Fate::Held => fate == Ok(Arrival::Held),
        Fate::Still => fate == Ok(Arrival::Still),
        Fate::Duplicate => fate == Ok(Arrival::Duplicate),
        Fate::Arrived(_) => fate == Ok(Arrival::Entered),
    };
    assert!(agrees, "{fate:?} where {expected:?} was expected");
}

fn plane<T: Float>(point: Point2<T>) -> [f64; 2] {
    [point.x.widened(), point.y.widened()]
}

struct Matching<'a> {
    reference: &'a Reference<'a>,
    tally: &'a mut Tally,
    /// Settled, latest, snapshot.
    mode: usize,
}

impl Matching<'_> {
    /// Reports in the order of the statements, one for each.
    fn agree<T: Float>(&mut self, reports: &[Report<T>], statements: &[Statement]) {
        assert_eq!(reports.len(), statements.len(), "arcs reported at once");
        for (report, statement) in reports.iter().zip(statements) {
            self.tally.arcs[self.mode] += 1;
            let sample = &self.reference.log.samples[self.reference.history.stays[statement.arrival].sample];
            if let Some(echo) = &report.echo {
                assert_eq!((echo.t, echo.sensor), (sample.t, sample.sensor), "order of output");
                assert_eq!(Some(echo.range.widened()), sample.echo());
            }
            if statement.doubtful {
                self.tally.arcs_left_out[self.mode] += 1;
                continue;
            }
            assert_eq!(report.count as usize, statement.crossings.len(), "crossings of {statement:?}\n{report:?}");
            match (&report.echo, &statement.placed) {
                (None, None) => self.tally.ignored[self.mode][statement.crossings.len()] += 1,
                (Some(_), Some(placed)) => self.agree_on_echo(report, statement, placed),
                _ => panic!("{report:?} where the reference says {statement:?}"),
            }
            self.agree_on_crossings(report, statement);
        }
    }

    fn agree_on_echo<T: Float>(&mut self, report: &Report<T>, statement: &Statement, placed: &Placed) {
        let (Some(echo), margins) = (&report.echo, T::MARGINS) else { return };
        assert_eq!(echo.kind, placed.kind, "{statement:?}");
        let kind = Kind::ALL.iter().position(|&kind| kind == echo.kind).expect("all are listed");
        self.tally.kinds[self.mode][kind] += 1;
        let range = echo.range.widened();
        let off = distance(plane(echo.position), placed.position);
        self.tally.worst_position = self.tally.worst_position.max(off);
        assert!(off <= margins.position, "{off} m off: {echo:?}\n{statement:?}");
        let aside = range * (echo.azimuth().widened() - placed.azimuth).abs();
        assert!(aside <= margins.position, "{aside} m along the arc: {echo:?}\n{statement:?}");
        let resolution = echo.resolution.widened();
        assert!((resolution - placed.resolution).abs() <= margins.share * placed.resolution + margins.position);
        if placed.within_doubtful {
            self.tally.significances_left_out += 1;
            return;
        }
        self.tally.significances += 1;
        self.tally.significances_of_some += u64::from((placed.within as usize) < statement.crossings.len());
        assert_eq!(echo.within, placed.within, "{echo:?}\n{statement:?}");
        let logarithm = echo.log_significance().widened();
        let slack = margins.share * (1.0 + f64::from(placed.within));
        assert!((logarithm - placed.log_significance).abs() <= slack * (1.0 + logarithm.abs()));
        let chance = echo.significance().widened();
        assert!((chance - placed.log_significance.exp()).abs() <= slack, "{chance}");
        if let Some(expected) = placed.scan_significance {
            let scan = echo.scan_significance().widened();
            let slack = slack * (1.0 + f64::from(echo.crossings));
            assert!((scan - expected).abs() <= slack, "{scan} where {expected} was expected for {placed:?}");
        }
    }

    fn agree_on_crossings<T: Float>(&mut self, report: &Report<T>, statement: &Statement) {
        let sample = |arrival: usize| &self.reference.log.samples[self.reference.history.stays[arrival].sample];
        let own = sample(statement.arrival);
        let range = own.echo().expect("only echoes make arcs");
        let mut unmatched: Vec<_> = report.crossings.iter().collect();
        for on_arc in &statement.crossings {
            let other = sample(on_arc.partner);
            // Partners of one sensor and instant are told apart by their crossings alone.
            let apart = |crossing: &ArcCrossing<T>| {
                let angle = (crossing.angle.widened() - on_arc.angle).abs();
                distance(plane(crossing.position), on_arc.position) + angle
            };
            let place = unmatched
                .iter()
                .enumerate()
                .filter(|(_, found)| (found.t_other, found.sensor_other) == (other.t, other.sensor))
                .min_by(|(_, a), (_, b)| apart(a).total_cmp(&apart(b)))
                .map(|(place, _)| place);
            let Some(place) = place else { panic!("nothing like {on_arc:?} in {report:?}") };
            let crossing = unmatched.swap_remove(place);
            assert_eq!((crossing.t, crossing.sensor), (own.t, own.sensor));
            let off = distance(plane(crossing.position), on_arc.position);
            let aside = range * (crossing.bearing.azimuth().widened() - on_arc.azimuth).abs();
            let turned = (crossing.angle.widened() - on_arc.angle).abs();
            assert!(off.max(aside) <= T::MARGINS.position, "{crossing:?}\n{on_arc:?}");
            assert!(turned <= T::MARGINS.crossing_angle, "{crossing:?}\n{on_arc:?}");
            self.tally.crossings += 1;
            self.tally.worst_crossing = self.tally.worst_crossing.max(off.max(aside));
            self.tally.worst_angle = self.tally.worst_angle.max(turned);
        }
        assert!(unmatched.is_empty(), "{unmatched:?}");
        let twice = statement.crossings.iter().enumerate().any(|(place, on_arc)| {
            statement.crossings[..place].iter().any(|earlier| earlier.partner == on_arc.partner)
        });
        self.tally.arcs_crossed_twice_by_one += u64::from(twice);
        let itself = statement.crossings.iter().any(|on_arc| sample(on_arc.partner).sensor == own.sensor);
        self.tally.arcs_crossed_by_own_sensor += u64::from(itself);
    }
}
