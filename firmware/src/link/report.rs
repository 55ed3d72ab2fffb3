//! Who the device is, how it is, and the table in use, as it says them over the link.

use super::device::{Device, Forgotten};
use core::sync::atomic::Ordering::Relaxed;
use embedded_storage_async::nor_flash::NorFlash;
use estimator_core::AdcCode;
use estimator_core::record::{MAX_LENGTH, VERSION, checksum};
use estimator_core::table::Interface;
use protocol::{Health, Identity, Record, ResetCause, Text, text};

impl<F: NorFlash> Device<'_, F> {
    pub(super) fn identity(&self) -> Identity {
        let Interface { tick_us, adc_full_scale, dac_full_scale } = self.facts.interface;
        Identity {
            board: text(self.facts.name),
            uid: self.facts.uid,
            firmware: text(env!("CARGO_PKG_VERSION")),
            git: text(env!("GIT_COMMIT")),
            record_version: VERSION,
            tick_us,
            adc_full_scale,
            dac_full_scale,
            source: self.chosen.source.clone(),
            model: self.chosen.table.as_ref().map_or_else(Text::new, |table| text(table.model())),
            table_crc: self.record().and_then(|record| checksum(&record)).unwrap_or(0),
        }
    }

    pub(super) fn health(&self) -> Health {
        let telemetry = self.telemetry;
        Health {
            mode: telemetry.mode(),
            ticks: telemetry.ticks.load(Relaxed),
            faults: telemetry.faults(),
            faults_seen: telemetry.faults_seen(),
            reset: self.reset(),
            last_words: self.last_words.clone(),
            cycles_last: telemetry.cycles_last.load(Relaxed),
            cycles_max: telemetry.cycles_max.load(Relaxed),
            cycles_period: self.facts.cycles_per_tick,
            missed: telemetry.missed.load(Relaxed),
            adc_saturated: telemetry.adc_saturated.load(Relaxed),
            voltage_out_of_range: telemetry.voltage_out_of_range.load(Relaxed),
            clamped: telemetry.clamped.load(Relaxed),
            dac_saturated: telemetry.dac_saturated.load(Relaxed),
            out_of_reach: telemetry.out_of_reach.load(Relaxed),
            samples_dropped: telemetry.dropped.load(Relaxed),
            frames_refused: self.frames_refused,
            line_errors: self.line_errors().wrapping_sub(self.forgotten.line_errors),
            flash_errors: self.chip.flash_errors().wrapping_sub(self.forgotten.flash_errors),
            bias_um: telemetry.bias.um(),
            bias_age_ticks: telemetry.bias.age_ticks(),
            supply_mv: telemetry.supply.mv(),
            brown_out_level: self.facts.brown_out_level,
            setpoint: telemetry.setpoint().map(|AdcCode(code)| code),
            lines: telemetry.lines.load(Relaxed),
            triggers_ignored: telemetry.triggers_ignored.load(Relaxed),
        }
    }

    pub(super) fn forget(&mut self) {
        self.telemetry.forget();
        self.last_words = None;
        self.frames_refused = 0;
        self.forgotten = Forgotten { line_errors: self.line_errors(), flash_errors: self.chip.flash_errors() };
    }

    /// Why the board started: what its chip says, and what the start before has left.
    fn reset(&self) -> ResetCause {
        let asked = if self.facts.restarts.asked { ResetCause::ASKED } else { ResetCause::empty() };
        self.facts.reset | asked
    }

    /// Errors of the line since start: those that the board counts, and those that its driver reports.
    fn line_errors(&self) -> u32 {
        self.chip.line_errors().wrapping_add(self.line_errors)
    }

    pub(super) fn record(&self) -> Option<Record> {
        let mut buffer = [0; MAX_LENGTH];
        let length = self.chosen.table.as_ref()?.encode(&mut buffer)?;
        Record::from_slice(buffer.get(..length)?).ok()
    }
}
