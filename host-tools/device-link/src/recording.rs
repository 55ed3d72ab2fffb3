//! Streamed samples as a log: `time_s,voltage_V,estimated_displacement_um`, a row a sample, written as they come; with
//! a sensor on the board's second channel `time_s,voltage_V,displacement_um,estimate_um`.
//!
//! The voltage is the code through the calibration of the device's table, the sensor's displacement that of the same
//! tick. The estimate is the device's own, and the column says so. Time counts ticks; where samples were lost it leaps.
//! Of a device that streams every n-th tick only, a row is an n-th tick.

use super::client::Client;
use super::error::LinkError;
use super::sensor::Sensor;
use super::streamed::estimate_at;
use super::window::{Continuity, Numbers, samples_in};
use estimator_core::{AdcCalibration, AdcCode, Status};
use protocol::{Faults, Sample, Samples};
use std::io::{self, Write};
use std::num::NonZeroU8;
use std::time::Duration;

/// Names of the columns; [`recordings::log::read`] knows them.
pub const HEADER: &str = "time_s,voltage_V,estimated_displacement_um";
/// The same with a sensor, whose displacement is then the log's.
pub const HEADER_WITH_SENSOR: &str = "time_s,voltage_V,displacement_um,estimate_um";

/// A stream that gives nothing for so long has ended.
pub const SILENCE: Duration = Duration::from_secs(2);
/// How often the wish to end is looked at.
const LOOK: Duration = Duration::from_millis(100);

/// What is to be recorded.
#[derive(Clone, Copy, Debug)]
pub struct RecordingRequest {
    /// Codes to volts.
    pub calibration: AdcCalibration,
    /// The sensor, where one is to be recorded.
    pub sensor: Option<Sensor>,
    /// The device's tick, µs.
    pub tick_us: u32,
    /// Ticks; without it until the user has enough.
    pub ticks: Option<u64>,
    /// Go on after a gap.
    pub allow_gaps: bool,
}

/// What was recorded.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Rows that were written.
    pub rows: u64,
    /// Ticks from the first to after the last row.
    pub ticks: u64,
    /// Rows that are missing in between.
    pub lost: u64,
    /// Rows of ticks that came late.
    pub late: u64,
    /// Every status bit.
    pub status: Status,
    /// Every fault that a sample had.
    pub faults: Faults,
    /// Ticks from a row to the next.
    pub every: Option<NonZeroU8>,
    /// The last sample, whose displacement is that of the tick after it.
    before: Option<Sample>,
}

impl Recording {
    /// Whether it has so many ticks; where nobody says how many, any will do.
    pub fn lasted(&self, ticks: Option<u64>) -> bool {
        ticks.is_none_or(|ticks| self.ticks >= ticks)
    }
}

/// Why a recording ended.
#[derive(Debug)]
pub enum End {
    /// All is there, or the user has enough.
    Complete,
    /// Samples were lost, and gaps were not allowed.
    Gap {
        /// How many samples came before.
        samples: u64,
    },
    /// The device counts from 0 again: somebody restarted it.
    Restarted,
    /// The board has no channel of a sensor, which is to be recorded.
    NoSensor,
    /// No samples came any more.
    Silence,
    /// The link failed.
    Link(LinkError),
}

/// A recording under way, which takes the frames of samples as they come: for who has other uses of them, too.
#[derive(Debug)]
pub struct Recorder<W> {
    request: RecordingRequest,
    log: W,
    numbers: Numbers,
    recording: Recording,
}

impl<W: Write> Recorder<W> {
    /// Begins a log, by its header.
    ///
    /// # Errors
    /// The log cannot be written, here and below.
    pub fn begin(request: RecordingRequest, mut log: W) -> io::Result<Self> {
        writeln!(log, "{}", if request.sensor.is_some() { HEADER_WITH_SENSOR } else { HEADER })?;
        Ok(Self { request, log, numbers: Numbers::default(), recording: Recording::default() })
    }

    /// Writes the next frame; or says why it is not written, and nothing after it may be.
    pub fn take(&mut self, samples: &Samples) -> io::Result<Option<End>> {
        let recording = &mut self.recording;
        match self.numbers.take(samples) {
            Continuity::Contiguous => {}
            Continuity::Gap(ticks) if self.request.allow_gaps => {
                recording.lost += samples_in(ticks, samples);
                recording.ticks += u64::from(ticks);
                recording.before = None;
            }
            Continuity::Gap(ticks) => return Ok(Some(End::Gap { samples: samples_in(ticks, samples) })),
            Continuity::Restarted => return Ok(Some(End::Restarted)),
        }
        if self.request.sensor.is_some() && samples.samples.iter().any(|sample| sample.sensor.is_none()) {
            return Ok(Some(End::NoSensor));
        }
        write(samples, &self.request, recording, &mut self.log)?;
        // Where the program is killed, what is on the disk ends with a whole line, and is a frame old.
        self.log.flush()?;
        Ok(None)
    }

    /// What is recorded so far.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Hands all that was recorded to whatever the log is written to.
    pub fn flush(&mut self) -> io::Result<()> {
        self.log.flush()
    }

    /// The log as it stands, also of one that cannot be written any more.
    pub fn into_log(self) -> W {
        self.log
    }

    /// Ends it; what was recorded, and the log, all of which is handed to whatever it is written to.
    pub fn finish(mut self) -> io::Result<(Recording, W)> {
        self.log.flush()?;
        Ok((self.recording, self.log))
    }
}

/// Records until enough is there, `enough` says so, or something ends it.
///
/// # Errors
/// The log cannot be written.
pub fn record(
    client: &mut Client,
    request: &RecordingRequest,
    log: &mut impl Write,
    mut enough: impl FnMut(&Recording) -> bool,
) -> io::Result<(Recording, End)> {
    let mut recorder = Recorder::begin(*request, log)?;
    let mut silence = Duration::ZERO;
    let end = loop {
        let recording = recorder.recording();
        if request.ticks.is_some_and(|ticks| recording.ticks >= ticks) || enough(recording) {
            break End::Complete;
        }
        let samples = match client.samples(LOOK) {
            Ok(Some(samples)) => samples,
            Ok(None) if silence < SILENCE => {
                silence += LOOK;
                continue;
            }
            Ok(None) => break End::Silence,
            Err(error) => break End::Link(error),
        };
        silence = Duration::ZERO;
        if let Some(end) = recorder.take(&samples)? {
            break end;
        }
    };
    Ok((recorder.finish()?.0, end))
}

fn write(
    samples: &Samples,
    request: &RecordingRequest,
    recording: &mut Recording,
    log: &mut impl Write,
) -> io::Result<()> {
    let ticks = u64::from(samples.every.get());
    recording.every = Some(samples.every);
    for sample in &samples.samples {
        if request.ticks.is_some_and(|ticks| recording.ticks >= ticks) {
            break;
        }
        // Whole µs over 10⁶ is the double nearest to the true time, and so prints short.
        let time = (recording.ticks * u64::from(request.tick_us)) as f64 / 1e6;
        let voltage: f32 = request.calibration.voltage(AdcCode(sample.code));
        // A sample's displacement is that of the next tick, beside whose voltage it belongs.
        let Some(before) = recording.before.replace(*sample) else {
            if recording.rows > 0 {
                recording.ticks += ticks;
                recording.lost += 1;
            }
            continue;
        };
        let displacement = estimate_at(&before, sample, samples.every);
        match request.sensor {
            None => writeln!(log, "{time},{voltage},{displacement}")?,
            Some(sensor) => {
                // Every sample has one: it was looked at before.
                let measured = sensor.um(sample).unwrap_or(f64::NAN);
                writeln!(log, "{time},{voltage},{measured:.5},{displacement}")?;
            }
        }
        recording.rows += 1;
        recording.ticks += ticks;
        recording.late += u64::from(sample.faults.contains(Faults::MISSED_DEADLINE));
        recording.status |= sample.status;
        recording.faults |= sample.faults;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use emulator::faults::{lose_samples_at, silent_from};
    use emulator::{Emulator, Fault, FaultyLine, TABLE};
    use recordings::log::{ReadOptions, read};

    fn recorded(fault: impl Fault, ticks: u64, allow_gaps: bool) -> (String, Recording, End) {
        let device = Emulator::new().speed(8.0).start().unwrap();
        let line = FaultyLine::to(device.address(), fault).unwrap();
        let (mut client, identity) = Client::connect(&line.address().into()).unwrap();
        let calibration = TABLE.adc;
        client.stream(true).unwrap();
        let request =
            RecordingRequest { calibration, sensor: None, tick_us: identity.tick_us, ticks: Some(ticks), allow_gaps };
        let mut log = Vec::new();
        let (recording, end) = record(&mut client, &request, &mut log, |_| false).unwrap();
        (String::from_utf8(log).unwrap(), recording, end)
    }

    #[test]
    fn a_recording_is_a_log() {
        let (log, recording, end) = recorded(|_, _: &mut Vec<u8>| {}, 1000, false);
        assert!(matches!(end, End::Complete), "{end:?}");
        assert_eq!((recording.rows, recording.lost), (1000, 0));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, log).unwrap();
        let log = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!((log.voltage.len(), log.sample_period), (1000, 0.0005));
        assert!(log.displacement.is_some() && log.displacement_estimated);
    }

    #[test]
    fn a_sensor_that_is_not_there_is_not_recorded() {
        let device = Emulator::new().speed(8.0).start().unwrap();
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        client.stream(true).unwrap();
        let sensor = Some(Sensor { zero_um: 0.0, full_um: 30.0, full_scale: TABLE.adc.full_scale });
        let request =
            RecordingRequest { calibration: TABLE.adc, sensor, tick_us: 500, ticks: Some(100), allow_gaps: false };
        let (recording, end) = record(&mut client, &request, &mut Vec::new(), |_| false).unwrap();
        assert!(matches!(end, End::NoSensor) && recording.rows == 0, "{end:?}");
    }

    #[test]
    fn a_gap_ends_it_or_shows_in_the_time() {
        let (log, recording, end) = recorded(lose_samples_at(200), 1000, false);
        assert!(matches!(end, End::Gap { samples } if samples > 0), "{end:?}");
        assert_eq!((log.lines().count() as u64, recording.ticks), (recording.rows + 1, recording.rows));

        let (log, recording, end) = recorded(lose_samples_at(200), 1000, true);
        assert!(matches!(end, End::Complete), "{end:?}");
        assert!(recording.lost > 0);
        assert_eq!(recording.rows + recording.lost, 1000);
        assert!(log.lines().last().unwrap().starts_with("0.4995,"), "time goes on over the gap");
    }

    #[test]
    fn a_device_that_falls_silent_ends_it() {
        let (_, recording, end) = recorded(silent_from(100), 1000, false);
        assert!(matches!(end, End::Silence), "{end:?}");
        assert_eq!(recording.rows, 99, "the first sample's displacement is the second's tick's");
    }
}
