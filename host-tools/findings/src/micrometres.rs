//! Micrometres for people, whose actuators go over tens of nanometres or hundreds of micrometres.

use std::fmt::{Display, Formatter, Result};

/// So many µm, printed with the decimals that are asked for, and with more where these would not show
/// two significant digits.
#[derive(Clone, Copy)]
pub struct Micrometres(pub f64);

/// Most decimals, a femtometre.
const MOST: f64 = 9.0;

impl Micrometres {
    /// The decimals that it is printed with, where so many are asked for.
    pub fn decimals(self, asked: usize) -> usize {
        // −∞ of nothing, which needs none.
        let place = self.0.abs().log10().floor();
        let needed = if place.is_finite() { (1.0 - place).clamp(0.0, MOST) as usize } else { 0 };
        asked.max(needed)
    }
}

impl Display for Micrometres {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (decimals, width) = (self.decimals(f.precision().unwrap_or(0)), f.width().unwrap_or(0));
        match f.sign_plus() {
            true => write!(f, "{:>+width$.decimals$}", self.0),
            false => write!(f, "{:>width$.decimals$}", self.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_digits_are_shown_of_what_is_small() {
        for (um, shown) in
            [(45.21, "45.210"), (0.0874, "0.087"), (0.000_312, "0.00031"), (0.0, "0.000"), (2e-12, "0.000000000")]
        {
            assert_eq!(format!("{:.3}", Micrometres(um)), shown);
        }
        assert_eq!(format!("{:+.3} {:>9.4}", Micrometres(-0.002), Micrometres(0.000_87)), "-0.0020   0.00087");
        assert_eq!(format!("{:.1} {:.1}", Micrometres(0.049), Micrometres(f64::NAN)), "0.049 NaN");
    }
}
