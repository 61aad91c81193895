//! Counts instructions: QEMU with `-icount shift=5` lets each take 32 ns.

/// A counter that goes on.
pub struct Clock(());

#[cfg(target_arch = "arm")]
impl Clock {
    /// SysTick counts down in 24 bits.
    const WRAP: u32 = 0x00ff_ffff;

    /// Starts the system timer on the processor's clock, which is 25 MHz on these boards.
    pub fn start(mut timer: cortex_m::peripheral::SYST) -> Self {
        timer.set_clock_source(cortex_m::peripheral::syst::SystClkSource::Core);
        timer.set_reload(Self::WRAP);
        timer.clear_current();
        timer.enable_counter();
        Self(())
    }

    /// Where it stands.
    #[inline(always)]
    pub fn read(&self) -> u32 {
        cortex_m::peripheral::SYST::get_current()
    }

    /// Instructions since `start`, up to 20 million: a tick is 40 ns, 1.25 instructions; rounded up.
    pub const fn instructions_since(start: u32, end: u32) -> u32 {
        let ticks = start.wrapping_sub(end) & Self::WRAP;
        (ticks * 5).div_ceil(4)
    }
}

#[cfg(target_arch = "riscv32")]
impl Clock {
    /// The counter of retired instructions runs from reset. QEMU has it count the nanoseconds of its clock: 2⁵ each.
    pub const fn start() -> Self {
        Self(())
    }

    /// Where it stands.
    #[inline(always)]
    pub fn read(&self) -> u32 {
        let count;
        // SAFETY: reads a counter.
        unsafe { core::arch::asm!("csrr {0}, minstret", out(reg) count, options(nomem, nostack)) };
        count
    }

    /// Instructions since `start`, up to 130 million.
    pub const fn instructions_since(start: u32, end: u32) -> u32 {
        end.wrapping_sub(start) >> 5
    }
}
