//! Which part of which log was used for what, in words.

use recordings::{LogUse, Role};

/// A log's role, as a heading, and its file, seconds and hash.
pub fn log_use(of: &LogUse) -> (String, String) {
    let role = match of.role {
        Role::Training => "Trained on",
        Role::HeldOut => "Held out",
        Role::JudgedThenLearnt => "Held out to judge, then trained on",
    };
    (role.to_owned(), format!("{}, {}, SHA-256 {}", of.file, seconds(of), of.sha256))
}

/// The logs of a role, each with the seconds that were used of it, in one line.
pub fn used(logs: &[LogUse], role: Role) -> String {
    let of_role = logs.iter().filter(|log| log.role == role);
    of_role.map(|log| format!("{} {}", log.file, seconds(log))).collect::<Vec<_>>().join(", ")
}

fn seconds(of: &LogUse) -> String {
    let stretches = of.stretches.map(|stretches| format!("{stretches} stretches in "));
    format!("{}{:.2} … {:.2} s", stretches.unwrap_or_default(), of.from_s, of.to_s)
}
