//! Identified parameters: Tables 4.5 (ranges), 4.6 (Voigt) and 5.2 (the extremum models), with both costs.

use super::bench::{Bench, cost_name};
use crate::error::ThesisError;
use estimator_core::{Model, Parameters, VoigtParameters};
use identification::cost::Feedback;
use identification::search::Gene;
use identification::search::space::{Ranges, Space};
use identification::{Progress, SearchOptions};
use report::{Section, yes};
use serde_json::{Value, json};

/// Table 4.5: minimum absolute changes of α (µm), β (V), λ (1/V), b (Ω), P as printed.
const TABLE_4_5_MAC: [(&str, &str); 5] =
    [("alpha", "2.35"), ("beta", "0.78"), ("lambda", "8.79e-6"), ("b", "190.61"), ("p", "0.0011")];

/// Set of a table: α µm, β V, λ 1/V, b Ω, P, g µm/s/V^h, h, e (m/s)/m^f, f; 0 for what a model lacks.
type Printed = [f64; 9];

/// Tables 4.6 and 5.2. Of Eq. (5.4) α, β and b lost their decimal points in print; they are put back.
pub fn printed(model: Model, cost: Feedback) -> Option<Printed> {
    Some(match (model, cost) {
        (Model::Voigt, Feedback::Osp) => [672.434, 729.423, 0.00725, 95_923.754, 0.742, 0.0, 0.0, 0.0, 0.0],
        (Model::Voigt, Feedback::Simulation) => [1139.296, 749.755, 0.00772, 90_777.126, 0.754, 0.0, 0.0, 0.0, 0.0],
        (Model::VoltageExtremum, Feedback::Osp) => {
            [2414.135, 676.810, 0.00805, 31_272.727, 0.863, 14.21, 0.628, 0.0, 0.0]
        }
        (Model::VoltageExtremum, Feedback::Simulation) => {
            [2392.473, 672.336, 0.00959, 88_140.762, 0.783, 61.69, 0.061, 0.0, 0.0]
        }
        (Model::DisplacementExtremum, Feedback::Osp) => {
            [2260.405, 863.929, 0.00622, 68_909.09, 0.8445, 0.0, 0.0, 250.825, 1.252]
        }
        (Model::DisplacementExtremum, Feedback::Simulation) => {
            [1150.947, 958.553, 0.00600, 98_211.144, 0.732, 0.0, 0.0, 449.560, 1.631]
        }
        (Model::Enhanced, Feedback::Osp) => {
            [1770.343, 563.636, 0.00950, 109_511.730, 0.872, 60.428, 0.582, 736.694, 1.222]
        }
        (Model::Enhanced, Feedback::Simulation) => {
            [1790.724, 664.516, 0.00974, 130_278.592, 0.763, 23.710, 0.920, 525.753, 1.166]
        }
        _ => return None,
    })
}

/// Symbols and units, in the order of [`Printed`].
const SYMBOLS: [&str; 9] = ["α µm", "β V", "λ 1/V", "b Ω", "P", "g µm/s/Vʰ", "h", "e (m/s)/mᶠ", "f"];

/// What each model is identified with.
const COSTS: [Feedback; 2] = [Feedback::Osp, Feedback::Simulation];

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    2 * search.generations_of(&Model::VOIGT_FAMILY)
}

/// Identifies the family with both costs and compares.
///
/// # Errors
/// The figures cannot be written down.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    for cost in COSTS {
        bench.identify(cost, &Model::VOIGT_FAMILY, progress);
    }
    let ranges = ranges(bench);
    let mut grid =
        bench.grid("Tables 4.6 and 5.2: identified parameters.").words("model", 27).words("cost", 10).words("whose", 6);
    for symbol in SYMBOLS {
        grid = grid.numbers(symbol, 9);
    }
    let mut rows = Vec::new();
    for model in Model::VOIGT_FAMILY {
        for cost in COSTS {
            let ours = bench.candidate(cost, model).and_then(|found| set(&found.table.parameters));
            let theirs = printed(model, cost);
            let mut line = |whose: &str, set: Option<Printed>| {
                let names = [model.to_string(), cost_name(cost).to_owned(), whose.to_owned()];
                let value = |index: usize| set.and_then(|set| set.get(index).copied()).filter(|_| has(model, index));
                let values = (0..SYMBOLS.len()).map(|index| value(index).map_or_else(|| "–".to_owned(), short));
                grid.row(names.into_iter().chain(values));
            };
            line("ours", ours);
            line("thesis", theirs);
            rows.push(json!({ "model": model, "cost": cost, "ours": named(ours), "thesis": named(theirs) }));
        }
    }
    let search = match bench.search().ranges {
        Ranges::Data => {
            "Searched are coordinates on the logs' own scale, from which the published parameters follow, so that \
                         these may lie outside of Table 4.5's ranges; the ranges `table-4.5` search within them."
        }
        Ranges::Table45 => "Searched is within Table 4.5's ranges, and Table 5.2's magnitudes for g, h, e, f.",
    };
    let mut notes = vec![
        search.to_owned(),
        "α, λ and b act through the product α·λ·b and, far from β, through α·exp(−λβ): sets that look far apart may \
         be the same model. g and e have free signs here; both printed ones are positive, with which the recursion \
         gives a loop that no actuator of this stroke has. Of Eq. (5.4) the lost decimal points of α, β and b are put \
         back."
            .to_owned(),
    ];
    let attempts = || Model::VOIGT_FAMILY.into_iter().flat_map(|model| COSTS.map(|cost| (model, cost)));
    let ended = attempts().filter_map(|(model, cost)| {
        let genes = &bench.candidate(cost, model)?.fit.genes;
        let ends = at_an_end(genes);
        (!ends.is_empty()).then(|| format!("{model} by {}: {}", cost_name(cost), ends.join(", ")))
    });
    let ended: Vec<String> = ended.collect();
    notes.push(if ended.is_empty() {
        "No searched coordinate ended at an end of its range.".to_owned()
    } else {
        format!(
            "At an end of its range a searched coordinate ended in {}. There the optimum may lie beyond, or the logs do not \
             determine it; a term whose exponent ended at 0 or nearly so keeps its size at every amplitude.",
            ended.join("; ")
        )
    });
    let json = serde_json::to_string_pretty(&json!({ "ranges": ranges.1, "parameters": rows }))?;
    let tables = vec![ranges.0, grid];
    Ok(Section { title: "Parameters: Tables 4.5, 4.6 and 5.2", tables, notes, figures: Vec::new(), json })
}

/// Table 4.5 beside its minimum absolute changes at the search's bits (Eq. 4.6), and whether ours lie within.
fn ranges(bench: &Bench) -> (report::Grid, Value) {
    let bits = bench.search().bits;
    let mut grid = bench
        .grid("Table 4.5: ranges of the thesis, and whether Voigt's identified values lie within.")
        .words("parameter", 9)
        .words("unit", 4)
        .numbers("min", 8)
        .numbers("max", 8)
        .numbers("range", 8)
        .numbers("thesis MAC, 10 bits", 10)
        .numbers(&format!("MAC, {bits} bits"), 10)
        .numbers("ours by OSP within", 6)
        .numbers("by simulation", 6);
    let genes = Space::new(Model::Voigt, Ranges::Table45, bench.problem().extent()).genes;
    let mut rows = Vec::new();
    for (index, (gene, (_, thesis))) in genes.iter().zip(TABLE_4_5_MAC).enumerate() {
        let change = (gene.max - gene.min) / f64::from((1u32 << bits) - 1);
        let within = [Feedback::Osp, Feedback::Simulation].map(|cost| {
            let found = bench.candidate(cost, Model::Voigt).and_then(|found| set(&found.table.parameters));
            found.and_then(|set| set.get(index).map(|x| (gene.min..=gene.max).contains(x)))
        });
        let words = within.map(|within| within.map_or("–".to_owned(), yes));
        let symbol = SYMBOLS.get(index).and_then(|symbol| symbol.split(' ').next()).unwrap_or(gene.name);
        let [min, max, range] = [gene.min, gene.max, gene.max - gene.min].map(short);
        let [osp, simulation] = words;
        grid.row([
            symbol.to_owned(),
            gene.unit.to_owned(),
            min,
            max,
            range,
            thesis.to_owned(),
            short(change),
            osp,
            simulation,
        ]);
        rows.push(json!({
            "parameter": gene.name, "min": gene.min, "max": gene.max, "mac": change, "thesis_mac": thesis,
            "osp_within": within[0], "simulation_within": within[1],
        }));
    }
    (grid, Value::from(rows))
}

/// Coordinates that ended where their range does, with the range: "h = 0.010 (0 … 3)".
fn at_an_end(genes: &[(Gene, f64)]) -> Vec<String> {
    let at_end = genes.iter().filter(|(gene, value)| gene.undetermined(*value));
    at_end
        .map(|(gene, value)| format!("{} = {value:.3} ({} … {})", gene.name, short(gene.min), short(gene.max)))
        .collect()
}

fn set(parameters: &Parameters) -> Option<Printed> {
    parameters.voigt().map(|of| of.named().map(|(_, x)| f64::from(x)))
}

fn named(set: Option<Printed>) -> Value {
    let names = VoigtParameters::<f32>::default().named().map(|(name, _)| name);
    set.map_or(Value::Null, |set| {
        Value::Object(names.into_iter().zip(set).map(|(name, x)| (name.to_owned(), json!(x))).collect())
    })
}

/// Whether a model has the parameter of this place.
fn has(model: Model, index: usize) -> bool {
    match index {
        0..=4 => true,
        5 | 6 => model.has_voltage_term(),
        _ => model.has_displacement_term(),
    }
}

/// Four significant digits.
pub fn short(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e6).contains(&size) {
        format!("{x:.3e}")
    } else {
        let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
        format!("{x:.decimals$}")
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn parameters_of_both_costs_stand_beside_the_printed_ones() {
        let section = section(&mut small(), &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data["parameters"].as_array().unwrap();
        assert_eq!(rows.len(), 8);
        assert_eq!(rows[0]["thesis"]["alpha_um"], 672.434);
        assert_eq!(rows[2]["thesis"]["b_ohm"], 31_272.727, "the decimal point that was lost");
        assert!(rows.iter().all(|row| row["ours"]["p"].as_f64().is_some_and(|p| p > 0.1)), "{rows:?}");
        let text = section.text();
        assert!(text.contains("Table 4.5") && text.contains("672.4") && text.matches("Thesis: its own").count() == 2);
    }

    #[test]
    fn the_minimum_absolute_changes_are_those_of_the_thesis() {
        let (_, rows) = ranges(&small());
        for (row, (_, printed)) in rows.as_array().unwrap().iter().zip(TABLE_4_5_MAC) {
            let (ours, printed) = (row["mac"].as_f64().unwrap(), printed.parse::<f64>().unwrap());
            assert!((ours / printed - 1.0).abs() < 0.03, "{row}");
        }
    }

    #[test]
    fn what_ended_at_an_end_of_its_range_is_named_and_nothing_else() {
        let genes =
            |h: f64| [(Gene::linear("h", "exponent", "", 0.0, 3.0), h), (Gene::linear("p", "P", "", 0.4, 2.5), 1.0)];
        assert_eq!(at_an_end(&genes(0.01)), ["h = 0.010 (0 … 3.000)"]);
        assert_eq!(at_an_end(&genes(3.0)), ["h = 3.000 (0 … 3.000)"]);
        assert!(at_an_end(&genes(0.02)).is_empty());
        let mut bench = small();
        let section = section(&mut bench, &mut |_, _| ()).unwrap();
        let note = section.notes.last().unwrap();
        for (model, cost) in Model::VOIGT_FAMILY.into_iter().flat_map(|model| COSTS.map(|cost| (model, cost))) {
            let ended = at_an_end(&bench.candidate(cost, model).unwrap().fit.genes);
            let words = format!("{model} by {}: {}", cost_name(cost), ended.join(", "));
            assert_eq!(note.contains(&words), !ended.is_empty(), "{words}: {note}");
        }
    }

    #[test]
    fn four_digits() {
        assert_eq!(
            [0.0, 0.00725, 95_923.754, -1.5, 2e-4, 0.742].map(short),
            ["0", "0.007250", "95924", "-1.500", "2.000e-4", "0.7420"]
        );
    }
}
