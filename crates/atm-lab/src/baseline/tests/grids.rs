//! Uniform arcs, Moravec–Elfes, Elfes, HIMM, the range layer. Sensors stand in the middle of the cell (0, 0).

use atm_core::Limits;

use super::{super::*, Sensor, assert_near, run};
use crate::map::Cell;

fn cell(row: i32, column: i32) -> Cell {
    Cell { row, column }
}

fn evidence(method: impl Method + 'static, readings: &[atm_core::Reading<f64>]) -> Evidence {
    run(method, readings).unwrap().evidence.unwrap()
}

fn reach(metres: f64) -> Vec<Limits<f64>> {
    vec![Limits::new(0.0, metres).unwrap()]
}

#[test]
fn uniform_arc_spreads_a_mass_of_one_and_frees_what_is_inside() {
    // Cells of 1 m, r = 2 along +x, beam 170°. On the arc, 1.5 to 2.5 m away: (2, 0), (2, ±1) and (1, ±2) at √5 = 2.24 m; (0, ±2) are
    // out of the beam. Inside: (0, 0), (1, 0), (1, ±1).
    let far = Sensor::with_beam(170.0).reads(0, (0.5, 0.5), 0.0, 2.0);
    let once = evidence(UniformArcs::new(1.0, Vec::new()).unwrap(), &[far]);
    for (row, column) in [(0, 2), (1, 2), (-1, 2), (2, 1), (-2, 1)] {
        assert_near(once.grid.get(cell(row, column)), 1.0, 0.0);
    }
    for (row, column) in [(0, 0), (0, 1), (1, 1), (-1, 1)] {
        assert_near(once.grid.get(cell(row, column)), 0.0, 0.0);
    }
    assert!(once.grid.get(cell(2, 0)).is_nan() && once.grid.get(cell(0, 3)).is_nan());
    assert_eq!(once.marks(once.occupied_above).len(), 5);
    // And r = 1: on the arc (1, 0), (1, ±1), with 1/3 each against 1 free; (2, 0) keeps 1/5 against nothing.
    let near = Sensor::with_beam(170.0).reads(1, (0.5, 0.5), 0.0, 1.0);
    let twice = evidence(UniformArcs::new(1.0, Vec::new()).unwrap(), &[far, near]);
    assert_near(twice.grid.get(cell(0, 1)), 0.25, 1e-12);
    assert_near(twice.grid.get(cell(0, 2)), 1.0, 0.0);
    // r = 3 frees (2, 0), (2, ±1): 1/5 against 1.
    let farther = Sensor::with_beam(170.0).reads(1, (0.5, 0.5), 0.0, 3.0);
    let freed = evidence(UniformArcs::new(1.0, Vec::new()).unwrap(), &[far, farther]);
    assert_near(freed.grid.get(cell(0, 2)), 0.2 / 1.2, 1e-12);
}

#[test]
fn what_is_beyond_the_largest_range_frees_up_to_there_and_what_is_too_close_frees_nothing() {
    let beyond = Sensor::with_beam(170.0).reads(0, (0.5, 0.5), 0.0, f64::INFINITY);
    let close = Sensor::with_beam(170.0).reads(0, (0.5, 0.5), 0.0, f64::NEG_INFINITY);
    type Make = fn(Vec<Limits<f64>>) -> Box<dyn Method>;
    let methods: [Make; 3] = [
        |limits| Box::new(UniformArcs::new(1.0, limits).unwrap()),
        |limits| Box::new(Elfes::new(1.0, limits).unwrap()),
        |limits| Box::new(Himm::new(1.0, limits).unwrap()),
    ];
    for method in methods {
        let map = |limits, reading| {
            let mut method = method(limits);
            method.take(&reading).unwrap();
            method.finish().unwrap().unwrap().evidence.unwrap().grid
        };
        let freed = map(reach(3.0), beyond);
        assert!(freed.get(cell(0, 3)) < 0.05 && freed.get(cell(0, 4)).is_nan());
        assert!(map(reach(3.0), close).get(cell(0, 1)).is_nan());
        assert!(map(vec![Limits::NONE], beyond).get(cell(0, 1)).is_nan(), "no largest range, no free space");
    }
}

#[test]
fn moravec_elfes_by_hand() {
    // Cells of 1 m, so ε = 1 m; R = 3, ω = 90°, Rmin = 0. On the axis E = 1 − (ρ/2)²: 1 at 0 m, ¾ at 1 m, 0 at 2 m.
    // O before it is divided: (3, 0): 1; (2, ±1) at 2.236 m and 26.565°: (1 − 0.764²)(1 − 0.5903²) = 0.41641 · 0.65151 = 0.27129;
    // (3, ±1) at 3.162 m and 18.435°: 0.97367 · 0.83217 = 0.81026; (3, ±2) at 3.606 m and 33.690°: 0.63331 · 0.43949 = 0.27833; cells at 45° none.
    // Sum 1 + 2 (0.27129 + 0.81026 + 0.27833) = 3.71977.
    let reading = Sensor::with_beam(90.0).reads(0, (0.5, 0.5), 0.0, 3.0);
    let once = evidence(MoravecElfes::new(1.0, Vec::new()), &[reading]);
    let at = |evidence: &Evidence, row, column| evidence.grid.get(cell(row, column));
    assert_near(at(&once, 0, 0), -1.0, 1e-12);
    assert_near(at(&once, 0, 1), -0.75, 1e-12);
    assert_near(at(&once, 0, 3), 1.0 / 3.719_77, 1e-5);
    assert_near(at(&once, 1, 3), 0.810_26 / 3.719_77, 1e-5);
    assert_near(at(&once, -1, 2), 0.271_29 / 3.719_77, 1e-5);
    assert_near(at(&once, 2, 3), 0.278_33 / 3.719_77, 1e-5);
    assert!(once.grid.get(cell(0, 5)).is_nan());
    // Twice: Emp = 1 − (1 − ¾)² = 0.9375, Occ = 1 − (1 − 0.26883)².
    let twice = evidence(MoravecElfes::new(1.0, Vec::new()), &[reading, reading]);
    assert_near(at(&twice, 0, 1), -0.9375, 1e-12);
    assert_near(at(&twice, 0, 3), 1.0 - (1.0 - 0.268_83f64).powi(2), 1e-5);
}

#[test]
fn moravec_elfes_moves_what_is_occupied_out_of_what_any_reading_says_is_empty() {
    // The second reading looks down the column of (3, 0) from (3, 3), to R = 5, so it is empty for 4 m: E = 1 − (ρ/4)² is 0.9375 at (3, 2),
    // 0.75 at (3, 1), 0.4375 at (3, 0) and 0 at (3, −1). The whole log is superposed as empty before any of it as occupied, so the
    // first reading's O there shrinks by as much, and its sum to 3.71977 − 0.9375 · 0.27833 − 0.75 · 0.81026 − 0.4375 = 2.41364.
    let sensor = Sensor::with_beam(90.0);
    let down = Sensor::with_beam(1.0).reads(1, (3.5, 3.5), -90.0, 5.0);
    let both = evidence(MoravecElfes::new(1.0, Vec::new()), &[sensor.reads(0, (0.5, 0.5), 0.0, 3.0), down]);
    assert_near(both.grid.get(cell(-1, 3)), 0.810_26 / 2.413_64, 1e-5);
    assert_near(both.grid.get(cell(-1, 2)), 0.271_29 / 2.413_64, 1e-5);
    // 0.25 · 0.81026 and 0.5625 are left, 0.0839 and 0.2330 of the sum: less than is empty.
    assert_near(both.grid.get(cell(1, 3)), -0.75, 1e-12);
    assert_near(both.grid.get(cell(0, 3)), -0.4375, 1e-12);
}

#[test]
fn elfes_by_hand() {
    // Cells of 0.1 m, σr = 0.1 m (coarser than 1 in), r = 1, φ = 90°, σα = 22.5°. On the axis at 1 m: P = ½ Φ(−½) + Φ(½) − Φ(−½)
    // = 0.15427 + 0.38292 = 0.53719. At (0.8, 0.6): 1 m, 36.87°, w = exp(−½ 1.63865²) = 0.26118, ½ + w 0.03719 = 0.50971.
    let reading = Sensor::with_beam(90.0).reads(0, (0.05, 0.05), 0.0, 1.0);
    let once = evidence(Elfes::new(0.1, Vec::new()).unwrap(), &[reading]);
    assert_near(once.grid.get(cell(0, 10)), 0.537_19, 1e-5);
    assert_near(once.grid.get(cell(6, 8)), 0.509_71, 1e-5);
    assert_near(once.grid.get(cell(0, 4)), 0.02, 1e-9);
    // Twice: odds 0.53719 / 0.46281 = 1.16071 squared, 1.34725 : 1.
    let twice = evidence(Elfes::new(0.1, Vec::new()).unwrap(), &[reading, reading]);
    assert_near(twice.grid.get(cell(0, 10)), 1.347_25 / 2.347_25, 1e-5);
    assert_near(twice.grid.get(cell(0, 4)), 1.0 / (1.0 + 49.0 * 49.0), 1e-9);
}

#[test]
fn himm_by_hand() {
    // Cells of 0.1 m: r = 0.5 along +x raises (0, 5) and lowers (0, 0) to (0, 4).
    let hit = Sensor::with_beam(22.5).reads(0, (0.05, 0.05), 0.0, 0.5);
    let past = Sensor::with_beam(22.5).reads(0, (0.05, 0.05), 0.0, 1.0);
    let value = |readings: &[atm_core::Reading<f64>], row, column| {
        evidence(Himm::new(Himm::CELL, Vec::new()).unwrap(), readings).grid.get(cell(row, column))
    };
    assert_near(value(&[hit], 0, 5), 3.0, 0.0);
    assert_near(value(&[hit], 0, 4), 0.0, 0.0);
    assert!(value(&[hit], 1, 5).is_nan(), "cells off the axis are not touched");
    assert_near(value(&[hit; 3], 0, 5), 9.0, 0.0);
    assert_near(value(&[hit; 6], 0, 5), 15.0, 0.0);
    // A reading past it lowers it by one.
    assert_near(value(&[hit, hit, hit, past], 0, 5), 8.0, 0.0);
    // From 0.1 m higher: 3 and half of the neighbour's 9.
    let above = Sensor::with_beam(22.5).reads(0, (0.05, 0.15), 0.0, 0.5);
    assert_near(value(&[hit, hit, hit, above], 1, 5), 7.5, 0.0);
    let obstacles = |readings: &[atm_core::Reading<f64>]| {
        let map = evidence(Himm::new(Himm::CELL, Vec::new()).unwrap(), readings);
        map.marks(map.occupied_above).len()
    };
    assert_eq!(obstacles(&[hit, hit, hit, above]), 1, "7.5 is not yet an obstacle, 9 is");
    assert_eq!(obstacles(&[hit, hit, hit, past]), 1, "8 is one");
    assert_eq!(obstacles(&[hit, hit, hit, past, past]), 0);
}

#[test]
fn range_layer_by_hand() {
    // Cells of 0.1 m, so the error is 10 % of r = 1. At 0.5 m: δ = 1 − (1 + tanh(−1.4))/2 = 0.94268, says ½ (1 − δ) = 0.02866; the prior
    // is 127/254 = ½; 0.02866 · 254 = 7.28: cost 7. The target's cell, 1 m: cost 233 first, 0.91732; δ = 0.68997, says
    // ½ + δ/2 = 0.84499; together 0.77513 / (0.77513 + 0.15501 · 0.08268) = 0.98373: cost 249.
    let reading = Sensor::with_beam(22.5).reads(0, (0.05, 0.05), 0.0, 1.0);
    let map = evidence(RangeLayer::new(0.1).unwrap(), &[reading]);
    assert_near(map.grid.get(cell(0, 5)), 7.0 / 254.0, 1e-12);
    assert_near(map.grid.get(cell(0, 10)), 249.0 / 254.0, 1e-12);
    // At (0.9, 0.1): 0.90554 m, 6.340°, γ = 1 − 0.56357² = 0.68239, δ = 1 − (1 + tanh(−0.58892))/2 = 0.76458, λ = 0.52174,
    // says ½ + λ (½ − ½ 0.94460²) = ½ + 0.52174 · 0.05386 = 0.52810: 134.1.
    assert_near(map.grid.get(cell(1, 9)), 134.0 / 254.0, 1e-12);
    // Off the beam nothing changes, and what is beyond the range stays as it is.
    assert!(map.grid.get(cell(3, 9)).is_nan() && map.grid.get(cell(0, 12)).is_nan());
    // A mark is a cost above 0.8 · 254 = 203, free is below 50.
    assert_near(map.occupied_above, 203.0 / 254.0, 1e-12);
    assert_near(map.free_below, 50.0 / 254.0, 1e-12);
    assert_eq!(map.marks(map.occupied_above).len(), 1);
    let beyond = Sensor::with_beam(22.5).reads(0, (0.05, 0.05), 0.0, f64::INFINITY);
    assert_eq!(evidence(RangeLayer::new(0.1).unwrap(), &[beyond]).grid.cells().count(), 0);
}
