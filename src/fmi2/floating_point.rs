//! The floating-point environment of the calling thread, which a call must neither use nor change.
//!
//! Inside a call floating-point exceptions do not trap, rounding is to nearest and subnormal numbers are kept, whatever the host set: a
//! quotient by 0 that is handled here must not end the host, and results must not depend on its settings. Traps, rounding and the
//! sticky flags of exceptions are given back as they were. Threads that a call starts take the environment of the call.
//!
//! A register is written only where that changes it: a write stops the processor for some 30 ns, and reading it takes 6. So getting and
//! setting values, which mostly copies numbers, enters the environment only where it computes.

#[cfg(any(target_arch = "x86_64", all(target_arch = "x86", target_feature = "sse2")))]
mod registers {
    use core::arch::asm;

    /// MXCSR: the exceptions raised so far, and the rest with all exceptions masked, to nearest, subnormal numbers kept.
    const RAISED: u32 = 0x3f;
    const MXCSR: u32 = 0x1f80;
    /// x87 control word: the bits of the masks and of the rounding, and their values with all masked and to nearest. The precision may
    /// be any: results are computed with SSE.
    const MASKS_AND_ROUNDING: u16 = 0x0c3f;
    const MASKED_TO_NEAREST: u16 = 0x003f;
    const X87: u16 = 0x037f;

    /// MXCSR, and the environment of the x87 unit where it would trap or round otherwise. C libraries set both.
    #[must_use = "restores the environment when it is dropped"]
    pub(crate) struct Environment {
        mxcsr: u32,
        x87: Option<[u32; 7]>,
    }

    #[inline(always)]
    fn mxcsr() -> u32 {
        let mut word = 0;
        // SAFETY: one word is stored.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut word, options(nostack, preserves_flags)) };
        word
    }

    #[inline(always)]
    fn set_mxcsr(word: u32) {
        // SAFETY: the word was stored by `stmxcsr`, or is the default one: it has no reserved bit.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const word, options(nostack)) };
    }

    impl Environment {
        /// Saves the environment, and sets that of a call.
        #[inline(always)]
        pub(crate) fn enter() -> Environment {
            let (mxcsr, mut control) = (mxcsr(), 0_u16);
            if mxcsr & !RAISED != MXCSR {
                set_mxcsr(MXCSR | mxcsr & RAISED);
            }
            // SAFETY: one word is stored.
            unsafe { asm!("fnstcw [{}]", in(reg) &raw mut control, options(nostack, preserves_flags)) };
            let x87 = (control & MASKS_AND_ROUNDING != MASKED_TO_NEAREST).then(save_x87);
            Environment { mxcsr, x87 }
        }
    }

    impl Drop for Environment {
        #[inline(always)]
        fn drop(&mut self) {
            if let Some(environment) = &self.x87 {
                restore_x87(environment);
            }
            if mxcsr() != self.mxcsr {
                set_mxcsr(self.mxcsr);
            }
        }
    }

    #[cold]
    fn save_x87() -> [u32; 7] {
        let mut environment = [0; 7];
        // SAFETY: 28 bytes are stored; the register stack is not used.
        unsafe {
            asm!(
                "fnstenv [{}]", "fnclex", "fldcw [{}]",
                in(reg) &raw mut environment, in(reg) &X87, options(nostack)
            );
        }
        environment
    }

    #[cold]
    fn restore_x87(environment: &[u32; 7]) {
        // SAFETY: the environment was stored by `fnstenv`, with the register stack as empty as it is here.
        unsafe { asm!("fldenv [{}]", in(reg) environment, options(nostack)) };
    }
}

#[cfg(target_arch = "aarch64")]
mod registers {
    use core::arch::asm;

    /// FPCR and FPSR. A FPCR of 0 traps nothing, rounds to nearest and keeps subnormal numbers.
    #[must_use = "restores the environment when it is dropped"]
    pub(crate) struct Environment {
        control: u64,
        status: u64,
    }

    #[inline(always)]
    fn status() -> u64 {
        let status;
        // SAFETY: a register is read.
        unsafe { asm!("mrs {}, fpsr", out(reg) status, options(nostack)) };
        status
    }

    impl Environment {
        /// Saves the environment, and sets that of a call.
        #[inline(always)]
        pub(crate) fn enter() -> Environment {
            let control: u64;
            // SAFETY: a register is read, and set to its default where it differs.
            unsafe {
                asm!("mrs {}, fpcr", out(reg) control, options(nostack));
                if control != 0 {
                    asm!("msr fpcr, xzr", options(nostack));
                }
            }
            Environment { control, status: status() }
        }
    }

    impl Drop for Environment {
        #[inline(always)]
        fn drop(&mut self) {
            // SAFETY: the values were read from these registers.
            unsafe {
                if self.control != 0 {
                    asm!("msr fpcr, {}", in(reg) self.control, options(nostack));
                }
                if status() != self.status {
                    asm!("msr fpsr, {}", in(reg) self.status, options(nostack));
                }
            }
        }
    }
}

#[cfg(not(any(target_arch = "x86_64", all(target_arch = "x86", target_feature = "sse2"), target_arch = "aarch64")))]
mod registers {
    /// The library is built for the processors above.
    #[must_use]
    pub(crate) struct Environment;

    impl Environment {
        pub(crate) fn enter() -> Environment {
            Environment
        }
    }
}

pub(crate) use registers::Environment;
