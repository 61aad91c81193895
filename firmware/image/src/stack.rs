//! How deep the stack went: the memory below it is painted, and looked at afterwards.

unsafe extern "C" {
    /// The end of the static variables: the runtimes' linker scripts define it.
    static mut __sheap: u32;
    /// Where the stack begins, which grows downwards.
    static mut _stack_start: u32;
}

const PAINT: u32 = 0xa5a5_5a5a;

/// Left unpainted below the stack pointer: the compiler may save registers there after the pointer was read.
const MARGIN: usize = 64;

/// Paints everything between the static variables and the stack as it stands.
#[inline(never)]
pub fn paint() {
    let (mut place, end) = (&raw mut __sheap, stack_pointer().saturating_sub(MARGIN));
    while place.addr() < end {
        // SAFETY: nothing lives between the static variables and the stack.
        unsafe {
            place.write_volatile(PAINT);
            place = place.add(1);
        }
    }
}

/// Bytes from the beginning of the stack to the deepest that was written to since [`paint`].
#[inline(never)]
pub fn used() -> u32 {
    let mut place = &raw mut __sheap;
    // SAFETY: as above; the words are read, and the walk ends in the stack at the latest.
    unsafe {
        while place.read_volatile() == PAINT {
            place = place.add(1);
        }
    }
    (&raw mut _stack_start).addr().wrapping_sub(place.addr()) as u32
}

/// Bytes from the beginning of the stack to its end as it stands.
pub fn depth() -> u32 {
    (&raw mut _stack_start).addr().wrapping_sub(stack_pointer()) as u32
}

fn stack_pointer() -> usize {
    let pointer: usize;
    // SAFETY: reads a register.
    unsafe {
        #[cfg(target_arch = "arm")]
        core::arch::asm!("mov {0}, sp", out(reg) pointer, options(nomem, nostack));
        #[cfg(target_arch = "riscv32")]
        core::arch::asm!("mv {0}, sp", out(reg) pointer, options(nomem, nostack));
    }
    pointer
}
