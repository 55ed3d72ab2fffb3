//! Readings and codes that are not to be believed: swapped, mistyped, or of a converter without its reference.

use super::channel::Channel;
use crate::calibration_error::CalibrationError;
use protocol::{Faults, Sample};

/// Refuses a multimeter's reading, V, that cannot be of the voltage that the amplifier was driven to.
/// `readings` and `volts` are those of the points so far, the newest last; they may be `most` apart, V.
///
/// # Errors
/// The newest is too far from its voltage, or they go the other way than the voltages.
pub fn of_driven(readings: &[f64], volts: [f64; 2], most: f64) -> Result<(), CalibrationError> {
    if let Some((&reading, &volts)) = readings.iter().zip(&volts).next_back()
        && (reading.is_nan() || (reading - volts).abs() > most)
    {
        return Err(CalibrationError::FarFromDriven { reading, volts, most });
    }
    match *readings {
        [low, high] if (high - low) * (volts[1] - volts[0]) < 0.0 => {
            Err(CalibrationError::OtherWay { readings: [low, high], volts })
        }
        _ => Ok(()),
    }
}

/// Refuses a span that goes the other way than the file's former one, where it had one.
///
/// # Errors
/// The two spans go opposite ways.
pub fn of_former(former: Option<(f64, f64)>, found: (f64, f64)) -> Result<(), CalibrationError> {
    match former {
        Some(former) if (former.1 > former.0) != (found.1 > found.0) => {
            Err(CalibrationError::Inverted { former, found })
        }
        _ => Ok(()),
    }
}

/// Refuses samples whose codes the device itself does not believe. The watch of a stuck converter is of the monitor's
/// alone; whether a channel is saturated, its codes say.
///
/// # Errors
/// One of them has such a fault.
pub fn of_samples(samples: &[Sample], channel: Channel) -> Result<(), CalibrationError> {
    let unbelievable = match channel {
        Channel::Monitor => Faults::SUPPLY | Faults::ADC_STUCK,
        Channel::Sensor => Faults::SUPPLY,
    };
    let seen = samples.iter().fold(Faults::empty(), |seen, sample| seen | (sample.faults & unbelievable));
    if seen.is_empty() { Ok(()) } else { Err(CalibrationError::Faulty(seen)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::Status;

    #[test]
    fn swapped_and_mistyped_readings_are_refused_with_both_numbers() {
        let of = |readings: &[f64]| of_driven(readings, [10.0, 90.0], 20.0);
        assert_eq!((of(&[11.0]), of(&[11.0, 91.0])), (Ok(()), Ok(())));
        assert_eq!(of(&[91.0]), Err(CalibrationError::FarFromDriven { reading: 91.0, volts: 10.0, most: 20.0 }));
        let said = of(&[11.0, 900.0]).unwrap_err().to_string();
        assert!(said.contains("900 V") && said.contains("90 V"), "{said}");
        let (readings, volts) = ([55.0, 45.0], [45.0, 55.0]);
        assert_eq!(of_driven(&readings, volts, 20.0), Err(CalibrationError::OtherWay { readings, volts }));
        assert!(of(&[f64::NAN]).is_err());
    }

    #[test]
    fn a_span_goes_the_way_of_the_former_one() {
        let (up, down) = ((-30.0, 130.0), (130.0, -30.0));
        assert!(
            of_former(None, down).is_ok() && of_former(Some(up), up).is_ok() && of_former(Some(down), down).is_ok()
        );
        assert_eq!(of_former(Some(up), down), Err(CalibrationError::Inverted { former: up, found: down }));
    }

    #[test]
    fn codes_without_their_reference_are_refused_and_other_faults_are_not() {
        let of = |faults, channel| {
            let (code, status) = (30_000, Status::empty());
            let good = Sample {
                code,
                sensor: None,
                displacement: 0.0,
                half_width: None,
                dac: 0,
                status,
                faults: Faults::NO_TABLE,
            };
            of_samples(&[good, Sample { faults, ..good }], channel)
        };
        assert!(of(Faults::SAFE_OUTPUT, Channel::Monitor).is_ok() && of(Faults::ADC_STUCK, Channel::Sensor).is_ok());
        let said = of(Faults::SUPPLY | Faults::ADC_STUCK, Channel::Monitor).unwrap_err().to_string();
        assert!(said.contains("SUPPLY") && said.contains("ADC_STUCK"), "{said}");
    }
}
