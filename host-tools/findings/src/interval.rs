//! The ± beside the estimate, in words.

use crate::micrometres::Micrometres;
use crate::short::counted;
use prediction_interval::Calibration;

/// The simulated devices have added to what the logs ask for where the width is more than so many times that.
const ADDS: f64 = 1.02;

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
    let um = |um: f32| Micrometres(um.into());
    let (misfit, own) = (um(misfit_um), Micrometres(*own_um));
    let devices = counted(devices, "simulated device");
    let cause = match f64::from(misfit_um) > ADDS * own_um {
        true => format!(
            "These logs' own errors ask for ±{own:.3} µm; the rest is a prior, how far off was what was learnt of {devices} from the same voltages"
        ),
        false => format!(
            "That is these logs' own errors; what was learnt of {devices} from the same voltages asks for no more"
        ),
    };
    let (anywhere_um, at_an_end_um) =
        (misfit_um.hypot(memory_um), misfit_um.hypot(parameters.memory_at_ends * memory_um));
    let at_an_end = match at_an_end_um < anywhere_um {
        true => {
            format!(", or ±{:.3} µm where the voltage stood at an end of its range at the start", um(at_an_end_um))
        }
        false => String::new(),
    };
    format!(
        "The ± beside the estimate is at least ±{misfit:.3} µm. {cause}. It grows with the way and the time since the displacement was last \
         told (`piezo zero`), with speed, and where the voltage goes otherwise than in the training; the sensor is within it 95 % of the time. \
         Where the displacement was told before a full swing, that swing widens it to ±{:.3} µm{at_an_end}, since nobody knows what was before.",
        um(anywhere_um)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::IntervalParameters;
    use estimator_core::interval::SPANS;

    const PARAMETERS: IntervalParameters =
        IntervalParameters { memory_um: [4.0; SPANS], memory_at_ends: 0.5, ..IntervalParameters::constant(1.5) };

    /// What is said of these, whose logs' own errors are `own_um`.
    fn said(parameters: IntervalParameters, own_um: f64) -> String {
        interval(Some(&Calibration { parameters, own_um }), 12)
    }

    #[test]
    fn why_there_is_none_is_said() {
        assert!(interval(None, 0).contains("--devices 0") && interval(None, 12).contains("none could be learnt"));
    }

    #[test]
    fn a_start_at_an_end_of_the_range_is_told_from_one_in_the_middle() {
        let at_an_end = said(PARAMETERS, 1.0);
        for part in ["at least ±1.500 µm", "widens it to ±4.272 µm", "±2.500 µm where the voltage stood at an end"]
        {
            assert!(at_an_end.contains(part), "{part:?} is missing in {at_an_end}");
        }
        let anywhere = said(IntervalParameters { memory_at_ends: 1.0, ..PARAMETERS }, 1.5);
        assert!(anywhere.contains("±4.272 µm, since") && !anywhere.contains("at an end"), "{anywhere}");
    }

    #[test]
    fn what_the_simulated_devices_add_is_told_from_what_the_logs_say() {
        let of = |own_um| said(IntervalParameters { misfit_um: 0.006, ..PARAMETERS }, own_um);
        let (added, own) = (of(0.004), of(0.005_95));
        assert!(added.contains("at least ±0.0060 µm"), "{added}");
        assert!(added.contains("own errors ask for ±0.0040 µm; the rest is a prior"), "{added}");
        assert!(own.contains("asks for no more") && !own.contains("prior"), "{own}");
    }
}
