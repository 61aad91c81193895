//! How sharp an echo is, what that costs in travel, and the inverse: equation (2) both ways (Sec. IV-B and IV-D).

use crate::{
    crossing::MinAngle,
    error::DomainError,
    scalar::Scalar,
    sensor::{Beam, RangeResolution},
};

/// Length along the arc in which an echo found by crossings at θmin lies: L = δ (1/sin θ + 1/tan θ) = δ cot(θ/2), in
/// metres (Sec. IV-B). 1 in at 30° gives 3.73 in.
pub fn interval<T: Scalar>(resolution: RangeResolution<T>, min_angle: &MinAngle<T>) -> T {
    resolution.metres() * min_angle.cot_half()
}

/// How many times finer than the whole arc that is at a distance: n = d φ / L, equation (2). 10.5 at 100 in.
///
/// `distance` in metres, positive. Below 1 the arc is short enough as it is.
pub fn improvement<T: Scalar>(
    distance: T,
    beam: &Beam<T>,
    resolution: RangeResolution<T>,
    min_angle: &MinAngle<T>,
) -> Result<T, DomainError> {
    Ok(positive(distance)? * beam.field_of_view() / interval(resolution, min_angle))
}

/// The angle that gives a wanted improvement at a distance: θmin = 2 atan(n δ / (d φ)), the paper's improvement as an
/// input (Sec. VI). 28.57° for 10 at 100 in.
///
/// `distance` in metres, positive; 0 < `improvement` ≤ d φ / δ, and the angle in \[1°, 90°\].
pub fn min_angle_for<T: Scalar>(
    improvement: T,
    distance: T,
    beam: &Beam<T>,
    resolution: RangeResolution<T>,
) -> Result<MinAngle<T>, DomainError> {
    let arc_length = positive(distance)? * beam.field_of_view();
    let wanted = improvement * resolution.metres();
    if !(wanted > T::ZERO && wanted <= arc_length) {
        return Err(DomainError::Improvement);
    }
    MinAngle::new(T::TWO * wanted.arc_tangent_2(arc_length))
}

/// The range up to which an arc is no longer than the interval, so that its centre is as good as any crossing:
/// r = L / φ, in metres (Sec. IV-B). 9.50 in with the paper's sensor.
pub fn close_range<T: Scalar>(beam: &Beam<T>, resolution: RangeResolution<T>, min_angle: &MinAngle<T>) -> T {
    interval(resolution, min_angle) / beam.field_of_view()
}

/// The straight travel after which arcs on a point at a distance cross at θmin: 2 d sin(θ/2), in metres (Sec. IV-D).
///
/// 51.76 in at 100 in; the paper rounds to 50.
pub fn travel<T: Scalar>(distance: T, min_angle: &MinAngle<T>) -> Result<T, DomainError> {
    let (half_sine, _) = (min_angle.radians() / T::TWO).sine_cosine();
    Ok(T::TWO * positive(distance)? * half_sine)
}

/// How many readings of one sensor that travel takes: ceil(travel / (speed / rate)) + 1, the first one included
/// (Sec. IV-D). 12 at 100 in, 5 in/s and 1 Hz, where the paper's rounding gives ten.
///
/// `travel` in metres, `speed` in m/s, `rate` in Hz; all positive.
pub fn readings_needed<T: Scalar>(travel: T, speed: T, rate: T) -> Result<u32, DomainError> {
    let step = step(speed, rate)?;
    // A whole number of steps must not become one more by rounding in the last place: a micrometre is no travel.
    let slack = T::ONE / T::MICROMETRES;
    Ok(((positive(travel)? - slack) / step).round_up().to_count().saturating_add(1))
}

/// How far away arcs of one sensor still cross at θmin when the local map holds `history` of its readings:
/// (H − 1) · speed / rate / (2 sin(θ/2)), in metres. H = 10 reaches 87 in at 5 in/s and 1 Hz.
pub fn reach<T: Scalar>(history: u32, speed: T, rate: T, min_angle: &MinAngle<T>) -> Result<T, DomainError> {
    let travel = T::from_count(history.saturating_sub(1)) * step(speed, rate)?;
    let (half_sine, _) = (min_angle.radians() / T::TWO).sine_cosine();
    Ok(travel / (T::TWO * half_sine))
}

fn step<T: Scalar>(speed: T, rate: T) -> Result<T, DomainError> {
    if !(speed > T::ZERO && speed.finite()) {
        return Err(DomainError::Speed);
    }
    if !(rate > T::ZERO && rate.finite()) {
        return Err(DomainError::Rate);
    }
    Ok(speed / rate)
}

fn positive<T: Scalar>(distance: T) -> Result<T, DomainError> {
    if distance > T::ZERO && distance.finite() { Ok(distance) } else { Err(DomainError::Distance) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INCH: f64 = 0.0254;

    fn polaroid() -> (Beam<f64>, RangeResolution<f64>) {
        (Beam::new(22.5f64.to_radians()).unwrap(), RangeResolution::new(INCH).unwrap())
    }

    fn near(actual: f64, expected: f64, tolerance: f64) {
        assert!((actual - expected).abs() <= tolerance, "{actual} is not {expected}");
    }

    #[test]
    fn paper_interval_is_3_732_inches() {
        near(interval(polaroid().1, &MinAngle::PAPER) / INCH, 3.732, 5e-4);
    }

    #[test]
    fn paper_improvement_at_100_inches_is_10_52() {
        let (beam, resolution) = polaroid();
        near(improvement(100.0 * INCH, &beam, resolution, &MinAngle::PAPER).unwrap(), 10.52, 5e-3);
    }

    #[test]
    fn tenfold_improvement_at_100_inches_needs_28_57_degrees() {
        let (beam, resolution) = polaroid();
        let angle = min_angle_for(10.0, 100.0 * INCH, &beam, resolution).unwrap();
        near(angle.radians().to_degrees(), 28.57, 5e-3);
        near(improvement(100.0 * INCH, &beam, resolution, &angle).unwrap(), 10.0, 1e-12);
    }

    #[test]
    fn improvement_is_bounded_by_the_arc_in_steps_of_the_range_resolution() {
        let (beam, resolution) = polaroid();
        let most = 100.0 * 22.5f64.to_radians();
        near(
            min_angle_for(most * (1.0 - 1e-12), 100.0 * INCH, &beam, resolution).unwrap().radians().to_degrees(),
            90.0,
            1e-9,
        );
        assert_eq!(min_angle_for(most * 1.001, 100.0 * INCH, &beam, resolution), Err(DomainError::Improvement));
        assert_eq!(min_angle_for(0.0, 100.0 * INCH, &beam, resolution), Err(DomainError::Improvement));
        assert_eq!(min_angle_for(1.0, f64::NAN, &beam, resolution), Err(DomainError::Distance));
    }

    #[test]
    fn paper_close_range_is_9_50_inches() {
        let (beam, resolution) = polaroid();
        near(close_range(&beam, resolution, &MinAngle::PAPER) / INCH, 9.50, 5e-3);
    }

    #[test]
    fn paper_travel_is_51_76_inches_and_12_readings() {
        let length = travel(100.0 * INCH, &MinAngle::<f64>::PAPER).unwrap();
        near(length / INCH, 51.76, 5e-3);
        assert_eq!(readings_needed(length, 5.0 * INCH, 1.0), Ok(12));
        near(reach(10, 5.0 * INCH, 1.0, &MinAngle::PAPER).unwrap() / INCH, 86.93, 5e-3);
    }

    #[test]
    fn whole_number_of_steps_takes_one_reading_more() {
        assert_eq!(readings_needed(1.0f64, 0.1, 1.0), Ok(11));
        assert_eq!(readings_needed(1.0f64, 0.0, 1.0), Err(DomainError::Speed));
        assert_eq!(readings_needed(1.0f64, 0.1, f64::NAN), Err(DomainError::Rate));
    }
}
