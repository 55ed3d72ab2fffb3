//! The tables of models that were compared, as the files that people read.

use comparison::Matrix;
use estimator_core::Model;
use identification::SearchOptions;
use identification::cost::Cost;
use std::path::Path;
use table_files::{Noise, TableFile, TableFileError};

/// The name of a model's table in the folder of a comparison.
pub fn table_name(model: Model) -> String {
    format!("{}.toml", model.name())
}

/// The file of each model that was identified, by its name. Nobody looked for what makes one of them doubtful, and it
/// has no ±.
///
/// # Errors
/// A table cannot be written as text.
pub fn compared_tables(
    matrix: &Matrix,
    cost: Cost,
    search: &SearchOptions,
) -> Result<Vec<(String, String)>, TableFileError> {
    let (voltage_v, displacement_um) = log_survey::noise(matrix.problem.training());
    let of = |model: Model| {
        let compared = format!(
            "it was made to be compared: it states no ±, and what makes it doubtful was not looked for; `piezo identify --model {}` does both",
            model.name()
        );
        matrix.doubts.iter().map(crate::doubt).chain([compared]).collect()
    };
    let tables = matrix.rows.iter().filter_map(|row| Some((row.model, row.table.as_deref()?)));
    let file = |(model, table): (Model, &estimator_core::Table)| {
        let file = TableFile {
            noise: Some(Noise { voltage_v, displacement_um }),
            tool: format!("piezo {}", env!("CARGO_PKG_VERSION")),
            doubts: of(model),
            determined: Vec::new(),
            table: *table,
            recipe: matrix.recipe.clone(),
            cost: Some(cost.feedback),
            norm: Some(cost.norm),
            feedback_weight: cost.feedback_weight,
            search: Some(search.clone()),
            logs: matrix.logs.clone(),
            unit: None,
        };
        Ok((table_name(model), file.to_toml()?))
    };
    tables.map(file).collect()
}

/// What was written into the folder of a comparison, and which models' tables are there that it did not write.
pub fn written_to(folder: &Path, tables: &[(String, String)]) -> String {
    let written: Vec<&str> = tables.iter().map(|(name, _)| name.as_str()).collect();
    let stays = |name: &String| !written.contains(&name.as_str()) && folder.join(name).exists();
    let of_before: Vec<String> = Model::ALL.into_iter().map(table_name).filter(stays).collect();
    let kept = match of_before.is_empty() {
        true => String::new(),
        false => format!("; still there from before, and not of this comparison: {}", of_before.join(", ")),
    };
    format!("Written to {}: {}{kept}", folder.display(), [&["compare.html"], &written[..]].concat().join(", "))
}
