//! A library's enumeration as the value of an option.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// A value, its name on the command line, and what it is.
pub type Choice<T> = (T, &'static str, &'static str);

/// A parser of the names of some values; `--help` lists each with what it is.
pub fn choice<T>(choices: impl IntoIterator<Item = Choice<T>>) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let choices: Vec<Choice<T>> = choices.into_iter().collect();
    let possible: Vec<_> = choices.iter().map(|(_, name, what)| PossibleValue::new(*name).help(*what)).collect();
    PossibleValuesParser::new(possible).map(move |given| {
        let found = choices.iter().find(|(_, name, _)| *name == given);
        // Cannot fail: the parser before lets nothing through but these names.
        found.expect("a possible value is one of the choices").0
    })
}
