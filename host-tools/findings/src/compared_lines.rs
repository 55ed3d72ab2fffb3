//! Models side by side, in words.

use comparison::{Judgement, Matrix, Row};
use identification::validate::Figures;
use identification::{Job, StraightLine};
use recordings::Role;

/// How to read the figures.
pub const COMPARED: [&str; 5] = [
    "Errors of the estimate in simulation, from the first sample on, on data that decided nothing: mean absolute (MAE), root \
     mean square (RMS), largest (MAX), and the mean absolute without the constant offset that re-zeroing removes; of the \
     stroke where it says %. Whoever chooses a model by them has used this data up: prove the choice on another log. The arrow \
     marks the smallest mean absolute without it, since no model knows where the sensor's zero lies.",
    "Straight line: the displacement proportional to the voltage and an offset, Eq. (2.1), by least squares through the training \
     logs, each weighing the same: what is left for a model to gain.",
    "Parameters: what was searched or solved for by least squares; a grid that was laid out before does not count.",
    "Evals: candidates that were evaluated, of the same budget for every model; a model in which nothing is searched takes one, \
     its least-squares solution, for each of its structures.",
    "Seconds: wall-clock time of the model's own search. An extremum model starts from the results of the simpler ones of \
     its family, whose evaluations and time are theirs (--start random: it does not).",
];

/// What every model saw, and how, with what facts are called.
pub fn compared_how(job: &Job, budget: usize, matrix: &Matrix) -> Vec<(String, String)> {
    let used = |role| crate::used(&matrix.logs, role);
    let recipe = &matrix.recipe;
    let facts = [
        ("Every model fitted to", used(Role::Training)),
        ("Held out", used(Role::HeldOut)),
        ("Zero and delay", crate::zeros(recipe)),
        ("Tick", format!("{} µs, {} where it is the Voigt family's", recipe.tick_us, job.conditions.scheme)),
        ("Cost", job.cost.to_string()),
        (
            "Search",
            format!("{} evaluations a model at most, by {}, seed {}", budget, job.search.optimiser, job.search.seed),
        ),
        ("Tool", format!("piezo {}", env!("CARGO_PKG_VERSION"))),
    ];
    let doubts = matrix.doubts.iter().map(|doubt| ("Doubt".to_owned(), crate::doubt(doubt)));
    let left_out = crate::left_out(job, recipe, &matrix.problem).into_iter().map(|said| ("Left out".to_owned(), said));
    facts.into_iter().map(|(name, what)| (name.to_owned(), what)).chain(left_out).chain(doubts).collect()
}

/// Every model's errors, how to read them, and how they came about, a line each.
pub fn compared_lines(matrix: &Matrix, facts: &[(String, String)]) -> Vec<String> {
    let mut lines = Vec::new();
    let mut out = |line: &str| lines.push(line.to_owned());
    let names = matrix.held_out();
    let counted = matrix.counted();
    let heading = |first: &str| {
        format!(
            "{first:<34} {:>8} {:>8} {:>8} {:>7} {:>7} {:>11}",
            "MAE µm", "RMS µm", "MAX µm", "MAE %", "RMS %", "MAE, no off"
        )
    };
    let all =
        format!("held out, {}", if let [name] = names[..] { name.to_owned() } else { format!("{} logs", names.len()) });
    let costs = if counted { format!(" {:>9} {:>9}", "instr max", "mean") } else { String::new() };
    out(&format!(
        "{} {:>9} {:>9} {:>6} {:>6} {:>8}{costs}",
        heading(&all),
        "train MAE",
        "train RMS",
        "param.",
        "evals",
        "seconds"
    ));
    let nearest = matrix.nearest();
    let first = |row: &Row| format!("{}{}", if nearest == Some(row.model) { "→ " } else { "  " }, row.model);
    let baseline = matrix.straight_line.as_ref().map(|baseline| &baseline.errors);
    let straight = format!("  {}", StraightLine::NAME);
    for row in &matrix.rows {
        let counts = row.instructions.map_or_else(
            || format!(" {:>9} {:>9}", "–", "–"),
            |counts| format!(" {:>9.0} {:>9.1}", counts.max, counts.mean),
        );
        let counts = if counted { counts } else { String::new() };
        match &row.result {
            Judgement::Identified(errors) => out(&format!(
                "{} {:>9.4} {:>9.4} {:>6} {:>6} {:>8.2}{counts}",
                line(&first(row), &errors.held_out.all),
                errors.training.all.mae_um,
                errors.training.all.rmse_um,
                errors.parameters,
                row.evaluations,
                row.seconds
            )),
            Judgement::Failed { failed } => out(&format!("{:<34} {failed}", first(row))),
        }
    }
    if let Some(errors) = baseline {
        out(&format!(
            "{} {:>9.4} {:>9.4} {:>6} {:>6} {:>8}{}",
            line(&straight, &errors.held_out.all),
            errors.training.all.mae_um,
            errors.training.all.rmse_um,
            errors.parameters,
            "–",
            "–",
            if counted { format!(" {:>9} {:>9}", "–", "–") } else { String::new() }
        ));
    }
    for (index, name) in names.iter().enumerate().filter(|_| names.len() > 1) {
        out(&format!("\n{}", heading(&format!("held out, {name}"))));
        for row in &matrix.rows {
            if let Some(log) = row.errors().and_then(|errors| errors.held_out.logs.get(index)) {
                out(&line(&first(row), &log.errors));
            }
        }
        if let Some(log) = baseline.and_then(|errors| errors.held_out.logs.get(index)) {
            out(&line(&straight, &log.errors));
        }
    }
    out("");
    COMPARED.iter().for_each(|note| out(note));
    out("");
    facts.iter().for_each(|(name, what)| out(&format!("{name}: {what}")));
    lines
}

fn line(first: &str, figures: &Figures) -> String {
    format!(
        "{first:<34} {:>8.4} {:>8.4} {:>8.4} {:>7.3} {:>7.3} {:>11.4}",
        figures.mae_um,
        figures.rmse_um,
        figures.max_um,
        figures.mae_percent,
        figures.rmse_percent,
        figures.mae_without_offset_um
    )
}
