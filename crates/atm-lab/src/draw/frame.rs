//! What part of the plane a picture shows.
use nalgebra::Point2;

/// Coordinates beyond this, in metres, are never shown: neighbouring numbers are an eighth of a metre apart there.
const FARTHEST: f64 = 1e15;
/// Share of the points, on each side of each axis, that may lie so far off that the picture leaves them out.
const STRAY: f64 = 0.02;
/// How far off that is: this many times the stretch that holds the others.
const FAR: f64 = 1.0;
/// Fewer points than this are all shown: none can be called stray.
const FEW: usize = 8;
/// Smallest side of a frame that is found automatically, in metres.
const SMALLEST: f64 = 1.0;
/// Height of a frame of which only the width is asked for, in parts of the width.
const HEIGHT: f64 = 0.6;
/// Room around what is shown, in parts of the longer side.
const ROOM: f64 = 0.05;

/// A rectangle of the plane, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    min: Point2<f64>,
    max: Point2<f64>,
}

impl Frame {
    /// What is shown where there is nothing to show.
    pub(super) const EMPTY: Self = Self { min: Point2::new(-1.0, -0.5), max: Point2::new(1.0, 0.5) };

    /// The rectangle between two opposite corners; `None` where it has no area, or a corner is not finite or beyond 1e15 m.
    pub fn new(a: Point2<f64>, b: Point2<f64>) -> Option<Self> {
        let (min, max) = (Point2::new(a.x.min(b.x), a.y.min(b.y)), Point2::new(a.x.max(b.x), a.y.max(b.y)));
        let near = [a.x, a.y, b.x, b.y].iter().all(|value| value.abs() <= FARTHEST);
        (near && max.x > min.x && max.y > min.y).then_some(Self { min, max })
    }

    /// The frame about a middle that is so wide, in metres, and three fifths as high. `None` as for [`Frame::new`].
    pub fn about(center: Point2<f64>, width: f64) -> Option<Self> {
        let half = nalgebra::Vector2::new(width / 2.0, width / 2.0 * HEIGHT);
        Self::new(center - half, center + half).filter(|_| width > 0.0)
    }

    /// The frame that shows `points`, all but the few that lie far away from the rest; `None` without any.
    ///
    /// On each axis, the stretch that holds all but 2 % of the points at either end is found, and extended by its length at
    /// both ends; every point within it is shown. Fewer than eight points are all shown.
    pub fn around(points: &[Point2<f64>]) -> Option<Self> {
        let near = |point: &&Point2<f64>| point.x.abs() <= FARTHEST && point.y.abs() <= FARTHEST;
        let near: Vec<Point2<f64>> = points.iter().filter(near).copied().collect();
        let x = stretch(near.iter().map(|point| point.x).collect())?;
        let y = stretch(near.iter().map(|point| point.y).collect())?;
        let shown = near.iter().filter(|point| within(point.x, x) && within(point.y, y));
        let mut frame: Option<Self> = None;
        for point in shown {
            let before = frame.unwrap_or(Self { min: *point, max: *point });
            frame = Some(before.with(*point));
        }
        Some(frame?.padded())
    }

    fn with(self, point: Point2<f64>) -> Self {
        Self {
            min: Point2::new(self.min.x.min(point.x), self.min.y.min(point.y)),
            max: Point2::new(self.max.x.max(point.x), self.max.y.max(point.y)),
        }
    }

    fn padded(self) -> Self {
        let room = ROOM * self.width().max(self.height()).max(SMALLEST);
        let (width, height) = ((self.width() + 2.0 * room).max(SMALLEST), (self.height() + 2.0 * room).max(SMALLEST));
        self.resized(width, height)
    }

    /// The frame of this size about the same centre.
    fn resized(self, width: f64, height: f64) -> Self {
        let center = self.center();
        let half = nalgebra::Vector2::new(width / 2.0, height / 2.0);
        Self { min: center - half, max: center + half }
    }

    /// The smallest frame about the same centre that holds this one and is `aspect` times as wide as high.
    pub(super) fn with_aspect(self, aspect: f64) -> Self {
        let width = self.width().max(self.height() * aspect);
        self.resized(width, width / aspect)
    }

    /// Width in metres.
    pub fn width(&self) -> f64 {
        self.max.x - self.min.x
    }

    /// Height in metres.
    pub fn height(&self) -> f64 {
        self.max.y - self.min.y
    }

    /// The middle.
    pub fn center(&self) -> Point2<f64> {
        Point2::new(f64::midpoint(self.min.x, self.max.x), f64::midpoint(self.min.y, self.max.y))
    }

    /// The lower left corner.
    pub fn min(&self) -> Point2<f64> {
        self.min
    }

    /// The upper right corner.
    pub fn max(&self) -> Point2<f64> {
        self.max
    }

    /// Whether it holds the point, its border included.
    pub fn holds(&self, point: Point2<f64>) -> bool {
        within(point.x, (self.min.x, self.max.x)) && within(point.y, (self.min.y, self.max.y))
    }

    /// The part of the straight line from `a` to `b` that lies within; `None` where nothing does (Liang and Barsky 1984).
    pub(super) fn clip(&self, a: Point2<f64>, b: Point2<f64>) -> Option<(Point2<f64>, Point2<f64>)> {
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let (from, step) = (a[axis], b[axis] - a[axis]);
            for (side, sign) in [(self.min[axis], -1.0), (self.max[axis], 1.0)] {
                let (room, speed) = (sign * (side - from), sign * step);
                if speed == 0.0 && room < 0.0 {
                    return None;
                } else if speed < 0.0 {
                    enter = enter.max(room / speed);
                } else if speed > 0.0 {
                    leave = leave.min(room / speed);
                }
            }
        }
        let at = |share: f64| a + (b - a) * share;
        (enter <= leave).then(|| (at(enter), at(leave)))
    }
}

fn within(value: f64, (low, high): (f64, f64)) -> bool {
    low <= value && value <= high
}

/// The stretch outside of which a value is far away from the rest.
fn stretch(mut values: Vec<f64>) -> Option<(f64, f64)> {
    values.sort_by(f64::total_cmp);
    let (first, last) = (*values.first()?, *values.last()?);
    if values.len() < FEW {
        return Some((first, last));
    }
    let stray = ((values.len() - 1) as f64 * STRAY).ceil() as usize;
    let (low, high) = (*values.get(stray)?, *values.get(values.len() - 1 - stray)?);
    // Where nearly all have one value, a metre is a stretch.
    let far = FAR * (high - low).max(SMALLEST);
    Some((low - far, high + far))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> Point2<f64> {
        Point2::new(x, y)
    }

    fn row(count: u32) -> Vec<Point2<f64>> {
        (0..count).map(|i| point(f64::from(i) * 0.1, 2.0)).collect()
    }

    #[test]
    fn a_few_points_far_away_do_not_shrink_the_rest() {
        let mut points = row(200);
        let plain = Frame::around(&points).unwrap();
        points.extend([point(1e12, 0.0), point(0.0, -5e9), point(900.0, 2.0), point(f64::NAN, 0.0)]);
        assert_eq!(Frame::around(&points).unwrap(), plain);
        assert!(plain.holds(point(0.0, 2.0)) && plain.holds(point(19.9, 2.0)) && plain.width() < 23.0);
    }

    #[test]
    fn all_of_a_few_points_are_shown() {
        let points = [point(0.0, 0.0), point(1.0, 1.0), point(1000.0, -3.0)];
        let frame = Frame::around(&points).unwrap();
        assert!(points.iter().all(|point| frame.holds(*point)));
    }

    #[test]
    fn one_point_has_a_metre_around_it_wherever_it_is() {
        for at in [0.0, 5e5, 1e12] {
            let frame = Frame::around(&[point(at, -at)]).unwrap();
            assert_eq!(frame.center(), point(at, -at));
            assert!(frame.width() >= 1.0 && frame.width() < 1.5, "{frame:?}");
        }
    }

    #[test]
    fn nothing_and_nonsense_have_no_frame() {
        assert_eq!(Frame::around(&[]), None);
        assert_eq!(Frame::around(&[point(f64::NAN, 0.0), point(1e300, 0.0), point(f64::INFINITY, 1.0)]), None);
        assert_eq!(Frame::new(point(0.0, 0.0), point(1.0, 0.0)), None);
        assert_eq!(Frame::new(point(0.0, f64::NAN), point(1.0, 1.0)), None);
        assert!(Frame::new(point(2.0, 3.0), point(0.0, 0.0)).unwrap().holds(point(1.0, 1.0)));
    }

    #[test]
    fn lines_are_cut_at_the_border() {
        let frame = Frame::new(point(0.0, 0.0), point(4.0, 2.0)).unwrap();
        assert_eq!(frame.clip(point(-4.0, 1.0), point(1e9, 1.0)), Some((point(0.0, 1.0), point(4.0, 1.0))));
        assert_eq!(frame.clip(point(1.0, 1.0), point(1.0, 9.0)), Some((point(1.0, 1.0), point(1.0, 2.0))));
        assert_eq!(frame.clip(point(-1.0, 3.0), point(9.0, 3.0)), None);
        assert_eq!(frame.clip(point(-2.0, 1.0), point(1.0, 4.0)), None);
        assert_eq!(frame.clip(point(1.0, 1.0), point(2.0, 1.5)), Some((point(1.0, 1.0), point(2.0, 1.5))));
    }

    #[test]
    fn an_aspect_is_reached_by_adding_only() {
        let frame = Frame::new(point(0.0, 0.0), point(4.0, 2.0)).unwrap();
        let wide = frame.with_aspect(4.0);
        assert!((wide.width() - 8.0).abs() < 1e-12 && (wide.height() - 2.0).abs() < 1e-12);
        let high = frame.with_aspect(0.5);
        assert!((high.width() - 4.0).abs() < 1e-12 && (high.height() - 8.0).abs() < 1e-12);
    }
}
