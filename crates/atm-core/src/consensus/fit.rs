//! Joint least squares of a reflector over the readings that agree with it, and the information that they hold.

use nalgebra::{Point2, Vector2};

use super::{
    poll::{votes_for_point, votes_for_wall},
    witness::{Tolerance, Vote, Witness},
};
use crate::{
    arc::{cross, dot},
    scalar::Scalar,
};

/// What is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Point = 0,
    Wall = 1,
}

/// A reflector as seen from the sensor of the arc that is reported: in a direction, at a distance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place<T: Scalar> {
    pub sensor: Point2<T>,
    /// A unit vector; for a wall its normal, away from the sensor.
    pub direction: Vector2<T>,
    pub distance: T,
    /// Of a point that is a round thing; 0 for a sharp one, and for a wall.
    pub radius: T,
}

impl<T: Scalar> Place<T> {
    /// Where the sensor hears it.
    pub fn position(&self) -> Point2<T> {
        self.sensor + self.direction * self.distance
    }

    fn center(&self) -> Point2<T> {
        self.sensor + self.direction * (self.distance + self.radius)
    }
}

/// How a witness's range changes with a shift of the echo along its own ray and across it, and with the radius of what
/// stands there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slopes<T> {
    along: T,
    across: T,
    radius: T,
}

/// Normal equations for the two shifts and the radius, in metres; every range weighs 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Information<T> {
    along: T,
    both: T,
    across: T,
    pull: [T; 2],
    radius: T,
    /// Of the radius with either shift.
    mixed: [T; 2],
    radius_pull: T,
    /// Agreeing readings.
    pub support: u32,
}

impl<T: Scalar> Information<T> {
    /// Of the arc's own reading, which says nothing across its ray, and of what is known beforehand of a radius.
    fn own(residual: T, radius: T, weight: T) -> Self {
        Self {
            along: T::ONE,
            both: T::ZERO,
            across: T::ZERO,
            pull: [residual, T::ZERO],
            radius: weight,
            mixed: [T::ZERO; 2],
            radius_pull: -radius * weight,
            support: 0,
        }
    }

    fn add(&mut self, slopes: &Slopes<T>, residual: T) {
        let Slopes { along, across, radius } = *slopes;
        self.along += along * along;
        self.both += along * across;
        self.across += across * across;
        self.pull[0] += along * residual;
        self.pull[1] += across * residual;
        self.radius += radius * radius;
        self.mixed[0] += radius * along;
        self.mixed[1] += radius * across;
        self.radius_pull += radius * residual;
        self.support += 1;
    }

    /// The equations of the shifts alone, the radius being whatever suits them best.
    fn without_radius(&self) -> Self {
        let [along, across] = self.mixed;
        Self {
            along: self.along - along * along / self.radius,
            both: self.both - along * across / self.radius,
            across: self.across - across * across / self.radius,
            pull: [
                self.pull[0] - along * self.radius_pull / self.radius,
                self.pull[1] - across * self.radius_pull / self.radius,
            ],
            ..*self
        }
    }

    fn determinant(&self) -> T {
        self.along * self.across - self.both * self.both
    }

    /// Variances along the ray and across it, for ranges of variance 1.
    pub fn variances(&self) -> [T; 2] {
        let shifts = self.without_radius();
        let determinant = shifts.determinant();
        [shifts.across / determinant, shifts.along / determinant]
    }

    fn shift(&self) -> [T; 2] {
        let determinant = self.determinant();
        let [along, across] = self.pull;
        [
            (self.across * along - self.both * across) / determinant,
            (self.along * across - self.both * along) / determinant,
        ]
    }

    /// The best shifts and radius; the shifts that go with no radius where it would become negative.
    fn solution(&self, radius: T) -> ([T; 2], T) {
        let [along, across] = self.without_radius().shift();
        let change = (self.radius_pull - self.mixed[0] * along - self.mixed[1] * across) / self.radius;
        if radius + change > T::ZERO {
            return ([along, across], radius + change);
        }
        let fixed = |place: usize| {
            let mixed = self.mixed.get(place).copied().unwrap_or(T::ZERO);
            self.pull.get(place).copied().unwrap_or(T::ZERO) + mixed * radius
        };
        (Self { pull: [fixed(0), fixed(1)], ..*self }.shift(), T::ZERO)
    }
}

/// One arc, and where its reflector is supposed to be.
pub(super) struct Fit<T: Scalar> {
    pub shape: Shape,
    pub place: Place<T>,
    /// The reading.
    pub range: T,
    /// Along a wall, how far from the echo its witnesses may stand.
    pub window: T,
    /// How much is known beforehand of a radius: the variance of a range over its own.
    pub radius_weight: T,
}

impl<T: Scalar> Fit<T> {
    /// A witness's word, and how its range changes with what is fitted.
    pub fn ask(&self, witness: &Witness<T>, tolerance: &Tolerance<T>) -> (Vote<T>, Slopes<T>) {
        let Place { sensor, direction, distance, radius } = self.place;
        match self.shape {
            Shape::Point => {
                let offset = self.place.center() - witness.sensor;
                let ray = offset / dot(offset, offset).square_root();
                let along = dot(ray, direction);
                let across = cross(direction, ray) * (T::ONE + radius / distance);
                let vote = witness.on_round(self.place.center(), radius, tolerance);
                (vote, Slopes { along, across, radius: along - T::ONE })
            }
            Shape::Wall => {
                let (vote, _) = witness.on_wall(self.place.position(), direction, self.window, tolerance);
                let across = cross(direction, sensor - witness.sensor) / distance;
                (vote, Slopes { along: T::ONE, across, radius: T::ZERO })
            }
        }
    }

    /// The votes of an agreeing witness with these slopes.
    pub fn votes(&self, slopes: &Slopes<T>) -> i32 {
        match self.shape {
            Shape::Point => votes_for_point(slopes.across * slopes.across),
            Shape::Wall => {
                let offset = slopes.across * self.place.distance;
                votes_for_wall(offset * offset)
            }
        }
    }

    /// One step of Gauss and Newton, at most `limit` in either direction. What it rests on; `None` where that says nothing
    /// across the ray, or has the reflector behind the sensor.
    pub fn step(
        &mut self,
        witnesses: impl Iterator<Item = Witness<T>>,
        tolerance: &Tolerance<T>,
        limit: T,
    ) -> Option<Information<T>> {
        let Place { direction, distance, radius, .. } = self.place;
        let mut information = Information::own(self.range - distance, radius, self.radius_weight);
        for witness in witnesses {
            if let (Vote::For(residual), slopes) = self.ask(&witness, tolerance) {
                information.add(&slopes, residual);
            }
        }
        if !(information.without_radius().determinant() > T::ZERO) {
            return None;
        }
        let (shift, radius) = information.solution(radius);
        let [along, across] = shift.map(|x| {
            if x > limit {
                limit
            } else if x < -limit {
                -limit
            } else {
                x
            }
        });
        if !(distance + along > T::ZERO) {
            return None;
        }
        let turned = direction * distance + Vector2::new(-direction.y, direction.x) * across;
        self.place.direction = turned / dot(turned, turned).square_root();
        self.place.distance = distance + along;
        self.place.radius = radius;
        Some(information)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: Tolerance<f64> = Tolerance { agree: 0.2, beyond: 0.3 };

    /// A fit from the origin, supposed straight up at 2 m.
    fn fit(shape: Shape) -> Fit<f64> {
        let place = Place { sensor: Point2::origin(), direction: Vector2::new(0.0, 1.0), distance: 2.0, radius: 0.0 };
        // As good as no radius.
        Fit { shape, place, range: 2.0, window: 0.9, radius_weight: 1e12 }
    }

    #[test]
    fn witness_at_a_right_angle_knows_the_azimuth_as_well_as_the_reading_its_range() {
        let mut fit = fit(Shape::Point);
        // From (2, 2) to the left, 0.1 m nearer than supposed.
        let witness = Witness::looking(Point2::new(2.0, 2.0), 180.0, 1.9);
        let information = fit.step([witness].into_iter(), &WIDE, 1.0).unwrap();
        let [along, across] = information.variances();
        assert!((along - 1.0).abs() < 1e-9 && (across - 1.0).abs() < 1e-9, "{along} {across}");
        assert!((fit.place.position() - Point2::new(0.1, 2.0)).norm() < 0.003, "{}", fit.place.position());
    }

    #[test]
    fn witness_from_the_same_place_knows_nothing_of_the_azimuth() {
        let witness = Witness::looking(Point2::origin(), 90.0, 2.0);
        assert!(fit(Shape::Point).step([witness].into_iter(), &WIDE, 1.0).is_none());
        assert!(fit(Shape::Wall).step([witness].into_iter(), &WIDE, 1.0).is_none());
    }

    #[test]
    fn walls_normal_is_as_sure_as_a_straight_line_through_its_feet() {
        let mut fit = fit(Shape::Wall);
        let witnesses = [-0.5, 0.5].map(|x| Witness::looking(Point2::new(x, 0.0), 90.0, 2.0));
        let [along, across] = fit.step(witnesses.into_iter(), &WIDE, 1.0).unwrap().variances();
        // The slope of a regression has variance 1/Σx² = 2, its mean 1/n; 2 m of lever make 2² · 2 across.
        assert!((along - 1.0 / 3.0).abs() < 1e-12 && (across - 8.0).abs() < 1e-9, "{along} {across}");
        assert!((fit.place.direction - Vector2::new(0.0, 1.0)).norm() < 1e-12);
    }

    #[test]
    fn slanted_wall_is_found_from_a_straight_guess() {
        let mut fit = fit(Shape::Wall);
        let normal = Vector2::new(-(0.1f64.sin()), 0.1f64.cos());
        let distance = |x: f64| 2.0 - dot(normal, Vector2::new(x, 0.0));
        fit.range = distance(0.0);
        for _ in 0..4 {
            let witnesses = [-0.6, -0.3, 0.4].map(|x| Witness::looking(Point2::new(x, 0.0), 90.0, distance(x)));
            fit.step(witnesses.into_iter(), &WIDE, 1.0).unwrap();
        }
        assert!((fit.place.direction - normal).norm() < 1e-6, "{}", fit.place.direction);
        assert!((fit.place.distance - 2.0).abs() < 1e-6);
    }

    #[test]
    fn radius_of_a_pole_is_found_from_either_side() {
        let mut fit = Fit { radius_weight: 1e-9, ..fit(Shape::Point) };
        // A pole of 0.1 m about (0.05, 2.1).
        let distance = |x: f64, y: f64| (0.05 - x).hypot(2.1 - y) - 0.1;
        fit.range = distance(0.0, 0.0);
        for _ in 0..6 {
            let witnesses = [(-2.0, 2.0, 0.0), (2.0, 2.2, 180.0), (-1.5, 0.5, 45.0)];
            let witnesses = witnesses.map(|(x, y, yaw)| Witness::looking(Point2::new(x, y), yaw, distance(x, y)));
            fit.step(witnesses.into_iter(), &WIDE, 1.0).unwrap();
        }
        assert!((fit.place.radius - 0.1).abs() < 1e-6, "{}", fit.place.radius);
        assert!((fit.place.center() - Point2::new(0.05, 2.1)).norm() < 1e-6);
    }

    #[test]
    fn what_would_have_a_negative_radius_is_a_point() {
        let mut fit = Fit { radius_weight: 0.01, ..fit(Shape::Point) };
        // Both sides hear it nearer than the point is, which only a hollow could explain.
        for _ in 0..4 {
            let witnesses =
                [(-2.0, 0.0), (2.0, 180.0)].map(|(x, yaw)| Witness::looking(Point2::new(x, 2.0), yaw, 2.05));
            fit.step(witnesses.into_iter(), &WIDE, 1.0).unwrap();
        }
        assert_eq!(fit.place.radius, 0.0);
        assert!((fit.place.position() - Point2::new(0.0, 2.0)).norm() < 1e-9, "{}", fit.place.position());
    }

    #[test]
    fn nothing_is_found_behind_the_sensor() {
        // Steps of the range that are larger than the range: all say that it is 1 m nearer, and it is half a metre away.
        let mut fit = fit(Shape::Wall);
        (fit.place.distance, fit.range) = (0.5, 0.5);
        let witnesses = [-0.5, 0.5].map(|x| Witness::looking(Point2::new(x, 0.0), 90.0, -2.0));
        let tolerance = Tolerance { agree: 4.0, beyond: 6.0 };
        assert!(fit.step(witnesses.into_iter(), &tolerance, 4.0).is_none());
    }

    #[test]
    fn step_is_no_longer_than_its_limit() {
        let mut fit = fit(Shape::Point);
        let witness = Witness::looking(Point2::new(2.0, 2.0), 180.0, 1.9);
        fit.step([witness].into_iter(), &WIDE, 0.01).unwrap();
        assert!((fit.place.position().x - 0.01).abs() < 1e-4);
    }
}
