//! What may go wrong with the monitor's signal before the converter has made a code of it, and what the firmware makes
//! of that: which flag it raises and when, how far the estimate is off meanwhile, and when it may be believed again.
//!
//! The voltage is a sine of 1 Hz over most of the table's range. A fault begins where it rises fastest, after the
//! displacement was told, so that the estimate has its ±. The error is the difference to the same run without the
//! fault. Codes of 12 bits are meant wherever a fault is given in codes: sixteen of the board's.

mod outcome;
mod run;

pub use outcome::{Outcome, Recovery};
pub use run::Runs;

use estimator_core::{AdcCalibration, AdcCode};
use firmware::rate::TICK_HZ;
use firmware::supply::MADE_FOR_MV;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// What happens to the signal.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Injected {
    /// Noise, codes rms.
    Noise(f64),
    /// A voltage is added, V.
    Added(f64),
    /// The code stays what it was as the fault began.
    Held,
    /// The voltage comes no higher than this part of the table's range: something before the converter is at its end.
    Clipped(f64),
    /// A voltage is added that grows to this many codes.
    Drift(f64),
    /// The wire is off, and the input reads 0 V with noise of two codes.
    Open,
    /// The voltage is beyond the converter's upper end, or the wire is off and something pulls the input there.
    AtTheEnd,
    /// The supply, which is the converter's reference, is off by so many percent.
    Supply(f64),
}

/// A fault of the signal: what it is called, what happens, and for how many ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SignalFault {
    /// What it is called.
    pub name: &'static str,
    /// What is done to the signal, and with which numbers.
    pub injected: Injected,
    /// For how many ticks.
    pub ticks: u32,
}

const SECONDS: u32 = TICK_HZ;

/// Every fault that the book has a row of, in its order.
pub const FAULTS: [SignalFault; 22] = [
    of("noise of 1 code rms, 10 s", Injected::Noise(1.0), 10 * SECONDS),
    of("noise of 5 codes rms, 10 s", Injected::Noise(5.0), 10 * SECONDS),
    of("noise of 20 codes rms, 10 s", Injected::Noise(20.0), 10 * SECONDS),
    of("noise of 50 codes rms, 10 s", Injected::Noise(50.0), 10 * SECONDS),
    of("glitch of +20 V, 1 tick", Injected::Added(20.0), 1),
    of("glitch of +20 V, 19 ticks", Injected::Added(20.0), 19),
    of("glitch of −20 V, 19 ticks", Injected::Added(-20.0), 19),
    of("glitch of +1 V, 1 tick", Injected::Added(1.0), 1),
    of("glitch of +1 V, 19 ticks", Injected::Added(1.0), 19),
    of("held for 10 ticks", Injected::Held, 10),
    of("held for 100 ticks", Injected::Held, 100),
    of("held for 0.5 s", Injected::Held, SECONDS / 2),
    of("held for 2 s", Injected::Held, 2 * SECONDS),
    of("at the converter's end, 1 s", Injected::AtTheEnd, SECONDS),
    of("clipped at 80 % of the range, 10 s", Injected::Clipped(0.8), 10 * SECONDS),
    of("offset that drifts by 10 codes in 10 s", Injected::Drift(10.0), 10 * SECONDS),
    of("offset that drifts by 50 codes in 10 s", Injected::Drift(50.0), 10 * SECONDS),
    of("offset of +0.3 V, 10 s", Injected::Added(0.3), 10 * SECONDS),
    of("disconnected, reads 0 V, 10 s", Injected::Open, 10 * SECONDS),
    of("supply +4 %, 10 s", Injected::Supply(4.0), 10 * SECONDS),
    of("supply −4 %, 10 s", Injected::Supply(-4.0), 10 * SECONDS),
    of("supply −8 %, 10 s", Injected::Supply(-8.0), 10 * SECONDS),
];

const fn of(name: &'static str, injected: Injected, ticks: u32) -> SignalFault {
    SignalFault { name, injected, ticks }
}

/// Codes of the board in a code of 12 bits.
const FINER: f64 = 16.0;
/// Noise of an input that nothing is connected to, codes rms.
const OPEN_NOISE: f64 = 2.0;

/// What a converter reads.
pub(crate) struct Converter<'r> {
    pub adc: &'r AdcCalibration,
    /// The table's lowest and highest voltage, V.
    pub range_v: (f64, f64),
    pub noise: &'r mut ChaCha8Rng,
    /// The code before the fault.
    pub before: AdcCode,
}

impl SignalFault {
    /// The code of a voltage (V) at the `n`th tick of the fault.
    pub(crate) fn code(&self, converter: &mut Converter<'_>, n: u32, volts: f64) -> AdcCode {
        let step = FINER * f64::from(converter.adc.gain_v_per_code);
        let mut noisy = |volts: f64, codes: f64| -> f64 {
            let normal: f64 = StandardNormal.sample(converter.noise);
            volts + codes * step * normal
        };
        let volts = match self.injected {
            Injected::Noise(codes) => noisy(volts, codes),
            Injected::Added(added) => volts + added,
            Injected::Held => return converter.before,
            Injected::Clipped(part) => {
                let (min, max) = converter.range_v;
                volts.min(min + part * (max - min))
            }
            Injected::Drift(codes) => volts + codes * step * f64::from(n) / f64::from(self.ticks),
            Injected::Open => noisy(0.0, OPEN_NOISE),
            Injected::AtTheEnd => return AdcCode(converter.adc.full_scale),
            Injected::Supply(_) => volts,
        };
        read(converter.adc, volts, self.supply_mv())
    }

    /// The supply meanwhile, mV.
    pub(crate) fn supply_mv(&self) -> f64 {
        let made_for = f64::from(MADE_FOR_MV);
        match self.injected {
            Injected::Supply(percent) => made_for * (1.0 + percent / 100.0),
            _ => made_for,
        }
    }
}

/// The code of a voltage (V) at a supply (mV).
pub(crate) fn read(adc: &AdcCalibration, volts: f64, supply_mv: f64) -> AdcCode {
    let zero = -f64::from(adc.offset_v) / f64::from(adc.gain_v_per_code) * if adc.invert { -1.0 } else { 1.0 };
    let codes = volts / f64::from(adc.gain_v_per_code) * if adc.invert { -1.0 } else { 1.0 };
    let code = zero + codes * f64::from(MADE_FOR_MV) / supply_mv;
    // Limited to the converter's range, which fits.
    AdcCode(code.round().clamp(0.0, f64::from(adc.full_scale)) as u16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{Admitted, Status, Table};
    use firmware::leap::TOO_LONG;
    use firmware::watch::{SATURATED, STUCK};
    use protocol::Faults;

    fn outcomes(table: &Admitted) -> Vec<(Injected, u32, Outcome)> {
        let runs = Runs::new(table);
        FAULTS.iter().map(|fault| (fault.injected, fault.ticks, runs.with(fault))).collect()
    }

    #[test]
    fn what_can_be_seen_of_a_fault_is_flagged_in_time() {
        for (injected, ticks, outcome) in outcomes(&firmware::compiled::TABLE.admit().unwrap()) {
            let Outcome { flag, fault, worst_um, recovery, .. } = outcome;
            let found = format!("{injected:?} for {ticks} ticks: {outcome:?}");
            let first = |bit: Status| flag.is_some_and(|(bits, at)| bits.contains(bit) && at == 1);
            match injected {
                Injected::Noise(codes) => assert!(fault.is_none() && worst_um < 0.03 * codes, "{found}"),
                Injected::Added(volts) if volts.abs() > 10.0 => {
                    assert!(first(Status::ADC_SATURATED | Status::VOLTAGE_OUT_OF_RANGE) && fault.is_none(), "{found}")
                }
                Injected::AtTheEnd => {
                    assert!(first(Status::ADC_SATURATED), "{found}");
                    assert_eq!(fault, Some((Faults::ADC_SATURATED, SATURATED)), "{found}");
                }
                Injected::Held if ticks > STUCK => {
                    let expected = STUCK..=STUCK + 1;
                    let stuck = |(fault, at): (Faults, u32)| fault == Faults::ADC_STUCK && expected.contains(&at);
                    assert!(fault.is_some_and(stuck), "{found}");
                }
                // Two measurements of the supply, a twentieth of a second.
                Injected::Supply(percent) if percent < -5.0 => {
                    assert!(fault.is_some_and(|(fault, at)| fault == Faults::SUPPLY && at <= 140), "{found}");
                }
                _ => assert!(fault.is_none(), "{found}"),
            }
            // The compiled table has no ±.
            assert_eq!((recovery, outcome.silent), (Recovery::NeedsZero, 0), "{found}");
        }
    }

    /// What the book's table states, V/s: over twenty times the sine's fastest change.
    const AMPLIFIER_SLEW: f32 = 250.0;

    #[test]
    fn what_leaps_costs_little_or_is_a_fault_where_the_amplifiers_slew_rate_is_stated() {
        let table =
            Table { amplifier_slew_v_per_s: Some(AMPLIFIER_SLEW), ..firmware::compiled::TABLE }.admit().unwrap();
        for (injected, ticks, outcome) in outcomes(&table) {
            let Outcome { flag, fault, worst_um, recovery, .. } = outcome;
            let found = format!("{injected:?} for {ticks} ticks: {outcome:?}");
            let held = flag.is_some_and(|(bits, at)| bits.contains(Status::SLEW_EXCEEDED) && at == 1);
            match injected {
                Injected::Noise(codes) if codes <= 5.0 => assert_eq!((flag, fault), (None, None), "{found}"),
                Injected::Added(_) if ticks < TOO_LONG => assert!(held && fault.is_none() && worst_um < 1.5, "{found}"),
                Injected::Added(_) | Injected::Open => {
                    assert!(held && worst_um < 1.5, "{found}");
                    assert_eq!(fault, Some((Faults::SLEW_EXCEEDED, TOO_LONG)), "{found}");
                }
                // Both are as early.
                Injected::AtTheEnd => {
                    let both = Faults::SLEW_EXCEEDED | Faults::ADC_SATURATED;
                    assert_eq!((held, fault), (true, Some((both, TOO_LONG))), "{found}");
                }
                // What comes after it leaps, is the voltage, and stays: nothing tells it from a wire that is off.
                Injected::Held if ticks == 100 => {
                    assert_eq!(fault, Some((Faults::SLEW_EXCEEDED, ticks + TOO_LONG)), "{found}");
                    assert_eq!(recovery, Recovery::Faulty, "{found}");
                }
                // And so much noise leaps for a while, and then does not.
                Injected::Noise(codes) if codes >= 50.0 => {
                    assert!(fault.is_some_and(|(fault, _)| fault == Faults::SLEW_EXCEEDED), "{found}");
                    assert_eq!(recovery, Recovery::Faulty, "{found}");
                }
                Injected::Held if ticks > STUCK => {
                    assert!(fault.is_some_and(|(fault, _)| fault == Faults::ADC_STUCK), "{found}");
                }
                Injected::Supply(percent) if percent < -5.0 => {
                    assert!(fault.is_some_and(|(fault, _)| fault == Faults::SUPPLY), "{found}");
                }
                Injected::Noise(_)
                | Injected::Held
                | Injected::Clipped(_)
                | Injected::Drift(_)
                | Injected::Supply(_) => {
                    assert!(!held && fault.is_none(), "{found}");
                }
            }
        }
    }

    #[test]
    fn a_supply_scales_what_the_voltage_adds_to_the_code_of_0_v() {
        let adc = AdcCalibration { gain_v_per_code: 1e-3, offset_v: -10.0, invert: false, full_scale: 65_520 };
        let inverted = AdcCalibration { offset_v: 10.0, invert: true, ..adc };
        for adc in [adc, inverted] {
            assert_eq!(read(&adc, 0.0, 3135.0), adc.code(0.0));
            assert_eq!(read(&adc, 5.0, f64::from(MADE_FOR_MV)), adc.code(5.0));
            assert_eq!(read(&adc, 5.0, 3300.0 / 1.04), adc.code(5.2));
        }
    }
}
