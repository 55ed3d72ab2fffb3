//! What a table's estimator and inverse give in `f32`, bit for bit, for a face of the core in another language to be
//! compared with: `bits table.bin`.
//!
//! A line is a letter and numbers in hexadecimal, an `f32` by its bits: `L` limits of the inverse (least, greatest and
//! rest voltage, V; change, V/s), where there is one; `E` code of the ADC, displacement and half-width (µm), status;
//! `Z` displacement that is told (µm), and whether it was taken; `C` displacement that is wanted (µm), voltage (V),
//! displacement (µm), whether it is reached.

use estimator_core::{AdcCode, Commanded, DriveLimits, Estimate, Estimator, Inverse, Range, Table};
use std::error::Error;

const TICKS: u32 = 12_000;
/// When an actuator that moved at the start has come to where it goes.
const TOLD_AT: u32 = 8000;

fn line(letter: char, numbers: [u32; 4]) {
    let [first, second, third, fourth] = numbers;
    println!("{letter} {first:08x} {second:08x} {third:08x} {fourth:08x}");
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("bits table.bin")?;
    let table = Table::parse(&std::fs::read(path)?)?;
    let zero = table.voltage_zero_v;
    let range_v = Range { min: table.voltage_range_v.min + zero, max: table.voltage_range_v.max + zero };
    let limits = DriveLimits { range_v, rest_v: range_v.min, slew_v_per_s: 100.0 * range_v.span() };
    let mut estimator = Estimator::<f32>::new(&table);
    let mut inverse: Option<Inverse<f32>> = table.inverse(&limits).ok();
    if inverse.is_some() {
        line('L', [range_v.min, range_v.max, limits.rest_v, limits.slew_v_per_s].map(f32::to_bits));
    }
    let displacements = table.displacement_limits_um;
    let mut noise = 1u32;
    for tick in 0..TICKS {
        // A triangle, then noise that reaches every code.
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let phase = tick % 800;
        let triangle = 160 * if phase < 400 { phase } else { 800 - phase };
        let code = u16::try_from(if tick < TOLD_AT { triangle } else { noise >> 16 })?;
        let Estimate { displacement, half_width, status, .. } = estimator.tick(AdcCode(code));
        let half_width = half_width.unwrap_or(f32::NAN);
        line('E', [code.into(), displacement.to_bits(), half_width.to_bits(), status.bits().into()]);
        if let Some(inverse) = &mut inverse {
            let wanted = displacements.min + displacements.span() * (f32::from(code) / 65536.0);
            let Commanded { voltage, displacement, reached } = inverse.tick(wanted);
            line('C', [wanted.to_bits(), voltage.to_bits(), displacement.to_bits(), reached.into()]);
        }
        if tick == TOLD_AT {
            let told = estimator.set_zero(1.0);
            line('Z', [1.0f32.to_bits(), told.into(), 0, 0]);
        }
    }
    Ok(())
}
