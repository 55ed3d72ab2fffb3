//! The figures of the firmware: what it makes of a bad signal, and what its ticks take.

use anyhow::{Context, Result};
use estimator_core::{Model, table::ALLOWED_PERCENT};
use serde_json::Value;

use crate::cycles::{LEVELS, RATES_HZ};

use super::{
    ceiling,
    cells::{array, fixed, number, table, thousands, whole},
    command::{Command::SizeModels, Printed},
    document::Content,
};

/// What the firmware makes of faults of the monitor's signal.
pub fn signal(printed: &Value) -> Result<Content> {
    let row = |row: &Value| -> Result<Vec<String>> {
        let raised = |name: &str| -> Result<[String; 2]> {
            let Some(raised) = row.get(name).filter(|raised| !raised.is_null()) else {
                return Ok(["–"; 2].map(str::to_owned));
            };
            let bits = array(raised, "/bits")?.iter().filter_map(Value::as_str).map(|bit| format!("`{bit}`"));
            Ok([bits.collect::<Vec<_>>().join(", "), thousands(whole(raised, "/tick")?)])
        };
        let stated = row["stated_um"].as_f64().map_or_else(|| "–".to_owned(), |um| fixed(um, 2));
        let back = match row["back_after_ticks"].as_u64() {
            Some(ticks) => thousands(ticks),
            None if row["stays"] == true => "stays".to_owned(),
            None if row["needs_zero"] == true => "needs a zero".to_owned(),
            None => "not in 10 s".to_owned(),
        };
        let name = row["fault"].as_str().context("a fault has no name")?;
        let error = fixed(number(row, "/worst_um")?, 2);
        let rest = [error, stated, thousands(whole(row, "/silent_ticks")?), back];
        Ok([vec![name.to_owned()], raised("flag")?.to_vec(), raised("lasting")?.to_vec(), rest.to_vec()].concat())
    };
    let columns = [
        "flag",
        "at tick",
        "lasting fault",
        "from tick",
        "error µm",
        "its ± µm",
        "ticks beyond ±, unsaid",
        "back after ticks",
    ];
    table(1, &columns, array(printed, "")?.iter().map(row))
}

/// What a tick of each model takes.
pub fn models(printed: &Printed<'_>) -> Result<Content> {
    let ticks = printed.by(SizeModels)?;
    let row = |model: Model| -> Result<Vec<String>> {
        let name = model.name();
        let most = whole(&ticks, &format!("/{name}/max"))?;
        ceiling::check(name, most)?;
        let mean = number(&ticks, &format!("/{name}/mean"))?;
        Ok(vec![format!("`{name}`"), thousands(most), thousands(mean.round() as u64)])
    };
    table(1, &["instructions, most", "mean"], Model::ALL.into_iter().map(row))
}

/// Instructions of a tick with the thesis's model.
pub fn tick(printed: &Value) -> Result<Content> {
    let most = whole(printed, "/instructions_per_tick/max")?;
    let mean = number(printed, "/instructions_per_tick/mean")?;
    Ok(Content::Value(format!("{} at most, {} on average", thousands(most), fixed(mean, 1))))
}

/// Cycles of the tick's interrupt on the board, with each model.
pub fn cycles(printed: &Value) -> Result<Content> {
    let row = |row: &Value| -> Result<Vec<String>> {
        let what = if row["drives"] == true { "drive" } else { "estimate" };
        let name = row["model"].as_str().context("a row has no model")?;
        let mut cells = vec![format!("`{name}`"), what.to_owned()];
        if row["refused"] == true {
            cells.extend(["–"; 4].map(str::to_owned));
        } else {
            cells.push(thousands(whole(row, "/most_instructions")?));
            for level in LEVELS {
                cells.push(thousands(whole(row, &format!("/most_cycles/{level}"))?));
            }
        }
        cells.push(thousands(whole(row, "/stated")?));
        for hz in RATES_HZ {
            let percent = number(row, &format!("/percent/{hz}"))?;
            cells.push(if percent > f64::from(ALLOWED_PERCENT) { "–".to_owned() } else { fixed(percent, 0) });
        }
        Ok(cells)
    };
    let columns = ["instructions", LEVELS[0], LEVELS[1], LEVELS[2], "stated", "% at 1 kHz", "2 kHz", "5 kHz", "10 kHz"];
    table(2, &columns, array(printed, "")?.iter().map(row))
}
