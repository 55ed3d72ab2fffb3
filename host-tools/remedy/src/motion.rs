//! What a zero is worth that is told while the voltage moves.

use device_link::motion::{LOOKED_S, Motion};

/// What is to be said of a displacement that was called `at_um`, µm, while the voltage moved; `None` where it stood.
pub fn moving(motion: &Motion, at_um: f64) -> Option<String> {
    let volts = motion.moved_v?;
    Some(format!(
        "the voltage is moving, by {volts:.3} V within {LOOKED_S} s, and the estimate with it by {:.3} µm: what is called {at_um} µm is \
         wherever it was at that instant, and nobody knows where. Let it come to rest and zero again; or tell the mean over a cycle: piezo \
         zero --over-cycle",
        motion.moved_um
    ))
}
