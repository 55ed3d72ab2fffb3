//! A fleet in words.

use crate::fleet::{Alike, Fleet};
use crate::outlier::{ENOUGH, Outlier, Quantity, median};
use crate::row::{Row, State};

/// A line each: the units, then what is to be known of them.
pub fn said(fleet: &Fleet) -> Vec<String> {
    let width = fleet.units.iter().map(|row| row.unit.chars().count()).max().unwrap_or(0).max("unit".len());
    let mut lines = vec![format!(
        "{:<width$}  {:<10} {:<30} {:>8} {:>8} {:>8}  gravest doubt",
        "unit", "status", "model", "MAE µm", "% stroke", "± µm"
    )];
    lines.extend(fleet.units.iter().map(|row| line(row, width)));
    lines.push(String::new());
    lines.push(counted(fleet));
    let part = |heading: &str, of: Vec<String>| {
        let heading = (!of.is_empty()).then(|| heading.to_owned());
        heading.into_iter().chain(of.into_iter().map(|line| format!("- {line}"))).collect::<Vec<_>>()
    };
    let without = |row: &&Row| row.status != State::Identified;
    let told = |row: &Row| format!("{} ({}): {}", row.unit, row.status, row.said.as_deref().unwrap_or("–"));
    lines.extend(part("Without a table:", fleet.units.iter().filter(without).map(told).collect()));
    let grave = fleet.units.iter().filter(|row| row.grave);
    let doubted = |row: &Row| format!("{}: {}", row.unit, row.said.as_deref().unwrap_or("–"));
    lines.extend(part("On no board before it is mended:", grave.map(doubted).collect()));
    lines.extend(part("Far from the rest of the fleet:", fleet.outliers.iter().map(far).collect()));
    lines.extend(part("Alike, as no two units should be:", fleet.alike.iter().map(in_common).collect()));
    lines
}

fn line(row: &Row, width: usize) -> String {
    let number =
        |value: Option<f64>, digits: usize| value.map_or("–".to_owned(), |value| format!("{value:.digits$}"));
    let doubt = match (&row.gravest_doubt, row.doubts) {
        (Some(kind), Some(count)) if count > 1 => format!("{kind}, of {count}"),
        (Some(kind), _) => kind.clone(),
        (None, _) => "–".to_owned(),
    };
    format!(
        "{:<width$}  {:<10} {:<30} {:>8} {:>8} {:>8}  {doubt}",
        row.unit,
        row.status,
        row.model.map_or("–".to_owned(), |model| model.to_string()),
        number(row.held_out_mae_um, 4),
        number(row.held_out_mae_percent, 2),
        number(row.half_width_um, 3)
    )
}

/// How many there are of each state, and what the identified ones are like.
fn counted(fleet: &Fleet) -> String {
    let others = [State::Failed, State::Running, State::Killed, State::Missing, State::Unreadable];
    let others = others.into_iter().filter(|&state| fleet.count(state) > 0);
    let others: Vec<String> = others.map(|state| format!("{} {state}", fleet.count(state))).collect();
    let all = fleet.units.len();
    let of = format!("{} of {all} identified", fleet.count(State::Identified));
    let counts = std::iter::once(of).chain(others).collect::<Vec<_>>().join(", ");
    let errors: Vec<f64> = fleet.units.iter().filter_map(|row| row.held_out_mae_percent).collect();
    let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
    let most = errors.iter().copied().fold(0.0, f64::max);
    match errors.len() {
        0 => format!("{counts}; no error on held-out data is known."),
        count if count < ENOUGH => format!(
            "{counts}; held-out error {least:.2} … {most:.2} % of the stroke. Which is unlike the rest is said of {ENOUGH} and more."
        ),
        _ => format!(
            "{counts}; held-out error {:.2} % of the stroke in the median, {least:.2} … {most:.2} %.",
            median(&errors)
        ),
    }
}

fn far(Outlier { unit, quantity, value, median }: &Outlier) -> String {
    let median = match quantity {
        Quantity::StrokeUm => format!("{median:.2} µm"),
        Quantity::ErrorPercent | Quantity::HalfWidthPercent => format!("{median:.2} %"),
    };
    format!("{unit}: {quantity} {}, where the fleet's median is {median}", quantity.said(*value))
}

fn in_common(alike: &Alike) -> String {
    match alike {
        Alike::Name { unit, folders } => format!("{} are all of {unit}", folders.join(" and ")),
        Alike::Logs { units } => format!("{} were learnt from the same logs", units.join(" and ")),
    }
}
