//! What of a job's logs is fitted to and what is held out.

use crate::job_error::JobError;
use log_survey::{ends_go_beyond, range};
use recordings::log::Log;
use recordings::prepare::PrepareOptions;
use recordings::{LogUse, Role};
use std::borrow::Cow;

/// The logs of a job, cut.
pub(crate) struct Parts<'l> {
    /// The training logs, or what of them is fitted to.
    pub training: Vec<Log>,
    /// Held out as a whole.
    pub held_out: Vec<Log>,
    /// Training logs as a whole, and what is held out of each: the estimator runs on into that, as a device does.
    pub rests: Vec<(Cow<'l, Log>, Log)>,
    /// The ends of the training logs go through what nothing before them does, so that they are left whole here, and
    /// [stretches](log_survey::held_in_turns) of them are held out.
    pub in_turns: bool,
}

impl<'l> Parts<'l> {
    /// Training logs of which the fraction `hold_out` is held out, and logs that are held out as a whole.
    pub fn of(
        training: &'l [Log],
        held_out: &[Log],
        hold_out: f64,
        prepare: &PrepareOptions,
    ) -> Result<Self, JobError> {
        let (whole, apart) = (training, held_out);
        let known = |log| (log, LogUse::new(log, Role::Training));
        let logs: Vec<(&Log, LogUse)> = whole.iter().chain(apart).map(known).collect();
        for (at, (training, content)) in logs.iter().enumerate().take(whole.len()) {
            // Either may be a part of the other.
            let same = |(other, of_other): &&(&Log, LogUse)| {
                content.within(other).is_some() || of_other.within(training).is_some()
            };
            if let Some((log, _)) = logs[at + 1..].iter().find(same) {
                let (rewritten, log) = (log.sha256 != training.sha256, log.path.clone());
                return Err(JobError::SameLog { log, training: training.path.clone(), rewritten });
            }
        }
        let held_out: Vec<Log> = apart.iter().map(|log| prepare.cut(log).into_owned()).collect();
        let (mut training, mut rests) = (Vec::new(), Vec::new());
        held_out.iter().try_for_each(|log| moves(log, log))?;
        let parts = whole.iter().map(|log| prepare.cut(log)).map(|log| (log.split(hold_out), log));
        let parts: Vec<((Log, Log), Cow<'l, Log>)> = parts.collect();
        let in_turns = ends_go_beyond(parts.iter().map(|((first, rest), _)| (first, rest)));
        for ((first, rest), log) in parts {
            if in_turns {
                moves(&log, &log)?;
                training.push(log.into_owned());
                continue;
            }
            moves(&first, &log)?;
            training.push(first);
            if !rest.voltage.is_empty() {
                moves(&rest, &log)?;
                rests.push((log, rest));
            }
        }
        Ok(Self { training, held_out, rests, in_turns })
    }
}

/// Refuses a part of a log in which the actuator rests.
fn moves(part: &Log, whole: &Log) -> Result<(), JobError> {
    let displacement = |log: &Log| range(log.displacement.as_deref().unwrap_or_default());
    let signals = [
        ("voltage", range(&part.voltage), range(&whole.voltage)),
        ("displacement", displacement(part), displacement(whole)),
    ];
    for (signal, here, everywhere) in signals {
        if !part.voltage.is_empty() && here <= RESTS * everywhere {
            return Err(JobError::Rests {
                log: whole.path.clone(),
                signal,
                from_s: part.start_s,
                to_s: part.start_s + part.duration(),
                held_out: part.start_s > whole.start_s,
            });
        }
    }
    Ok(())
}

/// A part whose signal spans less than this fraction of the whole log's rests.
const RESTS: f64 = 0.05;
