//! Rules that the numbers of a parameter table obey, as sentences.

/// A rule in words, such as "`alpha_um` must be positive": what is said where it is broken.
pub type Rule = &'static str;

/// Checks rules in turn.
///
/// # Errors
/// The first that does not hold.
pub fn check(rules: impl IntoIterator<Item = (Rule, bool)>) -> Result<(), Rule> {
    rules.into_iter().find(|&(_, holds)| !holds).map_or(Ok(()), |(rule, _)| Err(rule))
}
