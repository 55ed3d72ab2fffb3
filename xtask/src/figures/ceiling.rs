//! What a tick of each model may take at most.

use anyhow::{Context, Result, ensure};

/// Instructions of the most expensive tick on the measured log. What is measured may lie below by [`SLACK_PERCENT`].
const CEILINGS: &[(&str, u64)] = &[
    ("voigt", 438),
    ("voltage-extremum", 563),
    ("displacement-extremum", 564),
    ("enhanced", 640),
    ("voigt-chain", 925),
    ("prandtl-ishlinskii", 988),
    ("maxwell-slip", 988),
    ("duhem", 399),
    ("bouc-wen", 489),
    ("preisach", 4591),
    ("narx", 15094),
    ("generalised-prandtl-ishlinskii", 6418),
];
const SLACK_PERCENT: u64 = 2;
const HERE: &str = file!();

/// Compares the instructions of a model's most expensive tick with its ceiling.
///
/// # Errors
/// They exceed it; or it has become too loose to notice when they grow; or there is none.
pub fn check(model: &str, measured: u64) -> Result<()> {
    let ceiling = CEILINGS.iter().find(|(name, _)| *name == model).map(|(_, ceiling)| *ceiling);
    let ceiling = ceiling.with_context(|| format!("{model} has no ceiling: write {measured} in CEILINGS, {HERE}"))?;
    holds(model, measured, ceiling)
}

fn holds(model: &str, measured: u64, ceiling: u64) -> Result<()> {
    ensure!(
        measured <= ceiling,
        "a tick of {model} takes {measured} instructions, more than {ceiling}: make it cheaper, or write {measured} in \
         CEILINGS, {HERE}, and say in the commit what is worth it"
    );
    ensure!(
        100 * ceiling <= (100 + SLACK_PERCENT) * measured,
        "a tick of {model} takes {measured} instructions, and {ceiling} are allowed, more than {SLACK_PERCENT} % above: write \
         {measured} in CEILINGS, {HERE}"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ceiling_is_neither_exceeded_nor_loose() {
        for measured in [1000, 981] {
            assert!(holds("duhem", measured, 1000).is_ok(), "{measured}");
        }
        for measured in [1001, 980] {
            let error = holds("duhem", measured, 1000).expect_err("beyond").to_string();
            assert!(error.contains(&format!("write {measured}")), "{error}");
        }
        assert!(check("no model", 1).is_err());
    }
}
