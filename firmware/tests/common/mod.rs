//! A tick and its other half, on the host.
#![allow(dead_code, reason = "each test uses its part")]

use estimator_core::{AdcCode, Admitted, DacCode, DriveCalibration, DriveLimits, Estimator, Range, Table};
use firmware::drive::Drive;
use firmware::tick::{Command, Numbered, Queues};
use firmware::{Converters, Telemetry, Tick};
use heapless::spsc::{Consumer, Producer, Queue};
use protocol::Faults;

pub const CONVERTERS: Converters = Converters { adc_full_scale: 65_520, dac_full_scale: 4095 };
/// Cycles from tick to tick.
pub const PERIOD: u32 = 85_000;
pub const SAFE: DacCode = DacCode(252);

pub fn compiled() -> Admitted {
    firmware::table::TABLE.admit().expect("the compiled table is admissible")
}

/// The compiled table with another seed: as good, and told apart by its record.
pub fn other() -> Admitted {
    let mut table: Table = *compiled();
    table.provenance.seed += 1;
    table.admit().expect("the seed does not matter")
}

pub fn record(table: &Admitted) -> protocol::Record {
    let mut buffer = [0; estimator_core::record::MAX_LENGTH];
    let length = table.encode(&mut buffer).expect("the longest record fits");
    buffer[..length].iter().copied().collect()
}

/// The compiled table, its DAC driving an amplifier of 0 … 4 V at 0 … full scale.
pub fn driving() -> Admitted {
    let limits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
    let drive = DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits };
    Table { drive: Some(drive), ..*compiled() }.admit().expect("the Voigt family has an inverse")
}

/// The side of the queues that the link has.
pub struct Other {
    pub commands: Producer<'static, Command>,
    pub feed: Producer<'static, AdcCode>,
    pub refer: Producer<'static, f32>,
    pub samples: Consumer<'static, Numbered>,
    pub telemetry: &'static Telemetry,
}

/// A tick; `None` has no table.
pub fn tick(table: Option<&Admitted>, standing: Faults) -> (Tick<'static>, Other) {
    let (commands, to_commands) = {
        let (producer, consumer) = Box::leak(Box::new(Queue::<Command, 4>::new())).split();
        (consumer, producer)
    };
    let (feed, fed) = Box::leak(Box::new(Queue::<AdcCode, 256>::new())).split();
    let (refer, references) = Box::leak(Box::new(Queue::<f32, 256>::new())).split();
    let (to_link, samples) = Box::leak(Box::new(Queue::<Numbered, 256>::new())).split();
    let telemetry: &'static Telemetry = Box::leak(Box::new(Telemetry::new()));
    let estimator = table.map(|table| Estimator::new(table, None).expect("a direct table needs no lookup"));
    let queues = Queues { commands, fed, references, samples: to_link };
    let drive = table.and_then(Drive::new);
    let safe = table.and_then(Drive::rest).unwrap_or(SAFE);
    let tick = Tick::new(estimator, drive, safe, CONVERTERS, queues, telemetry, PERIOD, standing);
    (tick, Other { commands: to_commands, feed, refer, samples, telemetry })
}

/// A code that goes up and down over most of the range.
pub fn triangle(k: u32) -> AdcCode {
    let phase = k % 2_000;
    AdcCode((3_000 + 59 * phase.min(2_000 - phase)) as u16)
}
