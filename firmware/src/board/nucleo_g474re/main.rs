//! ST's NUCLEO-G474RE: STM32G474RE at 170 MHz from the board's 24 MHz crystal; where that does not start, from the
//! chip's own oscillator, to say so over the link.
//!
//! | what | where |
//! |---|---|
//! | amplifier monitor, through divider and offset | PA0 (A0), ADC1 channel 1, injected, oversampled ([`sampling`]): codes up to 65,520 |
//! | displacement sensor, through divider and clamp, if there is one | PA1 (A1), ADC1 channel 2, injected after it, likewise |
//! | set-point of a controller, through divider and clamp, if there is one | PB0 (A3), ADC1 channel 15, injected last, likewise |
//! | estimate, or the amplifier's input | PA4 (A2), DAC1 channel 1, 12 bits at 100 kHz, 16 bits behind a low-pass, by DMA1's channel 2 ([`output`]) |
//! | high while the tick runs, for an oscilloscope | PA8 (D7) |
//! | VALID: an edge at every good tick, for an interlock | PB10 (D6) |
//! | trigger of a waveform's line, pulled down; sync, high at its first point: [`firmware::waveform`] | PB5 (D4), PC7 (D9) |
//! | lamp, button: [`firmware::panel`] | PA5 (LD2), PC13 (B1) |
//! | link | LPUART1 on PA2, PA3, by DMA1's channels 1 and 3: the ST-Link's virtual COM port |
//! | trigger of the ADC, and of the DAC | TIM6, 2 kHz ([`firmware::rate`]), and TIM7, 100 kHz |
//! | async time, cycle count, watchdog | TIM5, DWT, IWDG (200 ms) |
//!
//! At 2 kHz sampling takes 16 · (47.5 + 12.5) clocks of 42.5 MHz a channel, 67.8 µs for all three, the monitor first;
//! the interrupt follows. Every other interrupt has a lower priority, so only a critical section (embassy's own, tens
//! of instructions each) can delay the tick.
#![no_std]
#![no_main]

mod chip;
mod clocks;
mod failure;
mod line;
mod output;
mod reset;
mod sampling;
mod shared;
mod supply;
mod trigger;

use core::cell::Cell;
use core::ptr::addr_of;

use cortex_m::peripheral::{DWT, SCB};
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_stm32::adc::AdcChannel as _;
use embassy_stm32::flash::Flash;
use embassy_stm32::gpio::{self, Input, Level, Pull, Speed};
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{bind_interrupts, flash, interrupt};
use embassy_sync::blocking_mutex::CriticalSectionMutex;
use estimator_core::table::{ALLOWED_PERCENT, Interface};
use firmware::marked_reads::MarkedReads;
use firmware::panel::Front;
use firmware::rate::{TICK_HZ, TICK_US};
use firmware::shaping::PARTS;
use firmware::{Conversion, Facts, Peripherals, Resources, Tick, last_words, restarts};
use protocol::Uid;
use static_cell::{ConstStaticCell, StaticCell};

use chip::Stm32G4;
use clocks::CORE_HZ;
use output::{AHEAD, Output, Put};
use sampling::FULL_SCALE;
use shared::{POINTS, TELEMETRY};

bind_interrupts!(struct Irqs {
    FLASH => flash::InterruptHandler;
});

/// The converters' codes have the same scale at every rate, so that a calibration of the wiring holds at each.
const INTERFACE: Interface = Interface { tick_us: TICK_US, adc_full_scale: FULL_SCALE, dac_full_scale: 4095 };
/// What a tick may take, cycles.
const ALLOWED: u32 = CORE_HZ / TICK_HZ - sampling::CYCLES - AHEAD;
const _: () = assert!(100 * ALLOWED >= ALLOWED_PERCENT * (CORE_HZ / TICK_HZ), "tables are admitted that have no time");
/// Longest that the tick or the main loop may stand still, µs, from the first tick on; a start has the half second of
/// the reset values, and a write of the flash lets both go on.
const WATCHDOG_US: u32 = 200_000;

/// What the converter's interrupt owns.
struct Armed {
    tick: Tick<'static>,
    adc: sampling::Converter,
    output: Output,
    marker: gpio::Output<'static>,
    valid: gpio::Output<'static>,
    trigger_pin: Input<'static>,
    sync: gpio::Output<'static>,
}

/// The board's own button and lamp.
struct OnBoard {
    button: Input<'static>,
    lamp: gpio::Output<'static>,
}

impl Front for OnBoard {
    /// Held, the button connects the pin to 3.3 V, else a resistor pulls it down: so says the schematic of this board
    /// (MB1367), and ST's own driver of it waits for a rising edge. Other Nucleo boards have it the other way round.
    fn held(&mut self) -> bool {
        self.button.is_high()
    }

    fn light(&mut self, on: bool) {
        self.lamp.set_level(on.into());
    }
}

/// On its way to the converter's interrupt.
static ARMED: CriticalSectionMutex<Cell<Option<&'static mut Armed>>> = CriticalSectionMutex::new(Cell::new(None));

unsafe extern "C" {
    /// Symbols of memory.x: their addresses are meant.
    static __flash_start: u8;
    static __parameters_start: u8;
    static __parameters_end: u8;
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let reset = reset::cause();
    // SAFETY: once, before the tick and every task.
    let memory = unsafe { restarts::memory() };
    let restarts = memory.count(reset);
    freeze_in_debug();
    // With its reset values, half a second: a crystal that does not start must not be waited for for ever.
    pac::IWDG.kr().write(|w| w.set_key(pac::iwdg::vals::Key::START));
    let (p, clock_good) = clocks::start();
    let options = pac::FLASH.optr().read();
    // Otherwise a page is 4 KiB, both parameter pages are one, and an erase stops the code.
    let no_store = (!options.dbank()).then_some("the flash is not in dual-bank mode: set the option bit DBANK");
    // Cannot fail: this is the only call.
    let mut core = cortex_m::Peripherals::take().expect("the core's peripherals are taken once");
    core.DCB.enable_trace();
    core.DWT.enable_cycle_counter();
    defmt::info!("nucleo-g474re, reset cause {=u8:b}", reset.bits());

    let (transmitter, receiver) = line::start(p.LPUART1, p.PA3, p.PA2, p.DMA1_CH3, p.DMA1_CH1);
    let (receives, sends) = (interrupt::DMA1_CHANNEL1, interrupt::DMA1_CHANNEL3);
    for other in [interrupt::LPUART1, receives, sends, interrupt::TIM5, interrupt::FLASH, interrupt::DMA1_CHANNEL2] {
        other.set_priority(Priority::P6);
    }
    interrupt::ADC1_2.set_priority(Priority::P0);

    let mut adc = sampling::converter(p.ADC1);
    let supply_mv = supply::at_start(&mut adc);
    IndependentWatchdog::new(p.IWDG, WATCHDOG_US).unleash();

    let flash_start = addr_of!(__flash_start) as u32;
    let pages = addr_of!(__parameters_start) as u32 - flash_start..addr_of!(__parameters_end) as u32 - flash_start;
    let (tim6, tim7, dac1, dma, pa0, pa1, pb0) = (p.TIM6, p.TIM7, p.DAC1, p.DMA1_CH2, p.PA0, p.PA1, p.PB0);
    let marker = gpio::Output::new(p.PA8, Level::Low, Speed::High);
    let valid = gpio::Output::new(p.PB10, Level::Low, Speed::Low);
    let (trigger_pin, sync) = (Input::new(p.PB5, Pull::Down), gpio::Output::new(p.PC7, Level::Low, Speed::Low));
    // The board has the button's resistor.
    let front =
        OnBoard { button: Input::new(p.PC13, Pull::None), lamp: gpio::Output::new(p.PA5, Level::Low, Speed::Low) };
    let facts = Facts {
        name: "nucleo-g474re",
        emulated: false,
        uid: Some(Uid(embassy_stm32::uid::uid())),
        has_setpoint: true,
        has_trigger: true,
        interface: INTERFACE,
        dac_parts: PARTS,
        cycles_per_tick: CORE_HZ / TICK_HZ,
        reset,
        restarts,
        supply_mv: Some(supply_mv),
        brown_out_level: Some(options.bor_lev()),
        clock_good,
        no_store,
    };
    let board = Peripherals {
        facts,
        chip: Stm32G4,
        memory,
        // SAFETY: once, before the tick and every task.
        last_words: unsafe { last_words::take() },
        receiver,
        transmitter,
        flash: MarkedReads::new(Flash::new(p.FLASH, Irqs), &failure::READING_STORE),
        pages,
        front,
        start: |tick: Tick<'static>| {
            // Before the converter listens: loading the prescaler is a trigger too.
            let timer = trigger::at_rate(tim6, TICK_HZ);
            let adc = sampling::start(adc, [pa0.degrade_adc(), pa1.degrade_adc(), pb0.degrade_adc()]);
            let (output, ahead) = output::start(dac1, dma, tim7);
            static OWNED: StaticCell<Armed> = StaticCell::new();
            let owned = OWNED.init(Armed { tick, adc, output, marker, valid, trigger_pin, sync });
            ARMED.lock(|armed| armed.set(Some(owned)));
            // The 200 ms are in force from here: to start a dog that runs already reloads nothing.
            pac::IWDG.kr().write(|w| w.set_key(pac::iwdg::vals::Key::RESET));
            // SAFETY: the handler below is ready, and no critical section masks by priority.
            unsafe { interrupt::ADC1_2.enable() };
            critical_section::with(|_| {
                ahead.start();
                timer.start();
            });
            // Dropped, it would stop.
            core::mem::forget(timer);
        },
    };
    static RESOURCES: ConstStaticCell<Resources> = ConstStaticCell::new(Resources::new());
    match firmware::run(board, RESOURCES.take(), &POINTS, &TELEMETRY).await {
        Ok(()) => SCB::sys_reset(),
        Err(error) => panic!("{error}"),
    }
}

/// The tick. See [`Tick`] for its contract.
#[interrupt]
fn ADC1_2() {
    static mut OWNED: Option<&'static mut Armed> = None;
    let started = DWT::cycle_count();
    let Some(Armed { tick, adc, output, marker, valid, trigger_pin, sync }) = OWNED.as_deref_mut() else {
        // The first time: the request stays, so the handler is entered again at once.
        *OWNED = ARMED.lock(Cell::take);
        return;
    };
    marker.set_high();
    // Set first, so that it has no jitter against the trigger that put out the code it belongs to.
    if let Some(high) = tick.sync() {
        sync.set_level(high.into());
        tick.trigger(trigger_pin.is_high());
    }
    let [monitor, sensor, setpoint] = sampling::codes(adc);
    let conversion = Conversion { monitor, sensor: Some(sensor), setpoint: Some(setpoint) };
    let put = output.put(tick.sample(conversion, started));
    // DMA has lost a request or gets none any more, and the last code would stand; or it is out of step with the ticks.
    assert!(put != Put::Stopped, "the DAC's DMA has stopped");
    let cycles = DWT::cycle_count().wrapping_sub(started);
    // An entry that was late itself may leave too little time for a tick that took no longer than it may.
    let in_time = put == Put::InTime && cycles <= ALLOWED;
    TELEMETRY.took(cycles, in_time);
    if in_time && tick.valid() {
        valid.toggle();
    }
    marker.set_low();
}

/// Has a debugger that halts the core halt the watchdog with it, which else resets the board in the midst of a look;
/// TIM6 and TIM7, without which DMA would go on putting the last two ticks' codes out in turns: the output stays at its
/// last code; and TIM5, by which a host that is waited for would have been silent for too long.
fn freeze_in_debug() {
    pac::DBGMCU.apb1lfzr().modify(|w| {
        w.set_iwdg(true);
        w.set_tim5(true);
        w.set_tim6(true);
        w.set_tim7(true);
    });
}
