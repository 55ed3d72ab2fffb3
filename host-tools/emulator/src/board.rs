//! The emulated board: it starts the firmware, again after a restart, and calls its tick.

use crate::plant::Plant;
use crate::serial_line::{Receiver, SerialLine, Transmitter};
use embassy_futures::select::{Either, select};
use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, Timer};
use embedded_storage_async::nor_flash::NorFlash;
use estimator_core::DacCode;
use estimator_core::table::Interface;
use firmware::drive::Following;
use firmware::rate::{TICK_HZ, TICK_US};
use firmware::restarts::{Memory, Place, Restarts};
use firmware::waveform::Points;
use firmware::{Chip, Facts, Peripherals, Resources, Telemetry, Tick};
use parameter_store::StoreError;
use protocol::{ResetCause, Uid};
use std::ops::Range;
use std::sync::atomic::Ordering::Relaxed;

/// Counts of the emulated cycle counter in a second; a count is a nanosecond.
const CYCLES_HZ: u32 = 1_000_000_000;
/// As the real board's, so that the same tables fit.
const INTERFACE: Interface = Interface { tick_us: TICK_US, adc_full_scale: 65_520, dac_full_scale: 4095 };
/// How often the ticks that are due are looked for.
const TURN: Duration = Duration::from_millis(1);
/// Most ticks between two turns of the link. Its queue takes 255 samples. From one look at them to the next come, where
/// this machine is busy, twice these ticks to be made up for, those of the link's 4 ms, and these again: 224 in all at
/// sixteen times real time.
const MOST_TICKS: f64 = 32.0;

/// All that the firmware on this board needs.
pub struct Board<'l, P, F> {
    /// What the converters are connected to.
    pub plant: P,
    /// The flash that holds the parameter pages.
    pub flash: F,
    /// Where in the flash the parameter pages are, bytes from its start.
    pub pages: Range<u32>,
    /// The chip's unique number.
    pub uid: Uid,
    /// Whether a controller's set-point is among what the plant gives.
    pub has_setpoint: bool,
    /// Seconds of emulated time in a second; while a drive waits for a reference, at most one.
    pub speed: f64,
    /// The serial line.
    pub line: &'l SerialLine,
}

impl<P: Plant, F: NorFlash> Board<'_, P, F> {
    /// Runs the firmware and starts it again whenever it asks for that.
    ///
    /// # Errors
    /// The pages do not fit the flash.
    pub async fn run(mut self) -> Result<std::convert::Infallible, StoreError> {
        let mut reset = ResetCause::BROWN_OUT;
        let (points, kept) = (Points::new(), Place::default());
        let memory = Memory::new(&kept);
        loop {
            let mut resources = Resources::new();
            let telemetry = Telemetry::new();
            let started: Signal<NoopRawMutex, Tick<'_>> = Signal::new();
            let peripherals = Peripherals {
                facts: facts(reset, memory.count(reset), self.uid, self.has_setpoint),
                chip: Emulated,
                memory,
                last_words: None,
                receiver: Receiver::new(self.line, self.speed),
                transmitter: Transmitter(self.line),
                flash: &mut self.flash,
                pages: self.pages.clone(),
                front: (),
                start: |tick| started.signal(tick),
            };
            let firmware = firmware::run(peripherals, &mut resources, &points, &telemetry);
            match select(firmware, ticks(&started, &telemetry, &mut self.plant, self.speed)).await {
                Either::First(restart) => restart?,
                Either::Second(never) => match never {},
            }
            reset = ResetCause::SOFTWARE;
        }
    }
}

/// It counts no errors.
struct Emulated;

impl Chip for Emulated {}

pub(crate) fn facts(reset: ResetCause, restarts: Restarts, uid: Uid, has_setpoint: bool) -> Facts {
    Facts {
        name: "emulated",
        emulated: true,
        uid: Some(uid),
        has_setpoint,
        has_trigger: false,
        interface: INTERFACE,
        dac_parts: 1,
        cycles_per_tick: CYCLES_HZ / TICK_HZ,
        reset,
        restarts,
        supply_mv: None,
        brown_out_level: None,
        clock_good: true,
        no_store: None,
    }
}

/// Waits for the tick to be started, then calls it as often as the time that has passed demands. Ticks that this
/// machine had no time for are not made up for: the emulated time has then stood still. While a drive waits for a
/// reference (one that is to hold its last does not), the emulated time is no faster than the host's: it then has the
/// same second to send one as with a real board.
async fn ticks(
    started: &Signal<NoopRawMutex, Tick<'_>>,
    telemetry: &Telemetry,
    plant: &mut impl Plant,
    speed: f64,
) -> std::convert::Infallible {
    let mut tick = started.wait().await;
    let mut starving = false;
    let mut cycles = 0u32;
    // The DAC puts a code out from the tick after the one that computed it; the plant answers it from the
    // tick after that.
    let mut computed = telemetry.safe();
    let mut put_out = computed;
    let (mut looked, mut due) = (Instant::now(), 0.0);
    loop {
        let now = Instant::now();
        let rate = f64::from(TICK_HZ) * if starving { speed.min(1.0) } else { speed };
        due = (due + rate * (now - looked).as_micros() as f64 / 1e6).min(2.0 * MOST_TICKS);
        looked = now;
        let (mut left, starved) = (MOST_TICKS, telemetry.starved.load(Relaxed));
        while due >= 1.0 && left >= 1.0 {
            let conversion = plant.sample(put_out);
            put_out = computed;
            // A part is a code here.
            computed = DacCode(tick.sample(conversion, cycles).0);
            cycles = cycles.wrapping_add(CYCLES_HZ / TICK_HZ);
            due -= 1.0;
            left -= 1.0;
        }
        if left < MOST_TICKS {
            starving = telemetry.starved.load(Relaxed) != starved && telemetry.following() != Following::UntilModeEnds;
        }
        if due >= 1.0 {
            yield_now().await;
        } else {
            Timer::after(TURN).await;
        }
    }
}
