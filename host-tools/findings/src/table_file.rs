//! What an identification found, as the file that people read.

use estimator_core::table::BoundToTick;
use identification::cost::Cost;
use identification::{Outcome, SearchOptions};
use table_files::{Noise, TableFile};

/// The file of the chosen model. `determined` are the lines of [`determination`](crate::determination).
pub fn table_file(outcome: &Outcome, cost: Cost, search: &SearchOptions, determined: &[(String, String)]) -> TableFile {
    let (voltage_v, displacement_um) = log_survey::noise(outcome.learnt_from().training());
    TableFile {
        noise: Some(Noise { voltage_v, displacement_um }),
        unit: None,
        tool: format!("piezo {}", env!("CARGO_PKG_VERSION")),
        doubts: outcome.doubts.iter().map(crate::doubt).collect(),
        determined: determined.iter().map(|(what, found)| format!("{what}: {found}")).collect(),
        table: *outcome.learnt.candidate.table,
        recipe: outcome.learnt.context.recipe.clone(),
        cost: Some(cost.feedback),
        norm: Some(cost.norm),
        feedback_weight: cost.feedback_weight,
        search: Some(search.clone()),
        logs: outcome.learnt.logs.clone(),
    }
}

/// Brings a file's table to a tick of so many µs by its equations, and says so among its doubts where that
/// is another tick.
///
/// # Errors
/// Its model is bound to the tick that it was identified at.
pub fn bring_to(file: &mut TableFile, tick_us: u32) -> Result<(), BoundToTick> {
    let before_us = file.table.sample_period_us;
    file.bring_to(tick_us)?;
    if tick_us != before_us {
        file.doubts.push(format!(
            "identified at a tick of {before_us} µs and brought to one of {tick_us} µs by its equations: what its errors are there was \
             not measured (piezo validate)"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_table_brought_to_another_tick_says_so_and_one_of_that_tick_does_not() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/table/table.toml"));
        let (file, _) = TableFile::load(path).unwrap();
        let tick_us = file.table.sample_period_us;
        let mut brought = file.clone();
        bring_to(&mut brought, tick_us).unwrap();
        assert_eq!(brought, file);
        bring_to(&mut brought, tick_us / 5).unwrap();
        let said = brought.doubts.last().unwrap();
        assert!(
            said.contains(&format!("brought to one of {} µs", tick_us / 5)) && said.ends_with("(piezo validate)"),
            "{said}"
        );
    }
}
