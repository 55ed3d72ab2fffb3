//! Arm's AN386 (Cortex-M4F, 25 MHz) for the MPS2 board, as QEMU emulates it: all of the firmware but the STM32.
//!
//! The tick is CMSDK timer 0, at 2 kHz ([`firmware::rate`]). There is no converter: the "ADC" gives a triangle over
//! most of its range, 1 Hz, or, with a table that drives, what the "DAC" puts out, which is a word in memory. The link
//! is UART 0. The flash is memory that a reset keeps and a power-on does not.
#![no_std]
#![no_main]

mod clock;
mod registers;
mod uart;

use core::cell::Cell;
use core::panic::PanicInfo;
use core::ptr::{addr_of, addr_of_mut};
use core::sync::atomic::{AtomicU16, AtomicU32, Ordering::Relaxed};

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception, interrupt};
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::CriticalSectionMutex;
use estimator_core::AdcCode;
use estimator_core::table::Interface;
use firmware::rate::{TICK_HZ, TICK_US};
use firmware::waveform::Points;
use firmware::{Chip, Facts, Peripherals, Resources, Telemetry, Tick, last_words, restarts};
use parameter_store::RamFlash;
use protocol::ResetCause;
use registers::{CORE_HZ, Interrupt as interrupt};
use static_cell::{ConstStaticCell, StaticCell};

/// As the primary board's, so that the same tables fit.
const INTERFACE: Interface = Interface { tick_us: TICK_US, adc_full_scale: 65_520, dac_full_scale: 4095 };

/// The emulated chip: it has no watchdog, and counts no errors.
struct An386;

impl Chip for An386 {}

/// What the tick leaves for others to read.
static TELEMETRY: Telemetry = Telemetry::new();

/// The points of a waveform.
// SAFETY: a section of its own, which nothing initialises: any bits are points, and none is read before it is written.
#[unsafe(link_section = ".waveform")]
static POINTS: Points = Points::new();
/// The tick on its way to the interrupt that owns it.
static ARMED: CriticalSectionMutex<Cell<Option<&'static mut Tick<'static>>>> =
    CriticalSectionMutex::new(Cell::new(None));
/// What the DAC would put out at the next trigger.
static DAC: AtomicU16 = AtomicU16::new(0);

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    // Cannot fail: this is the only call.
    let mut core = cortex_m::Peripherals::take().expect("the core's peripherals are taken once");
    clock::start(core.SYST);
    registers::start_cycle_counter();
    uart::start();
    interrupt::Timer0.enable(&mut core.NVIC, 0);
    interrupt::Uart0Receive.enable(&mut core.NVIC, 0x40);
    let (flash, reset) = flash();
    let pages = 0..flash.len() as u32;
    // SAFETY: once, before the tick and every task.
    let memory = unsafe { restarts::memory() };
    let facts = Facts {
        name: "mps2-an386 (emulated)",
        emulated: true,
        uid: None,
        has_setpoint: false,
        has_trigger: false,
        interface: INTERFACE,
        dac_parts: 1,
        cycles_per_tick: CORE_HZ / TICK_HZ,
        reset,
        restarts: memory.count(reset),
        supply_mv: None,
        brown_out_level: None,
        clock_good: true,
        no_store: None,
    };
    let board = Peripherals {
        facts,
        chip: An386,
        memory,
        // SAFETY: once, before the tick and every task.
        last_words: unsafe { last_words::take() },
        receiver: uart::Receiver,
        transmitter: uart::Transmitter,
        flash: RamFlash::new(flash),
        pages,
        front: (),
        start: |tick: Tick<'static>| {
            static OWNED: StaticCell<Tick<'static>> = StaticCell::new();
            let owned = OWNED.init(tick);
            ARMED.lock(|armed| armed.set(Some(owned)));
            registers::start_timer(CORE_HZ / TICK_HZ);
        },
    };
    static RESOURCES: ConstStaticCell<Resources> = ConstStaticCell::new(Resources::new());
    match firmware::run(board, RESOURCES.take(), &POINTS, &TELEMETRY).await {
        Ok(()) => SCB::sys_reset(),
        Err(error) => panic!("{error}"),
    }
}

/// The tick's interrupt, of the highest priority (which the clock's has as well).
#[interrupt]
fn Timer0() {
    static mut TICK: Option<&'static mut Tick<'static>> = None;
    let started = registers::cycles();
    registers::acknowledge_timer();
    let Some(tick) = TICK.as_mut() else {
        *TICK = ARMED.lock(Cell::take);
        return;
    };
    let code = if TELEMETRY.drives() { looped_back() } else { triangle() };
    DAC.store(tick.sample(code.into(), started).0, Relaxed);
    let cycles = registers::cycles().wrapping_sub(started);
    TELEMETRY.took(cycles, cycles <= CORE_HZ / TICK_HZ);
}

#[interrupt]
fn Uart0Receive() {
    uart::received();
}

/// One second of it goes up and down between 3,000 and 62,000.
fn triangle() -> AdcCode {
    static PHASE: AtomicU32 = AtomicU32::new(0);
    let phase = PHASE.load(Relaxed);
    PHASE.store((phase + 1) % TICK_HZ, Relaxed);
    AdcCode((3_000 + 118_000 * phase.min(TICK_HZ - phase) / TICK_HZ) as u16)
}

/// The DAC's code on the ADC's scale, as a wire from one to the other gives it, with a converter's noise.
fn looped_back() -> AdcCode {
    static NOISE: AtomicU16 = AtomicU16::new(0);
    let noise = 1 - NOISE.load(Relaxed);
    NOISE.store(noise, Relaxed);
    // Codes are no larger than 4,095 each, so this fits.
    AdcCode((INTERFACE.adc_full_scale / INTERFACE.dac_full_scale * DAC.load(Relaxed)).saturating_add(noise))
}

/// The parameter pages, erased if this is the first start since power-on, and why the board started.
fn flash() -> (&'static mut [u8], ResetCause) {
    unsafe extern "C" {
        static mut __parameters_start: u8;
        static __parameters_end: u8;
    }
    let start = addr_of_mut!(__parameters_start);
    let length = addr_of!(__parameters_end) as usize - start as usize;
    // SAFETY: memory.x keeps this region free of everything else, and this function is called once.
    let flash = unsafe { core::slice::from_raw_parts_mut(start, length) };
    // QEMU starts with zeros, which no store leaves behind.
    if flash.iter().all(|&byte| byte == 0) {
        flash.fill(0xFF);
        (flash, ResetCause::BROWN_OUT)
    } else {
        (flash, ResetCause::SOFTWARE)
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    // SAFETY: nothing else runs any more.
    unsafe { last_words::keep_panic(info) };
    SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // SAFETY: nothing else runs any more.
    unsafe { last_words::keep_hard_fault(frame) };
    SCB::sys_reset()
}

#[exception]
unsafe fn DefaultHandler(interrupt: i16) {
    panic!("interrupt {interrupt} has no handler");
}
