//! Runs of the firmware's tick with a fault of the signal, and without one.

use super::{Converter, FAULTS, Outcome, SignalFault, read};
use crate::board::facts;
use crate::emulator::UID;
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::Admitted;
use firmware::queues::{Command, Queues};
use firmware::rate::TICK_HZ;
use firmware::restarts::Restarts;
use firmware::startup::Startup;
use firmware::supply::{MADE_FOR_MV, Measured};
use firmware::waveform::Points;
use firmware::{Telemetry, Tick};
use protocol::{Faults, ResetCause, Sample};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// The tick at which the displacement is told.
const TOLD: u32 = 5 * TICK_HZ;
/// The tick at which a fault begins: a whole number of periods, where the voltage rises fastest.
const BEGINS: u32 = 8 * TICK_HZ;
/// Ticks that are looked at after a fault's end.
const AFTER: u32 = 10 * TICK_HZ;
/// What the voltage covers of the table's range, which is a tenth wider than what its logs covered.
const COVERED: f64 = 1.0 / 1.1;
/// Ticks from measurement to measurement of the supply.
const MEASURED: u32 = 40;

/// What a table's runs are compared with: its run without a fault.
pub struct Runs<'t> {
    table: &'t Admitted,
    sound: Vec<Sample>,
}

impl<'t> Runs<'t> {
    /// For a table; runs it without a fault, for long enough to compare each of [`FAULTS`].
    pub fn new(table: &'t Admitted) -> Self {
        let longest = FAULTS.iter().map(|fault| fault.ticks).max().unwrap_or_default();
        Self { table, sound: run(table, None, BEGINS + longest + AFTER) }
    }

    /// What the firmware makes of a fault.
    pub fn with(&self, fault: &SignalFault) -> Outcome {
        let faulty = run(self.table, Some(fault), BEGINS + fault.ticks + AFTER);
        let from = BEGINS as usize;
        Outcome::of(&self.sound[from..], &faulty[from..], fault.ticks as usize)
    }
}

/// The samples of so many ticks.
fn run(table: &Admitted, fault: Option<&SignalFault>, ticks: u32) -> Vec<Sample> {
    let facts = facts(ResetCause::BROWN_OUT, Restarts::NONE, UID, false);
    let (mut queues, points, telemetry) = (Queues::new(), Points::new(), Telemetry::new());
    let (of_tick, mut link) = queues.split();
    let mut tick = Tick::new(Startup::new(Some(table), &facts, Faults::empty()), &facts, of_tick, &points, &telemetry);
    telemetry.streaming.store(true, Relaxed);
    let (range, zero) = (table.voltage_range_v, f64::from(table.voltage_zero_v));
    let (min, max) = (f64::from(range.min) + zero, f64::from(range.max) + zero);
    let mut noise = ChaCha8Rng::seed_from_u64(1);
    let mut before = read(&table.adc, zero, f64::from(MADE_FOR_MV));
    let mut supply = Measured::default();
    let mut samples: Vec<Sample> = Vec::with_capacity(ticks as usize);
    for k in 0..ticks {
        let now = fault.filter(|fault| (BEGINS..BEGINS + fault.ticks).contains(&k));
        let supply_mv = now.map_or(f64::from(MADE_FOR_MV), SignalFault::supply_mv);
        if k % MEASURED == 0 {
            supply.take(Some(supply_mv as f32));
            telemetry.supply.publish(&supply);
        }
        if k == TOLD {
            // What it is already, so that a bias which is lost is no error of its own. There is room for a command.
            let at_um = samples.last().map_or(0.0, |sample| sample.displacement);
            let _ = link.commands.enqueue(Command::SetZero { at_um });
        }
        let volts = 0.5 * (min + max + COVERED * (max - min) * (TAU * f64::from(k) / f64::from(TICK_HZ)).sin());
        let code = match now {
            Some(fault) => {
                let mut converter = Converter { adc: &table.adc, range_v: (min, max), noise: &mut noise, before };
                fault.code(&mut converter, k - BEGINS, volts)
            }
            None => {
                before = read(&table.adc, volts, supply_mv);
                before
            }
        };
        tick.sample(code.into(), k.wrapping_mul(facts.cycles_per_tick));
        samples.extend(link.samples.dequeue().map(|numbered| numbered.sample));
    }
    samples
}
