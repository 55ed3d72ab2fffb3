//! A tick and its other half, on the host.
#![allow(dead_code, reason = "each test uses its part")]

pub mod driven;

use estimator_core::table::Interface;
use estimator_core::{
    AdcCode, Admitted, BoucWenParameters, DacCode, DriveCalibration, DriveLimits, Parameters, Range,
    SetpointCalibration, Table,
};
use firmware::drive::Drive;
use firmware::queues::Queues;
use firmware::restarts::Restarts;
use firmware::shaping::DacParts;
use firmware::startup::Startup;
use firmware::waveform::Points;
use firmware::{Facts, Telemetry, Tick};
use protocol::{Faults, ResetCause, Uid};

/// Cycles from tick to tick.
pub const PERIOD: u32 = 85_000;
pub const FACTS: Facts = Facts {
    name: "bench",
    emulated: false,
    uid: Some(Uid([7; 12])),
    has_setpoint: true,
    has_trigger: true,
    interface: Interface { tick_us: 500, adc_full_scale: 65_520, dac_full_scale: 4095 },
    dac_parts: 1,
    cycles_per_tick: PERIOD,
    reset: ResetCause::WATCHDOG,
    restarts: Restarts::NONE,
    supply_mv: Some(3301.0),
    brown_out_level: Some(4),
    clock_good: true,
    no_store: None,
};
/// What the DAC is given for the safe code of the compiled table; a part is a code here.
pub const SAFE: DacParts = DacParts(252);

pub fn compiled() -> Admitted {
    firmware::compiled::TABLE.admit().expect("the compiled table is admissible")
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
    let drive = DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits, setpoint: None };
    Table { drive: Some(drive), ..*compiled() }.admit().expect("the Voigt family has an inverse")
}

/// A table whose drive takes more of a tick than there may be: the Bouc–Wen model with an exponent of 2,
/// which it integrates in steps, driving an amplifier as [`driving`] does.
pub fn too_long() -> Admitted {
    let of = BoucWenParameters {
        lag_s: 0.0,
        a: 1.0,
        beta: 0.5,
        gamma: 0.3,
        delta: 0.0,
        n: 2.0,
        offset_um: 0.0,
        d1_um_per_v: 15.0,
        d2_um_per_v2: 0.0,
        c_um_per_v: -3.0,
    };
    let limits = Range { min: -50.0, max: 100.0 };
    let table = Table { parameters: Parameters::BoucWen(of), displacement_limits_um: limits, ..*driving() };
    table.admit().expect("it has an inverse")
}

/// Code 0 is −5 µm, full scale 45 µm.
pub const SETPOINT: SetpointCalibration =
    SetpointCalibration { gain_um_per_code: 50.0 / 65_520.0, offset_um: -5.0, at_start: true };

/// A table that drives, and may by a set-point; after a start of itself or not.
pub fn linearising(at_start: bool) -> Admitted {
    let setpoint = Some(SetpointCalibration { at_start, ..SETPOINT });
    let drive = driving().drive.map(|drive| DriveCalibration { setpoint, ..drive });
    Table { drive, ..*driving() }.admit().expect("the span shares displacements with the limits")
}

/// What the link has of a tick.
pub type LinkEnd = firmware::link::LinkEnd<'static>;

/// A tick with further faults since boot; `None` has no table.
pub fn tick(table: Option<&Admitted>, faults: Faults) -> (Tick<'static>, LinkEnd) {
    let start = Startup::new(table, &FACTS, Faults::empty());
    let safe = table.and_then(Drive::rest).unwrap_or(DacCode(SAFE.0));
    started(Startup { safe, faults: start.faults | faults, ..start })
}

/// A tick that starts so.
pub fn started(startup: Startup) -> (Tick<'static>, LinkEnd) {
    started_on(&FACTS, startup)
}

/// The same on a board of these facts.
pub fn started_on(facts: &Facts, startup: Startup) -> (Tick<'static>, LinkEnd) {
    let (tick_queues, queues) = Box::leak(Box::new(Queues::new())).split();
    let telemetry: &'static Telemetry = Box::leak(Box::new(Telemetry::new()));
    let points: &'static Points = Box::leak(Box::new(Points::new()));
    (Tick::new(startup, facts, tick_queues, points, telemetry), LinkEnd { queues, telemetry, points })
}

/// A code that goes up and down over most of the range.
pub fn triangle(k: u32) -> AdcCode {
    let phase = k % 2_000;
    AdcCode((3_000 + 59 * phase.min(2_000 - phase)) as u16)
}
