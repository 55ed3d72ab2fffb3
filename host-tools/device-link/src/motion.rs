//! Whether the voltage moves: what a displacement of now is worth that is called something.
//!
//! The voltage is averaged over as many samples as `AVERAGED` says, which takes noise off and leaves what an actuator
//! follows. It moves where either mean goes over more than `STILL` of the table's voltages, and twice its deadband,
//! within [`LOOKED_S`]: a sine of 0.01 Hz over all of them does for half of its time, and not around its ends, where
//! it is slower.

use crate::client::Client;
use crate::error::LinkError;
use crate::window::Window;
use estimator_core::{AdcCode, Admitted};
use protocol::Sample;
use std::time::{Duration, Instant};

/// How long it is looked at, s of the device.
pub const LOOKED_S: f64 = 0.5;
/// Samples that are averaged: a mean over 8 sees no sine whose period is 8 samples, or a part of them; the mean
/// over 7 does.
const AVERAGED: [usize; 2] = [7, 8];
/// Part of the table's voltage range within which a voltage stands still.
const STILL: f64 = 0.01;
/// How long to wait for the first samples, and how long for all of them: a busy line gives fewer.
const PATIENCE: Duration = Duration::from_secs(1);

/// What the device did while it was looked at.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Motion {
    /// The displacement of the last tick, µm; none where no samples came.
    pub displacement_um: Option<f32>,
    /// How far the voltage went, noise apart, V, where it moves.
    pub moved_v: Option<f64>,
    /// How far the estimate went meanwhile, µm.
    pub moved_um: f64,
}

impl Motion {
    /// What a device that runs this table did at the end of the last second, as far back as there are samples.
    pub fn within(window: &Window, table: &Admitted) -> Self {
        let samples = (LOOKED_S / (table.sample_period::<f64>() * f64::from(window.every().get()))) as usize;
        Self::of(&window.tail(samples), table)
    }

    fn of(samples: &[Sample], table: &Admitted) -> Self {
        let volts: Vec<f64> = samples.iter().map(|sample| table.adc.voltage(AdcCode(sample.code))).collect();
        let over =
            |averaged: usize| extent(volts.windows(averaged).map(|part| part.iter().sum::<f64>() / averaged as f64));
        let moved_v = AVERAGED.map(over).into_iter().fold(0.0, f64::max);
        let still = STILL * f64::from(table.voltage_range_v.span()) + 2.0 * f64::from(table.deadband_v);
        Self {
            displacement_um: samples.last().map(|sample| sample.displacement),
            moved_v: Some(moved_v).filter(|moved| *moved > still),
            moved_um: extent(samples.iter().map(|sample| sample.displacement.into())),
        }
    }
}

/// From the least to the largest; 0 of nothing.
fn extent(numbers: impl Iterator<Item = f64>) -> f64 {
    let (least, most) =
        numbers.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| (least.min(x), most.max(x)));
    (most - least).max(0.0)
}

/// Looks at what a device that runs this table does; the stream is stopped afterwards.
///
/// # Errors
/// The link fails.
pub fn look(client: &mut Client, table: &Admitted) -> Result<Motion, LinkError> {
    Ok(Motion::of(&streamed(client, LOOKED_S / table.sample_period::<f64>())?, table))
}

/// The displacement of now, µm; none where no samples come. The stream is stopped afterwards.
///
/// # Errors
/// The link fails.
pub fn displacement(client: &mut Client) -> Result<Option<f32>, LinkError> {
    Ok(streamed(client, 1.0)?.last().map(|sample| sample.displacement))
}

fn streamed(client: &mut Client, ticks: f64) -> Result<Vec<Sample>, LinkError> {
    client.stream(true)?;
    let heard = hear(client, ticks);
    // What went wrong first is what is said.
    let stopped = client.stream(false);
    let samples = heard?;
    stopped?;
    Ok(samples)
}

/// Samples of so many ticks, or of as many as come in time.
fn hear(client: &mut Client, ticks: f64) -> Result<Vec<Sample>, LinkError> {
    let (start, mut samples, mut heard) = (Instant::now(), Vec::new(), 0.0);
    while heard < ticks && (samples.is_empty() || start.elapsed() < PATIENCE) {
        let Some(batch) = client.samples(PATIENCE)? else { break };
        heard += batch.samples.len() as f64 * f64::from(batch.every.get());
        samples.extend(batch.samples);
    }
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;
    use emulator::TABLE;
    use protocol::Samples;
    use std::num::NonZeroU8;

    /// How far it moves, of a voltage by the tick, as a part of the table's voltages above their middle.
    fn moved(of: impl Fn(f64) -> f64) -> Option<f64> {
        let table = TABLE.admit().unwrap();
        let (range, s) = (table.voltage_range_v, table.sample_period::<f64>());
        let sample = |tick: u32| {
            let volts = f64::from(range.min) + f64::from(range.span()) * (0.5 + of(f64::from(tick) * s));
            Sample {
                code: table.adc.code(volts as f32).0,
                sensor: None,
                displacement: volts as f32,
                half_width: None,
                dac: 0,
                status: Default::default(),
                faults: Default::default(),
            }
        };
        let samples: Vec<Sample> = (0..(LOOKED_S / s) as u32).map(sample).collect();
        Motion::of(&samples, &table).moved_v
    }

    #[test]
    fn what_moves_is_told_from_noise_and_from_what_stands() {
        let sine = |hertz: f64, part: f64| move |s: f64| part * (std::f64::consts::TAU * hertz * s).sin();
        assert_eq!(moved(|_| 0.2), None);
        // Noise of 0.3 % rms, several times what a converter has.
        let noise = |s: f64| {
            let draw =
                |n: u32| f64::from(((s * 2e3) as u32 * 4 + n + 1).wrapping_mul(2_654_435_761) >> 8) / 2f64.powi(24);
            0.003 * 3f64.sqrt() * ((0..4).map(draw).sum::<f64>() - 2.0)
        };
        assert_eq!(moved(noise), None);
        for (hertz, part) in [(0.01, 0.5), (1.0, 0.05), (20.0, 0.05), (100.0, 0.05)] {
            assert!(moved(sine(hertz, part)).is_some(), "{hertz} Hz");
        }
        // A sine of a quarter of the voltages at any frequency up to half the rate.
        for hertz in (1..=200).map(|k| 5.0 * f64::from(k)) {
            let swing = |s: f64| 0.25 * (std::f64::consts::TAU * hertz * s).cos();
            assert!(moved(swing).is_some(), "{hertz} Hz");
        }
        // The slowest that the documentation names moves for half of its time.
        let slow = |from: u32| moved(move |s| 0.5 * (std::f64::consts::TAU * 0.01 * (s + f64::from(from))).sin());
        let moves = (0..100).filter(|&from| slow(from).is_some()).count();
        assert!((45..=60).contains(&moves) && slow(25).is_none(), "{moves} of 100 s");
        assert!(moved(|s| 0.1 * s).is_some(), "a ramp");
        assert_eq!(Motion::of(&[], &TABLE.admit().unwrap()), Motion::default());
    }

    #[test]
    fn of_a_stream_what_came_last_is_looked_at_also_where_ticks_are_left_out() {
        let table = TABLE.admit().unwrap();
        let sample = |code| Sample {
            code,
            sensor: None,
            displacement: 0.0,
            half_width: None,
            dac: 0,
            status: Default::default(),
            faults: Default::default(),
        };
        for every in [1, 4].map(|every| NonZeroU8::new(every).unwrap()) {
            // It leaps, and stands for so long.
            let moved = |stood_s: f64| {
                let mut window = Window::new(table.adc, (1.0 / table.sample_period::<f64>()) as usize);
                let stood = (stood_s / table.sample_period::<f64>()) as usize / usize::from(every.get());
                let codes = std::iter::repeat_n(10_000, 50).chain(std::iter::repeat_n(30_000, stood));
                for (number, code) in (0..).zip(codes) {
                    let samples = std::iter::once(sample(code)).collect();
                    window.take(&Samples { first: number * u32::from(every.get()), every, samples });
                }
                Motion::within(&window, &table).moved_v
            };
            assert!(moved(0.9 * LOOKED_S).is_some() && moved(1.1 * LOOKED_S).is_none(), "{every}");
        }
    }
}
