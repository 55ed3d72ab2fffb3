//! The tables that the tick's cycles are counted with: of every model the one that was identified on the measured log,
//! and the largest that there may be; to estimate and, where the model has an inverse, to drive.

use super::largest;
use super::shapes::STEADY;
use anyhow::{Context, Result};
use estimator_core::table::Interface;
use estimator_core::*;
use serde::Deserialize;
use std::fs;
use std::path::Path;

/// What the board asks of a table.
pub const BOARD: Interface = Interface { tick_us: 500, adc_full_scale: 65_520, dac_full_scale: 4095 };
/// How much of its voltages a drive has.
const DRIVEN: f32 = 0.9;
/// From end to end of the drive's voltages at its slew rate, ticks: fast enough for the search to go far at every tick.
const STRIDES: f32 = 8.0;
/// An offset (µm) that leaves an `f32` too coarse for the search of the inverse to end before its last step.
const COARSE_UM: f32 = 20_000.0;

#[derive(Deserialize)]
struct File {
    table: Table,
}

/// The table of a model that was identified on the measured log.
fn identified(model: Model) -> Result<Table> {
    let file = format!("../data/table/models/{}.toml", model.name());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let File { table } = toml::from_str(&fs::read_to_string(&path)?).with_context(|| path.display().to_string())?;
    Ok(table)
}

/// The table with converters of the board that span its voltages and displacements, and the amplifier where it drives.
fn fitted(table: &Table, drives: bool) -> Result<Admitted> {
    let (zero, volts, way) = (table.voltage_zero_v, table.voltage_range_v, table.displacement_limits_um);
    let span = volts.span() * 1.04;
    let adc = AdcCalibration {
        gain_v_per_code: span / f32::from(BOARD.adc_full_scale),
        offset_v: volts.min + zero - 0.02 * volts.span(),
        invert: false,
        full_scale: BOARD.adc_full_scale,
    };
    let codes = f32::from(BOARD.dac_full_scale);
    let gain = codes / (way.span() * 1.04);
    let offset_code = -gain * (way.min - 0.02 * way.span());
    let dac = DacCalibration { gain_codes_per_um: gain, offset_code, full_scale: BOARD.dac_full_scale };
    let left = 0.5 * (1.0 - DRIVEN) * volts.span();
    let range_v = Range { min: volts.min + zero + left, max: volts.max + zero - left };
    let slew_v_per_s = range_v.span() / STRIDES * 2_000.0;
    let limits = DriveLimits { range_v, rest_v: range_v.min, slew_v_per_s };
    let gain_codes_per_v = codes / range_v.span();
    let drive =
        DriveCalibration { gain_codes_per_v, offset_code: -gain_codes_per_v * range_v.min, limits, setpoint: None };
    // As far as the codes go in a tick: each is looked at, and believed.
    let amplifier_slew_v_per_s = Some(span * 2_000.0);
    let table = Table {
        adc,
        amplifier_slew_v_per_s,
        dac,
        drive: drives.then_some(drive),
        sample_period_us: BOARD.tick_us,
        ..*table
    };
    Ok(table.admit()?)
}

/// The same with an amplifier so slow that [`leaping`](super::shapes::leaping) leaps; of a drive, as slow as that is.
pub fn slower(table: &Admitted) -> Result<Admitted> {
    let a_tick = STEADY * table.voltage_range_v.span();
    let slew = table.drive.map_or(a_tick * 2_000.0, |drive| drive.limits.slew_v_per_s);
    Ok(Table { amplifier_slew_v_per_s: Some(slew), ..**table }.admit()?)
}

/// The table with its displacements far from 0.
fn coarse(table: &Table) -> Table {
    let mut parameters = table.parameters;
    let offset = match &mut parameters {
        Parameters::VoigtChain(of) => &mut of.offset_um,
        Parameters::Duhem(of) => &mut of.offset_um,
        Parameters::BoucWen(of) => &mut of.offset_um,
        Parameters::Preisach(of) => &mut of.offset_um,
        Parameters::GeneralisedPrandtlIshlinskii(of) => &mut of.offset_um,
        _ => return *table,
    };
    *offset += COARSE_UM;
    let Range { min, max } = table.displacement_limits_um;
    Table { parameters, displacement_limits_um: Range { min: min + COARSE_UM, max: max + COARSE_UM }, ..*table }
}

/// The straight line of a board that has no model yet, over the table's voltages: a µm a V.
fn line(table: &Table) -> Table {
    let volts = table.voltage_range_v;
    let of = PrandtlIshlinskiiParameters {
        lag_s: 0.0,
        thresholds_v: List::of([0.0]),
        weights_um_per_v: List::of([1.0]),
        offset_um: 0.0,
        dead_zones_um: List::of([]),
        dead_zone_slopes: List::of([]),
        memory_v: volts,
    };
    let displacement_limits_um = Range { min: 1.1 * volts.min - 1.0, max: 1.1 * volts.max + 1.0 };
    Table { parameters: Parameters::PrandtlIshlinskii(of), displacement_limits_um, interval: None, ..*table }
}

/// The largest table; of the Bouc-Wen model one for each way to take a power.
fn variants(table: &Table) -> Vec<(&'static str, Table)> {
    if table.model() == Model::PrandtlIshlinskii {
        return vec![("largest", *table), ("line", line(table))];
    }
    let Parameters::BoucWen(of) = table.parameters else {
        return vec![(if table.model().is_voigt() { "identified" } else { "largest" }, *table)];
    };
    let of_exponent = |n| Table { parameters: Parameters::BoucWen(BoucWenParameters { n, ..of }), ..*table };
    vec![("n = 1", of_exponent(1.0)), ("n = 2", of_exponent(2.0)), ("n = 1.5", of_exponent(1.5))]
}

/// The tables of a model that estimate, or that drive; none where it has no inverse.
pub fn tables(model: Model, drives: bool) -> Result<Vec<(&'static str, Admitted)>> {
    let interval = identified(Model::GeneralisedPrandtlIshlinskii)?.interval;
    let identified = identified(model)?;
    let largest = if model.is_voigt() { identified } else { largest::models::table_of(model) };
    let largest = Table { interval, ..largest };
    // Those of Voigt's family have but one size.
    let mut tables = if model.is_voigt() { Vec::new() } else { vec![("identified", identified)] };
    let lag_s = if drives { 0.0 } else { -1e-6 * largest.sample_period_us as f32 };
    let unlagged = Table { parameters: largest.parameters.with_lag(lag_s), ..largest };
    // A lag lets less through, and a look-ahead is one more term; the lag of a chain with others is in its largest.
    let other = model != Model::GeneralisedPrandtlIshlinskii && unlagged.parameters != largest.parameters;
    for (name, table) in variants(&largest).into_iter().chain(other.then(|| variants(&unlagged)).into_iter().flatten())
    {
        // (The superposition of the Prandtl-Ishlinskii model takes no offset that its dead zones are not made for.)
        tables.push((name, if drives && model != Model::PrandtlIshlinskii { coarse(&table) } else { table }));
    }
    let mut fit = Vec::new();
    for (name, table) in tables {
        match fitted(&table, drives) {
            Err(error) if drives => println!("{}, {name}, is refused for driving: {error}", model.name()),
            table => fit.push((name, table.with_context(|| format!("{}, {name}", model.name()))?)),
        }
    }
    Ok(fit)
}
