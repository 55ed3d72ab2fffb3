//! What a drive is designed for, and when there is none.

/// What a drive is designed for.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Request {
    /// Lowest amplifier voltage, V.
    pub min_v: f64,
    /// Highest amplifier voltage, V.
    pub max_v: f64,
    /// Where it starts and ends, V; within the range.
    pub rest_v: f64,
    /// Fastest change, V/s.
    pub slew_v_per_s: f64,
    /// Highest frequency, Hz.
    pub up_to_hz: f64,
    /// Length of the whole, s.
    pub duration_s: f64,
    /// From one sample to the next, s.
    pub tick_s: f64,
    /// Draws the random part.
    pub seed: u64,
}

/// Longest drive, s: an hour.
pub const LONGEST_S: f64 = 3600.0;
/// No drive goes fewer times over the whole range than this.
const FEWEST_WAYS: f64 = 20.0;
/// Fewest ticks in a period of the highest frequency.
const TICKS_A_PERIOD: f64 = 10.0;

/// Why there is no drive.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum ExcitationError {
    /// There is nothing between the ends of the range.
    #[error("the voltages from {min_v} to {max_v} V are no range: the first must be lower than the second")]
    NoRange {
        /// The lower end, V.
        min_v: f64,
        /// The upper end, V.
        max_v: f64,
    },
    /// The rest lies outside.
    #[error("the rest at {rest_v} V does not lie within {min_v} … {max_v} V")]
    Rest {
        /// The voltage at rest that was asked for, V.
        rest_v: f64,
        /// The lower end, V.
        min_v: f64,
        /// The upper end, V.
        max_v: f64,
    },
    /// A number that must be positive is not.
    #[error("the {what} must be a positive number, not {value}")]
    NotPositive {
        /// Which number it is.
        what: &'static str,
        /// The number that was given.
        value: f64,
    },
    /// The highest frequency has too few ticks in a period.
    #[error("at {up_to_hz} Hz a period has fewer than ten ticks of {tick_s} s: at most {most_hz} Hz")]
    TooFast {
        /// What was asked for, Hz.
        up_to_hz: f64,
        /// The board's tick, s.
        tick_s: f64,
        /// The highest frequency that can be played, Hz.
        most_hz: f64,
    },
    /// The voltage cannot go everywhere in that time.
    #[error("{duration_s:.1} s are too few at this slew limit and these frequencies: it takes {least_s:.0} s at least")]
    TooShort {
        /// What was asked for, s.
        duration_s: f64,
        /// What is enough, s.
        least_s: f64,
    },
    /// Nobody waits for so long.
    #[error("{duration_s:.0} s are too long: at most {LONGEST_S:.0} s")]
    TooLong {
        /// What was asked for, or is needed, s.
        duration_s: f64,
    },
}

impl Request {
    /// Checks the numbers.
    ///
    /// # Errors
    /// What is wrong with them.
    pub(crate) fn check(&self) -> Result<(), ExcitationError> {
        let &Self { min_v, max_v, rest_v, slew_v_per_s, up_to_hz, duration_s, tick_s, .. } = self;
        // NaN is no order either.
        if min_v.partial_cmp(&max_v) != Some(std::cmp::Ordering::Less) || !(max_v - min_v).is_finite() {
            return Err(ExcitationError::NoRange { min_v, max_v });
        }
        if !(min_v..=max_v).contains(&rest_v) {
            return Err(ExcitationError::Rest { rest_v, min_v, max_v });
        }
        let numbers =
            [("slew limit", slew_v_per_s), ("highest frequency", up_to_hz), ("duration", duration_s), ("tick", tick_s)];
        if let Some((what, value)) = numbers.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            return Err(ExcitationError::NotPositive { what, value });
        }
        let most_hz = 1.0 / (TICKS_A_PERIOD * tick_s);
        if up_to_hz > most_hz {
            return Err(ExcitationError::TooFast { up_to_hz, tick_s, most_hz });
        }
        let duration_s = duration_s.max(self.least_s());
        if duration_s > LONGEST_S {
            return Err(ExcitationError::TooLong { duration_s });
        }
        Ok(())
    }

    /// A time in which no drive can be gone through, s.
    pub(crate) fn least_s(&self) -> f64 {
        FEWEST_WAYS * self.span_v() / self.slew_v_per_s
    }

    /// From the lowest to the highest voltage, V.
    pub fn span_v(&self) -> f64 {
        self.max_v - self.min_v
    }
}
