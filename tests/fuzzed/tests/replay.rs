//! Replays the inputs that the fuzzer has kept, `tests/data/fuzz/`, one folder a target: what it has once looked at
//! stays looked at.

use embassy_time::Duration;
use estimator_core::Model;
use fuzzed::{frame, link, log, precision, record, store, table};
use std::cell::Cell;
use std::collections::HashSet;
use std::path::Path;

/// Checks every input of a target; returns them.
fn replay(target: &str, check: impl Fn(&[u8])) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/fuzz").join(target);
    let mut inputs = Vec::new();
    for file in std::fs::read_dir(&folder).expect("the target's inputs are in the repository") {
        let path = file.expect("the folder can be listed").path();
        // A failure shows the last of them.
        println!("{}", path.display());
        let bytes = std::fs::read(&path).expect("the input can be read");
        check(&bytes);
        inputs.push(bytes);
    }
    assert!(inputs.len() >= 10, "{} inputs: CONTRIBUTING.md says how to write the first ones", inputs.len());
    inputs
}

/// Replays a target whose check says whether the input was one that is worked on: some must be.
fn replay_some(target: &str, check: impl Fn(&[u8]) -> bool) {
    let some = Cell::new(false);
    replay(target, |bytes| some.set(check(bytes) | some.get()));
    assert!(some.get(), "every input of {target} is refused: write the seeds again");
}

#[test]
fn no_record_makes_an_estimator_or_an_inverse_leave_its_limits() {
    let inputs = replay("record", record::check);
    // A new format of the record makes nonsense of all of them.
    let models: HashSet<&str> =
        inputs.iter().filter_map(|bytes| record::admitted(bytes)).map(|(table, _)| table.model().name()).collect();
    for model in Model::ALL {
        assert!(models.contains(model.name()), "no input has an admitted table of {model}: write the seeds again");
    }
}

#[test]
fn no_codes_part_the_two_precisions() {
    replay("precision", precision::check);
    assert_eq!(precision::tables().len(), Model::ALL.len());
}

#[test]
fn whatever_becomes_a_message_is_one_and_the_next_is_received() {
    replay_some("frame", frame::check);
}

#[test]
fn every_request_has_its_one_answer_and_the_output_never_jumps() {
    // Real time: what the fuzzer's clock skips is not waited for.
    replay_some("link", |bytes| link::check(bytes, &|time| std::thread::sleep(time.min(PACE).into())));
}

/// What a device waits at a time.
const PACE: Duration = Duration::from_micros(100);

#[test]
fn the_store_gives_what_was_written_last_whatever_the_power_and_the_flash_do() {
    replay("store", store::check);
}

#[test]
fn any_file_is_read_as_a_log_or_refused_by_name_in_little_memory() {
    // Of a few kilobytes, none may need more. All tests here share it.
    #[cfg(target_os = "linux")]
    {
        use nix::sys::resource::{Resource, setrlimit};
        setrlimit(Resource::RLIMIT_DATA, 1 << 30, 1 << 30).expect("a limit can be lowered");
    }
    replay_some("log", log::check);
}

#[test]
fn any_text_is_a_table_that_is_written_as_it_was_read_or_is_refused_by_name() {
    replay_some("table", table::check);
}
