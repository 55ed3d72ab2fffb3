//! What is done to a log, resolved to numbers, and doing it.

use super::resample::{self, Decimation};
use crate::log::Log;
use crate::session::Session;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Everything that is done to a log, resolved to numbers.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recipe {
    /// The tick's period, µs.
    pub tick_us: u32,
    /// Factor on the recorded voltage (an amplifier's gain, where the log holds its input).
    pub voltage_scale: f64,
    /// Factor on the recorded displacement.
    pub displacement_scale: f64,
    /// Scaled voltage that the model calls 0, V.
    pub voltage_zero_v: f64,
    /// Scaled displacement that the model calls 0, µm.
    pub displacement_zero_um: f64,
    /// How much later the sensor shows a displacement than it happens, ticks.
    pub delay_ticks: u32,
    /// Cut off at the start of each log, s.
    pub skip_start_s: f64,
    /// Cut off at the end of each log, s.
    pub skip_end_s: f64,
    /// What a log faster than the tick is reduced by.
    pub decimation: Decimation,
}

/// The rule that a recipe breaks, in words.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{0}")]
pub struct RecipeError(&'static str);

/// Why a log cannot be brought to the tick.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum PrepareError {
    /// Cutting and shifting left too little.
    #[error(
        "{log}: only {left} measured samples are left at the tick, after what is cut off, held out, decimated and delayed; at least {need} are needed (is the sample rate right?)"
    )]
    TooShort {
        /// Name of the log.
        log: String,
        /// Samples that are left.
        left: usize,
        /// Samples that are needed.
        need: usize,
    },
    /// Faster than the tick by no whole number, and means were asked for.
    #[error(
        "{log}: {log_hz} Hz is no multiple of the tick rate, {tick_hz} Hz, and has no means there: take the sample at each tick"
    )]
    NotAMultiple {
        /// Name of the log.
        log: String,
        /// Its sample rate, Hz.
        log_hz: f64,
        /// The tick rate, Hz.
        tick_hz: f64,
    },
    /// A log at a far lower rate than the tick.
    #[error(
        "{log}: {ticks:.0} ticks of {tick_us} µs, more than {most:.0}: is the sample rate right? Else use a longer tick"
    )]
    TooLong {
        /// Name of the log.
        log: String,
        /// Ticks it would have.
        ticks: f64,
        /// The tick's period, µs.
        tick_us: u32,
        /// Most ticks of a session.
        most: f64,
    },
    /// The log holds a voltage only.
    #[error("{log}: holds no displacement to compare with")]
    NoDisplacement {
        /// Name of the log.
        log: String,
    },
}

/// Most ticks of a session.
const MOST: f64 = 1e8;
/// Fewest measured samples of a session.
const FEWEST: usize = 16;

impl Recipe {
    /// Every n-th sample at the tick, and nothing else done.
    pub fn at_tick(tick_us: u32) -> Self {
        Self {
            tick_us,
            voltage_scale: 1.0,
            displacement_scale: 1.0,
            voltage_zero_v: 0.0,
            displacement_zero_um: 0.0,
            delay_ticks: 0,
            skip_start_s: 0.0,
            skip_end_s: 0.0,
            decimation: Decimation::Every,
        }
    }

    /// What is to be done to one log. One of a device's estimates, or of a plan, is in the table's units as it is: V at
    /// the amplifier, µm relative to the model's zero.
    pub fn of(&self, log: &Log) -> Self {
        if log.displacement_estimated {
            let Self { voltage_zero_v, decimation, .. } = *self;
            Self { voltage_zero_v, decimation, ..Self::at_tick(self.tick_us) }
        } else {
            self.clone()
        }
    }

    /// Whether it can be used.
    ///
    /// # Errors
    /// The first of its rules that does not hold.
    pub fn check(&self) -> Result<(), RecipeError> {
        let scale = |x: f64| x.is_finite() && x != 0.0;
        let duration = |x: f64| x.is_finite() && x >= 0.0;
        let rules = [
            ("tick_us must lie between 10 and 1000000", (10..=1_000_000).contains(&self.tick_us)),
            ("voltage_scale must be a number other than 0", scale(self.voltage_scale)),
            ("displacement_scale must be a number other than 0", scale(self.displacement_scale)),
            ("voltage_zero_v must be a number", self.voltage_zero_v.is_finite()),
            ("displacement_zero_um must be a number", self.displacement_zero_um.is_finite()),
            ("delay_ticks must be below a second", f64::from(self.delay_ticks) * self.tick_s() < 1.0),
            ("skip_start_s must be 0 or positive", duration(self.skip_start_s)),
            ("skip_end_s must be 0 or positive", duration(self.skip_end_s)),
        ];
        rules.into_iter().find(|(_, holds)| !holds).map_or(Ok(()), |(rule, _)| Err(RecipeError(rule)))
    }

    /// The nearest whole number of ticks to so many ms.
    pub fn ticks_of(&self, ms: f64) -> u32 {
        (ms * 1e-3 / self.tick_s()).round() as u32
    }

    /// The tick's period, s.
    pub fn tick_s(&self) -> f64 {
        f64::from(self.tick_us) * 1e-6
    }

    /// The log without what `skip_start_s` and `skip_end_s` take.
    pub fn cut<'l>(&self, log: &'l Log) -> Cow<'l, Log> {
        log.trimmed(self.skip_start_s, self.skip_end_s)
    }

    /// Prepares logs that have been [cut](Self::cut), or parts of such.
    pub fn sessions(&self, logs: &[Log]) -> Result<Vec<Session>, PrepareError> {
        logs.iter().map(|log| self.session(log)).collect()
    }

    /// A voltage relative to the model's zero (V) as a log has it.
    pub fn as_recorded(&self, voltage: f64) -> f64 {
        (voltage + self.voltage_zero_v) / self.voltage_scale
    }

    /// Prepares a log that has been [cut](Self::cut), or a part of one.
    pub fn session(&self, log: &Log) -> Result<Session, PrepareError> {
        let displacement =
            log.displacement.as_ref().ok_or_else(|| PrepareError::NoDisplacement { log: log.name.clone() })?;
        let too_short = |left| PrepareError::TooShort { log: log.name.clone(), left, need: FEWEST };
        if displacement.len() < FEWEST {
            return Err(too_short(displacement.len()));
        }
        let ticks = log.duration() / self.tick_s();
        if ticks > MOST {
            return Err(PrepareError::TooLong { log: log.name.clone(), ticks, tick_us: self.tick_us, most: MOST });
        }
        let voltage: Vec<f64> = log.voltage.iter().map(|v| v * self.voltage_scale - self.voltage_zero_v).collect();
        let displacement: Vec<f64> =
            displacement.iter().map(|y| y * self.displacement_scale - self.displacement_zero_um).collect();
        let at_tick = resample::to_tick(&voltage, &displacement, log.sample_period / self.tick_s(), self.decimation)
            .ok_or_else(|| PrepareError::NotAMultiple {
                log: log.name.clone(),
                log_hz: 1.0 / log.sample_period,
                tick_hz: 1.0 / self.tick_s(),
            })?;
        let seen = at_tick.instants.iter().take_while(|&&tick| tick < self.delay_ticks).count();
        let displacement = at_tick.displacement[seen..].to_vec();
        if displacement.len() < FEWEST {
            return Err(too_short(displacement.len()));
        }
        // What is seen at an instant happened `delay_ticks` before.
        let happened: Vec<u32> = at_tick.instants[seen..].iter().map(|tick| tick - self.delay_ticks).collect();
        let first = happened[0];
        let last = happened[happened.len() - 1];
        let mut session = Session::new(
            log.name.clone(),
            at_tick.voltage[first as usize..=last as usize].to_vec(),
            happened.iter().map(|tick| tick - first).collect(),
            displacement,
            self.tick_s(),
        );
        session.start_s = log.start_s + f64::from(first) * self.tick_s();
        Ok(session)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recipe() -> Recipe {
        Recipe { voltage_scale: 2.0, voltage_zero_v: 10.0, displacement_zero_um: -3.0, ..Recipe::at_tick(500) }
    }

    /// A log whose voltage is its row number and whose displacement is twice that.
    fn log(rows: u32, hertz: f64) -> Log {
        Log {
            name: "ramp".into(),
            path: "ramp.csv".into(),
            sha256: String::new(),
            start_s: 0.0,
            sample_period: 1.0 / hertz,
            voltage: (0..rows).map(f64::from).collect(),
            displacement: Some((0..rows).map(|k| 2.0 * f64::from(k)).collect()),
            displacement_estimated: false,
            holes: Vec::new(),
        }
    }

    #[test]
    fn scale_and_zero() {
        let session = recipe().session(&log(20, 2000.0)).unwrap();
        assert_eq!(session.voltage[..3], [-10.0, -8.0, -6.0]);
        assert_eq!(session.displacement[..3], [3.0, 5.0, 7.0]);
        assert_eq!(session.instants[..3], [0, 1, 2]);
    }

    #[test]
    fn a_slow_log_keeps_its_instants_and_has_its_voltage_interpolated() {
        let session = recipe().session(&log(20, 200.0)).unwrap();
        assert_eq!(session.instants[..3], [0, 10, 20]);
        assert_eq!(session.voltage.len(), 191);
        assert!((session.voltage[15] - (2.0 * 1.5 - 10.0)).abs() < 1e-12);
        assert_eq!(session.displacement.len(), 20);
    }

    #[test]
    fn delay_moves_displacement_back_in_time() {
        let session = Recipe { delay_ticks: 15, ..recipe() }.session(&log(40, 200.0)).unwrap();
        // Row 2 was seen at tick 20 and happened at tick 5, half-way between rows 0 and 1.
        assert_eq!(session.displacement[0], 2.0 * 2.0 + 3.0);
        assert!((session.voltage[0] - (2.0 * 0.5 - 10.0)).abs() < 1e-12);
        assert_eq!(session.instants[..3], [0, 10, 20]);
        assert!((session.start_s - 5.0 * 500e-6).abs() < 1e-12);
    }

    #[test]
    fn what_is_skipped_is_gone() {
        let recipe = Recipe { skip_start_s: 0.01, skip_end_s: 0.005, ..recipe() };
        let session = recipe.session(&recipe.cut(&log(100, 2000.0))).unwrap();
        assert_eq!(session.voltage.len(), 70);
        assert_eq!(session.displacement[0], 2.0 * 20.0 + 3.0);
        assert!((session.start_s - 0.01).abs() < 1e-12);
        let all = Recipe { skip_start_s: 1.0, ..recipe };
        assert!(matches!(all.session(&all.cut(&log(100, 2000.0))), Err(PrepareError::TooShort { left: 0, .. })));
    }

    #[test]
    fn a_recipe_that_breaks_a_rule_is_refused_by_it() {
        assert_eq!(recipe().check(), Ok(()));
        let said = |recipe: Recipe| recipe.check().unwrap_err().to_string();
        assert_eq!(said(Recipe { voltage_scale: 0.0, ..recipe() }), "voltage_scale must be a number other than 0");
        assert_eq!(said(Recipe { delay_ticks: 2000, ..recipe() }), "delay_ticks must be below a second");
    }

    #[test]
    fn a_log_without_displacement_is_no_session() {
        let log = Log { displacement: None, ..log(20, 2000.0) };
        assert!(matches!(recipe().session(&log), Err(PrepareError::NoDisplacement { .. })));
    }
}
