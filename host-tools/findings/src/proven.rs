//! What admission has proven of a table, in words.

use crate::micrometres::Micrometres;
use estimator_core::{Admitted, Range};

/// Within what the estimate stays, and by what.
pub fn proven(table: &Admitted) -> String {
    let um = |um: f32| Micrometres(um.into());
    let Range { min, max } = table.displacement_limits_um;
    let (min, max) = (um(min), um(max));
    let within = format!("{min:.2} … {max:.2} µm of the model's zero");
    match table.rings() {
        None => format!("Proven: stable at every voltage, and within {within} for any sequence of voltages."),
        Some(reach) => format!(
            "Proven: stable at every voltage, and within {within} for any sequence of voltages that does not make the resonance swing \
             beyond; one in step with it could, to {:.2} … {:.2} µm at worst, and the estimate is then held at the limits and says so \
             (CLAMPED).",
            um(reach.min),
            um(reach.max)
        ),
    }
}
