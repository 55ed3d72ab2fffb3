//! A recording that the page began: the log of `device_link::recording`, in a file of its own.

use device_link::recording::{End, Recorder, Wish};
use protocol::Samples;
use recordings::file::Replacement;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// More recordings than anybody makes in a folder.
const MOST: u32 = 100_000;

/// A recording under way. Dropped, it leaves nothing.
pub struct Log {
    path: PathBuf,
    recorder: Recorder<BufWriter<Replacement>>,
    tick_us: u32,
}

impl Log {
    /// Begins one in a folder, under the first `recording-N.csv` that is free.
    ///
    /// # Errors
    /// It cannot be written, here and below.
    pub fn begin(folder: &Path, wish: Wish) -> io::Result<Self> {
        let free = names(folder, 1).find(|path| !path.exists() && !path.is_symlink());
        let path = free.ok_or(io::ErrorKind::AlreadyExists)?;
        let recorder = Recorder::begin(wish, BufWriter::new(Replacement::of(&path)?))?;
        Ok(Self { path, recorder, tick_us: wish.tick_us })
    }

    /// Where it will be, unless another program makes a file there meanwhile: then it is the next that is free.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How long it is, s.
    pub fn seconds(&self) -> f64 {
        (self.recorder.recording().ticks * u64::from(self.tick_us)) as f64 / 1e6
    }

    /// Takes the next frame; a sentence where the recording must end before it.
    pub fn take(&mut self, samples: &Samples) -> io::Result<Option<String>> {
        Ok(self.recorder.take(samples)?.map(|end| match end {
            End::Gap { ticks } => {
                format!("{ticks} samples were lost: is the cable sound, and this machine not too busy?")
            }
            End::Restarted => "the device was restarted, or its mode set".to_owned(),
            End::NoSensor => "the device reads no sensor, although it should".to_owned(),
            // These are not of a frame.
            End::Complete | End::Silence | End::Link(_) => "it is complete".to_owned(),
        }))
    }

    /// Ends it, in its place; a sentence of what there is.
    pub fn finish(self) -> io::Result<String> {
        let seconds = self.seconds();
        let sensor = self.recorder.recording();
        let rows = sensor.rows;
        let (_, file) = self.recorder.finish()?;
        if rows == 0 {
            return Ok(format!("ended before the first sample: {} is not written", self.path.display()));
        }
        let file = file.into_inner().map_err(|error| error.into_error())?;
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let path = file.commit_to_free(names(folder, 1))?;
        Ok(format!("{} holds {rows} samples, {seconds:.3} s", path.display()))
    }
}

fn names(folder: &Path, first: u32) -> impl Iterator<Item = PathBuf> + '_ {
    (first..MOST).map(|number| folder.join(format!("recording-{number}.csv")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use emulator::TABLE;
    use protocol::Sample;
    use std::fs;

    fn samples(first: u32) -> Samples {
        let sample = Sample {
            code: 100,
            sensor: None,
            displacement: 1.0,
            half_width: None,
            dac: 7,
            status: Default::default(),
            faults: Default::default(),
        };
        Samples { first, samples: [sample; 4].into_iter().collect() }
    }

    fn begun(folder: &Path) -> Log {
        Log::begin(folder, Wish { calibration: TABLE.adc, sensor: None, tick_us: 500, ticks: None, allow_gaps: false })
            .unwrap()
    }

    #[test]
    fn no_file_is_written_over_not_even_one_that_came_meanwhile() {
        let folder = tempfile::tempdir().unwrap();
        let at = |number: u32| folder.path().join(format!("recording-{number}.csv"));
        fs::write(at(1), "mine").unwrap();
        let mut log = begun(folder.path());
        assert_eq!(log.path(), at(2));
        assert_eq!(log.take(&samples(0)).unwrap(), None);
        fs::write(at(2), "yours").unwrap();
        let said = log.finish().unwrap();
        assert!(said.contains("recording-3.csv holds 3 samples, 0.002 s"), "{said}");
        assert_eq!(
            (fs::read_to_string(at(1)).unwrap(), fs::read_to_string(at(2)).unwrap()),
            ("mine".into(), "yours".into())
        );
        assert_eq!(fs::read_to_string(at(3)).unwrap().lines().count(), 4);
    }

    #[test]
    fn what_is_lost_ends_it_and_nothing_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = begun(folder.path());
        assert_eq!(log.take(&samples(0)).unwrap(), None);
        assert!(log.take(&samples(9)).unwrap().is_some_and(|why| why.contains("5 samples were lost")));
        drop(log);
        let said = begun(folder.path()).finish().unwrap();
        assert!(said.contains("before the first sample"), "{said}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
