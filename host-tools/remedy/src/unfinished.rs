//! What is said of a session on the bench that has ended before its time, or has not ended.

use super::bench::{complaint, identify, stopped};
use super::learnable::tried;
use super::paste::{quoted, typed};
use super::sentence;
use bench::{Ended, FORMER, Unfinished};
use device_link::Address;
use recordings::log::{ReadOptions, read};
use std::path::Path;

/// Why a session ended before its time, with its remedy.
pub fn ended(why: &Ended) -> String {
    match why {
        Ended::Fault(faults) => stopped(*faults),
        Ended::Complaint(of) => complaint(of),
        Ended::Log(error) => sentence(error),
        Ended::Play(error) => sentence(error),
    }
}

/// What is kept of a session that ended before its time, and the command that learns from it; `None` where there is
/// nothing to learn from.
pub fn kept_logs(folder: &Path) -> Option<String> {
    let session = bench::session(folder).ok().filter(|session| !session.logs.is_empty())?;
    let all = session.logs.len() + session.held_out.len();
    let there = session.unfinished.map_or(all, |unfinished| unfinished.there);
    let logs = if there == 1 { "1 log is".to_owned() } else { format!("{there} logs are") };
    let read_all =
        || session.logs.iter().map(|log| read(log, &ReadOptions::default()).ok()).collect::<Option<Vec<_>>>();
    if let Some(Err(why)) = read_all().map(tried) {
        return Some(format!(
            "{logs} kept, from which nothing can be learnt ({}): piezo train with another --out plays a session anew",
            sentence(&why)
        ));
    }
    Some(format!("{logs} kept, to learn from as far as they go:\n\n    {}{}", identify(folder), typed("--board")))
}

/// What is to be done where a session's device was not seen to have its table of before again.
pub fn stranded(folder: &Path, port: &Address) -> String {
    let former = folder.join(FORMER);
    match former.exists() {
        true => format!(
            "the table of before is not in use again (piezo push {} --reset --port {port} brings it back)",
            quoted(&former.display().to_string())
        ),
        false => format!("the device was not seen to come to rest (piezo info --port {port} says, once it answers)"),
    }
}

/// What is missing of a session, with its remedy; and where its folder keeps the only copy of a table.
pub fn unfinished(folder: &Path, of: &Unfinished) -> String {
    let former = folder.join(FORMER);
    match of.under_way {
        true => format!("{of}: wait until it has ended"),
        false if former.exists() => format!(
            "{of}: piezo train with another --out plays a session anew. The table that was in use before is in {} alone; \
             it is brought back with:\n    piezo push {} --reset",
            former.display(),
            quoted(&former.display().to_string())
        ),
        false => format!("{of}: piezo train with another --out plays a session anew"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use device_link::play::PlayError;

    #[test]
    fn a_session_that_a_silent_host_ended_says_why_and_what_is_kept() {
        let said = ended(&Ended::Play(PlayError::LetGo));
        assert!(said.contains("nothing of this machine for five seconds") && said.contains("suspended"), "{said}");
        let folder = tempfile::tempdir().unwrap();
        let of = |rows: [u32; 2]| {
            let log = |(name, rows): (&str, u32)| {
                format!("[[logs]]\nlog = \"{name}.csv\"\nheld_out = false\ncomplete = {}\nrows = {rows}\n", rows > 500)
            };
            let logs = [("01-branch", rows[0]), ("02-loops", rows[1])].map(log).concat();
            let session = format!("complete = false\nseed = 1\nplanned = 8\n{logs}");
            std::fs::write(folder.path().join("session.toml"), session).unwrap();
            kept_logs(folder.path())
        };
        let said = of([900, 0]).unwrap();
        assert!(said.starts_with("1 log is kept") && said.contains(&identify(folder.path())), "{said}");
        assert!(of([900, 200]).unwrap().starts_with("2 logs are kept"));
        assert_eq!(of([20, 0]), None);
        // Nothing is missing where a description does not say what was planned; the log to prove with is one of those
        // that are kept.
        let log = |name: &str, held_out: bool| format!("[[logs]]\nlog = \"{name}.csv\"\nheld_out = {held_out}\n");
        let logs = [log("01-branch", false), log("02-loops", false), log("03-proof", true)].concat();
        std::fs::write(folder.path().join("session.toml"), format!("complete = true\nseed = 1\n{logs}")).unwrap();
        assert!(kept_logs(folder.path()).unwrap().starts_with("3 logs are kept"));
        // Killed, it left the only copy of a table.
        let (there, under_way) = (1, false);
        let killed =
            Unfinished { under_way, ended: false, there, cut_short: vec![], planned: Some(8), held_out: false };
        assert!(!unfinished(folder.path(), &killed).contains(FORMER));
        std::fs::write(folder.path().join(FORMER), []).unwrap();
        let said = unfinished(folder.path(), &killed);
        assert!(said.contains("piezo push") && said.ends_with(&format!("{FORMER} --reset")), "{said}");
    }
}
