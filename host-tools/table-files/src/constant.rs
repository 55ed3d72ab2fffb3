//! The Rust face of a table: a `const` for the firmware image.
//!
//! The core's types print themselves as Rust expressions once their variants are in scope (`{:?}` of an `f32` is the
//! shortest text that reads back as the same number); a test compiles what this writes and compares it with the TOML.

use crate::name::name;
use estimator_core::Admitted;

/// How the line of `table.rs` that has the checksum begins.
pub(super) const LINE: &str = "// Checksum ";

/// The source of a module that defines `TABLE`.
pub fn rust_source(table: &Admitted) -> String {
    let provenance = &table.provenance;
    format!(
        "// Made by `piezo emit`; change table.toml instead.\n\
         // Logs {}, seed {}, training MAE {:.4} µm.\n\
         {LINE}{}.\n\n\
         #[allow(unused_imports, reason = \"which types a table names depends on what it has\")]\n\
         use estimator_core::{{\n    AdcCalibration, DacCalibration, Digest, DriveCalibration, DriveLimits, IntervalParameters, List, \
         Parameters,\n    Provenance, Range, Scheme::*, SetpointCalibration, Table, {},\n}};\n\n\
         /// The compiled-in parameter table.\n\
         pub const TABLE: Table = {:#?};\n",
        provenance.logs,
        provenance.seed,
        provenance.train_mae_um,
        name(table),
        table.parameters.type_name(),
        **table
    )
}
