use super::*;

fn at(x: f64, y: f64) -> Point2<f64> {
    Point2::new(x, y)
}

fn wall(from: (f64, f64), to: (f64, f64)) -> Shape {
    Shape::Segment { from: at(from.0, from.1), to: at(to.0, to.1) }
}

/// Whether these shapes block the line from (0, 0) to (4, 0).
fn blocked(shapes: &[Shape]) -> bool {
    let mut touched = Touched::default();
    shapes.iter().any(|shape| touched.block(shape.hit(at(0.0, 0.0), at(4.0, 0.0))))
}

#[test]
fn wall_across_blocks_and_one_beside_or_behind_does_not() {
    assert!(blocked(&[wall((2.0, -1.0), (3.0, 1.0))]));
    assert!(!blocked(&[wall((2.0, 0.5), (3.0, 1.0))]));
    assert!(!blocked(&[wall((5.0, -1.0), (5.0, 1.0))]));
    assert!(!blocked(&[wall((-1.0, -1.0), (-1.0, 1.0))]));
}

#[test]
fn end_that_only_touches_passes_and_touches_from_both_sides_block() {
    let (above, below) = (wall((2.0, 0.0), (2.0, 1.0)), wall((2.0, -1.0), (2.0, 0.0)));
    assert!(!blocked(&[above]) && !blocked(&[below]));
    assert!(blocked(&[above, below]), "a joint is tight");
    let tip = [wall((1.0, 1.0), (2.0, 0.0)), wall((2.0, 0.0), (3.0, 1.0))];
    assert!(!blocked(&tip), "an edge is passed");
}

#[test]
fn target_and_viewer_on_an_end_are_not_hidden_by_it() {
    assert!(!blocked(&[wall((4.0, 0.0), (4.0, 1.0)), wall((4.0, 0.0), (4.0, -1.0))]));
    assert!(!blocked(&[wall((4.0, -1.0), (4.0, 1.0))]), "a wall does not hide its own points");
}

#[test]
fn wall_along_the_line_passes() {
    assert!(!blocked(&[wall((1.0, 0.0), (3.0, 0.0))]));
}

#[test]
fn pole_blocks_within_its_radius_only() {
    let pole = |y: f64| Shape::Circle { center: at(2.0, y), radius: 0.5 };
    assert!(blocked(&[pole(0.0)]) && blocked(&[pole(-0.499)]));
    assert!(!blocked(&[pole(0.5)]), "its rim touches");
    assert!(blocked(&[Shape::Circle { center: at(4.0, 0.3), radius: 0.5 }]), "the target is inside");
    assert!(!blocked(&[Shape::Circle { center: at(5.0, 0.0), radius: 0.5 }]));
}

#[test]
fn clearance_is_the_smallest_distance_from_a_way() {
    let clearance = |shape: Shape| shape.clearance(at(0.0, 0.0), at(4.0, 0.0));
    assert_eq!(clearance(wall((2.0, -1.0), (2.0, 1.0))), 0.0);
    assert_eq!(clearance(wall((2.0, 0.0), (2.0, 1.0))), 0.0);
    assert_eq!(clearance(wall((1.0, 2.0), (3.0, 1.5))), 1.5);
    assert_eq!(clearance(wall((4.0, 3.0), (9.0, 3.0))), 3.0);
    assert_eq!(clearance(wall((7.0, 4.0), (9.0, 9.0))), 5.0);
    assert_eq!(clearance(Shape::Circle { center: at(2.0, 3.0), radius: 1.0 }), 2.0);
    assert_eq!(clearance(Shape::Circle { center: at(2.0, 0.5), radius: 1.0 }), 0.0);
}
