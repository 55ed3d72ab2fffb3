//! What a result was made from, as three digests: the same logs, options and program make the same result.
//!
//! A log counts by its bytes and by what was read of them, in the order in which the logs were named, never by its
//! name or its time. An option counts by what it came to: a board's file by what it says, a session's folder by its
//! tick and its logs.

use crate::error::UnitError;
use identification::Job;
use recordings::log::{Log, ReadOptions};
use serde::{Deserialize, Serialize};
use sha2::digest::Update;
use sha2::{Digest as _, Sha256};
use std::path::PathBuf;

/// Digests, SHA-256 in lower-case hexadecimal.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Asked {
    /// Of the logs, those that are trained on before those held out.
    pub inputs: String,
    /// Of everything that was chosen or left to its default.
    pub options: String,
    /// Of the program's file: a version's number says too little while one is worked on.
    pub program: String,
}

impl Asked {
    /// Of a job whose logs were read so, and of so many simulated devices for the interval, by this program.
    ///
    /// # Errors
    /// The program's own file cannot be read.
    pub fn of(job: &Job, read: &ReadOptions, devices: u32) -> Result<Self, UnitError> {
        let path = own_file();
        let program = std::fs::read(&path).map_err(|error| UnitError::Program { path, error })?;
        Ok(Self::by(hexadecimal(&program), job, read, devices))
    }

    fn by(program: String, job: &Job, read: &ReadOptions, devices: u32) -> Self {
        Self { inputs: inputs(job), options: options(job, read, devices), program }
    }

    /// What of it is other than before, in words; nothing where all is the same.
    pub fn differs(&self, before: &Self) -> Vec<&'static str> {
        let parts = [
            ("the logs", &self.inputs, &before.inputs),
            ("the options", &self.options, &before.options),
            ("the program", &self.program, &before.program),
        ];
        parts.into_iter().filter(|(_, now, before)| now != before).map(|(what, ..)| what).collect()
    }
}

/// SHA-256 of some bytes, in hexadecimal.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    in_words(Sha256::new_with_prefix(bytes))
}

fn in_words(digest: Sha256) -> String {
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The file of the program that runs. Linux keeps it for whoever runs it, also where another has taken its place.
fn own_file() -> PathBuf {
    let kept = PathBuf::from("/proc/self/exe");
    if kept.exists() { kept } else { std::env::current_exe().unwrap_or(kept) }
}

fn inputs(job: &Job) -> String {
    let mut digest = Sha256::new();
    add_all(&mut digest, job);
    in_words(digest)
}

/// Number by number: a copy of all samples would take as much memory as the logs once more.
fn add_all(digest: &mut impl Update, job: &Job) {
    for logs in [&job.training, &job.held_out] {
        number(digest, logs.len());
        logs.iter().for_each(|log| add(digest, log));
    }
}

/// A log's bytes stand for what lies beside them in no format, so what was read counts, too.
fn add(digest: &mut impl Update, log: &Log) {
    // Holes follow from the bytes and the options.
    let Log { sha256, start_s, sample_period, voltage, displacement, displacement_estimated, .. } = log;
    digest.update(sha256.as_bytes());
    digest.update(&start_s.to_le_bytes());
    digest.update(&sample_period.to_le_bytes());
    digest.update(&[u8::from(*displacement_estimated)]);
    for series in [Some(voltage), displacement.as_ref()] {
        let values = series.map_or(&[][..], Vec::as_slice);
        number(digest, values.len());
        values.iter().for_each(|value| digest.update(&value.to_le_bytes()));
    }
}

fn number(digest: &mut impl Update, count: usize) {
    digest.update(&(count as u64).to_le_bytes());
}

/// Of the options as the program prints them to itself: it names each field, and every digit of a number that
/// makes a difference.
fn options(job: &Job, read: &ReadOptions, devices: u32) -> String {
    let Job { training: _, held_out: _, hold_out, as_judged, prepare, model, conditions, calibration, cost, search } =
        job;
    let said = format!(
        "{hold_out:?} {as_judged:?} {prepare:?} {model:?} {conditions:?} {calibration:?} {cost:?} {search:?} {read:?} {devices}"
    );
    hexadecimal(said.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use identification::cost::{Cost, Feedback};
    use identification::{Conditions, ModelChoice, SearchOptions};
    use recordings::rig::{EXCITATIONS, Rig};

    fn job() -> Job {
        let [one, other, ..] = EXCITATIONS.map(|excitation| Rig { duration: 0.1, ..Rig::default() }.log(excitation));
        Job {
            training: vec![one],
            held_out: vec![other],
            hold_out: 0.0,
            as_judged: false,
            prepare: recordings::prepare::PrepareOptions::default(),
            model: ModelChoice::Auto,
            conditions: Conditions::default(),
            calibration: calibration::CalibrationOptions::default(),
            cost: Cost::from(Feedback::Simulation),
            search: SearchOptions::DEFAULT,
        }
    }

    fn changed(change: impl FnOnce(&mut Job)) -> Vec<&'static str> {
        let of = |job: &Job| Asked::by("p".to_owned(), job, &ReadOptions::default(), 12);
        let mut other = job();
        change(&mut other);
        of(&other).differs(&of(&job()))
    }

    #[test]
    fn what_a_log_is_called_does_not_count() {
        assert_eq!(changed(|_| ()), [""; 0]);
        assert_eq!(changed(|job| job.training[0].name = "SN043".to_owned()), [""; 0]);
        assert_eq!(changed(|job| job.training[0].path = "elsewhere/SN043.csv".into()), [""; 0]);
    }

    #[test]
    fn a_sample_the_role_and_each_option_count() {
        assert_eq!(changed(|job| job.training[0].voltage[7] += 1e-9), ["the logs"]);
        assert_eq!(changed(|job| job.training[0].sha256.replace_range(..1, "x")), ["the logs"]);
        assert_eq!(changed(|job| std::mem::swap(&mut job.training, &mut job.held_out)), ["the logs"]);
        assert_eq!(changed(|job| job.training.append(&mut job.held_out)), ["the logs"]);
        assert_eq!(changed(|job| job.hold_out = 0.25), ["the options"]);
        assert_eq!(changed(|job| job.as_judged = true), ["the options"]);
        assert_eq!(changed(|job| job.search.seed = 2), ["the options"]);
        assert_eq!(changed(|job| job.prepare.voltage_scale = 1.0 + f64::EPSILON), ["the options"]);
        assert_eq!(changed(|job| job.calibration.adc_full_scale = Some(65_520)), ["the options"]);
        assert_eq!(changed(|job| job.conditions.repair = true), ["the options"]);
    }

    /// What a digest is given, and how many bytes of it at once.
    #[derive(Default)]
    struct Given {
        bytes: Vec<u8>,
        most: usize,
    }

    impl Update for Given {
        fn update(&mut self, bytes: &[u8]) {
            self.bytes.extend(bytes);
            self.most = self.most.max(bytes.len());
        }
    }

    #[test]
    fn samples_are_digested_where_they_lie() {
        let (job, mut given) = (job(), Given::default());
        add_all(&mut given, &job);
        assert!(given.bytes.len() > 16 * job.training[0].voltage.len() && given.most <= 64, "{}", given.most);
        assert_eq!(inputs(&job), hexadecimal(&given.bytes));
    }

    #[test]
    fn how_the_logs_are_read_and_how_many_devices_are_simulated_count() {
        let of = |read: &ReadOptions, devices| Asked::of(&job(), read, devices).unwrap();
        let before = of(&ReadOptions::default(), 12);
        assert_eq!(of(&ReadOptions::default(), 0).differs(&before), ["the options"]);
        let read = ReadOptions { sample_rate: Some(200.0), ..ReadOptions::default() };
        assert_eq!(of(&read, 12).differs(&before), ["the options"]);
        let other = Asked { program: String::new(), ..before.clone() };
        assert_eq!(other.differs(&before), ["the program"]);
        assert_eq!(before.program.len(), 64, "of a file that there is");
    }
}
