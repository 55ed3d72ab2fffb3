//! The page of a comparison of models: one HTML file that needs nothing else, for a screen, a phone or paper.

use super::error::ReportError;
use super::number::{number, quantity};
use super::rows::Cell;
use askama::Template;
use comparison::{Errors, Judgement, Matrix, Row};
use identification::StraightLine;
use identification::validate::Figures;

/// What the page says.
#[derive(Clone, Copy, Debug)]
pub struct ComparisonReport<'a> {
    /// Models and their errors.
    pub matrix: &'a Matrix,
    /// How to read the figures.
    pub notes: &'a [&'a str],
    /// What every model saw; provenance.
    pub facts: &'a [(String, String)],
}

/// The page as HTML.
///
/// # Errors
/// [`ReportError::Template`] where the template cannot be rendered.
pub fn comparison(report: &ComparisonReport<'_>) -> Result<String, ReportError> {
    Ok(Page::new(report).render()?)
}

/// The page that the template fills.
#[derive(Template)]
#[template(path = "compare.html")]
struct Page<'a> {
    title: String,
    summary: String,
    notes: &'a [&'a str],
    tables: Vec<ErrorTable<'a>>,
    facts: &'a [(String, String)],
}

/// The models on one log, or on all.
struct ErrorTable<'a> {
    title: String,
    headings: Vec<&'static str>,
    rows: Vec<ModelRow<'a>>,
}

/// A model, or the straight line, in such a table.
struct ModelRow<'a> {
    name: String,
    nearest: bool,
    /// Column heading and what stands there.
    cells: Vec<(&'static str, Cell)>,
    /// Why there are none.
    failed: Option<&'a str>,
}

impl<'a> Page<'a> {
    fn new(report: &ComparisonReport<'a>) -> Self {
        let matrix = report.matrix;
        let names = matrix.held_out();
        let over_all = match names[..] {
            [name] => format!("Held out: {name}"),
            _ => format!("Held out, over all {} logs", names.len()),
        };
        let mut tables = vec![ErrorTable::new(over_all, matrix, |row, errors| {
            [held_out(&errors.held_out.all), beside(row, errors)].into_iter().flatten().collect()
        })];
        for (index, name) in names.iter().enumerate().filter(|_| names.len() > 1) {
            let title = format!("Held out: {name}");
            tables.push(ErrorTable::new(title, matrix, |_, errors| {
                errors.held_out.logs.get(index).map_or(Vec::new(), |log| held_out(&log.errors))
            }));
        }
        Self {
            title: format!("{} models on {}", matrix.rows.len(), names.join(", ")),
            summary: summary(matrix),
            notes: report.notes,
            tables,
            facts: report.facts,
        }
    }
}

/// Which is nearest to the sensor, in words.
fn summary(matrix: &Matrix) -> String {
    let nearest = matrix.nearest();
    let row = matrix.rows.iter().find(|row| Some(row.model) == nearest);
    let Some(errors) = row.and_then(Row::errors) else { return "No model has an admissible candidate.".to_owned() };
    let all = &errors.held_out.all;
    format!(
        "Nearest to the sensor on data that none has seen, in simulation: {}, on average {} off ({} of the stroke) without \
         each log's constant offset; with it {}, and never more than {}.",
        nearest.map_or(String::new(), |model| model.to_string()),
        quantity(all.mae_without_offset_um, "µm"),
        quantity(all.mae_without_offset_percent, "%"),
        quantity(all.mae_um, "µm"),
        quantity(all.max_um, "µm")
    )
}

impl<'a> ErrorTable<'a> {
    fn new(
        title: String,
        matrix: &'a Matrix,
        cells: impl Fn(Option<&Row>, &Errors) -> Vec<(&'static str, Cell)>,
    ) -> Self {
        let nearest = matrix.nearest();
        let mut rows: Vec<ModelRow<'a>> = matrix
            .rows
            .iter()
            .map(|row| ModelRow {
                name: row.model.to_string(),
                nearest: nearest == Some(row.model),
                cells: row.errors().map_or(Vec::new(), |errors| cells(Some(row), errors)),
                failed: match &row.result {
                    Judgement::Failed { failed } => Some(failed),
                    Judgement::Identified(_) => None,
                },
            })
            .collect();
        rows.extend(matrix.straight_line.as_ref().map(|baseline| ModelRow {
            name: StraightLine::NAME.to_owned(),
            nearest: false,
            cells: cells(None, &baseline.errors),
            failed: None,
        }));
        // Every row that has cells has the same ones but instructions, which not every model need have.
        let longest = rows.iter().max_by_key(|row| row.cells.len());
        let headings = longest.map_or(Vec::new(), |row| row.cells.iter().map(|(heading, _)| *heading).collect());
        Self { title, headings, rows }
    }
}

fn error(um: f64, percent: f64) -> Cell {
    Cell { um: number(um), percent: percent.is_finite().then(|| quantity(percent, "%")) }
}

fn held_out(figures: &Figures) -> Vec<(&'static str, Cell)> {
    vec![
        ("MAE, µm", error(figures.mae_um, figures.mae_percent)),
        ("RMS, µm", error(figures.rmse_um, figures.rmse_percent)),
        ("MAX, µm", error(figures.max_um, figures.max_percent)),
        ("MAE, no offset, µm", error(figures.mae_without_offset_um, figures.mae_without_offset_percent)),
    ]
}

/// What stands beside the errors over all logs; nothing is searched for the straight line, which has no row.
fn beside(row: Option<&Row>, errors: &Errors) -> Vec<(&'static str, Cell)> {
    let training = &errors.training.all;
    let plain = |text: String| Cell { um: text, percent: None };
    let mut cells = vec![
        ("Training MAE, µm", error(training.mae_um, training.mae_percent)),
        ("Training RMS, µm", error(training.rmse_um, training.rmse_percent)),
        ("Parameters", plain(errors.parameters.to_string())),
        ("Evaluations", plain(row.map_or("–".to_owned(), |row| row.evaluations.to_string()))),
        ("Seconds", plain(row.map_or("–".to_owned(), |row| format!("{:.2}", row.seconds)))),
    ];
    if let Some(counts) = row.and_then(|row| row.instructions) {
        cells.push((
            "Instructions a tick, most",
            Cell { um: format!("{:.0}", counts.max), percent: Some(format!("mean {:.0}", counts.mean)) },
        ));
    }
    cells
}
