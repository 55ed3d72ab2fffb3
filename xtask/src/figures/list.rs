//! The list of figures: what each is called in the documents, and how it is made of what a command prints.

use anyhow::{Context, Result, ensure};
use estimator_core::Model;
use serde_json::Value;

use super::{
    cells::{array, fixed, number, table},
    command::{
        Command::{
            self, Cycles, Identify, OtherDay, OtherDayUnzeroed, Reproduce, Resistors, SameDay, SignalFaults, Size,
            Validate,
        },
        Printed, bytes,
    },
    document::Content,
    firmware::{cycles, models, signal, tick},
    resistors::{dividers, stages},
};

/// A figure, or a table of them.
pub struct Figure {
    /// What it is called in the documents' markers.
    pub name: &'static str,
    /// Where it is a file of its own: its path. Else it stands between markers.
    pub file: Option<&'static str>,
    /// By what part of itself a number may differ from what is stated.
    pub slack: f64,
    /// Makes it of what commands print.
    pub make: fn(&Printed<'_>) -> Result<Content>,
}

/// One source makes one of several images, whose functions are laid out and inlined otherwise: rustc does not compile
/// the core to the same bytes each time. Their cycles differ by up to 2 %.
const OF_CYCLES: f64 = 0.03;

/// Every figure of the documents.
pub const FIGURES: [Figure; 20] = [
    Figure {
        name: "picture",
        file: Some("book/src/estimate.svg"),
        slack: 0.0,
        make: |printed| Ok(Content::File(bytes(&printed.as_judged()?.join("estimate.svg"))?)),
    },
    stated("held-out", |printed| held_out(&*printed.by(Identify)?)),
    stated("held-out-in-short", |printed| held_out_in_short(&*printed.by(Identify)?)),
    stated("settled-after-s", |printed| value(printed, Validate, "/logs/0/cold/settled_after_s", 2)),
    stated("settled-mae-um", |printed| value(printed, Validate, "/logs/0/cold/settled/mae_um", 3)),
    stated("cold-mae-um", |printed| value(printed, Validate, "/logs/0/cold/all/mae_um", 2)),
    stated("told-mae-um", |printed| value(printed, Validate, "/all/sil/mae_um", 3)),
    stated("other-day-unzeroed-um", |printed| value(printed, OtherDayUnzeroed, "/all/sil/mae_um", 2)),
    stated("other-day-without-offset-um", |printed| {
        value(printed, OtherDayUnzeroed, "/all/sil/mae_without_offset_um", 2)
    }),
    stated("interval", intervals),
    stated("signal", |printed| signal(&*printed.by(SignalFaults)?)),
    stated("dividers", |printed| dividers(&*printed.by(Resistors)?)),
    stated("stages", |printed| stages(&*printed.by(Resistors)?)),
    stated("thesis", |printed| thesis(&printed.by(Reproduce)?["errors"])),
    stated("tracking", |printed| tracking(&printed.by(Reproduce)?["tracking"])),
    stated("models", models),
    stated("tick", |printed| tick(&*printed.by(Size)?)),
    // To 10 kB: the messages of panics hold the paths of the machine that builds the image.
    stated("flash-kb", |printed| kilobytes(printed, "/flash_bytes", 10.0)),
    stated("ram-kb", |printed| kilobytes(printed, "/ram_bytes", 1.0)),
    Figure { slack: OF_CYCLES, ..stated("cycles", |printed| cycles(&*printed.by(Cycles)?)) },
];

const fn stated(name: &'static str, make: fn(&Printed<'_>) -> Result<Content>) -> Figure {
    Figure { name, file: None, slack: 0.0, make }
}

/// What every model must better: the displacement proportional to the voltage, and an offset.
const STRAIGHT_LINE: &str = "straight line";

/// Errors of the models on the measured log's held-out half.
fn held_out(printed: &Value) -> Result<Content> {
    let row = |name: String, errors: &Value| -> Result<Vec<String>> {
        let figure = |name: &str| number(errors, &format!("/held_out/{name}"));
        Ok(vec![
            name,
            fixed(figure("mae_um")?, 3),
            fixed(figure("max_um")?, 3),
            fixed(figure("rmse_um")?, 3),
            fixed(100.0 * figure("mae_um")? / figure("stroke_um")?, 2),
            fixed(figure("mae_without_offset_um")?, 3),
        ])
    };
    let candidate = |candidate: &Value| -> Result<Vec<String>> {
        let chosen = if candidate["model"] == printed["model"] { " (chosen)" } else { "" };
        row(format!("{}{chosen}", model(&candidate["model"])?), candidate)
    };
    let columns = ["MAE µm", "MAX µm", "RMSE µm", "MAE, % of stroke", "MAE µm without constant offset"];
    let line = row(STRAIGHT_LINE.to_owned(), &printed["straight_line"]);
    table(1, &columns, [line].into_iter().chain(array(printed, "/candidates")?.iter().map(candidate)))
}

/// The same of the models that a reader compares first: what is there without one, the thesis's two ends,
/// and the choice.
fn held_out_in_short(printed: &Value) -> Result<Content> {
    let row = |name: String, figures: &Value| -> Result<Vec<String>> {
        let figure = |name: &str| number(figures, name);
        let percent = 100.0 * figure("/mae_um")? / figure("/stroke_um")?;
        Ok(vec![name, fixed(figure("/mae_um")?, 3), fixed(figure("/max_um")?, 3), fixed(percent, 2)])
    };
    let candidates = array(printed, "/candidates")?;
    let shown = [Model::Voigt, Model::Enhanced];
    let shown = candidates.iter().filter(|candidate| {
        candidate["model"] == printed["model"] || model(&candidate["model"]).is_ok_and(|model| shown.contains(&model))
    });
    let straight = row(STRAIGHT_LINE.to_owned(), &printed["straight_line"]["held_out"]);
    let models = shown.map(|candidate| {
        let chosen = if candidate["model"] == printed["model"] { " (chosen)" } else { "" };
        row(format!("{}{chosen}", model(&candidate["model"])?), &candidate["held_out"])
    });
    table(1, &["MAE µm", "MAX µm", "MAE, % of stroke"], [straight].into_iter().chain(models))
}

/// How the interval does after a zero, on the recording's own second half and on another day.
fn intervals(printed: &Printed<'_>) -> Result<Content> {
    let row = |(name, command): (&str, Command)| -> Result<Vec<String>> {
        let printed = printed.by(command)?;
        let log = printed.pointer("/logs/0").context("no log was judged")?;
        let holds = number(log, "/interval/covered_percent")?;
        ensure!(holds >= 90.0, "{name}: the interval holds the sensor {holds:.1} % of the time, and must 90 %");
        Ok(vec![
            name.to_owned(),
            fixed(number(log, "/told/nothing/mae_um")?, 3),
            fixed(number(log, "/told/nothing/rmse_without_offset_um")?, 3),
            fixed(number(log, "/interval/half_width_um")?, 3),
            fixed(holds, 1),
            fixed(number(log, "/interval/best_constant_um")?, 3),
        ])
    };
    let rows = [
        ("its second half, by a table of the first, zeroed at 20.1 s", SameDay),
        ("another session, zeroed at 24 s", OtherDay),
    ];
    let columns = [
        "MAE µm",
        "RMS µm without offset",
        "± µm, mean",
        "holds the sensor, % of the time",
        "a fixed ± that would hold as often, µm",
    ];
    table(1, &columns, rows.into_iter().map(row))
}

/// Errors on the synthetic rig, beside those of the thesis.
fn thesis(printed: &Value) -> Result<Content> {
    let rows = array(printed, "")?;
    let of_voigt = |row: &Value, name: &str| -> Result<f64> {
        let voigt = rows.iter().find(|other| other["model"] == "voigt" && other["cost"] == row["cost"]);
        Ok(number(row, name)? / number(voigt.context("Voigt's model is missing")?, name)?)
    };
    // The search must have found the optimum: a Voigt model badly converged would flatter the others.
    let simulated = |wanted: Model| -> Result<&Value> {
        let found =
            rows.iter().find(|row| model(&row["model"]).is_ok_and(|model| model == wanted) && row["cost"] != "osp");
        found.with_context(|| format!("{wanted} is missing"))
    };
    let voigt = number(simulated(Model::Voigt)?, "/mae_um")?;
    ensure!((0.24..0.27).contains(&voigt), "Voigt's optimum validates at 0.25 µm, this at {voigt:.3} µm");
    for (better, most) in [(Model::Enhanced, 0.6), (Model::GeneralisedPrandtlIshlinskii, 0.12)] {
        let ratio = of_voigt(simulated(better)?, "/mae_um")?;
        ensure!(ratio <= most, "{better}: the error must be at most {most} of Voigt's, and is {ratio:.3} of it");
    }
    let row = |row: &Value| -> Result<Vec<String>> {
        let cost = if row["cost"] == "osp" { "OSP" } else { "simulation" };
        let mut cells = vec![model(&row["model"])?.to_string(), cost.to_owned()];
        for prefix in ["/", "/thesis_"] {
            let [mae, max] = ["mae_um", "max_um"].map(|name| format!("{prefix}{name}"));
            cells.extend(if row.pointer(&mae).is_none_or(Value::is_null) {
                ["–"; 3].map(str::to_owned)
            } else {
                [fixed(number(row, &mae)?, 3), fixed(number(row, &max)?, 3), fixed(of_voigt(row, &mae)?, 2)]
            });
        }
        Ok(cells)
    };
    let columns = ["MAE µm", "MAX µm", "MAE of Voigt's", "thesis MAE µm", "thesis MAX µm", "thesis MAE of Voigt's"];
    let first = rows.first().context("no model was identified")?;
    let [mae, max] = ["/straight_line_mae_um", "/straight_line_max_um"].map(|name| number(first, name));
    let line: Vec<String> = [STRAIGHT_LINE.to_owned(), "–".to_owned(), fixed(mae?, 3), fixed(max?, 3)]
        .into_iter()
        .chain(["–"; 4].map(str::to_owned))
        .collect();
    table(2, &columns, [Ok(line)].into_iter().chain(rows.iter().map(row)))
}

/// Errors of the rig driven by the models' inverses. The trajectories are the document's headings.
fn tracking(printed: &Value) -> Result<Content> {
    const SHAPES: [&str; 6] = ["sine 1 Hz", "sine 10 Hz", "sine 50 Hz", "triangle 5 Hz", "staircase", "shrinking 5 Hz"];
    let inverted = array(printed, "")?.iter().filter(|row| !row["mae_nm"].is_null());
    let row = |row: &Value| -> Result<Vec<String>> {
        let mut cells = vec![row["name"].as_str().context("a row has no name")?.to_owned()];
        for index in 0..SHAPES.len() {
            cells.push(fixed(number(row, &format!("/mae_nm/{index}"))?, 0));
        }
        cells.push(fixed(number(row, "/of_scaling")?, 3));
        cells.extend([fixed(number(row, "/mean_nm")?, 0), fixed(number(row, "/converted_nm")?, 0)]);
        let round_trip = row["round_trip_nm"].as_f64();
        cells.push(round_trip.map_or_else(|| "–".to_owned(), |nm| fixed(nm, 2)));
        Ok(cells)
    };
    let columns = [&SHAPES[..], &["mean, of scaling's", "mean", "by the board", "round trip"]].concat();
    table(1, &columns, inverted.map(row))
}

fn value(printed: &Printed<'_>, command: Command, pointer: &str, digits: usize) -> Result<Content> {
    Ok(Content::Value(fixed(number(&*printed.by(command)?, pointer)?, digits)))
}

/// Rounded to a multiple of `step` kB.
fn kilobytes(printed: &Printed<'_>, pointer: &str, step: f64) -> Result<Content> {
    let bytes = number(&*printed.by(Size)?, pointer)?;
    Ok(Content::Value(fixed((1e-3 * bytes / step).round() * step, 0)))
}

fn model(name: &Value) -> Result<Model> {
    serde_json::from_value(name.clone()).with_context(|| format!("{name} is no model"))
}
