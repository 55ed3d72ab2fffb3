//! The ± beside the estimate, in words.

use prediction_interval::Calibration;

/// What the interval says, and where its width comes from: this many simulated devices, and the logs' own errors.
pub fn interval(interval: Option<&Calibration>, devices: u32) -> String {
    let Some(Calibration { parameters, own_um }) = interval else {
        let why = match devices {
            0 => "no simulated device was asked for (--devices 0)",
            _ => {
                "of the simulated devices none could be learnt from voltages such as these: record several cycles of the full range"
            }
        };
        return format!("There is no interval beside the estimate: {why}.");
    };
    let (misfit_um, memory_um) = (parameters.misfit_um, parameters.memory_um[0]);
    format!(
        "The ± beside the estimate is what it may be off by since the displacement was last told (`piezo zero`), 95 % of the time. \
         It is at least ±{misfit_um:.3} µm, where the voltage goes as it did in the training: ±{own_um:.3} µm by these logs' own errors, \
         more by those of {devices} simulated devices that were learnt from the same voltages. It is more where the voltage goes otherwise \
         or fast. If the displacement was told before a full swing, the ± widens with that to ±{:.3} µm, or ±{:.3} µm where the voltage stood at an \
         end of its range at the start, since nobody knows what was before; told after one, it does not, unless the voltage leaves that range.",
        misfit_um.hypot(memory_um),
        misfit_um.hypot(parameters.memory_at_ends * memory_um)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::IntervalParameters;
    use estimator_core::interval::{PLAYS, PROTOTYPES, SPANS, TRIANGLE};

    #[test]
    fn why_there_is_none_is_said() {
        assert!(interval(None, 0).contains("--devices 0") && interval(None, 12).contains("none could be learnt"));
    }

    #[test]
    fn a_start_at_an_end_of_the_range_is_told_from_one_in_the_middle() {
        let parameters = IntervalParameters {
            memory_um: [4.0; SPANS],
            memory_at_ends: 0.5,
            misfit_um: 1.5,
            rate_ticks: 0.0,
            spread_um: [0.0; TRIANGLE],
            prototypes: [[0; PLAYS]; PROTOTYPES],
            prototype_um: 1.0,
            untrained_um: 1.0,
            gain: 0.0,
            drift_um: 0.0,
            earliest_s: 0.0,
        };
        let said = interval(Some(&Calibration { parameters, own_um: 1.0 }), 12);
        for part in ["at least ±1.500 µm", "with that to ±4.272 µm", "±2.500 µm where the voltage stood at an end"]
        {
            assert!(said.contains(part), "{part:?} is missing in {said}");
        }
    }
}
