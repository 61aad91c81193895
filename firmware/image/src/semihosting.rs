//! Text out and exit through the debugger or emulator (Arm semihosting; RISC-V has taken over its calls).

use core::arch::asm;

const OPEN: usize = 0x01;
const WRITE: usize = 0x05;
const EXIT_EXTENDED: usize = 0x20;

/// `ADP_Stopped_ApplicationExit`, with a status to pass on.
const APPLICATION_EXIT: usize = 0x2_0026;

/// Standard output of whoever runs the image.
pub struct Console {
    handle: usize,
}

impl Console {
    /// Opens it.
    pub fn open() -> Self {
        const NAME: &[u8; 4] = b":tt\0";
        const MODE_WRITE: usize = 4;
        Self { handle: call(OPEN, &[NAME.as_ptr() as usize, MODE_WRITE, NAME.len() - 1]) }
    }

    /// Writes all of `text`.
    pub fn write(&mut self, text: &[u8]) {
        call(WRITE, &[self.handle, text.as_ptr() as usize, text.len()]);
    }
}

/// Ends the run with a status.
pub fn exit(status: u32) -> ! {
    call(EXIT_EXTENDED, &[APPLICATION_EXIT, status as usize]);
    loop {}
}

fn call<const N: usize>(operation: usize, block: &[usize; N]) -> usize {
    let mut result = operation;
    // SAFETY: the host reads the block, which lives through the call, and what it points to; the calls in use write
    // nothing.
    unsafe {
        #[cfg(target_arch = "arm")]
        asm!("bkpt 0xab", inout("r0") result, in("r1") block.as_ptr(), options(nostack));
        #[cfg(target_arch = "riscv32")]
        asm!(
            ".balign 16",
            ".option push",
            ".option norvc",
            "slli x0, x0, 0x1f",
            "ebreak",
            "srai x0, x0, 7",
            ".option pop",
            inout("a0") result, in("a1") block.as_ptr(), options(nostack)
        );
    }
    result
}
