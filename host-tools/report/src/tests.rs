//! The whole report of small, hand-made logs.

use super::*;
use estimator_core::{AdcCalibration, DacCalibration, Model, Range, Scheme, Status};
use estimator_core::{Admitted, Digest, Parameters, Provenance, Table, VoigtParameters};
use identification::cost::Feedback;
use identification::validate::{Cold, Comparison, Figures, ToldFigures, Trace};
use identification::{Baseline, Candidate, Conditions, Fit, Problem, SearchOptions, identify};
use recordings::session::Session;

fn fit(model: Model) -> Fit {
    let voltage: Vec<f64> = (0..400).map(|k| 20.0 * (f64::from(k) * 0.05).sin()).collect();
    let displacement = voltage.iter().map(|v| 0.2 * v).collect();
    let session = Session::new("made".to_owned(), voltage, (0..400).collect(), displacement, 5e-4);
    let problem = Problem::new(vec![session.clone()], vec![session], Conditions::default());
    let search = SearchOptions { population: 8, generations: 3, rounds: 2, ..SearchOptions::default() };
    identify(&problem, &[model], Feedback::Simulation, &search, &mut |_, _| ()).remove(0)
}

fn table(model: Model) -> Admitted {
    Table {
        sample_period_us: 500,
        scheme: Scheme::ForwardEuler,
        deadband_v: 0.04,
        voltage_zero_v: 0.0,
        displacement_zero_um: 0.0,
        voltage_range_v: Range { min: -22.0, max: 22.0 },
        displacement_limits_um: Range { min: -15.0, max: 15.0 },
        parameters: Parameters::of_voigt_family(
            model,
            VoigtParameters {
                alpha_um: 172.0,
                beta_v: 5.2,
                lambda_per_v: 0.051,
                b_ohm: 1416.0,
                p: 1.49,
                ..VoigtParameters::default()
            },
        ),
        remanence_um: [0.0; 2],
        adc: AdcCalibration { gain_v_per_code: 0.0107, offset_v: -22.0, invert: false, full_scale: 4095 },
        amplifier_slew_v_per_s: None,
        dac: DacCalibration { gain_codes_per_um: 100.0, offset_code: 2048.0, full_scale: 4095 },
        drive: None,
        interval: None,
        provenance: Provenance {
            logs: Digest([0; 8]),
            seed: 1,
            tool_version: [0, 1, 0],
            train_mae_um: 0.1,
            validation_mae_um: None,
            validation_max_um: None,
        },
    }
    .admit()
    .unwrap()
}

/// A log of `samples` at 2 kHz and 10 Hz, whose error is a function of the sample.
pub fn log(name: &str, samples: usize, error: impl Fn(usize) -> f64) -> Comparison {
    let time_s: Vec<f64> = (1..=samples).map(|k| k as f64 * 5e-4).collect();
    let voltage: Vec<f64> = time_s.iter().map(|t| 20.0 * (62.8 * t).sin()).collect();
    let measured: Vec<f64> = voltage.iter().map(|v| 0.2 * v).collect();
    let estimated = measured.iter().enumerate().map(|(k, y)| y + error(k)).collect();
    let figures = Figures {
        mae_um: error(0).abs(),
        max_um: error(0).abs(),
        rmse_um: error(0).abs(),
        stroke_um: 8.0,
        offset_um: 0.0,
        mae_without_offset_um: 0.0,
        rmse_without_offset_um: 0.0,
        mae_percent: 100.0 * error(0).abs() / 8.0,
        max_percent: 100.0 * error(0).abs() / 8.0,
        rmse_percent: 100.0 * error(0).abs() / 8.0,
        mae_without_offset_percent: 0.0,
        rmse_without_offset_percent: 0.0,
    };
    Comparison {
        name: name.to_owned(),
        mil: figures,
        sil: figures,
        mil_sil_um: 1e-6,
        interval: None,
        interval_one_cycle: None,
        cold: Cold { all: figures, settled: None, settled_after_s: None },
        told: ToldFigures { nothing: figures, first_reading: figures, one_cycle: None, offset: figures },
        scored_s: (5e-4, samples as f64 * 5e-4),
        zeroed_um: None,
        raised: Vec::new(),
        status: Status::empty(),
        trace: Trace { time_s, voltage, measured, estimated },
    }
}

fn candidate(model: Model, training: Vec<Comparison>, held_out: Vec<Comparison>) -> Candidate {
    Candidate { fit: fit(model), table: table(model), training, held_out }
}

fn html(chosen: &Candidate, doubts: &[&str]) -> String {
    with_flaws(chosen, doubts, &[])
}

fn with_flaws(chosen: &Candidate, doubts: &[&str], flaws: &[Mark]) -> String {
    page(chosen, chosen, doubts, flaws)
}

fn page(chosen: &Candidate, learnt: &Candidate, doubts: &[&str], flaws: &[Mark]) -> String {
    let doubts: Vec<String> = doubts.iter().map(|&doubt| doubt.to_owned()).collect();
    let line = chosen.training_figures().map(|training| Baseline {
        gain_um_per_v: 0.2,
        offset_um: 0.0,
        training,
        held_out: chosen.held_out_figures(),
    });
    let html = render(&Report {
        title: "a & <b>.csv",
        verdict: &[concat!("It is `0.1 µm` off; see --", "hold-out.").to_owned()],
        doubts: &doubts,
        chosen,
        learnt,
        straight_line: line.as_ref(),
        candidates: std::slice::from_ref(chosen),
        flaws,
        facts: &[("Seed".to_owned(), "<1>".to_owned())],
    })
    .unwrap();
    assert_eq!(html.contains("straight line (2.1)"), line.is_some());
    // uPlot's own address stands in its licence, and a script has signs that a tag begins with.
    let (page, scripts) = html.split_once("<!--").unwrap_or((&html, END));
    let page = page.strip_prefix("<!doctype html>").unwrap();
    check(page.strip_suffix(END).unwrap_or(page), &["html", "body"]);
    assert!(!page.contains("http") && !page.contains("<script") && !html.contains("url("));
    assert!(scripts.ends_with(END) && ["src=", "import", "fetch("].iter().all(|loads| !scripts.contains(loads)));
    assert_eq!(scripts.matches("<script>").count(), scripts.matches("</script>").count());
    html
}

const END: &str = "</body>\n</html>";

/// Whether every tag that is opened is closed, in order, but for these, and no number is other than finite.
pub(super) fn check(markup: &str, but: &[&str]) {
    let mut open: Vec<&str> = Vec::new();
    for tag in markup.split('<').skip(1).map(|rest| rest.split_once('>').expect("a tag has an end").0) {
        let name = tag.trim_matches('/').split_whitespace().next().unwrap();
        assert_eq!(tag.matches('"').count() % 2, 0, "<{tag}>");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') && name != "meta" {
            open.push(name);
        }
        assert!(!["NaN", "inf"].iter().any(|word| tag.split('"').skip(1).step_by(2).any(|value| value.contains(word))));
    }
    assert_eq!(open, but);
}

#[test]
fn figures_tables_and_words_are_there() {
    let held_out = vec![log("tr10", 4000, |k| 0.1 * (k as f64 * 0.03).sin())];
    let training = (0..5).map(|n| log(&format!("log{n}"), 4000, |_| 0.05)).collect();
    let page = html(&candidate(Model::Enhanced, training, held_out), &["`gene` is at its end"]);
    // Six loops, branches and coverage, the held-out trace and three others, convergence and residuals.
    assert_eq!(page.matches("<figure>").count(), 14);
    assert_eq!(page.matches(r#"<svg class="figure" role="img" aria-label=""#).count(), 14);
    assert!(page.contains("Not drawn: log3, log4."));
    assert!(
        page.contains("<li><code>gene</code> is at its end</li>")
            && page.contains(concat!("<code>--", "hold-out</code>"))
    );
    assert!(page.contains("When not to trust it") && !page.contains("No doubt was found"));
    assert_eq!(page.matches(r#"<tr class="chosen">"#).count(), 1);
    let first = |words: &str| page.find(words).unwrap_or_else(|| panic!("{words} is missing"));
    let order = ["<h1>", "0.1 µm", "When not", "Candidates", "Loops", "Where it is off", "about 10\u{a0}Hz"];
    let then = ["Over time", "Convergence", "Residuals", "Searched coordinates", "Published parameters", "&#60;1&#62;"];
    assert!(order.iter().chain(&then).map(|words| first(words)).is_sorted());
}

#[test]
fn an_error_that_is_a_constant_is_told_without_it() {
    let mut shifted = log("shifted", 400, |_| 4.0);
    assert!(rows::without_constant(&shifted).is_some());
    let nothing = &mut shifted.mil;
    (nothing.offset_um, nothing.mae_without_offset_um, nothing.mae_without_offset_percent) = (4.0, 0.02, 0.25);
    let said = rows::without_constant(&shifted).unwrap().replace('\u{a0}', " ");
    assert_eq!(said, "Mean error 0.0200 µm (0.250 % of stroke), without a constant offset of 4.00 µm");
    shifted.mil.mae_without_offset_um = 3.0;
    assert_eq!(rows::without_constant(&shifted), None);
}

/// One a log that is drawn over time, and one each for branches, coverage, convergence and residuals; the loops are
/// a log's, too.
#[test]
fn the_numbers_of_a_picture_are_in_its_link() {
    let held_out = vec![log("tr10", 4000, |k| 0.1 * (k as f64 * 0.03).sin())];
    let page = html(&candidate(Model::Enhanced, vec![log("a", 100, |_| 0.05)], held_out), &[]);
    assert_eq!(page.matches(r#" href="data:text/csv,"#).count(), 2 + 4);
    assert_eq!(page.matches(" data-log=").count(), 2);
    assert!(page.contains(r#"download="tr10-held-out-thinned.csv""#) && page.contains(r#"data-of="4000">CSV, "#));
    assert!(page.contains(r#"download="a-training.csv""#) && page.contains(r#"data-rows="100" data-of="100">CSV</a>"#));
    for columns in [
        "voltage_v,mean_error_um%0Arising,",
        "step,error_um%0Atraining,",
        "frequency_hz,swing_v%0A",
        "error_um,samples_percent%0A",
    ] {
        assert!(page.contains(&format!("data:text/csv,curve,{columns}")), "{columns}");
    }
    assert!(
        page.contains("<noscript>")
            && page.contains("uPlot (v1.6.32)")
            && page.contains("Permission is hereby granted")
    );
}

#[test]
fn what_is_no_measurement_is_marked_over_time_and_listed() {
    let chosen = candidate(Model::Voigt, vec![log("a", 4000, |_| 0.1)], vec![log("b", 1000, |_| 0.1)]);
    let mark = |log: &str, from_s: f64, to_s: f64| Mark {
        log: log.to_owned(),
        from_s,
        to_s,
        what: format!("<leaps> at {from_s} s"),
    };
    // Two of them are one mark; one lies in the last periods, too, and one beyond what was scored.
    let flaws = [mark("a", 0.5, 0.5), mark("a", 0.501, 0.7), mark("a", 1.95, 1.95), mark("b", 30.0, 31.0)];
    let page = with_flaws(&chosen, &[], &flaws);
    assert_eq!(page.matches(r#"<rect class="flaw""#).count(), 3);
    assert_eq!(page.matches("What is no measurement is marked behind the error. <a ").count(), 1);
    assert_eq!(page.matches("&#60;leaps&#62; at").count(), 4);
    assert!(!page.contains("more.</p>") && page.contains("<h2>What is no measurement</h2>"));
    let many: Vec<Mark> = (0..5_000).map(|n| mark("a", f64::from(n) * 4e-4, f64::from(n) * 4e-4)).collect();
    let page = with_flaws(&chosen, &[], &many);
    assert!(page.contains("And 4940 more.") && page.matches(r#"<rect class="flaw""#).count() < 400);
    assert!(!html(&chosen, &[]).contains("What is no measurement"));
}

#[test]
fn generations_are_drawn_of_the_genetic_algorithm_alone() {
    let of = |model| html(&candidate(model, vec![log("a", 100, |_| 0.1)], Vec::new()), &[]);
    let (voigt, other) = (of(Model::Voigt), of(Model::Duhem));
    assert!(voigt.contains("after each generation") && voigt.contains(">generation</text>"));
    assert!(!other.contains("generation") && other.contains(">step of the search</text>"));
}

#[test]
fn names_are_escaped() {
    let name = "<img src=x onerror=\"a\">&'\u{0}";
    let chosen = candidate(Model::Voigt, vec![log(name, 100, |_| 0.1)], vec![log(name, 100, |_| 0.1)]);
    let page = html(&chosen, &["<b>"]);
    assert!(
        !page.contains("<img") && !page.contains("<b>.csv") && page.contains("&#60;img src=x onerror=&#34;a&#34;&#62;")
    );
    let svg = picture(&chosen.training[0], name, None).unwrap();
    check(&svg, &[]);
    assert!(!svg.contains("<img") && !svg.contains('\u{0}'));
    assert_eq!(svg.matches("http").count(), 1);
}

#[test]
fn many_long_logs_stay_below_a_megabyte() {
    let logs = |count: usize| -> Vec<Comparison> {
        (0..count).map(|n| log(&format!("log{n}"), 40_000, |k| ((k * 7919) % 1000) as f64 * 1e-3)).collect()
    };
    let page = html(&candidate(Model::Voigt, logs(30), logs(12)), &[]);
    assert!(page.len() < 1_000_000, "{}", page.len());
    assert_eq!(page.matches("<figure>").count(), 24 + 2 + 8 + 3 + 2);
    let svg = picture(&logs(1)[0], "long", None).unwrap();
    assert!(svg.len() < 200_000, "{}", svg.len());
}

#[test]
fn nothing_held_out_and_no_doubt() {
    let page = html(&candidate(Model::Voigt, vec![log("only", 1000, |_| 0.1)], Vec::new()), &[]);
    assert!(page.contains("Nothing was held out") && page.contains("No doubt was found") && page.contains("no proof"));
    assert_eq!(page.matches("<figure>").count(), 6);
}

#[test]
fn values_that_are_not_finite_or_do_not_vary_can_be_drawn() {
    let errors: [fn(usize) -> f64; 6] = [
        |_| 0.0,
        |_| 0.25,
        |_| f64::NAN,
        |_| f64::INFINITY,
        |k| if k % 2 == 0 { f64::NAN } else { 1e300 },
        |_| -1e-300,
    ];
    for error in errors {
        for samples in [1, 2, 3, 2000] {
            let mut chosen = candidate(Model::Voigt, vec![log("a", samples, error)], vec![log("b", samples, error)]);
            chosen.fit.convergence[1].training = f64::INFINITY;
            chosen.fit.convergence[1].validation = Some(f64::NAN);
            html(&chosen, &[]);
            check(&picture(&chosen.training[0], "a", None).unwrap(), &[]);
        }
    }
}

#[test]
fn the_parameters_are_those_of_the_table_that_is_delivered() {
    let judged = candidate(Model::Enhanced, vec![log("a", 2000, |_| 0.1)], vec![log("b", 2000, |_| 0.1)]);
    let notes = [
        "learnt once more from the whole of each log",
        "The table has learnt all of them.",
        "The errors are those before the table had learnt what was held out, too.",
    ];
    let alone = html(&judged, &[]);
    assert_eq!(notes.map(|note| alone.contains(note)), [false; 3]);
    let learnt = candidate(Model::Voigt, vec![log("a", 2000, |_| 0.1)], Vec::new());
    let page = page(&judged, &learnt, &[], &[]);
    assert_eq!(notes.map(|note| page.contains(note)), [true; 3]);
    let names = |of: &Candidate| rows::parameters(&of.table).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    let stands = |name: &String| page.contains(&format!("<dt>{name}</dt>"));
    assert!(names(&learnt).iter().all(stands) && !names(&judged).iter().all(stands), "{page}");
}

#[test]
fn a_log_without_samples_is_named() {
    let empty = log("empty", 0, |_| 0.1);
    assert!(picture(&empty, "a", None).unwrap_err().to_string().contains("log 'empty'"));
    let page = html(&candidate(Model::Voigt, vec![empty], Vec::new()), &[]);
    assert!(page.contains("Not drawn: empty.") && !page.contains("<script") && !page.contains("uPlot"));
}
