//! Fuses readings that the compiler knows nothing of, in both modes and both precisions, where there is no std, no
//! allocator, and no way to panic: the panic handler calls a function that does not exist, so a panic path that is left
//! in the program fails its link.
#![no_std]
#![no_main]

use core::{hint::black_box, panic::PanicInfo};

use atm_core::*;

// Only for the start of the program; a microcontroller brings its own.
#[link(name = "c")]
unsafe extern "C" {
    fn a_panic_path_is_left() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    unsafe { a_panic_path_is_left() }
}

static mut LATEST: Fuser<f32, LatestArrays<f32, 16, 10>> =
    Fuser::latest(TransversalMedian::PAPER, Bounds::NONE, LatestArrays::new());
static mut SETTLED: Fuser<f64, Arrays<f64, 4, 10, 5>> =
    Fuser::settled(TransversalMedian::PAPER, Bounds::NONE, Arrays::new());

fn reading<T: Scalar>(t: i64, sensor: u16, bits: T) -> Option<Reading<T>> {
    let heading = UnitComplex::from_cos_sin_unchecked(bits, bits);
    Some(Reading {
        t,
        sensor,
        range: Limits::NONE.classify(bits),
        pose: Isometry2::from_parts(Vector2::new(bits, bits).into(), heading),
        robot: Point2::new(bits, bits),
        beam: Beam::new(bits).ok()?,
        range_resolution: RangeResolution::new(bits).ok()?,
    })
}

fn take<T: Scalar>(echo: &Echo<T>) {
    black_box((echo.kind, echo.position, echo.bearing, echo.crossings, echo.resolution));
}

#[unsafe(no_mangle)]
extern "C" fn main() -> i32 {
    // One thread, and nobody else knows of them.
    let (latest, settled) = unsafe { (&mut *&raw mut LATEST, &mut *&raw mut SETTLED) };
    let mut single = take::<f32>;
    for t in 0..black_box(100) {
        if let Some(reading) = reading(t, black_box(3), black_box(1.5f32)) {
            let _ = black_box(latest.push(&reading, &mut single));
        }
    }
    latest.finish(&mut single);
    let mut double = take::<f64>;
    for t in 0..black_box(100) {
        if let Some(reading) = reading(t, black_box(3), black_box(1.5f64)) {
            let _ = black_box(settled.push(&reading, &mut double));
        }
        settled.snapshot(&mut double);
    }
    settled.finish(&mut double);
    0
}
