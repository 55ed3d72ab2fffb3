//! The estimator and its inverse for programs in C: the bytes of a parameter table in, ticks out.
//!
//! `include/piezo_estimator.h` declares what is here, and `examples/tick.c` uses it. For a Cortex-M4F:
//!
//! ```text
//! cargo build --release -p estimator-c --target thumbv7em-none-eabihf
//! arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -Iestimator-c/include … \
//!     target/thumbv7em-none-eabihf/release/libpiezo_estimator.a
//! ```
//!
//! It is `estimator-core` in `f32` and nothing else: the numbers are those of the board and of the host, bit for bit.
//! The caller gives the memory; nothing is allocated, nothing is global, and no function waits. What may be called from
//! an interrupt is `…_tick`, `…_tick_volts` and `…_release`, never at the same time as another function of the same
//! value.
//!
//! Each function returns a [`PiezoResult`] and writes its results only where that is `PIEZO_RESULT_OK`; the reason of a
//! refusal is written with the refusal.
#![cfg_attr(target_os = "none", no_std)]

mod estimator;
mod inverse;
mod memory;
mod result;
mod table;

pub use estimator::*;
pub use inverse::*;
pub use result::PiezoResult;
pub use table::*;

/// No call leads here. If one did, the program must not go on: the undefined instruction ends in the fault handler,
/// which is the caller's and knows what is safe.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(target_arch = "arm")]
    // SAFETY: it touches no memory, and does not come back.
    unsafe {
        core::arch::asm!("udf #0", options(noreturn, nomem, nostack))
    }
    #[cfg(not(target_arch = "arm"))]
    loop {
        core::hint::spin_loop();
    }
}
