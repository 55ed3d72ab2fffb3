//! Which part of which log was used for what, in words.

use recordings::{LogUse, Role};

/// What one was used for, and which it is.
pub fn log_use(of: &LogUse) -> (String, String) {
    let role = match of.role {
        Role::Training => "Trained on",
        Role::HeldOut => "Held out",
        Role::JudgedThenLearnt => "Held out to judge, then trained on",
    };
    (role.to_owned(), format!("{}, {:.2} … {:.2} s, SHA-256 {}", of.file, of.from_s, of.to_s, of.sha256))
}

/// Those that were used for this, with their seconds.
pub fn used(logs: &[LogUse], role: Role) -> String {
    let of_role = logs.iter().filter(|log| log.role == role);
    of_role.map(|log| format!("{} {:.2} … {:.2} s", log.file, log.from_s, log.to_s)).collect::<Vec<_>>().join(", ")
}
