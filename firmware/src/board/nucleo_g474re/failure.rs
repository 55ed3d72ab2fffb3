//! What is left to do when the firmware fails, and what becomes of a flash word that cannot be read.

use core::panic::PanicInfo;
use core::sync::atomic::Ordering::{Relaxed, SeqCst};
use core::sync::atomic::{AtomicBool, AtomicU32, compiler_fence};

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use embassy_stm32::pac;
use firmware::last_words;
use firmware::rate::TICK_HZ;

use super::shared::TELEMETRY;
use super::{clocks, output};

/// Whether the parameter store is being read.
pub static READING_STORE: AtomicBool = AtomicBool::new(false);
/// Whether a failure has the output go to its safe value.
static RESTING: AtomicBool = AtomicBool::new(false);
/// Whether a panic has come.
static PANICS: AtomicBool = AtomicBool::new(false);
/// Flash words that could not be corrected.
static FLASH_ERRORS: AtomicU32 = AtomicU32::new(0);

/// How many flash words could not be corrected so far.
pub fn flash_errors() -> u32 {
    FLASH_ERRORS.load(Relaxed)
}

/// The DAC to its safe value: where it drives the amplifier, no faster than the drive may, and at once elsewhere. The
/// tick must not come any more. Before the DAC runs this does nothing.
fn output_safe() {
    RESTING.store(true, Relaxed);
    let Some(shown) = output::hold() else { return };
    if TELEMETRY.drives() {
        output::put_at_once(shown);
    }
    for given in TELEMETRY.ramp(shown) {
        if TELEMETRY.drives() {
            cortex_m::asm::delay(clocks::core_hz() / TICK_HZ);
            pac::IWDG.kr().write(|w| w.set_key(pac::iwdg::vals::Key::RESET));
        }
        output::put_at_once(given);
    }
}

/// The message is kept for the next start, and told to a probe that listens.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    // From here on a crystal that stops is no failure of its own, which would end this one before the output is safe.
    RESTING.store(true, Relaxed);
    compiler_fence(SeqCst);
    // A second panic is one of these steps themselves, and says nothing more. (Amid a log the first is not told to a
    // probe, but kept all the same.)
    if !PANICS.swap(true, Relaxed) {
        output_safe();
        // SAFETY: nothing else runs any more.
        unsafe { last_words::keep_panic(info) };
        defmt::error!("{}", defmt::Display2Format(info));
    }
    SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    cortex_m::interrupt::disable();
    output_safe();
    // SAFETY: nothing else runs any more.
    unsafe { last_words::keep_hard_fault(frame) };
    SCB::sys_reset()
}

/// The crystal has stopped, or the flash cannot correct a word. The first ends the run as any failure does, at the
/// speed of the chip's own oscillator: no tick comes any more, the output goes to its safe value, and the next start
/// looks for the crystal. Where another failure has the output on its way there already, it is left to arrive: the
/// steps that are left are as long as before, by [`clocks::core_hz`].
///
/// Flash words that a power cut left half-written cannot be corrected; reading one raises this. What was read is
/// garbage, which the parameter store's checksums refuse. Whose word it was is told by who reads, beside the bit that
/// names bank 2, where the store is: that may be missing after a power cut amid a write (an erratum of this family),
/// and a panic would then come back at every start. The store is read in thread mode only: a word that an interrupt's
/// handler has met is code, whatever the bit says, and the run ends.
#[exception]
unsafe fn NonMaskableInt() {
    if clocks::crystal_stopped() {
        if RESTING.load(Relaxed) {
            return;
        }
        panic!("the crystal has stopped");
    }
    let state = pac::FLASH.eccr().read();
    let of_store = interrupts_thread() && (state.bk_ecc() || READING_STORE.load(Relaxed));
    if !(state.eccd() && of_store) {
        panic!("non-maskable interrupt, flash ECC state {:#010x}", state.0);
    }
    pac::FLASH.eccr().modify(|w| w.set_eccd(true));
    FLASH_ERRORS.store(FLASH_ERRORS.load(Relaxed).saturating_add(1), Relaxed);
}

/// Whether the exception that is being handled has interrupted no other.
fn interrupts_thread() -> bool {
    const RETTOBASE: u32 = 1 << 11;
    // SAFETY: a register that is only read, and has no side effect.
    unsafe { (*SCB::PTR).icsr.read() & RETTOBASE != 0 }
}

#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    panic!("interrupt {interrupt} has no handler");
}
