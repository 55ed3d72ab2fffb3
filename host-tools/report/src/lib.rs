//! The report of an identification: one HTML file that needs nothing else, for a screen, a phone or paper.

mod axis;
mod branches;
mod comparison;
mod csv;
pub mod drawn;
mod error;
mod errors;
mod figures;
mod loops;
mod number;
mod page;
mod picture;
mod reproduction;
mod rows;
mod section;
mod survey;
mod svg;
mod swings;
mod thin;
mod traces;
mod whole;
mod zoom;

#[cfg(test)]
mod tests;

pub use comparison::{ComparisonReport, comparison};
pub use error::ReportError;
pub use figures::Mark;
pub use page::{Report, heading, render};
pub use picture::{Zeroed, picture};
pub use reproduction::{ReproductionReport, reproduction};
pub use section::{Grid, Picture, Section, shown, yes};
pub use survey::survey;
pub use thin::turns;
