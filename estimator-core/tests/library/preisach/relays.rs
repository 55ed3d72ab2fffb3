//! The Preisach model with a memory without limit, summed up anew each time: what the incremental one is held against.

use estimator_core::model::Preisach;

/// Every reversal since negative saturation that nothing has wiped out, V, and the present voltage last.
pub struct Unlimited(Vec<f64>);

impl Unlimited {
    pub fn new() -> Self {
        Self(vec![-20.0])
    }

    /// The displacement (µm) at this voltage (V), by Eq. (3.4) and (3.5) over all branches.
    pub fn displacement(&mut self, model: &Preisach<f64>, voltage: f64, offset: f64) -> f64 {
        self.0.push(voltage.clamp(-20.0, 80.0));
        self.reduce();
        let branches = self.0.windows(2).map(|pair| {
            let [from, to] = [pair[0], pair[1]];
            if to > from { model.everett(to, from) } else { -model.everett(from, to) }
        });
        offset + branches.sum::<f64>()
    }

    /// Drops what is no reversal, and loops that have been passed, from the end of the history.
    fn reduce(&mut self) {
        while let [.., a, b, c] = self.0[..] {
            // Going on, standing still, or past the extreme before the last.
            if (a <= b && b <= c) || (a >= b && b >= c) {
                self.0.remove(self.0.len() - 2);
            } else if let [.., z, a, b, c] = self.0[..]
                && (z - a).abs() >= (a - b).abs()
                && (c - b).abs() >= (a - b).abs()
            {
                let end = self.0.len();
                self.0.drain(end - 3..end - 1);
            } else {
                return;
            }
        }
    }
}
