//! Whether headings fit the way the robot goes.

use std::f64::consts::{FRAC_PI_2, PI};

use super::diagnosis::HeadingForm;
use crate::track::Pose;

/// What a heading may be meant as, and how it then becomes radians, counter-clockwise from x.
type Form = (Option<HeadingForm>, fn(f64) -> f64);

/// Distance over which a direction of travel is taken, in metres.
const STEP: f64 = 0.05;
/// The way a heading may be written, each turned into radians counter-clockwise from x.
const FORMS: [Form; 6] = [
    (None, |yaw| yaw),
    (Some(HeadingForm::Degrees), f64::to_radians),
    (Some(HeadingForm::Clockwise), |yaw| -yaw),
    (Some(HeadingForm::DegreesClockwise), |yaw| -yaw.to_radians()),
    (Some(HeadingForm::Compass), |yaw| FRAC_PI_2 - yaw),
    (Some(HeadingForm::DegreesCompass), |yaw| FRAC_PI_2 - yaw.to_radians()),
];

/// Directions of travel against headings, however those may be meant.
#[derive(Debug, Clone, Default)]
pub(super) struct Headings {
    anchor: Option<Pose>,
    steps: u64,
    /// Sums of cos 2(direction − heading), by form: a robot that backs up fits as well as one that goes ahead.
    fits: [f64; FORMS.len()],
    /// Sums of cosine and sine of twice the direction of travel.
    course: [f64; 2],
    /// The largest heading as it is written, without its sign.
    largest: f64,
    /// The lowest and the highest heading.
    turned: Option<(f64, f64)>,
}

impl Headings {
    pub(super) fn add(&mut self, pose: Pose) {
        let Some(anchor) = self.anchor else {
            self.anchor = Some(pose);
            return;
        };
        let (dx, dy) = (pose.x - anchor.x, pose.y - anchor.y);
        if !(dx * dx + dy * dy >= STEP * STEP) {
            return;
        }
        self.anchor = Some(pose);
        let course = libm::atan2(dy, dx);
        self.steps += 1;
        for (fit, (_, form)) in self.fits.iter_mut().zip(FORMS) {
            *fit += 0.5 * (along(course - form(anchor.yaw)) + along(course - form(pose.yaw)));
        }
        let [cos, sin] = &mut self.course;
        *cos += along(course);
        *sin += libm::sin(2.0 * course);
        self.largest = self.largest.max(pose.yaw.abs());
        let (low, high) = self.turned.unwrap_or((pose.yaw, pose.yaw));
        self.turned = Some((low.min(pose.yaw), high.max(pose.yaw)));
    }

    /// Begins anew somewhere else: what was jumped over is no travel.
    pub(super) fn lift(&mut self) {
        self.anchor = None;
    }

    /// Steps that have a direction.
    pub(super) const fn steps(&self) -> u64 {
        self.steps
    }

    /// How well headings as they are fit the travel: 1 along it, −1 across, 0 at random.
    pub(super) fn as_is(&self) -> f64 {
        self.fits[0] / self.steps.max(1) as f64
    }

    /// The form that headings fit, where they fit none as they are, with how well it fits.
    ///
    /// A robot that moves sideways has headings that fit nothing. So what is said has to be told apart from that: by a
    /// heading no turn has, or by directions that change; and a straight drive that a form fits has to fit it closely.
    pub(super) fn misread(&self) -> Option<(HeadingForm, f64)> {
        const FEWEST: u64 = 10;
        if self.steps < FEWEST || self.as_is() > 0.5 {
            return None;
        }
        let mean = |sum: f64| sum / self.steps as f64;
        let forms = self.fits.iter().zip(FORMS).filter_map(|(fit, (form, _))| Some((form?, mean(*fit))));
        let (form, fit) = forms.max_by(|a, b| a.1.total_cmp(&b.1))?;
        // 1 where all directions are one.
        let straight = mean(self.course[0]).hypot(mean(self.course[1]));
        let turns = self.turned.is_some_and(|(low, high)| high - low > 0.3) && straight < 0.9;
        let least = match form {
            _ if turns => 0.9,
            HeadingForm::Degrees | HeadingForm::DegreesClockwise if self.largest > 2.0 * PI => 0.97,
            HeadingForm::Clockwise => 0.995,
            // A heading that stays may be that of a robot that moves sideways.
            _ => return None,
        };
        (fit >= least).then_some((form, fit))
    }
}

/// 1 along an axis, either way; −1 across it.
fn along(angle: f64) -> f64 {
    libm::cos(2.0 * angle)
}
