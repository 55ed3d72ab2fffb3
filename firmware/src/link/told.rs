//! A displacement that is told: the estimate's zero, or a shift of it, which the tick takes or does not.

use super::device::{Device, OBEYED, POLL};
use crate::queues::Command;
use core::sync::atomic::Ordering::Relaxed;
use embassy_time::Timer;
use embedded_storage_async::nor_flash::NorFlash;
use estimator_core::Range;
use protocol::{Mode, Refusal};

impl<F: NorFlash> Device<'_, F> {
    /// Shifts the bias (µm), not farther than the displacement's span, however often.
    pub(super) async fn shift(&mut self, by_um: f32) -> Result<(), Refusal> {
        let bias_um = self.telemetry.bias.um();
        let farther = (bias_um + by_um).abs() > bias_um.abs();
        self.tell(if farther { bias_um + by_um } else { by_um }, Command::ShiftBias { by_um }).await
    }

    /// Hands on a command that tells the bias by a displacement, µm, and learns whether the tick has taken it.
    pub(super) async fn tell(&mut self, displacement: f32, command: Command) -> Result<(), Refusal> {
        let table = self.estimator().filter(|_| self.telemetry.mode() != Mode::Pause);
        let span_um = table.ok_or(Refusal::NotEstimating)?.displacement_limits_um.span();
        if !(Range { min: -span_um, max: span_um }).contains(displacement) {
            return Err(Refusal::BeyondSpan { span_um });
        }
        if !self.telemetry.may_be_told.load(Relaxed) {
            return Err(Refusal::TooSoon);
        }
        // A shift is of a mean, whatever the voltage of now.
        if matches!(command, Command::SetZero { .. }) && self.telemetry.doubts() {
            return Err(Refusal::NotBelieved);
        }
        let (before, _) = self.telemetry.told();
        self.queues.commands.enqueue(command).map_err(|_| Refusal::Busy)?;
        for _ in 0..OBEYED.as_ticks() / POLL.as_ticks() {
            match self.telemetry.told() {
                (now, _) if now == before => Timer::after(POLL).await,
                // Since it was looked at above, the voltage has gone wrong or the estimate has begun anew.
                (_, false) if self.telemetry.doubts() => return Err(Refusal::NotBelieved),
                (_, false) => return Err(Refusal::TooSoon),
                (_, true) => {
                    // Before the reply, so that no reset comes between. That of fed codes is over with them.
                    if self.telemetry.mode().measures() {
                        self.memory.keep_told();
                    }
                    return Ok(());
                }
            }
        }
        Err(Refusal::Busy)
    }

    /// Calls the displacement of now 0, for somebody beside the actuator: that of fed codes is none of it, and is told
    /// by who feeds them alone.
    ///
    /// # Errors
    /// Nothing is estimated of the ADC, the last voltage is not to be believed, or no tick has come to obey.
    pub async fn zero(&mut self) -> Result<(), Refusal> {
        if !self.telemetry.mode().measures() {
            return Err(Refusal::NotEstimating);
        }
        self.tell(0.0, Command::SetZero { at_um: 0.0 }).await
    }
}
