//! The Rust face of a table: a `const` for the firmware image, and its lookup where it is tabulated.
//!
//! The core's types print themselves as Rust expressions once their variants are in scope (`{:?}` of an `f32` is the
//! shortest text that reads back as the same number); a test compiles what this writes and compares it with the TOML.

use estimator_core::Admitted;
use std::fmt::Write;

/// The source of a module that defines `TABLE`, and `LOOKUP` for a tabulated form.
pub fn rust_source(table: &Admitted) -> String {
    let provenance = &table.provenance;
    let mut source = format!(
        "// Made by `piezo emit`; change table.toml instead.\n\
         // Logs {}, seed {}, training MAE {:.4} µm.\n\n\
         #[allow(unused_imports, reason = \"which variants a table names depends on the table\")]\n\
         use estimator_core::{{\n    AdcCalibration, BoucWenParameters, ChampionParameters, DacCalibration, Digest, \
         DriveCalibration, DriveLimits,\n    DuhemParameters, Form::*, List, MaxwellSlipParameters, Model::*, NarxParameters, \
         Parameters,\n    PrandtlIshlinskiiParameters, PreisachParameters, Provenance, Range, Scheme::*, Table, \
         VoigtChainParameters,\n    VoigtParameters,\n}};\n\n\
         /// The compiled-in parameter table.\n\
         pub const TABLE: Table = {:#?};\n",
        provenance.logs, provenance.seed, provenance.train_mae_um, **table
    );
    if let Some(lookup) = table.lookup::<f32>() {
        // Writing to a string cannot fail.
        let _ = write!(
            source,
            "\n/// The per-tick functions of [`TABLE`].\n\
             pub static LOOKUP: estimator_core::Lookup<f32> = {{\n    \
             use estimator_core::{{Lookup, Terms, lookup::Grid}};\n    {:?}\n}};\n",
            lookup
        );
    }
    source
}
