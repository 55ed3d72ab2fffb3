//! The tables of models that were compared, as the files that people read.

use comparison::Matrix;
use estimator_core::Model;
use identification::SearchOptions;
use identification::cost::Cost;
use serde_json::Value;
use table_files::{Noise, TableFile, TableFileError};

/// The name of a model's table in the folder of a comparison.
pub fn table_name(model: Model) -> String {
    format!("{}.toml", word(model))
}

/// A model as it is typed.
fn word(model: Model) -> String {
    match serde_json::to_value(model) {
        Ok(Value::String(word)) => word,
        _ => model.to_string(),
    }
}

/// The file of each model that was identified, by its name. Nobody looked for what makes one of them doubtful, and it has no ±.
///
/// # Errors
/// A table cannot be written as text.
pub fn compared(matrix: &Matrix, cost: Cost, search: &SearchOptions) -> Result<Vec<(String, String)>, TableFileError> {
    let (voltage_v, displacement_um) = log_survey::noise(matrix.problem.training());
    let of = |model: Model| {
        let compared = format!(
            "it was made to be compared: it states no ±, and what makes it doubtful was not looked for; `piezo identify --model {}` does both",
            word(model)
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
