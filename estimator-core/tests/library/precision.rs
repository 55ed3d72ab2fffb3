//! What an `f32` is off by: every model in the target's number type beside the reference in `f64`, over codes that
//! make hysteresis memories decide: retreats of just the deadband, memories that overflow, swings that shrink a code
//! at a time, sawtooths.
#![cfg(not(feature = "micromath"))]

use crate::common::VOIGT;
use crate::common::models::table_of;
use estimator_core::model::CELLS;
use estimator_core::*;

/// The most that `f32` and `f64` differ by, of the span of the table's displacement limits.
/// `book/src/promises.md` states it.
const STATED: &[(Model, f64)] = &[
    (Model::Voigt, 2e-6),
    (Model::VoltageExtremum, 2e-6),
    (Model::DisplacementExtremum, 2e-6),
    (Model::Enhanced, 2e-6),
    (Model::VoigtChain, 2e-6),
    (Model::PrandtlIshlinskii, 2e-6),
    (Model::MaxwellSlip, 2e-6),
    (Model::Duhem, 2e-6),
    (Model::BoucWen, 2e-6),
    (Model::Preisach, 2e-6),
    (Model::Narx, 2e-6),
    (Model::GeneralisedPrandtlIshlinskii, 2e-6),
];
/// Tables of each model, sequences of each table and ticks of each sequence.
const TABLES: u32 = 12;
const SEQUENCES: u32 = 12;
const TICKS: usize = 1_500;
/// Limits within which every model here is bounded, µm.
const WIDE: Range = Range { min: -1e4, max: 1e4 };

/// Repeatable numbers of 0 … 1 (Numerical Recipes).
struct Random(u32);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / 16_777_216.0
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }

    fn below(&mut self, count: u16) -> u16 {
        (self.next() * f32::from(count)) as u16
    }
}

/// The fixture's parameters, with what decides how they round or remember at random.
fn varied(parameters: Parameters, random: &mut Random) -> Parameters {
    match parameters {
        Parameters::Preisach(of) => Parameters::Preisach(PreisachParameters {
            // A lag decides by its last bit what a full memory forgets.
            lag_s: if random.next() < 0.5 { 0.0 } else { random.between(1e-4, 5e-3) },
            densities_um: List::collect((0..CELLS).map(|_| random.between(0.0, 1.5).powi(2))).unwrap(),
            ..of
        }),
        Parameters::Narx(of) => {
            let scale = random.between(0.005, 0.012);
            let own = random.between(0.1, 0.4);
            let weigh = |i| if i == 0 { own } else { scale * random.between(-1.0, 1.0) };
            Parameters::Narx(NarxParameters { coefficients: List::collect((0..39).map(weigh)).unwrap(), ..of })
        }
        Parameters::GeneralisedPrandtlIshlinskii(of) => {
            Parameters::GeneralisedPrandtlIshlinskii(GeneralisedPrandtlIshlinskiiParameters {
                // From the slowest that is admitted, a 400th of the tick rate.
                resonance_hz: 5.0 * 198.0f32.powf(random.next()),
                damping: random.between(0.003, 0.95),
                delay_ticks: random.between(-1.0, 8.0),
                slew_v_per_s: if random.next() < 0.5 { 0.0 } else { 30_000.0 },
                ..of
            })
        }
        Parameters::VoigtChain(of) => Parameters::VoigtChain(VoigtChainParameters {
            voltage_extremum_um_per_v: random.between(-0.05, 0.05),
            ..of
        }),
        other if other.model().is_voigt() => {
            let model = other.model();
            let (g_um_per_s, h) = if model.has_voltage_term() {
                (random.between(-6.0, 6.0), random.between(0.3, 1.2))
            } else {
                (0.0, 0.0)
            };
            let (e_m_per_s, f) = if model.has_displacement_term() {
                (random.between(-2e-5, 2e-6), random.between(1.0, 1.2))
            } else {
                (0.0, 0.0)
            };
            Parameters::of_voigt_family(model, VoigtParameters { g_um_per_s, h, e_m_per_s, f, ..VOIGT })
        }
        other => other,
    }
}

/// An admitted table of a model, of a converter of 12 or 16 bits, its deadband just a whole number of codes.
fn table(model: Model, random: &mut Random) -> Admitted {
    for _ in 0..200 {
        let base = Table { drive: None, ..table_of(model) };
        let Range { min, max } = base.voltage_range_v;
        let full_scale = if random.next() < 0.5 { 4095 } else { 65_520 };
        let gain_v_per_code = (max - min) * random.between(1.01, 1.3) / f32::from(full_scale);
        let adc = AdcCalibration {
            gain_v_per_code,
            offset_v: min - 0.003 * (max - min),
            invert: random.next() < 0.3,
            full_scale,
        };
        let adc = if adc.invert { AdcCalibration { offset_v: max + 0.003 * (max - min), ..adc } } else { adc };
        let deadband = gain_v_per_code * f32::from(random.below(8));
        let mut parameters = varied(base.parameters, random);
        match &mut parameters {
            Parameters::Narx(of) => of.deadband_v = deadband,
            Parameters::VoigtChain(of) => of.deadband_v = deadband,
            _ => {}
        }
        let table = Table { adc, deadband_v: deadband, parameters, ..base };
        // As tight as can be proven, and a thousandth for what rounds, as `identify` does.
        let reach = table.engine::<f32>().bound(table.voltage_range_v, WIDE);
        let limits = match reach {
            Ok(reach) if reach != WIDE => {
                let margin = 1e-3 * reach.span();
                Range { min: reach.min - margin, max: reach.max + margin }
            }
            _ => base.displacement_limits_um,
        };
        if let Ok(admitted) = (Table { displacement_limits_um: limits, ..table }).admit() {
            return admitted;
        }
    }
    panic!("{model}: no table is admitted");
}

/// Codes: ring-downs by whole codes, swings that retreat by just the deadband and one code more or less, jumps, noise.
fn codes(full_scale: u16, deadband: u16, random: &mut Random) -> Vec<AdcCode> {
    let mut codes = Vec::new();
    let inside = |code: f32| code.clamp(1.0, f32::from(full_scale) - 1.0) as u16;
    while codes.len() < TICKS {
        let middle = random.between(0.2, 0.8) * f32::from(full_scale);
        let radius = random.between(0.01, 0.3) * f32::from(full_scale);
        let kind = random.below(6);
        for k in 0..100u16 {
            let k = f32::from(k);
            let sign = if k % 2.0 == 0.0 { 1.0 } else { -1.0 };
            codes.push(match kind {
                // 100 reversals that shrink evenly, or by a factor.
                0 => inside(middle + sign * radius * (1.0 - k / 100.0)),
                1 => inside(middle + sign * radius * 0.96f32.powf(k)),
                // Steps up, and back by the deadband or a code about it.
                2 => {
                    let back = f32::from(deadband) + f32::from(random.below(3)) - 1.0;
                    inside(middle + 3.0 * k + if sign > 0.0 { 0.0 } else { -back - 3.0 })
                }
                // A sawtooth of a few ticks: what rounds one way piles up.
                3 => inside(middle + radius * (2.0 * (k % 7.0) / 6.0 - 1.0)),
                4 => inside(random.next() * f32::from(full_scale)),
                _ => inside(middle + radius * (0.7 * k).sin()),
            });
        }
    }
    codes.into_iter().map(AdcCode).collect()
}

#[test]
fn an_f32_is_off_by_no_more_than_is_stated_and_no_admitted_table_is_clamped() {
    let mut found = Vec::new();
    for &(model, stated) in STATED {
        let mut random = Random(7);
        let mut worst = 0.0f64;
        for _ in 0..TABLES {
            let table = table(model, &mut random);
            let span = f64::from(table.displacement_limits_um.span());
            let deadband = (table.deadband_v / table.adc.gain_v_per_code).round() as u16;
            for _ in 0..SEQUENCES {
                let (mut single, mut double) = (Estimator::<f32>::new(&table), Estimator::<f64>::new(&table));
                for code in codes(table.adc.full_scale, deadband, &mut random) {
                    let (one, other) = (single.tick(code), double.tick(code));
                    assert!(!one.status.contains(Status::CLAMPED), "{model}: {} µm, {table:?}", one.displacement);
                    // Where the DAC's last code begins is the rounding's.
                    let said = |status: Status| status.difference(Status::DAC_SATURATED);
                    assert_eq!(said(one.status), said(other.status), "{model}");
                    worst = worst.max((f64::from(one.displacement) - other.displacement).abs() / span);
                }
            }
        }
        found.push((model.name(), worst, stated));
    }
    assert!(found.iter().all(|(_, worst, stated)| worst <= stated), "{found:#?}");
}
