//! Whether anything depends on the voltage that a device puts out: a waveform, a controller's set-point,
//! a host's trajectory.

use crate::client::Client;
use crate::error::LinkError;
use crate::table;
use estimator_core::Table;
use protocol::{Faults, Mode};

/// Why a device is not interrupted.
#[derive(Debug, thiserror::Error)]
pub enum Busy {
    /// The link fails, or the device refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// It drives the amplifier.
    #[error("the device {}, and this would end it", match .0 {
        Mode::Waveform => "plays a waveform",
        Mode::Linearise => "follows the set-point at its ADC",
        _ => "is driven by a host, or holds what one told it",
    })]
    Drives(Mode),
}

/// Refuses a device that drives the amplifier. One whose voltage is at rest or on the way there, since a waveform is
/// over, a fault sent it there or it waits for its set-point, is interrupted in nothing.
///
/// # Errors
/// It drives, or the link fails.
pub fn idle(client: &mut Client) -> Result<(), Busy> {
    let health = client.health()?;
    match health.mode.drives() && !health.faults.contains(Faults::SAFE_OUTPUT) {
        true => Err(Busy::Drives(health.mode)),
        false => Ok(()),
    }
}

/// The same, but for a device that follows its set-point as it does of itself after a start, by its table: for who has
/// found it idle and restarted it.
///
/// # Errors
/// As [`idle`].
pub fn idle_as_started(client: &mut Client) -> Result<(), Busy> {
    match idle(client) {
        Err(Busy::Drives(Mode::Linearise)) if follows_at_start(client)? => Ok(()),
        other => other,
    }
}

fn follows_at_start(client: &mut Client) -> Result<bool, LinkError> {
    // One that cannot be read says nothing.
    let table = table::in_use(client)?.and_then(|record| Table::parse(&record).ok());
    Ok(table.and_then(|table| table.drive?.setpoint).is_some_and(|setpoint| setpoint.at_start))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pages;
    use crate::table::to_record;
    use emulator::{Conversion, Emulator, Plant, TABLE, amplifier};
    use estimator_core::{AdcCode, DacCode, DriveCalibration, DriveLimits, Range, SetpointCalibration};
    use parameter_store::RamFlash;

    #[test]
    fn only_what_a_device_begins_of_itself_may_be_ended_by_who_restarted_it() {
        let limits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
        for at_start in [true, false] {
            let setpoint = SetpointCalibration { gain_um_per_code: 50.0 / 65_520.0, offset_um: -5.0, at_start };
            let (gain_codes_per_v, offset_code) = (4095.0 / 4.0, 0.0);
            let drive = DriveCalibration { gain_codes_per_v, offset_code, limits, setpoint: Some(setpoint) };
            let record = to_record(&Table { drive: Some(drive), ..TABLE }.admit().unwrap());
            let (mut amplifier, mut noise) = (amplifier(drive, TABLE.adc), 0);
            let plant = move |dac: DacCode| {
                noise = 1 - noise;
                Conversion { setpoint: Some(AdcCode(32_760 + noise)), ..amplifier.sample(dac) }
            };
            let flash = RamFlash::new(pages::with(&record, 4096).unwrap());
            let device = Emulator::new().setpoint().flash(flash).plant(plant).speed(8.0).start().unwrap();
            let (mut client, _) = Client::connect(&device.address().into()).unwrap();
            client.set_mode(Mode::Linearise).unwrap();
            while client.health().unwrap().faults.contains(Faults::SAFE_OUTPUT) {}
            assert!(matches!(idle(&mut client), Err(Busy::Drives(Mode::Linearise))));
            assert_eq!(idle_as_started(&mut client).is_ok(), at_start);
        }
    }
}
