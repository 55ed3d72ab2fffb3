//! The report as a person reads it.

use serde_json::Value;
use std::fmt::Write as _;

/// The report's tables.
pub fn text(report: &Value) -> String {
    let mut text = String::new();
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let rows = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let work = &report["workload"];
    // Writing into a String cannot fail.
    let _ = writeln!(
        text,
        "{} candidates × {} generations × {} samples of {} logs = {:.0} million sample-evaluations, {} parameters; {}",
        work["candidates"],
        work["generations"],
        work["samples"],
        work["logs"],
        1e-6 * number(&work["sample_evaluations"]),
        work["parameters"],
        report["instructions"].as_str().unwrap_or_default(),
    );
    for cost in rows(&report["costs"]) {
        let _ = writeln!(
            text,
            "\n{:34}{:>8}{:>16}{:>16}{:>14}",
            cost["cost"].as_str().unwrap_or_default(),
            "threads",
            "million/s",
            "of plain loop",
            "cost off by"
        );
        for row in rows(&cost["kernels"]) {
            let _ = writeln!(
                text,
                "{:34}{:>8}{:>16.1}{:>16.2}{:>14.1e}",
                row["kernel"].as_str().unwrap_or_default(),
                number(&row["threads"]),
                1e-6 * number(&row["sample_evaluations_per_s"]),
                number(&row["of_the_plain_loop"]),
                number(&row["cost_off_by_at_most"]),
            );
        }
    }
    for scaling in rows(&report["scaling"]) {
        let _ = writeln!(text, "\n{:34}{:>24}", scaling["of"].as_str().unwrap_or_default(), "ms a generation");
        for point in rows(&scaling["points"]) {
            let _ = writeln!(text, "{:<34}{:>24.2}", number(&point["size"]), 1e3 * number(&point["seconds"]));
        }
        let _ = writeln!(text, "{:<34}{:>24.2}", "slope", number(&scaling["slope"]));
    }
    text
}
