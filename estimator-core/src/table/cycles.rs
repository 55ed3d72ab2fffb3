//! How long a table's tick takes on the board, of the time that it has there.
//!
//! Cycles of the board's core, a Cortex-M4F at 170 MHz behind flash with four wait states, that the tick's whole
//! interrupt takes. They are the most that was observed in the emulated board on inputs that are to be the worst, with
//! the largest table of each model (a full memory, a search that ends with its last step), counted with every
//! documented cost at its most and empty caches, and [`MARGIN_PERCENT`] beyond, rounded up by a few more: where the
//! linker puts the code moves them by 2 %. That is no proof that no input takes more. `cargo xtask cycles` prints what
//! they are made of; the check `figures` fails where the margin has become less than 3 %, or far too large. Those of a
//! model stand in its line of the [catalogue](crate::model::catalogue); here are those of a table that takes other ones
//! than its model.
//!
//! A tick may take [`ALLOWED_PERCENT`] of its time: the rest is the serial line's, the flash's and the host's. That
//! so much is left between the converter's end and the next trigger, the board's image sees to at each of its rates.
//! At 1 kHz the output's codes are twice as many as where the cycles were counted, at 2 kHz: some hundreds, which
//! the margin holds.

use super::Table;
use crate::model::Parameters;

/// What is added to the most that was observed, %.
pub const MARGIN_PERCENT: u32 = 6;
/// What a tick may take of its time, %.
pub const ALLOWED_PERCENT: u32 = 60;
/// Cycles of the board's core in a microsecond.
const CYCLES_PER_US: u32 = 170;

/// Cycles of the board's core at 170 MHz that a tick takes, and has.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cycles {
    /// What the tick takes at most, as far as was observed.
    pub most: u32,
    /// From one tick to the next.
    pub period: u32,
}

impl Cycles {
    /// Their share of the period, %.
    #[must_use]
    pub fn percent(&self) -> f32 {
        100.0 * self.most as f32 / self.period as f32
    }

    /// Whether that is no more than [`ALLOWED_PERCENT`].
    #[must_use]
    pub fn in_time(&self) -> bool {
        // Each factor is below 2³²; their product need not be.
        100 * u64::from(self.most) <= u64::from(ALLOWED_PERCENT) * u64::from(self.period)
    }
}

impl Table {
    /// Cycles of its tick on the board: with the inverse where it drives the amplifier.
    #[must_use]
    pub fn cycles(&self) -> Cycles {
        let drives = self.drive.is_some();
        let (estimate, drive) = STRAIGHT_LINE;
        let most = match self.is_straight_line() {
            true if drives => drive,
            true => estimate,
            false => self.parameters.most_cycles(drives),
        };
        Cycles { most, period: CYCLES_PER_US.saturating_mul(self.sample_period_us) }
    }

    /// Whether it is no model, but a straight line, as a board is measured with before it has one: the
    /// Prandtl-Ishlinskii model with one play and nothing behind it, and no interval, which is most of what
    /// an estimate takes.
    fn is_straight_line(&self) -> bool {
        let straight = match &self.parameters {
            Parameters::PrandtlIshlinskii(of) => of.thresholds_v.len() == 1 && of.dead_zones_um.is_empty(),
            _ => false,
        };
        straight && self.interval.is_none()
    }
}

impl Parameters {
    /// Most cycles of a tick on the board, with an interval beside the estimate; with the inverse where it `drives`.
    #[must_use]
    pub fn most_cycles(&self, drives: bool) -> u32 {
        let (estimate, drive) = match self {
            Self::BoucWen(of) if of.n == 2.0 => BOUC_WEN_SQUARE,
            Self::BoucWen(of) if of.n != 1.0 => BOUC_WEN_POWER,
            _ => self.model().most_cycles(),
        };
        if drives { drive } else { estimate }
    }
}

/// Of the Bouc-Wen model with exponents other than 1, which integrates in steps: exponent 2, and any other. What of
/// this and below is too much for a board was observed before boards refused it.
const BOUC_WEN_SQUARE: (u32, u32) = (18_300, 68_700);
const BOUC_WEN_POWER: (u32, u32) = (88_000, 245_900);

/// Of a straight line.
const STRAIGHT_LINE: (u32, u32) = (4_500, 8_600);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::IntervalParameters;
    use crate::list::List;
    use crate::model::{BoucWenParameters, PrandtlIshlinskiiParameters};
    use crate::range::Range;

    fn table() -> Table {
        *Table::parse(include_bytes!("../../../tests/data/table/table.bin")).unwrap()
    }

    #[test]
    fn a_tick_may_take_three_fifths_of_its_time_and_no_more() {
        let cycles = |most| Cycles { most, period: 85_000 };
        assert!(cycles(51_000).in_time() && !cycles(51_001).in_time());
        assert!((cycles(34_000).percent() - 40.0).abs() < 1e-4);
        let table = table();
        assert!(table.cycles().period == 85_000 && table.cycles().in_time());
        // The same tick ten times as often.
        let hurried = Table { sample_period_us: 10, ..table };
        let cycles = hurried.cycles();
        assert_eq!((cycles.period, cycles.most), (1_700, table.cycles().most));
        assert!(!cycles.in_time());
    }

    #[test]
    fn a_straight_line_takes_less_than_its_model_until_it_has_an_interval() {
        let of = PrandtlIshlinskiiParameters {
            lag_s: 0.0,
            thresholds_v: List::of([0.0]),
            weights_um_per_v: List::of([1.0]),
            offset_um: 0.0,
            dead_zones_um: List::of([]),
            dead_zone_slopes: List::of([]),
            memory_v: Range { min: 0.0, max: 1.0 },
        };
        let line = Table { parameters: Parameters::PrandtlIshlinskii(of), interval: None, ..table() };
        // At 10 kHz, too.
        assert!(Table { sample_period_us: 100, ..line }.cycles().in_time());
        let two = List::of([0.0, 0.5]);
        let two = PrandtlIshlinskiiParameters { thresholds_v: two, weights_um_per_v: two, ..of };
        let most = line.cycles().most;
        for more in [
            Table { parameters: Parameters::PrandtlIshlinskii(two), ..line },
            Table { interval: Some(IntervalParameters::constant(0.1)), ..line },
            Table { parameters: table().parameters, ..line },
        ] {
            assert!(more.cycles().most > most);
        }
    }

    #[test]
    fn what_integrates_in_steps_takes_longer() {
        let of = |n| {
            let of = BoucWenParameters {
                lag_s: 0.0,
                a: 1.0,
                beta: 0.1,
                gamma: 0.0,
                delta: 0.0,
                n,
                offset_um: 0.0,
                d1_um_per_v: 1.0,
                d2_um_per_v2: 0.0,
                c_um_per_v: 0.0,
            };
            Parameters::BoucWen(of).most_cycles(false)
        };
        assert!(of(1.0) < of(2.0) && of(2.0) < of(1.5));
    }
}
