//! Puts the parts together and never ends.

use crate::boot::{self, Chosen};
use crate::drive::Drive;
use crate::last_words;
use crate::link::{Device, Link};
use crate::peripherals::Peripherals;
use crate::table::TABLE;
use crate::telemetry::Telemetry;
use crate::tick::{Command, Numbered, Queues, Tick};
use core::sync::atomic::Ordering::Relaxed;
use embassy_futures::join::join;
use embassy_time::{Duration, Timer};
use embedded_io_async::{Read, Write};
use embedded_storage_async::nor_flash::NorFlash;
use estimator_core::{AdcCode, DacCode, Estimator, Lookup};
use heapless::spsc::Queue;
use parameter_store::{ParameterStore, StoreError};
use protocol::{Faults, TableSource};
use static_cell::{ConstStaticCell, StaticCell};

/// How often the watchdog is fed, if a tick has run since: a tenth of its period.
const WATCHDOG: Duration = Duration::from_millis(20);

/// What the tick leaves for others to read. A board's interrupt handler adds its duration.
pub static TELEMETRY: Telemetry = Telemetry::new();

/// Runs the firmware on a board. To be called once.
///
/// # Errors
/// The parameter pages do not fit the flash: a mistake in the board or its memory map.
pub async fn run<R: Read, W: Write, F: NorFlash, D: FnMut(), S: FnOnce(Tick<'static>)>(
    board: Peripherals<R, W, F, D, S>,
) -> Result<core::convert::Infallible, StoreError> {
    static COMMANDS: ConstStaticCell<Queue<Command, 4>> = ConstStaticCell::new(Queue::new());
    static FED: ConstStaticCell<Queue<AdcCode, 256>> = ConstStaticCell::new(Queue::new());
    static REFERENCES: ConstStaticCell<Queue<f32, 256>> = ConstStaticCell::new(Queue::new());
    static SAMPLES: ConstStaticCell<Queue<Numbered, 256>> = ConstStaticCell::new(Queue::new());
    static LOOKUP: StaticCell<Lookup<f32>> = StaticCell::new();

    // SAFETY: this function is called once, before the tick and every task.
    let last_words = unsafe { last_words::take() };
    let mut store = ParameterStore::new(board.flash, board.pages)?;
    let Chosen { table, source, fallback } = boot::choose(&mut store, TABLE, board.converters).await;
    log_start(&source);
    let (to_tick, commands) = COMMANDS.take().split();
    let (feed, fed) = FED.take().split();
    let (refer, references) = REFERENCES.take().split();
    let (to_link, samples) = SAMPLES.take().split();

    let estimator = table.and_then(|table| {
        let lookup = table.lookup().map(|lookup| &*LOOKUP.init(lookup));
        // Cannot fail: the lookup has just been made from the table.
        Estimator::new(&table, lookup).ok()
    });
    // The safe output says "at the model's zero", which is where an unpowered actuator is, or is the drive's rest; without a
    // table nobody knows which code that is, and it is half scale.
    let safe = table.map_or(DacCode(board.converters.dac_full_scale / 2), |table| {
        Drive::rest(&table).unwrap_or_else(|| table.dac.code(0.0f32))
    });
    let drive = table.as_ref().and_then(Drive::new);
    let mut standing = Faults::empty();
    standing.set(Faults::SUPPLY, !board.supply_good);
    standing.set(Faults::TABLE_FALLBACK, fallback);
    let queues = Queues { commands, fed, references, samples: to_link };
    let tick = Tick::new(estimator, drive, safe, board.converters, queues, &TELEMETRY, board.cycles_per_tick, standing);

    let device = Device {
        board: board.board,
        converters: board.converters,
        cycles_per_tick: board.cycles_per_tick,
        reset: board.reset,
        supply_mv: board.supply_mv,
        flash_errors: board.flash_errors,
        line_errors: board.line_errors,
        restart: board.restart,
        table,
        source,
        last_words,
        store,
        telemetry: &TELEMETRY,
        commands: to_tick,
        feed,
        refer,
        samples,
        frames_refused: 0,
        read_errors: 0,
    };
    let link = Link::new(device, board.receiver, board.transmitter);
    (board.start)(tick);
    let mut feed_watchdog = board.feed_watchdog;
    let watchdog = async {
        let mut seen = 0;
        let mut faults = Faults::empty();
        loop {
            let ticks = TELEMETRY.ticks.load(Relaxed);
            if ticks != seen {
                seen = ticks;
                feed_watchdog();
            }
            if TELEMETRY.faults() != faults {
                faults = TELEMETRY.faults();
                log_faults(faults);
            }
            Timer::after(WATCHDOG).await;
        }
    };
    let (never, _): (core::convert::Infallible, core::convert::Infallible) = join(link.serve(), watchdog).await;
    match never {}
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
    defmt::warn!("faults {=u8:#010b}", faults.bits());
}

/// The host's tests have no log.
#[cfg(not(feature = "on-target"))]
fn log_start(_: &TableSource) {}

#[cfg(not(feature = "on-target"))]
fn log_faults(_: Faults) {}
