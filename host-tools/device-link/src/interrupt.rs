//! Ctrl-C, as a wish to end properly.

use signal_hook::consts::TERM_SIGNALS;
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The operating system does not tell of signals.
#[derive(Debug, thiserror::Error)]
#[error("cannot listen for Ctrl-C")]
pub struct InterruptError(#[from] std::io::Error);

/// Whether the user wants the program to end.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Turns the first signal (Ctrl-C, `kill`) into a wish; the second ends the program at once.
    ///
    /// # Errors
    /// The operating system refuses.
    pub fn watch() -> Result<Self, InterruptError> {
        let interrupt = Self::default();
        for &signal in TERM_SIGNALS {
            flag::register_conditional_shutdown(signal, 2, interrupt.0.clone())
                .and_then(|_| flag::register(signal, interrupt.0.clone()))?;
        }
        Ok(interrupt)
    }

    /// Wishes so without a signal.
    pub fn want(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether a signal has come.
    pub fn wanted(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
