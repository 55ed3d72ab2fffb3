//! The report's tables.

use super::number::{number, quantity};
use estimator_core::{Parameters, Scheme, Status, Table};
use identification::search::Gene;
use identification::validate::{Comparison, Figures};
use identification::{Baseline, Candidate, StraightLine};

/// An error in µm and in % of the stroke.
pub struct Cell {
    /// The error as text, µm.
    pub um: String,
    /// Of the stroke, where there is one.
    pub percent: Option<String>,
}

/// Errors of a candidate or of the straight line; `None` where nothing was held out.
pub struct CandidateRow {
    /// Name of the model.
    pub name: String,
    /// Whether it is the chosen one.
    pub chosen: bool,
    /// Column heading and error.
    pub errors: Vec<(&'static str, Option<Cell>)>,
    /// Largest difference of the f32 from the f64 estimate.
    pub difference: String,
}

/// Headings of [`CandidateRow::errors`].
pub const ERRORS: [&str; 5] =
    ["Training MAE", "Held-out MAE", "Held-out MAX", "Held-out RMSE", "Held-out MAE, no offset"];

impl CandidateRow {
    /// The row of a candidate.
    pub fn new(candidate: &Candidate, chosen: &Candidate) -> Self {
        let all = candidate.training.iter().chain(&candidate.held_out);
        Self {
            name: candidate.fit.model.to_string(),
            chosen: candidate.fit.model == chosen.fit.model,
            errors: Self::errors(candidate.training_figures(), candidate.held_out_figures()),
            difference: quantity(all.map(|log| log.mil_sil_um).fold(0.0, f64::max) * 1e3, "nm"),
        }
    }

    /// The row of the straight line, which no firmware runs.
    pub fn straight_line(line: &Baseline) -> Self {
        Self {
            name: StraightLine::NAME.to_owned(),
            chosen: false,
            errors: Self::errors(Some(line.training), line.held_out),
            difference: "–".to_owned(),
        }
    }

    fn errors(training: Option<Figures>, held_out: Option<Figures>) -> Vec<(&'static str, Option<Cell>)> {
        let cell = |figures: Option<Figures>, of: fn(&Figures) -> (f64, f64)| {
            let (um, of_stroke) = of(&figures?);
            Some(Cell { um: quantity(um, "µm"), percent: percent(of_stroke) })
        };
        let cells = [
            cell(training, |f| (f.mae_um, f.mae_percent)),
            cell(held_out, |f| (f.mae_um, f.mae_percent)),
            cell(held_out, |f| (f.max_um, f.max_percent)),
            cell(held_out, |f| (f.rmse_um, f.rmse_percent)),
            cell(held_out, |f| (f.mae_without_offset_um, f.mae_without_offset_percent)),
        ];
        ERRORS.into_iter().zip(cells).collect()
    }
}

/// A percentage of the stroke, where there is a stroke.
fn percent(of_stroke: f64) -> Option<String> {
    of_stroke.is_finite().then(|| quantity(of_stroke, "%"))
}

/// Mean and largest error in words.
pub fn mean_and_largest(figures: &Figures) -> String {
    let of_stroke = percent(figures.mae_percent).map(|percent| format!(" ({percent} of stroke)"));
    let (mean, largest) = (quantity(figures.mae_um, "µm"), quantity(figures.max_um, "µm"));
    format!("Mean error {mean}{}, largest {largest}", of_stroke.unwrap_or_default())
}

/// An error of which less than this part is left without its constant offset is mostly that.
const CONSTANT: f64 = 0.5;

/// A log's mean error without a constant offset, in words; `None` where most of it is no constant.
pub fn without_constant(log: &Comparison) -> Option<String> {
    let figures = log.figures();
    let of_stroke = percent(figures.mae_without_offset_percent).map(|percent| format!(" ({percent} of stroke)"));
    let (mean, offset) = (quantity(figures.mae_without_offset_um, "µm"), quantity(figures.offset_um, "µm"));
    (figures.mae_without_offset_um < CONSTANT * figures.mae_um)
        .then(|| format!("Mean error {mean}{}, without a constant offset of {offset}", of_stroke.unwrap_or_default()))
}

/// A log's errors in a sentence.
pub fn sentence(log: &Comparison) -> String {
    let mut words = mean_and_largest(&log.mil);
    words += &format!(", constant offset {}.", quantity(log.mil.offset_um, "µm"));
    for (status, remark) in [
        (Status::VOLTAGE_OUT_OF_RANGE, " Its voltage leaves the range that the model was identified on."),
        (Status::CLAMPED, " The estimate was clamped to the table's limits."),
    ] {
        if log.status.contains(status) {
            words += remark;
        }
    }
    words
}

/// A searched coordinate.
pub struct GeneRow {
    /// Name of the gene.
    pub name: &'static str,
    /// What the gene stands for in the model.
    pub meaning: &'static str,
    /// Where the best lies.
    pub value: String,
    /// Its unit; empty for none.
    pub unit: &'static str,
    /// Lower end of its range.
    pub min: String,
    /// Upper end of its range.
    pub max: String,
    /// Where in its range the best lies, %.
    pub at: String,
    /// Whether that is an end of the range.
    pub at_end: bool,
}

impl GeneRow {
    /// The row of a coordinate.
    pub fn new((gene, value): &(Gene, f64)) -> Self {
        let at = Some(100.0 * gene.fraction(*value)).filter(|at| at.is_finite()).unwrap_or(0.0);
        Self {
            name: gene.name,
            meaning: gene.meaning,
            value: number(*value),
            unit: gene.unit,
            min: number(gene.min),
            max: number(gene.max),
            at: format!("{at:.1}"),
            at_end: gene.undetermined(*value),
        }
    }
}

/// A published parameter or another number of the table: symbol or name, value with unit.
pub type ParameterRow = (String, String);

/// The published parameters of a table.
pub fn parameters(table: &Table) -> Vec<ParameterRow> {
    let Some(p) = table.parameters.voigt() else { return fields(&table.parameters) };
    let p = p.map(f64::from);
    let mut rows = vec![
        ("α", quantity(p.alpha_um, "µm")),
        ("β", quantity(p.beta_v, "V")),
        ("λ", quantity(p.lambda_per_v, "1/V")),
        ("b", quantity(p.b_ohm, "Ω")),
        ("P", number(p.p)),
    ];
    if table.model().has_voltage_term() {
        rows.extend([("g", quantity(p.g_um_per_s, "µm/s/Vʰ")), ("h", number(p.h))]);
    }
    if table.model().has_displacement_term() {
        rows.extend([("e", quantity(p.e_m_per_s, "(m/s)/mᶠ")), ("f", number(p.f))]);
    }
    rows.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

/// The parameters of a model beyond the Voigt family, as `table.toml` names them.
fn fields(parameters: &Parameters) -> Vec<ParameterRow> {
    let shown = |value: &toml::Value| match value {
        toml::Value::Float(x) => number(*x),
        toml::Value::Array(values) => {
            let numbers: Vec<String> = values.iter().map(|x| x.as_float().map_or(x.to_string(), number)).collect();
            numbers.join(", ")
        }
        // A range, in the order of its ends.
        toml::Value::Table(ends) => match ["min", "max"].map(|end| ends.get(end).and_then(toml::Value::as_float)) {
            [Some(min), Some(max)] => format!("{} … {}", number(min), number(max)),
            _ => value.to_string(),
        },
        other => other.to_string(),
    };
    // Plain numbers, lists and tables of numbers: TOML has all of them.
    let Ok(toml::Value::Table(whole)) = toml::Value::try_from(parameters) else { return Vec::new() };
    let named = whole.iter().filter_map(|(_, model)| model.as_table()).flatten();
    named.map(|(name, value)| (name.clone(), shown(value) + beside(name))).collect()
}

/// What tells a parameter from the searched coordinate of another value.
fn beside(name: &str) -> &'static str {
    match name {
        "delay_ticks" => ", the coordinate delay less one tick: what a tick returns is the displacement at the next",
        _ => "",
    }
}

/// What else the table says.
pub fn table(table: &Table) -> Vec<ParameterRow> {
    let range = |min: f32, max: f32, unit: &str| format!("{} … {}", number(min.into()), quantity(max.into(), unit));
    let (volts, limits) = (table.voltage_range_v, table.displacement_limits_um);
    let rows = vec![
        ("Tick", quantity(table.sample_period_us.into(), "µs")),
        (
            "Discretisation",
            match table.scheme {
                Scheme::ForwardEuler => "forward Euler (Eq. 4.7)".to_owned(),
                Scheme::ZeroOrderHold => "zero-order hold".to_owned(),
            },
        ),
        ("Voltage range", range(volts.min, volts.max, "V")),
        ("Displacement limits", range(limits.min, limits.max, "µm")),
        ("Reversal deadband", quantity(table.retreat_v().into(), "V")),
        ("Voltage zero", quantity(table.voltage_zero_v.into(), "V")),
        ("Displacement zero", quantity(table.displacement_zero_um.into(), "µm")),
    ];
    rows.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_said_as_people_say_them() {
        let models = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/table/models");
        let (_, table) = table_files::TableFile::load(&models.join("generalised-prandtl-ishlinskii.toml")).unwrap();
        let rows = parameters(&table);
        let (_, delay) = rows.iter().find(|(name, _)| name == "delay_ticks").expect("the model has a delay");
        assert!(delay.contains("the coordinate delay less one tick"), "{delay}");
        let (_, span) = rows.iter().find(|(name, _)| name == "span_v").expect("the model has a span");
        assert!(span.contains(" … ") && span.len() < 20, "{span}");
    }
}
