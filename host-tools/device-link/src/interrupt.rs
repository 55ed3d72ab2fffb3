//! Ctrl-C, as a wish to end properly.

use signal_hook::consts::TERM_SIGNALS;
use signal_hook::flag;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// The operating system does not tell of signals.
#[derive(Debug, thiserror::Error)]
#[error("cannot listen for Ctrl-C")]
pub struct InterruptError(#[from] std::io::Error);

/// Whether the user wants the program to end.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

/// What is done as soon as a signal comes, while this lives.
#[derive(Debug)]
pub struct Then(Arc<AtomicBool>);

impl Drop for Then {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// How often a signal is looked for.
const LOOK: Duration = Duration::from_millis(50);

impl Interrupt {
    /// Turns the first signal (Ctrl-C, `kill`) into a wish; the second ends the program at once. There is one wish in a
    /// process, however often it is asked for, so that what comes between two parts of a task, or in the first, is
    /// known to the second.
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn watch() -> Result<Self, InterruptError> {
        static WATCHED: Mutex<Option<Interrupt>> = Mutex::new(None);
        // One that panicked while it held this has not changed it halfway.
        let mut watched = WATCHED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(interrupt) = &*watched {
            return Ok(interrupt.clone());
        }
        let interrupt = Self::default();
        for &signal in TERM_SIGNALS {
            flag::register_conditional_shutdown(signal, 2, interrupt.0.clone())
                .and_then(|_| flag::register(signal, interrupt.0.clone()))?;
        }
        Ok(watched.insert(interrupt).clone())
    }

    /// Wishes so without a signal.
    pub fn want(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Does something as soon as a signal comes, at once where one has come, until what it gives is dropped.
    pub fn then(&self, act: impl FnOnce() + Send + 'static) -> Then {
        let (over, wish) = (Arc::new(AtomicBool::new(false)), self.clone());
        let ends = Arc::clone(&over);
        std::thread::spawn(move || {
            while !ends.load(Ordering::Relaxed) {
                if wish.wanted() {
                    return act();
                }
                std::thread::sleep(LOOK);
            }
        });
        Then(over)
    }

    /// Whether a signal has come.
    pub fn wanted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wish_is_heard_while_somebody_listens() {
        let (wish, (said, heard)) = (Interrupt::default(), std::sync::mpsc::channel());
        let (now, after) = (said.clone(), said);
        drop(wish.then(move || after.send("after it is over").unwrap()));
        std::thread::sleep(4 * LOOK);
        let _listens = wish.then(move || now.send("now").unwrap());
        wish.want();
        assert_eq!(heard.recv_timeout(Duration::from_secs(10)), Ok("now"));
        assert!(heard.recv_timeout(Duration::from_secs(10)).is_err());
    }

    #[test]
    fn a_wish_in_one_part_of_a_task_is_known_to_the_next() {
        let (first, alone) = (Interrupt::watch().unwrap(), Interrupt::default());
        assert!(!first.wanted());
        signal_hook::low_level::raise(signal_hook::consts::SIGTERM).unwrap();
        assert!(first.wanted() && Interrupt::watch().unwrap().wanted() && !alone.wanted());
    }
}
