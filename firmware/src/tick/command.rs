//! What commands make of the tick: another mode, a displacement that is told, a start anew.

use super::{Tick, tick_restart};
use crate::decimation::Streamed;
use crate::drive::Following;
use crate::queues::Command;
use crate::startup::DacUse;
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::Estimator;
use protocol::{Faults, Mode};

impl Tick<'_> {
    pub(super) fn restart(&mut self) {
        if let Some(estimator) = &mut self.estimator {
            tick_restart(estimator);
        }
        // A code that leaps with the correction would look like the voltage of a wire that is on again.
        if self.leap.as_ref().is_none_or(|leap| leap.faults().is_empty()) {
            self.correction.restart();
        }
        if let Some(leap) = &mut self.leap {
            leap.restart();
        }
        self.telemetry.bias.set(None);
        self.telemetry.may_be_told.store(false, Relaxed);
        if core::mem::take(&mut self.told) {
            self.standing.insert(Faults::ZERO_LOST);
        }
    }

    /// Tells the estimator its bias, and the link whether it was taken.
    fn tell(&mut self, tell: impl FnOnce(&mut Estimator<f32>) -> bool) {
        let estimator = self.estimator.as_mut();
        let taken = estimator.and_then(|estimator| tell(estimator).then(|| estimator.bias()));
        if taken.is_some() {
            self.telemetry.bias.set(taken);
            // Of fed codes it is over with them.
            if self.mode.measures() {
                self.told = true;
                self.standing.remove(Faults::ZERO_LOST);
            }
        }
        self.telemetry.was_told(taken.is_some());
    }

    /// Begins a mode, wherever the output stands. An estimate from the ADC goes on, and so do the faults of
    /// what it reads.
    pub(super) fn enter(&mut self, mode: Mode) {
        let goes_on = self.mode.measures() && mode.measures();
        self.mode = mode;
        self.number = 0;
        self.decimation = Streamed::default();
        self.queues.fed.change_mode();
        self.queues.references.change_mode();
        self.watch.change_mode();
        if !goes_on {
            self.restart();
        }
        if let DacUse::Drives { drive, setpoint } = &mut self.dac {
            if let Some(setpoint) = setpoint {
                setpoint.restart();
            }
            drive.restart();
            if matches!(mode, Mode::Linearise | Mode::Waveform) {
                drive.go(true);
            }
        }
        self.player.stop();
        self.telemetry.set_following(Following::NotYet);
        self.telemetry.set_mode(mode);
    }

    pub(super) fn obey(&mut self, command: Command) {
        match command {
            Command::SetMode(mode) => self.enter(mode),
            Command::Play(how) => {
                self.enter(Mode::Waveform);
                if let Some(drive) = self.dac.drive() {
                    let (from, pace) = drive.stands();
                    self.player.play(how, from, pace);
                }
            }
            Command::Go { hold } => {
                if let Some(drive) = self.dac.drive_mut() {
                    drive.go(hold);
                }
            }
            // The voltage may have gone wrong since the device has looked.
            Command::SetZero { .. } if self.telemetry.doubts() => self.telemetry.was_told(false),
            Command::SetZero { at_um } => self.tell(|estimator| estimator.set_zero(at_um)),
            Command::ShiftBias { by_um } => self.tell(|estimator| estimator.shift(by_um)),
        }
    }
}
