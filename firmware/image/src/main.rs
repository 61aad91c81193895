//! A firmware image that replays a recorded log through the fuser as a robot's firmware would run it: the fuser is a
//! `static`, every number is single precision, nothing allocates, and nothing can panic. Prints what became of every
//! reading, and what it cost.
#![no_std]
#![no_main]

mod clock;
mod semihosting;
mod stack;

use core::panic::PanicInfo;

use atm_core::{Bounds, DomainError, Estimator, Fuser};
use replay::{Adversary, Event, Faults, Line, Log, Outcome, Ring, Store32};

use crate::{
    chosen::{Chosen, ESTIMATOR},
    clock::Clock,
    semihosting::Console,
};

/// The recorded log; `firmware/test` has it made.
static LOG: &[u8] = include_bytes!(env!("REPLAY_LOG"));

/// Who says where echoes came from: the median, or the consensus.
mod chosen {
    #[cfg(feature = "consensus")]
    pub type Chosen = atm_core::Consensus<f32>;
    #[cfg(feature = "consensus")]
    pub const ESTIMATOR: Chosen = Chosen::new(atm_core::MinAngle::PAPER);

    #[cfg(not(feature = "consensus"))]
    pub type Chosen = atm_core::TransversalMedian<f32>;
    #[cfg(not(feature = "consensus"))]
    pub const ESTIMATOR: Chosen = Chosen::PAPER;
}

type ChosenFuser = replay::Fuser32<Chosen>;
type ChosenEcho = <Chosen as Estimator<f32>>::Echo;

static mut FUSER: ChosenFuser = Fuser::latest(ESTIMATOR, Bounds::NONE, Store32::new());

unsafe extern "C" {
    fn a_panic_path_is_left() -> !;
}

/// Links only if nothing calls it: the function it calls does not exist.
#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    // SAFETY: never linked, so never called.
    unsafe { a_panic_path_is_left() }
}

/// The fuser's part: all that runs for one reading, from what the driver hands over to the echo.
///
/// A function of its own under its own name, so that its size can be told from the rest of the image's.
#[unsafe(no_mangle)]
#[inline(never)]
fn fuse_reading(fuser: &mut ChosenFuser, ring: &Ring<f32>, event: &Event<f32>, outcome: &mut Outcome<ChosenEcho>) {
    replay::fuse(fuser, ring, event, outcome);
}

/// Replays runs of readings, each through the same fuser, and adds up what they cost.
struct Bench {
    fuser: &'static mut ChosenFuser,
    clock: Clock,
    console: Console,
}

impl Bench {
    /// Fuses the readings of a run, prints what became of each and what the run cost.
    #[inline(never)]
    fn run(&mut self, run: &str, ring: &Ring<f32>, event: &mut dyn FnMut(u32) -> Option<Event<f32>>) {
        let (mut readings, mut worst, mut total) = (0u32, 0u32, 0u64);
        let mut outcome = Outcome::NONE;
        while let Some(event) = event(readings) {
            let start = self.clock.read();
            fuse_reading(self.fuser, ring, &event, &mut outcome);
            let cost = Clock::instructions_since(start, self.clock.read());
            worst = worst.max(cost);
            total = total.wrapping_add(u64::from(cost));
            self.print(run, readings, &outcome);
            readings = readings.wrapping_add(1);
        }
        // In `latest` that empties the local map and reports nothing.
        self.fuser.finish(&mut |_: &ChosenEcho| {});
        self.figure(run, "readings", readings);
        self.figure(run, "average", total.div_ceil(u64::from(readings.max(1))) as u32);
        self.figure(run, "worst", worst);
    }

    #[inline(never)]
    fn print(&mut self, run: &str, reading: u32, outcome: &Outcome<ChosenEcho>) {
        self.console.write(Line::of(run, reading, outcome).finished());
    }

    #[inline(never)]
    fn figure(&mut self, run: &str, name: &str, value: u32) {
        let mut line = Line::new("figure");
        line.text(run);
        line.text(name);
        line.word(value);
        self.console.write(line.finished());
    }
}

/// The three runs.
#[inline(never)]
fn replay_all(bench: &mut Bench) -> Result<(), DomainError> {
    let Some(log) = Log::new(LOG) else {
        semihosting::exit(2);
    };
    bench.fuser.set_span(Some(replay::span()?));
    bench.run("log", &Ring::<f32>::nomad200()?, &mut |index| log.event(index));
    let boundless = Ring::boundless()?;
    let mut adversary = Adversary::new();
    // The last H readings of every sensor, wherever they were taken: only so is every slot full.
    bench.fuser.set_span(None);
    bench.run("adversary", &boundless, &mut |index| adversary.event(&boundless, index));
    bench.fuser.set_span(Some(replay::span()?));
    let mut faults = Faults::new();
    bench.run("faults", &boundless, &mut |index| faults.event(&log, index));
    Ok(())
}

fn start(clock: Clock) -> ! {
    stack::paint();
    let before = stack::depth();
    // SAFETY: called once, and nothing else names the static.
    let fuser = unsafe { &mut *(&raw mut FUSER) };
    let mut bench = Bench { fuser, clock, console: Console::open() };
    let state = size_of_val(bench.fuser) as u32;
    let status = match replay_all(&mut bench) {
        Ok(()) => 0,
        Err(_) => 3,
    };
    let deepest = stack::used();
    for (name, value) in [("state", state), ("stack", deepest), ("stack-before", before)] {
        bench.figure("image", name, value);
    }
    if cfg!(feature = "panic-path") {
        // A length that only the run knows.
        assert!(deepest != state);
    }
    semihosting::exit(status)
}

/// Where the runtime hands over.
#[cfg(target_arch = "arm")]
#[cortex_m_rt::entry]
fn main() -> ! {
    // SAFETY: the first and only time.
    let peripherals = unsafe { cortex_m::Peripherals::steal() };
    start(Clock::start(peripherals.SYST))
}

#[cfg(target_arch = "arm")]
#[cortex_m_rt::exception]
unsafe fn HardFault(_: &cortex_m_rt::ExceptionFrame) -> ! {
    semihosting::exit(4)
}

/// Where the runtime hands over.
#[cfg(target_arch = "riscv32")]
#[riscv_rt::entry]
fn main() -> ! {
    start(Clock::start())
}

#[cfg(target_arch = "riscv32")]
#[unsafe(export_name = "ExceptionHandler")]
extern "C" fn exception(_: &riscv_rt::TrapFrame) -> ! {
    semihosting::exit(4)
}
