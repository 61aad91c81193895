use super::*;
use crate::world::Material;

fn walls(polylines: &[&[(f64, f64)]]) -> Vec<Surface> {
    let point = |(x, y): (f64, f64)| Point2::new(x, y);
    let pieces = polylines.iter().flat_map(|points| points.iter().zip(points.iter().skip(1)));
    let wall = |(&from, &to): (&(f64, f64), &(f64, f64))| Surface {
        shape: Shape::Segment { from: point(from), to: point(to) },
        material: Material::Specular,
    };
    pieces.map(wall).collect()
}

fn corners(polylines: &[&[(f64, f64)]]) -> Vec<Corner> {
    let mut surfaces = walls(polylines);
    snap(&mut surfaces);
    find(&surfaces, &boxes(&surfaces))
}

/// Whether the corner at a place is heard from a point; false where there is none.
fn answers(corners: &[Corner], at: (f64, f64), from: (f64, f64)) -> bool {
    let mut there = corners.iter().filter(|corner| (corner.at - Point2::new(at.0, at.1)).norm() < 1e-9);
    let found = there.next().is_some_and(|corner| corner.answers(Point2::new(from.0, from.1)));
    assert!(there.next().is_none(), "two corners at one place");
    found
}

#[test]
fn free_end_is_heard_from_everywhere() {
    let ends = corners(&[&[(0.0, 0.0), (1.0, 0.0)]]);
    assert_eq!(ends.len(), 2);
    for from in [(2.0, 0.0), (0.5, 1.0), (0.5, -1.0), (1.0, 3.0)] {
        assert!(answers(&ends, (1.0, 0.0), from));
    }
}

#[test]
fn square_joint_is_heard_from_both_sides() {
    let joint = corners(&[&[(0.0, 1.0), (0.0, 0.0), (1.0, 0.0)]]);
    assert!(answers(&joint, (0.0, 0.0), (0.5, 0.5)), "the apex");
    assert!(answers(&joint, (0.0, 0.0), (-0.5, -0.5)), "the edge");
    assert!(answers(&joint, (0.0, 0.0), (-0.5, 0.5)));
}

#[test]
fn other_joints_are_edges_only_and_straight_ones_are_nothing() {
    let dull = corners(&[&[(-1.0, 0.0), (0.0, 0.0), (1.0, 1.0)]]);
    assert!(!answers(&dull, (0.0, 0.0), (0.0, 1.0)));
    assert!(answers(&dull, (0.0, 0.0), (0.0, -1.0)));
    let straight = corners(&[&[(-1.0, 0.0), (0.0, 0.0), (1.0, 0.01)]]);
    assert_eq!(straight.len(), 2, "its ends: {straight:?}");
}

#[test]
fn right_angle_is_one_within_a_degree() {
    let turned = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        corners(&[&[(1.0, 0.0), (0.0, 0.0), (cos, sin)]])
    };
    assert!(answers(&turned(89.1), (0.0, 0.0), (1.0, 1.0)) && answers(&turned(90.9), (0.0, 0.0), (1.0, 1.0)));
    assert!(!answers(&turned(88.9), (0.0, 0.0), (1.0, 1.0)) && !answers(&turned(91.1), (0.0, 0.0), (1.0, 1.0)));
}

#[test]
fn wall_that_ends_at_another_makes_two_apexes_and_no_edge() {
    // Half a millimetre short of it.
    let tee = corners(&[&[(-1.0, 0.0), (1.0, 0.0)], &[(0.2, 0.0005), (0.2, 1.0)]]);
    assert!(answers(&tee, (0.2, 0.0), (0.5, 0.5)) && answers(&tee, (0.2, 0.0), (-0.5, 0.5)));
    assert!(!answers(&tee, (0.2, 0.0), (0.2, -1.0)), "from behind it is a smooth wall");
    let apart = corners(&[&[(-1.0, 0.0), (1.0, 0.0)], &[(0.2, 0.0015), (0.2, 1.0)]]);
    assert!(answers(&apart, (0.2, 0.0015), (0.2, -1.0)), "1.5 mm are a gap");
}

#[test]
fn crossing_walls_make_four_apexes() {
    let cross = corners(&[&[(-1.0, 0.0), (1.0, 0.0)], &[(0.0, -1.0), (0.0, 1.0)]]);
    for from in [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)] {
        assert!(answers(&cross, (0.0, 0.0), from));
    }
    let slanted = corners(&[&[(-1.0, 0.0), (1.0, 0.0)], &[(-1.0, -1.0), (1.0, 1.0)]]);
    assert_eq!(slanted.len(), 4, "only the ends: {slanted:?}");
}

#[test]
fn ends_that_nearly_meet_are_moved_onto_each_other() {
    let mut surfaces = walls(&[&[(0.0, 0.0), (1.0, 0.0)], &[(1.0004, 0.0005), (1.0, 1.0)]]);
    snap(&mut surfaces);
    let Shape::Segment { from, .. } = surfaces[1].shape else { panic!("a wall") };
    assert_eq!(from, Point2::new(1.0, 0.0));
}

#[test]
fn walls_on_one_another_are_one() {
    let twice = corners(&[&[(0.0, 0.0), (1.0, 0.0)], &[(0.0, 0.0), (2.0, 0.0)]]);
    assert!(answers(&twice, (0.0, 0.0), (-1.0, 0.5)) && answers(&twice, (2.0, 0.0), (3.0, 0.0)));
    assert!(!answers(&twice, (1.0, 0.0), (1.0, 1.0)));
}
