//! From lines to echoes: a ring of eight trigger/echo sensors on a robot that drives past a pole, fused as firmware would.
//!
//! The lines are simulated here, with a clock of their own; on a robot they are a board's pins and its timer, and the
//! body of the loop is what runs at an edge of an echo line and at the bank's deadline.

use std::{cell::Cell, convert::Infallible, f32::consts::PI, task::Poll};

use atm_core::{
    Beam, Bounds, Echo, Fuser, Isometry2, LatestArrays, Limits, Point2, RangeResolution, Reading, TransversalMedian,
    UnitComplex, Vector2,
};
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use hc_sr04::{Air, Bank, HcSr04, Turns};

const SENSORS: usize = 8;
const POLE: [f32; 2] = [1.0, 0.8];
const SPEED: f32 = 0.4;

/// cos and sin of the eight directions: on a robot a table like this one spares every sine.
const DIAGONAL: f32 = std::f32::consts::FRAC_1_SQRT_2;
const LOOKS: [[f32; 2]; SENSORS] = [
    [1.0, 0.0],
    [DIAGONAL, DIAGONAL],
    [0.0, 1.0],
    [-DIAGONAL, DIAGONAL],
    [-1.0, 0.0],
    [-DIAGONAL, -DIAGONAL],
    [0.0, -1.0],
    [DIAGONAL, -DIAGONAL],
];

/// Where the robot is: it drives along x.
fn robot(microseconds: u32) -> [f32; 2] {
    [microseconds as f32 * 1e-6 * SPEED, 0.0]
}

/// What sensor and pole do, seen from the two lines: 450 µs after the trigger the echo line rises, for the way there and
/// back if the pole is in the beam of 30°, else for 38 ms.
struct Wires<'a> {
    clock: &'a Cell<u32>,
    triggered: &'a Cell<u32>,
    look: [f32; 2],
}

impl ErrorType for Wires<'_> {
    type Error = Infallible;
}

impl OutputPin for Wires<'_> {
    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_low(&mut self) -> Result<(), Infallible> {
        self.triggered.set(self.clock.get());
        Ok(())
    }
}

impl InputPin for Wires<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        let start = self.triggered.get();
        let [x, y] = robot(start);
        let (dx, dy) = (POLE[0] - x, POLE[1] - y);
        let distance = dx.hypot(dy);
        let heard = dx * self.look[0] + dy * self.look[1] >= distance * (PI / 12.0).cos();
        let width = if heard { (distance * 2.0 / 343.2 * 1e6) as u32 } else { 38_000 };
        let since = self.clock.get().wrapping_sub(start);
        Ok(start != 0 && (450..450 + width).contains(&since))
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let clock = Cell::new(1);
    let triggered: [Cell<u32>; SENSORS] = std::array::from_fn(|_| Cell::new(0));
    let wires = |sensor: usize| Wires { clock: &clock, triggered: &triggered[sensor], look: LOOKS[sensor] };
    let mut bank =
        Bank::new(std::array::from_fn(|sensor| HcSr04::new(wires(sensor), wires(sensor))), Turns::<SENSORS>::new());

    let air = Air::at_celsius(20.0)?;
    let (beam, range_resolution) = (Beam::new(PI / 6.0)?, RangeResolution::new(0.003)?);
    let limits = Limits::new(0.02, 4.0)?;
    // In firmware this is a `static`.
    let mut fuser = Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, LatestArrays::<f32, SENSORS, 10>::new());

    while clock.get() < 5_000_000 {
        let now = clock.get();
        if let Poll::Ready((sensor, measurement)) = bank.poll(now)? {
            let (look, [x, y]) = (LOOKS[usize::from(sensor)], robot(now));
            let reading = Reading {
                t: i64::from(now) * 1000,
                sensor,
                range: limits.classify(measurement.range(&air)),
                pose: Isometry2::from_parts(
                    Vector2::new(x, y).into(),
                    UnitComplex::from_cos_sin_unchecked(look[0], look[1]),
                ),
                robot: Point2::new(x, y),
                beam,
                range_resolution,
            };
            fuser.push(&reading, &mut |echo: &Echo<f32>| {
                let kind = echo.kind.name();
                println!(
                    "{:.2} s  sensor {}  {kind:6}  ({:.2}, {:.2})",
                    now as f32 * 1e-6,
                    echo.sensor,
                    echo.position.x,
                    echo.position.y
                );
            })?;
        }
        clock.set(now + 20);
    }
    Ok(())
}
