//! What two points of a calibration say, as the file has it.

use super::channel::Channel;
use super::doubt;
use super::point::{Point, line};
use crate::board_edit::Measured;
use crate::board_file::BoardFacts;
use crate::calibration_error::CalibrationError;
use protocol::Identity;

/// Refuses to drive for readings of the monitor whose span could not be written: a file that says nothing else
/// of a drive.
///
/// # Errors
/// The file has no `drive_range`, or no `drive_slew`.
pub fn writable(channel: Channel, driven: bool, before: &BoardFacts) -> Result<(), CalibrationError> {
    let drives = before.drive_range.is_some() && before.drive_slew.is_some();
    if driven && channel == Channel::Monitor && !drives { Err(CalibrationError::NoDrive) } else { Ok(()) }
}

/// What board.toml is to say by two points: the span of the channel, and that of the DAC where the board drove to them.
/// A reading stands for `scale` times as much, in V, or of the sensor in µm.
///
/// # Errors
/// The points are no line that a converter's whole range can be read off, or one that goes the other way than
/// the one `before`.
pub fn measured(
    channel: Channel,
    scale: f64,
    identity: &Identity,
    before: &BoardFacts,
    points: &[Point; 2],
) -> Result<Measured, CalibrationError> {
    let readings = points.map(|point| scale * point.reading);
    let of = |codes: [f64; 2], full_scale| line([(codes[0], readings[0]), (codes[1], readings[1])], full_scale);
    let span = of(points.map(|point| point.channel.code), identity.adc_full_scale)?;
    let driven = match points.map(|point| point.dac) {
        [Some(low), Some(high)] => Some([low, high]),
        _ => None,
    };
    let former = match channel {
        // What the board drove to says which way it goes.
        Channel::Monitor if driven.is_some() => None,
        Channel::Monitor => before.adc_span,
        Channel::Sensor => before.sensor_span,
    };
    doubt::of_former(former, span)?;
    let whose = Measured {
        board_uid: identity.uid,
        adc_full_scale: Some(identity.adc_full_scale),
        dac_full_scale: Some(identity.dac_full_scale),
        ..Measured::default()
    };
    Ok(match channel {
        Channel::Sensor => Measured { sensor_span: Some(span), ..whose },
        Channel::Monitor => {
            let drive_span = driven.map(|codes| of(codes, identity.dac_full_scale)).transpose()?;
            Measured { adc_span: Some(span), drive_span, ..whose }
        }
    })
}
