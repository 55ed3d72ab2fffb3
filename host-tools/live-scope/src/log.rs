//! A recording that the page began: the log of `device_link::recording`, in a file of its own.

use crate::error::Unkept;
use device_link::recording::{End, Recorder, RecordingRequest, SILENCE};
use protocol::Samples;
use result_files::{Replacement, partial};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// More recordings than anybody makes in a folder.
const MOST: u32 = 100_000;

/// A recording under way. Dropped, it leaves nothing; killed, what it has by then (`recording-1.csv.partial`).
pub struct Log {
    path: PathBuf,
    /// The number in the file's name.
    number: u32,
    recorder: Recorder<BufWriter<Disk>>,
    tick_us: u32,
    /// When the last frame came.
    heard: Instant,
}

/// What it is written to; in tests a disk that is full after so many bytes.
struct Disk {
    file: Replacement,
    #[cfg(test)]
    bytes_left: usize,
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        #[cfg(test)]
        let bytes = &bytes[..bytes.len().min(self.bytes_left)];
        #[cfg(test)]
        if bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let written = self.file.write(bytes)?;
        #[cfg(test)]
        {
            self.bytes_left -= written;
        }
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Log {
    /// Begins one in a folder, under the first `recording-N.csv` that is free.
    ///
    /// # Errors
    /// It cannot be written, here and below.
    pub fn begin(folder: &Path, request: RecordingRequest) -> io::Result<Self> {
        let free = |path: &Path| !path.exists() && !path.is_symlink();
        let free = names(folder, 1).find(|(_, path)| free(path) && free(&partial(path)));
        let (number, path) = free.ok_or(io::ErrorKind::AlreadyExists)?;
        let disk = Disk {
            file: Replacement::growing(&path).map_err(io::Error::other)?,
            #[cfg(test)]
            bytes_left: usize::MAX,
        };
        let recorder = Recorder::begin(request, BufWriter::new(disk))?;
        Ok(Self { path, number, recorder, tick_us: request.tick_us, heard: Instant::now() })
    }

    /// Where it will be, unless another program makes a file there meanwhile: then it is the next that is free.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How long it is, s.
    pub fn seconds(&self) -> f64 {
        (self.recorder.recording().ticks * u64::from(self.tick_us)) as f64 / 1e6
    }

    /// A sentence where no samples come any more.
    pub fn silence(&self) -> Option<String> {
        (self.heard.elapsed() >= SILENCE).then(|| why(&End::Silence))
    }

    /// Takes the next frame; a sentence where the recording must end before it.
    pub fn take(&mut self, samples: &Samples) -> io::Result<Option<String>> {
        self.heard = Instant::now();
        Ok(self.recorder.take(samples)?.map(|end| why(&end)))
    }

    /// Ends it, in its place; a sentence of what there is.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(self) -> Result<String, Unkept> {
        let seconds = self.seconds();
        let Self { path, number, mut recorder, .. } = self;
        let rows = recorder.recording().rows;
        if rows == 0 {
            return Ok(format!("ended before the first sample: {} is not written", path.display()));
        }
        let flushed = recorder.flush();
        // What has not been handed to the disk by now cannot be.
        let (mut disk, _) = recorder.into_log().into_parts();
        let cut = if flushed.is_err() { disk.file.cut_to_lines().map(drop) } else { Ok(()) };
        let folder = path.parent().unwrap_or(Path::new(""));
        let put = disk.file.commit_to_free(names(folder, number).map(|(_, path)| path));
        match (put, flushed.and(cut)) {
            (Ok(path), Ok(())) => Ok(format!("{} holds {rows} samples, {seconds:.3} s", path.display())),
            (Ok(kept), Err(error)) => Err(Unkept::Cut { path, error, kept }),
            (Err(error), _) => Err(Unkept::Lost { path, error }),
        }
    }
}

/// Why a recording ends.
fn why(end: &End) -> String {
    match end {
        End::Gap { samples } => {
            format!("{samples} samples were lost: is the cable sound, and this machine not too busy?")
        }
        End::Restarted => "the device was restarted, or its mode set".to_owned(),
        End::NoSensor => "the device reads no sensor, although it should".to_owned(),
        // The rest are no end of a recording that lasts until somebody has enough: its link is the page's.
        End::Silence | End::Complete | End::Link(_) => "the device sends no samples any more".to_owned(),
    }
}

fn names(folder: &Path, first: u32) -> impl Iterator<Item = (u32, PathBuf)> + '_ {
    (first..MOST).map(|number| (number, folder.join(format!("recording-{number}.csv"))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use emulator::TABLE;
    use protocol::Sample;
    use std::fs;
    use std::num::NonZeroU8;

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
        Samples { first, every: NonZeroU8::MIN, samples: [sample; 4].into_iter().collect() }
    }

    fn begun(folder: &Path) -> Log {
        Log::begin(
            folder,
            RecordingRequest { calibration: TABLE.adc, sensor: None, tick_us: 500, ticks: None, allow_gaps: false },
        )
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
    fn what_a_killed_program_leaves_is_a_log_and_its_number_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = begun(folder.path());
        assert_eq!(log.take(&samples(0)).unwrap(), None);
        let left = partial(log.path());
        let text = fs::read_to_string(&left).unwrap();
        assert!(text.ends_with('\n') && text.lines().count() == 4, "{text}");
        drop(log);
        fs::write(&left, &text).unwrap();
        let log = begun(folder.path());
        assert_eq!(log.path(), folder.path().join("recording-2.csv"));
        assert_eq!(fs::read_to_string(left).unwrap(), text);
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

    #[test]
    fn the_name_that_was_announced_is_kept_where_one_before_it_is_free_by_then() {
        let folder = tempfile::tempdir().unwrap();
        let first = folder.path().join("recording-1.csv");
        fs::write(&first, "mine").unwrap();
        let mut log = begun(folder.path());
        assert_eq!(log.take(&samples(0)).unwrap(), None);
        fs::remove_file(first).unwrap();
        let announced = log.path().to_owned();
        let said = log.finish().unwrap();
        assert!(announced.exists() && said.starts_with(&announced.display().to_string()), "{said}");
    }

    #[test]
    fn a_disk_that_is_full_keeps_the_lines_that_it_has() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = begun(folder.path());
        let disk = Disk { file: Replacement::of(log.path()).unwrap(), bytes_left: 60 };
        let request =
            RecordingRequest { calibration: TABLE.adc, sensor: None, tick_us: 500, ticks: None, allow_gaps: false };
        log.recorder = Recorder::begin(request, BufWriter::with_capacity(8, disk)).unwrap();
        let path = log.path().to_owned();
        let failed = (0..100).find_map(|number| log.take(&samples(4 * number)).err());
        assert!(failed.is_some_and(|error| error.kind() == io::ErrorKind::StorageFull));
        let said = log.finish().unwrap_err().to_string();
        assert!(said.contains("cannot be written") && said.contains("recording-1.csv holds what was"), "{said}");
        let kept = fs::read_to_string(path).unwrap();
        assert!(
            kept.len() <= 60 && kept.ends_with('\n') && kept.lines().all(|line| line.matches(',').count() == 2),
            "{kept}"
        );
    }

    #[test]
    fn who_falls_silent_is_heard_of_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = begun(folder.path());
        assert_eq!(log.silence(), None);
        log.heard = Instant::now().checked_sub(SILENCE).unwrap();
        assert!(log.silence().is_some_and(|why| why.contains("no samples")));
    }
}
