//! What is taken for granted of coefficients, and added to their least squares.
//!
//! Voltages that stand at a few levels, as a staircase's do, say nothing of the slopes between these: least squares
//! alone has them in lumps. Nor does a single loop say how a slope is shared between the reversible part and the plays
//! that all move there, and what is shared wrongly is an error at every other amplitude. So how a function's slope
//! bends from knot to knot is under a prior, too, a normal one: what is reversible hardly bends, where several
//! amplitudes do not say how it does, and the envelope's slope changes from knot to knot by less than it is.
//!
//! ```text
//! (s_{j−1} − 2 s_j + s_{j+1})/σ    with a deviation of 1; s_j the coefficient of knot j, σ a multiple of the stroke an interval
//! ```

use crate::WORTH;
use crate::basis::FUNCTIONS;
use least_squares::Normal;

/// Deviation σ of how the reversible part's slope bends, of the stroke an interval: of sessions with one amplitude, and
/// with several. With 0.2 (and 2.0 of the envelope's), of eight simulated devices that were learnt from one sine of the
/// full range four were 1.2 to 6 times as far off on other recordings, three as far, one 0.7 times; and on another day
/// the measured stack was a tenth further off. With 0.015, of eleven that were learnt from several amplitudes two were
/// 1.3 and 1.8 times as far off, the others 0.95 to 1.03 times.
const ONE: f64 = 0.015;
const SEVERAL: f64 = 0.05;
/// The same of the envelope, which is multiplied by the plays' weights.
const ENVELOPE: f64 = 1.0;

/// What the sizes of coefficients are judged by.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Scale {
    /// Of the sessions' strokes, µm.
    pub stroke: f64,
    /// Whether the sessions have several amplitudes.
    pub several_amplitudes: bool,
}

/// What a coefficient is drawn towards.
#[derive(Clone, Copy)]
pub struct Prior {
    /// Index of its column among the sessions' common ones.
    pub column: usize,
    /// That of a column whose coefficient is taken off first.
    pub less: Option<usize>,
    /// The value that it is drawn towards.
    pub towards: f64,
    /// How far it may be from there, a standard deviation.
    pub within: f64,
    /// What the draw weighs beside a session.
    pub weight: f64,
}

impl Prior {
    /// Draws the coefficient towards its value.
    pub(crate) fn add(self, normal: &mut Normal) {
        let mut row = vec![0.0; normal.columns()];
        row[self.column] = 1.0 / self.within;
        if let Some(less) = self.less {
            row[less] = -1.0 / self.within;
        }
        normal.add(&row, self.towards / self.within, self.weight);
    }

    /// What coefficients add to the least squares.
    pub(crate) fn unlikely(self, coefficients: &[f64]) -> f64 {
        let drawn = coefficients[self.column] - self.less.map_or(0.0, |less| coefficients[less]);
        let off = (drawn - self.towards) / self.within;
        self.weight * off * off
    }
}

/// What the slopes of so many functions bend by at each knot between two others.
pub fn bends(functions: usize, scale: Scale) -> impl Iterator<Item = Bend> {
    let interval = scale.stroke / (FUNCTIONS - 1) as f64;
    let reversible = if scale.several_amplitudes { SEVERAL } else { ONE };
    [reversible, ENVELOPE].into_iter().take(functions).enumerate().flat_map(move |(function, bent)| {
        let knots = 1..FUNCTIONS - 1;
        knots.map(move |knot| Bend { knot: function * FUNCTIONS + knot, within: bent * interval })
    })
}

/// How a function's slope bends at a knot.
pub struct Bend {
    /// Column of the knot; those of its neighbours are the ones beside it.
    knot: usize,
    /// Its deviation σ, µm.
    within: f64,
}

impl Bend {
    /// Columns, and what their coefficients are multiplied by.
    pub fn parts(&self) -> [(usize, f64); 3] {
        let one = 1.0 / self.within;
        [(self.knot - 1, one), (self.knot, -2.0 * one), (self.knot + 1, one)]
    }

    /// That of these coefficients, in deviations.
    pub fn of(&self, coefficients: &[f64]) -> f64 {
        self.parts().iter().map(|&(column, part)| part * coefficients[column]).sum()
    }

    /// Draws the bend towards 0.
    pub fn add(&self, normal: &mut Normal) {
        let mut row = vec![0.0; normal.columns()];
        self.parts().iter().for_each(|&(column, part)| row[column] = part);
        normal.add(&row, 0.0, 1.0 / WORTH);
    }
}

#[cfg(test)]
mod tests {
    use crate::{Basis, Course, Scale, Stages, solve};
    use estimator_core::Range;
    use recordings::session::Session;

    #[test]
    fn between_the_levels_of_a_staircase_slopes_go_straight_from_knot_to_knot() {
        // Every fourth knot is a level, so that least squares alone leaves open how the slopes between share
        // what lies between.
        let level = |tick: u32| [0.0, 4.0, 8.0, 4.0][(tick / 50 % 4) as usize];
        let voltage: Vec<f64> = (0..2_000).map(level).collect();
        let instants: Vec<u32> = (0..2_000).filter(|tick| *tick < 50 || tick % 50 >= 10).collect();
        let displacement = instants.iter().map(|&tick| level(tick)).map(|v| v + 0.05 * v * v).collect();
        let session = Session::new("stairs".into(), voltage, instants, displacement, 5e-4);
        let courses = Course::of_all([&session].into_iter(), 0.0);
        let span = Range { min: 0.0, max: 8.0 };
        let stages = Stages {
            basis: &Basis::new(span),
            span,
            delay_ticks: 0.0,
            lag_s: 1e-6,
            slew_v_per_s: 0.0,
            plays: &[],
            creep: &[],
            rest_memory: 0.0,
            resonance: None,
        };
        let scale = Scale { stroke: 11.2, several_amplitudes: false };
        let found = solve(&[(&session, &courses[0])], &stages, scale, 0.0).unwrap();
        for (knot, slope) in found.reversible.iter().enumerate() {
            let wanted = 1.0 + 0.1 * knot as f64;
            assert!(
                (slope - wanted).abs() < 0.1,
                "knot {knot}: {slope} µm/V, not {wanted} µm/V: {:?}",
                found.reversible
            );
        }
    }
}
