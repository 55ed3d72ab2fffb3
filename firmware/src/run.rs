//! Puts the parts together, and runs until the host asks for a restart.

use crate::boot;
use crate::chip::Chip;
use crate::compiled::TABLE;
use crate::link::{Device, Link, LinkEnd};
use crate::panel::{Front, Panel};
use crate::peripherals::Peripherals;
use crate::queues::Queues;
use crate::restarts::SOON;
use crate::startup::Startup;
use crate::supply::Measured;
use crate::telemetry::Telemetry;
use crate::tick::Tick;
use crate::waveform::Points;
use core::sync::atomic::Ordering::Relaxed;
use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use embedded_io_async::{Read, Write};
use embedded_storage_async::nor_flash::NorFlash;
use parameter_store::{ParameterStore, StoreError};
use protocol::{Faults, TableSource};

/// How often the watchdog is fed, if a tick has run since, and the tick told that the main loop goes on: a tenth
/// of its period.
const WATCHDOG: Duration = Duration::from_millis(20);

/// Memory that the tick and the link use for as long as the firmware runs. A board keeps it in a static.
pub struct Resources {
    queues: Queues,
}

impl Resources {
    /// Memory for one run of the firmware.
    pub const fn new() -> Self {
        Self { queues: Queues::new() }
    }
}

impl Default for Resources {
    fn default() -> Self {
        Self::new()
    }
}

/// Runs the firmware on a board until the host asks for a restart, which is then the board's to do. The points of a
/// waveform are kept in `points`, whatever was there before. What the tick leaves for others to read is in `telemetry`,
/// to which the board's interrupt handler adds the tick's duration.
///
/// # Errors
/// The parameter pages do not fit the flash: a mistake in the board or its memory map.
pub async fn run<'r, C: Chip, R: Read, W: Write, F: NorFlash, P: Front, S: FnOnce(Tick<'r>)>(
    board: Peripherals<'r, C, R, W, F, P, S>,
    resources: &'r mut Resources,
    points: &'r Points,
    telemetry: &'r Telemetry,
) -> Result<(), StoreError> {
    let Peripherals { facts, chip, memory, last_words, .. } = board;
    let mut store = ParameterStore::new(board.flash, board.pages)?;
    let chosen = boot::choose(&mut store, TABLE, &facts).await;
    log_start(&chosen.source);
    let (tick_queues, link_queues) = resources.queues.split();
    let startup = Startup::new(chosen.table.as_ref(), &facts, chosen.doubts);
    if startup.connected {
        memory.keep_safe(startup.safe);
    }
    let tick = Tick::new(startup, &facts, tick_queues, points, telemetry);
    let link_end = LinkEnd { queues: link_queues, points, telemetry };
    let device = Device::new(facts, &chip, memory, chosen, last_words, store, link_end);
    let link = Link::new(device, board.receiver, board.transmitter, Panel::new(board.front));
    let mut supply = Measured::of(facts.supply_mv);
    telemetry.begin(&facts, &supply);
    (board.start)(tick);
    // Begins the first measurement; what it gives is from before.
    chip.measure_supply();
    let watchdog = async {
        let mut seen = 0;
        let (started, mut young) = (Instant::now(), true);
        let mut faults = Faults::empty();
        loop {
            // An emulated board's main loop is as late as its host, and no watchdog ends it.
            if !facts.emulated {
                telemetry.beat();
            }
            let ticks = telemetry.ticks.load(Relaxed);
            if ticks != seen {
                seen = ticks;
                chip.feed_watchdog();
            }
            if young && started.elapsed() > SOON {
                young = false;
                memory.forget();
            }
            Timer::after(WATCHDOG).await;
            supply.take(chip.measure_supply());
            telemetry.supply.publish(&supply);
            if telemetry.faults() != faults {
                faults = telemetry.faults();
                log_faults(faults);
            }
        }
    };
    match select(link.serve(), watchdog).await {
        Either::First(()) => {
            memory.asked();
            Ok(())
        }
        Either::Second(never) => never,
    }
}

#[cfg(feature = "on-target")]
fn log_start(source: &TableSource) {
    match source {
        TableSource::Stored => defmt::info!("the stored table is used"),
        TableSource::Compiled { reason } => defmt::info!("the compiled table is used: {=str}", reason.as_str()),
        TableSource::None { stored, compiled } => {
            defmt::error!("no table: {=str}; compiled: {=str}", stored.as_str(), compiled.as_str());
        }
    }
}

#[cfg(feature = "on-target")]
fn log_faults(faults: Faults) {
    defmt::warn!("faults {=u16:#017b}", faults.bits());
}

/// The host's tests have no log.
#[cfg(not(feature = "on-target"))]
fn log_start(_: &TableSource) {}

#[cfg(not(feature = "on-target"))]
fn log_faults(_: Faults) {}
