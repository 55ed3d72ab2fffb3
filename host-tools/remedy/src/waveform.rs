//! What becomes of a waveform that a device plays from its memory.

use super::device::{link, refusal, stop};
use super::paste::{typed, verb};
use bench::waveform::WaveformError;
use device_link::LinkError;
use findings::counted;
use protocol::{Health, Refusal};
use std::error::Error;

/// The error with its remedy, if it is of a waveform.
pub fn told(error: &(dyn Error + 'static)) -> Option<String> {
    error.downcast_ref().map(waveform)
}

fn waveform(error: &WaveformError) -> String {
    match error {
        WaveformError::NotTicks { .. } => format!("{error}; --every TICKS plays it at another speed"),
        WaveformError::Points(_) => {
            format!("{error}: leave some out, it is straight between those that are left, and say --every TICKS")
        }
        WaveformError::OutOfReach { .. } if verb("follow") => {
            format!(
                "{error}: ask for less or more slowly, or say what is allowed by --max-error; --dry-run looks at it again"
            )
        }
        WaveformError::OutOfReach { .. } => {
            format!("{error}: play it more slowly (--every TICKS), or ask for less; --dry-run looks at it again")
        }
        WaveformError::Beyond { .. } => {
            format!("{error}: begin within that; is it in µm, and relative to the model's zero?")
        }
        WaveformError::LongWay(_) => {
            format!("{error}: is the slew rate of `piezo info{}` what the amplifier stands?", typed("--port"))
        }
        WaveformError::NoDrive => refusal(&Refusal::NoDrive),
        WaveformError::Link(error @ LinkError::Unknown { .. }) => {
            let port = typed("--port");
            format!("{error}: `piezo info{port}` says whether it plays, and `{}` ends it", stop())
        }
        WaveformError::Link(error) => link(error),
        WaveformError::Inverse(_) | WaveformError::NotPlayed(_) => error.to_string(),
    }
}

/// What a device does that has been told to play so many lines, or lines for ever where there are 0.
pub fn plays(lines: u32, on_trigger: bool) -> String {
    let each = if on_trigger { ", each at a rising edge of its trigger input" } else { "" };
    let ends = format!("`{}`, a fault or a reset", stop());
    match lines {
        0 => format!("The device plays lines by itself{each}, until {ends}"),
        _ => {
            let lines = counted(lines, "line");
            format!("The device plays {lines} by itself{each}, then goes to rest; {ends} ends it sooner")
        }
    }
}

/// How far a waveform is, or how far it was when it ended.
pub fn played(health: &Health, over: bool) -> String {
    let [lines, triggers] = [counted(health.lines, "line"), counted(health.triggers_ignored, "trigger")];
    let said = format!("{lines} begun, {triggers} ignored");
    match over {
        true => format!("{said}; it is over, and the voltage at rest or on its way there"),
        false => said,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_waveform_that_may_have_begun_is_looked_for_and_ended() {
        let port = "tcp:127.0.0.1:4321".parse().unwrap();
        let said = waveform(&WaveformError::Link(LinkError::Unknown { port }));
        assert!(
            said.contains("it is not known whether it was done: `piezo info`") && said.contains("--stop"),
            "{said}"
        );
    }
}
