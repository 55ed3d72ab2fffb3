//! What an identification found, as the file that people read.

use identification::cost::Cost;
use identification::{Outcome, SearchOptions};
use table_files::TableFile;

/// The file of the chosen model. `determined` are the lines of [`determination`](crate::determination).
pub fn table_file(outcome: &Outcome, cost: Cost, search: &SearchOptions, determined: &[(String, String)]) -> TableFile {
    TableFile {
        tool: format!("piezo {}", env!("CARGO_PKG_VERSION")),
        doubts: outcome.doubts.iter().map(crate::doubt).collect(),
        determined: determined.iter().map(|(what, found)| format!("{what}: {found}")).collect(),
        table: *outcome.candidate().table,
        recipe: outcome.context.recipe.clone(),
        cost: Some(cost.feedback),
        norm: Some(cost.norm),
        feedback_weight: cost.feedback_weight,
        search: Some(search.clone()),
        logs: outcome.logs.clone(),
    }
}
