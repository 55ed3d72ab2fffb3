//! What something takes: of time, and of the processor.

use std::{fmt, time::Instant};

use serde::{Deserialize, Serialize};

/// Wall-clock time and the processor time, user's and system's, of the programs that were run and waited for meanwhile;
/// seconds.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub struct Spent {
    wall_s: f64,
    /// `None` where the system does not tell.
    cpu_s: Option<f64>,
}

/// Runs since [`Stopwatch::start`].
pub struct Stopwatch {
    start: Instant,
    cpu_s: Option<f64>,
}

impl Stopwatch {
    /// Starts one at this moment.
    pub fn start() -> Self {
        Self { start: Instant::now(), cpu_s: cpu_of_children_s() }
    }

    /// What has been spent since.
    pub fn read(&self) -> Spent {
        let cpu_s = self.cpu_s.zip(cpu_of_children_s()).map(|(before, now)| now - before);
        Spent { wall_s: self.start.elapsed().as_secs_f64(), cpu_s }
    }
}

#[cfg(unix)]
fn cpu_of_children_s() -> Option<f64> {
    use nix::sys::{
        resource::{UsageWho, getrusage},
        time::TimeVal,
    };
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).ok()?;
    let seconds = |time: TimeVal| time.tv_sec() as f64 + 1e-6 * time.tv_usec() as f64;
    Some(seconds(usage.user_time()) + seconds(usage.system_time()))
}

#[cfg(not(unix))]
fn cpu_of_children_s() -> Option<f64> {
    None
}

/// Two columns: wall-clock time and processor time.
impl fmt::Display for Spent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:>8.1} s ", self.wall_s)?;
        match self.cpu_s {
            Some(cpu_s) => write!(f, "{cpu_s:>8.1} s of CPU"),
            None => write!(f, "{:>8} s of CPU", "–"),
        }
    }
}
