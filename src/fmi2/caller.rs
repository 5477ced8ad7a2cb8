//! What a call must not change of the thread that makes it: its floating-point environment and whether it can be cancelled.
//!
//! Inside a call floating-point exceptions do not trap, rounding is to nearest and subnormal numbers are kept, whatever the host set: a
//! quotient by 0 that is handled here must not end the host, and results must not depend on its settings. Traps, rounding and the
//! sticky flags of exceptions are given back as they were. Threads that a call starts take the environment of the call.
//!
//! `pthread_cancel` acts after the call: unwinding out of the middle would leave an instance half changed, and the operators of a line
//! are built on a thread that writes to this one's stack.

/// Settings of the calling thread, restored when this is dropped.
#[must_use = "restores the settings when it is dropped"]
pub struct Caller {
    // In the order of their declaration: the floating-point environment is restored first.
    _floating_point: floating_point::Environment,
    _cancellation: cancellation::State,
}

impl Caller {
    /// Saves the settings, and sets those of a call.
    #[inline(always)]
    pub fn enter() -> Caller {
        Caller {
            _cancellation: cancellation::State::disable(),
            _floating_point: floating_point::Environment::replace(),
        }
    }
}

#[cfg(any(target_arch = "x86_64", all(target_arch = "x86", target_feature = "sse2")))]
mod floating_point {
    use core::arch::asm;

    /// MXCSR: all exceptions masked, none raised, to nearest, subnormal numbers kept.
    const MXCSR: u32 = 0x1f80;
    /// x87 control word: the bits of the masks and of the rounding, and their values with all masked and to nearest. The precision may
    /// be any: results are computed with SSE.
    const MASKS_AND_ROUNDING: u16 = 0x0c3f;
    const MASKED_TO_NEAREST: u16 = 0x003f;
    const X87: u16 = 0x037f;

    /// MXCSR, and the environment of the x87 unit where it would trap or round otherwise. C libraries set both.
    pub struct Environment {
        mxcsr: u32,
        x87: Option<[u32; 7]>,
    }

    impl Environment {
        #[inline(always)]
        pub fn replace() -> Environment {
            let (mut mxcsr, mut control) = (0_u32, 0_u16);
            // SAFETY: both words are stored; the value loaded has no reserved bit.
            unsafe {
                asm!("stmxcsr [{}]", in(reg) &raw mut mxcsr, options(nostack, preserves_flags));
                asm!("ldmxcsr [{}]", in(reg) &MXCSR, options(nostack));
                asm!("fnstcw [{}]", in(reg) &raw mut control, options(nostack, preserves_flags));
            }
            let x87 = (control & MASKS_AND_ROUNDING != MASKED_TO_NEAREST).then(save_x87);
            Environment { mxcsr, x87 }
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

    impl Drop for Environment {
        #[inline(always)]
        fn drop(&mut self) {
            if let Some(environment) = &self.x87 {
                restore_x87(environment);
            }
            // SAFETY: the value was stored by `stmxcsr`.
            unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const self.mxcsr, options(nostack)) };
        }
    }
}

#[cfg(target_arch = "aarch64")]
mod floating_point {
    use core::arch::asm;

    /// FPCR and FPSR. A FPCR of 0 traps nothing, rounds to nearest and keeps subnormal numbers.
    pub struct Environment {
        control: u64,
        status: u64,
    }

    impl Environment {
        #[inline(always)]
        pub fn replace() -> Environment {
            let (control, status): (u64, u64);
            // SAFETY: registers are read, and one is written where it differs from its default.
            unsafe {
                asm!("mrs {}, fpcr", "mrs {}, fpsr", out(reg) control, out(reg) status, options(nostack));
                if control != 0 {
                    asm!("msr fpcr, xzr", options(nostack));
                }
            }
            Environment { control, status }
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
                asm!("msr fpsr, {}", in(reg) self.status, options(nostack));
            }
        }
    }
}

#[cfg(not(any(target_arch = "x86_64", all(target_arch = "x86", target_feature = "sse2"), target_arch = "aarch64")))]
mod floating_point {
    /// No processor that this library is built for has traps besides those above.
    pub struct Environment;

    impl Environment {
        pub fn replace() -> Environment {
            Environment
        }
    }
}

#[cfg(any(target_os = "linux", target_vendor = "apple", target_os = "freebsd"))]
mod cancellation {
    use core::ffi::c_int;

    unsafe extern "C" {
        fn pthread_setcancelstate(state: c_int, old: *mut c_int) -> c_int;
    }

    /// `PTHREAD_CANCEL_DISABLE`
    const DISABLE: c_int = if cfg!(target_vendor = "apple") { 0 } else { 1 };

    /// Whether the thread could be cancelled.
    pub struct State(c_int);

    impl State {
        #[inline(always)]
        pub fn disable() -> State {
            let mut before = DISABLE;
            // SAFETY: the value of the platform, and a place for the old one.
            unsafe { pthread_setcancelstate(DISABLE, &raw mut before) };
            State(before)
        }
    }

    impl Drop for State {
        #[inline(always)]
        fn drop(&mut self) {
            // SAFETY: the state was given by this function, which is no cancellation point.
            unsafe { pthread_setcancelstate(self.0, &raw mut self.0) };
        }
    }
}

#[cfg(not(any(target_os = "linux", target_vendor = "apple", target_os = "freebsd")))]
mod cancellation {
    /// Threads of these platforms cannot be cancelled.
    pub struct State;

    impl State {
        pub fn disable() -> State {
            State
        }
    }
}
