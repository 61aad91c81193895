//! Barshan's voting, morphological processing and directional maximum.

use super::{super::*, Sensor, run};

#[test]
fn three_votes_make_a_cell_occupied() {
    // Along +x at r = 2 in cells of 0.1 m: the cell (0, 20) from 2.0 to 2.1 m, with each reading one vote.
    let reading = Sensor::with_beam(22.5).reads(0, (0.05, 0.05), 0.0, 2.0);
    let map = |readings| run(Voting::new(0.1).unwrap(), readings).unwrap().evidence.unwrap();
    let (two, three) = (map(&[reading; 2]), map(&[reading; 3]));
    let middle = crate::map::Cell { row: 0, column: 20 };
    assert_eq!((two.grid.get(middle), three.grid.get(middle)), (2.0, 3.0));
    assert_eq!(two.marks(two.occupied_above).len(), 0);
    assert!(!three.marks(three.occupied_above).is_empty());
    assert!(
        three.marks(three.occupied_above).iter().all(|mark| ((mark.position.coords
            - nalgebra::Vector2::new(0.05, 0.05))
        .norm()
            - 2.0)
            .abs()
            <= 0.05)
    );
}

#[test]
fn a_lone_arc_is_pruned_and_a_crowd_stays() {
    let arc = |range: f64| Sensor::with_beam(22.5).reads(0, (0.05, 0.05), 0.0, range);
    let points = |readings: &[_]| {
        let map = run(Morphology::new(0.1).unwrap(), readings).unwrap().evidence.unwrap();
        map.marks(map.occupied_above)
    };
    assert!(points(&[arc(2.0)]).is_empty());
    // Three arcs side by side: the middle one's cell ahead has all eight neighbours.
    let crowd = points(&[arc(1.9), arc(2.0), arc(2.1)]);
    assert!(crowd.iter().any(|mark| (mark.position - atm_core::Point2::new(2.05, 0.05)).norm() < 1e-9));
}

#[test]
fn a_cell_needs_five_of_its_eight_neighbours() {
    // Beams of 1° mark one cell of 0.1 m each, here (0, 20) and some around it. Those have three neighbours at most.
    let centre = crate::map::Cell { row: 0, column: 20 };
    let marked = |cells: &[(i32, i32)]| {
        let reads = |(row, column): &(i32, i32)| {
            let from = (0.05, 0.05 + 0.1 * f64::from(*row));
            Sensor::with_beam(1.0).reads(0, from, 0.0, 0.1 * f64::from(*column))
        };
        let readings: Vec<_> = cells.iter().map(reads).collect();
        run(Morphology::new(0.1).unwrap(), &readings).unwrap().evidence.unwrap()
    };
    let cells = [(0, 20), (1, 20), (1, 21), (0, 21), (-1, 20), (-1, 19)];
    let (four, five) = (marked(&cells[..5]), marked(&cells));
    assert_eq!((four.grid.get(centre), five.grid.get(centre)), (4.0, 5.0));
    assert_eq!(four.marks(four.occupied_above).len(), 0);
    let stays: Vec<_> = five.marks(five.occupied_above).iter().map(|mark| mark.position).collect();
    assert_eq!(stays, [five.grid.center(centre)]);
}

#[test]
fn of_each_column_and_side_the_cell_with_most_arcs_stays() {
    // A path along x; narrow beams to the left. Abreast of 0.55 m two arcs lie at 1 m and one at 2 m; of 1.05 m one at 2 m; nothing on
    // the right but one arc at 1.5 m abreast of 0.05 m.
    let up = |t: i64, x: f64, range: f64| Sensor::with_beam(1.0).reads(t, (x, 0.0), 90.0, range);
    let readings = [
        up(0, 0.05, 2.0),
        Sensor::with_beam(1.0).reads(1, (0.05, 0.0), -90.0, 1.5),
        up(2, 0.55, 2.0),
        up(3, 0.55, 1.0),
        up(4, 0.55, 1.0),
        up(5, 1.05, 2.0),
    ];
    let found = run(DirectionalMaximum::new(0.1), &readings).unwrap().points;
    let at = |x: f64, y: f64| {
        found.iter().filter(|mark| (mark.position - atm_core::Point2::new(x, y)).norm() < 0.11).count()
    };
    assert_eq!((at(0.05, 2.0), at(0.05, -1.5), at(0.55, 1.0), at(0.55, 2.0), at(1.05, 2.0)), (1, 1, 1, 0, 1));
    assert_eq!(found.len(), 4);
}

#[test]
fn directional_maximum_follows_the_path_whichever_way_it_runs() {
    // The same along a path at 30°: a point 1 m to its left, seen from three places.
    let turned = |along: f64, left: f64| {
        let (sin, cos) = 30f64.to_radians().sin_cos();
        (along * cos - left * sin, along * sin + left * cos)
    };
    let readings: Vec<_> =
        (0..3).map(|k| Sensor::with_beam(1.0).reads(k, turned(f64::from(k as i32), 0.0), 120.0, 1.0)).collect();
    let found = run(DirectionalMaximum::new(0.05), &readings).unwrap().points;
    assert_eq!(found.len(), 3);
    for (k, mark) in found.iter().enumerate() {
        let (x, y) = turned(k as f64, 1.0);
        assert!((mark.position - atm_core::Point2::new(x, y)).norm() < 0.05, "{:?}", mark.position);
    }
}
