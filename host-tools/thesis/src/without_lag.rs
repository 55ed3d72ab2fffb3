//! The rate-independent models of the thesis as their literature has them: without the lag, or the look-ahead, that
//! they have here.

use estimator_core::{Parameters, Table};

/// A table whose model has an input lag, or a look-ahead, that its literature does not have, without it. `None` where
/// the model has none, or has it as a part of a chain.
pub fn without_lag(table: &Table) -> Option<Table> {
    let parameters = match table.parameters {
        // Its lag is a part of the chain.
        Parameters::GeneralisedPrandtlIshlinskii(_) => return None,
        of => of.with_lag(0.0),
    };
    (parameters != table.parameters).then_some(Table { parameters, ..*table })
}
