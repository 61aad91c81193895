use std::vec::Vec;

use nalgebra::Isometry2;
use proptest::{prelude::*, strategy::ValueTree};

use super::*;
use crate::{Beam, columns::part, crossings};

/// Columns with their boxes, filled slot by slot.
struct Map<T> {
    boxes: Vec<Boxes<T>>,
    columns: [Vec<T>; 6],
}

impl<T: Scalar> Map<T> {
    /// Blocks that hold these arcs in turn; `None` is a slot without one.
    fn new(arcs: &[Option<Arc<T>>]) -> Self {
        let slots = arcs.len().next_multiple_of(BLOCK);
        let mut map = Self {
            boxes: std::vec![Boxes::EMPTY; slots.div_ceil(BLOCK * BLOCK)],
            columns: core::array::from_fn(|_| std::vec![T::NAN; slots]),
        };
        for (slot, arc) in arcs.iter().enumerate() {
            let Some(arc) = arc else { continue };
            let values = [arc.middle.x, arc.middle.y, arc.reach, arc.sensor.x, arc.sensor.y, arc.radius];
            for (column, value) in map.columns.iter_mut().zip(values) {
                column[slot] = value;
            }
            let block = slot / BLOCK;
            map.boxes[block / BLOCK].include(block % BLOCK, arc.middle.x, arc.middle.y, arc.reach);
        }
        map
    }

    fn field(&self) -> Field<'_, T> {
        let [middle_x, middle_y, reach, sensor_x, sensor_y, radius] =
            self.columns.each_ref().map(|column| column.as_chunks().0);
        Field { boxes: &self.boxes, middle_x, middle_y, reach, sensor_x, sensor_y, radius }
    }

    /// The slots that sweeps find, all of them together, by `sweep`.
    fn found(&self, sweep: impl Fn(&Field<'_, T>, usize, &mut Found) -> u64) -> Vec<usize> {
        let mut slots = Vec::new();
        for first in (0..self.columns[0].len() / BLOCK).step_by(SPAN) {
            let mut found = [0xff; SPAN];
            let blocks = sweep(&self.field(), first, &mut found);
            for index in (0..SPAN).filter(|index| blocks >> index & 1 == 1) {
                let lanes = (0..BLOCK).filter(|lane| found[index] >> lane & 1 == 1);
                slots.extend(lanes.map(|lane| (first + index) * BLOCK + lane));
            }
        }
        slots
    }
}

/// The same tests without boxes, blocks and bits.
fn one_by_one<T: Scalar>(arcs: &[Option<Arc<T>>], probe: &Probe<'_, T>) -> Vec<usize> {
    let passes = |other: &Arc<T>| {
        let between = other.sensor - probe.arc.sensor;
        is_near(probe.arc, other.middle.x, other.middle.y, other.reach)
            && Triangle::new(between, probe.arc.radius, other.radius).is_transversal(probe.min_angle)
    };
    (0..arcs.len()).filter(|&slot| arcs[slot].as_ref().is_some_and(passes)).collect()
}

/// Numbers on a coarse grid, so that circles touch exactly and angles are equal; and a few of any size.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (-24i32..=24).prop_map(|step| f64::from(step) * 0.25),
        2 => -6.0..6.0f64,
        1 => prop_oneof![Just(1e200), Just(-1e308), Just(1e-300), Just(0.0), Just(-0.0)],
    ]
}

fn arc() -> impl Strategy<Value = Arc<f64>> {
    let radius =
        prop_oneof![8 => (1i32..=16).prop_map(|step| f64::from(step) * 0.25), 1 => Just(1e308), 1 => 1e-3..9.0f64];
    let beam = prop_oneof![Just(22.5f64), Just(90.0), Just(180.0), 1.0..180.0f64];
    // A right angle and its like are exact: (cos, sin) of −1, 0 and 1.
    let heading = prop_oneof![3 => (0i32..4).prop_map(|turn| (f64::from((1 - turn) % 2), f64::from((2 - turn) % 2))), 2 => (0.0..6.3f64).prop_map(|yaw| (libm::cos(yaw), libm::sin(yaw)))];
    (coordinate(), coordinate(), radius, heading, beam).prop_map(|(x, y, radius, (cos, sin), beam)| {
        let rotation = nalgebra::UnitComplex::from_cos_sin_unchecked(cos, sin);
        let pose = Isometry2::from_parts(Vector2::new(x, y).into(), rotation);
        Arc::new(&pose, radius, &Beam::new(beam.to_radians()).unwrap())
    })
}

/// More than one sweep's worth, near each other in blocks as a sensor's readings are.
fn arcs() -> impl Strategy<Value = Vec<Option<Arc<f64>>>> {
    prop::collection::vec(prop::option::weighted(0.9, arc()), 1..700)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_set_of_instructions_finds_the_same_arcs_as_a_loop_over_all(
        arcs in arcs(), arc in arc(), angle in prop_oneof![Just(30.0f64), Just(60.0), Just(90.0), 1.0..90.0f64],
    ) {
        let min_angle = MinAngle::new(angle.to_radians().min(core::f64::consts::FRAC_PI_2)).unwrap();
        let probe = Probe { arc: &arc, min_angle: &min_angle };
        let (map, expected) = (Map::new(&arcs), one_by_one(&arcs, &probe));
        let portable = map.found(|field, first, found| sweep(field, first, &probe, found));
        prop_assert_eq!(&portable, &expected, "portable");
        for instructions in Instructions::available() {
            let vectors = map.found(|field, first, found| sweep_double(instructions, field, first, &probe, found));
            prop_assert_eq!(&vectors, &expected, "{}", instructions.name());
        }
    }
}

#[test]
fn sweep_finds_every_arc_that_has_a_transversal_crossing() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let (mut crossing, mut passed_over) = (0, 0);
    for _ in 0..60 {
        let (arcs, arc) = (arcs(), arc()).new_tree(&mut runner).unwrap().current();
        let probe = Probe { arc: &arc, min_angle: &MinAngle::PAPER };
        let found = Map::new(&arcs).found(|field, first, found| sweep(field, first, &probe, found));
        for (slot, other) in arcs.iter().enumerate() {
            let mut crosses = false;
            if let Some(other) = other {
                crossings(&arc, other, &MinAngle::PAPER, |_| crosses = true);
            }
            crossing += usize::from(crosses);
            passed_over += usize::from(!found.contains(&slot));
            assert!(!crosses || found.contains(&slot), "{arc:?} and {other:?}");
        }
    }
    // Or the test would show nothing.
    assert!(crossing > 200 && passed_over > 10_000, "{crossing} cross, {passed_over} were passed over");
}

#[test]
fn box_of_a_slot_without_an_arc_is_near_nothing() {
    let mut boxes = Boxes::EMPTY;
    boxes.include(3, 1.0, 1.0, f64::NAN);
    assert_eq!(boxes, Boxes::EMPTY);
    boxes.include(3, 1.0, 1.0, 0.5);
    assert_ne!(boxes, Boxes::EMPTY);
    boxes.empty(3);
    assert_eq!(boxes, Boxes::EMPTY);
    assert_eq!(part(&[1, 2, 3], &(2..9)), &[] as &[i32]);
}
