//! A fit is the best in the norm that it minimises, and keeps to its budget.

use calibration::CalibrationOptions;
use estimator_core::{Model, Parameters};
use identification::cost::{Cost, Feedback, Norm};
use identification::search::Optimiser;
use identification::{Conditions, Fit, Identification, Job, ModelChoice, Problem, SearchOptions, Trial, identify};
use recordings::prepare::{AutoOr, PrepareOptions, Recipe};
use recordings::rig::{EXCITATIONS, Rig};

/// The rig's 10 Hz logs.
fn problem() -> Problem {
    let fast = EXCITATIONS.into_iter().filter(|excitation| excitation.name.ends_with("10"));
    let rig = Rig { duration: 0.3, ..Rig::default() };
    let sessions = fast.map(|excitation| Recipe::at_tick(500).session(&rig.log(excitation)).unwrap());
    Problem::new(sessions.collect(), Vec::new(), Conditions::default())
}

fn fits(problem: &Problem, models: &[Model], cost: Cost, budget: usize) -> Vec<Fit> {
    let options = SearchOptions::default();
    Identification { problem, cost, options: &options, budget: Some(budget) }.run(models, &mut |_, _| ())
}

fn in_norm(norm: Norm) -> Cost {
    Cost { norm, ..Feedback::Simulation.into() }
}

#[test]
fn each_norm_s_fit_is_the_better_one_in_its_own() {
    let problem = problem();
    for model in [Model::Voigt, Model::BoucWen] {
        let [absolute, square] =
            [Norm::L1, Norm::L2].map(|norm| fits(&problem, &[model], in_norm(norm), 3000).remove(0));
        let in_both =
            |fit: &Fit| [Norm::L1, Norm::L2].map(|norm| problem.cost(&fit.parameters.unwrap(), in_norm(norm)));
        let ([mae, rms], [other_mae, other_rms]) = (in_both(&absolute), in_both(&square));
        assert!(mae < other_mae && other_rms < rms, "{model}: MAE {mae} {other_mae}, RMS {rms} {other_rms}");
        assert_eq!((absolute.cost, square.cost), (mae, other_rms), "{model}");
    }
}

#[test]
fn no_model_exceeds_the_budget() {
    let problem = problem();
    for (budget, narx) in [(300, 162), (40, 40)] {
        for fit in fits(&problem, &Model::ALL, in_norm(Norm::L1), budget) {
            let expected = match fit.model {
                Model::Narx => narx..=narx,
                // It ends where it finds nothing better.
                _ => budget / 8..=budget,
            };
            assert!(expected.contains(&fit.evaluations), "{}: {} of {budget}", fit.model, fit.evaluations);
        }
    }
}

#[test]
fn evaluations_are_counted_without_a_budget_too() {
    let options = SearchOptions {
        population: 8,
        generations: 3,
        rounds: 2,
        evaluations: 5,
        optimiser: Optimiser::Local,
        ..SearchOptions::default()
    };
    let models = [Model::Voigt, Model::VoltageExtremum, Model::Duhem];
    let found = identify(&problem(), &models, Feedback::Osp, &options, &mut |_, _| ());
    // Eight chromosomes in the first population and three generations of each round; the second has one seed, the
    // extremum model's second search one more in its first.
    let one = 2 * 8 * 4 + 1;
    let evaluations: Vec<usize> = found.iter().map(|fit| fit.evaluations).collect();
    assert_eq!(evaluations, [one, 2 * one + 1, 2 * 5]);
}

/// With an ADC so coarse that its codes decide what a reversal is.
#[test]
fn what_was_fitted_with_is_what_the_table_runs_with() {
    let rig = Rig { duration: 0.3, ..Rig::default() };
    for (model, adc_full_scale) in [(Model::VoltageExtremum, 255), (Model::VoltageExtremum, 4095), (Model::Narx, 255)] {
        let conditions = Conditions { deadband: Some(0.3), ..Conditions::default() };
        let outcome = Job {
            training: EXCITATIONS.into_iter().map(|excitation| rig.log(excitation)).collect(),
            held_out: Vec::new(),
            hold_out: 0.0,
            as_judged: false,
            prepare: PrepareOptions { delay: AutoOr::Given(0.0), ..PrepareOptions::default() },
            model: ModelChoice::Is(model),
            conditions,
            calibration: CalibrationOptions { adc_full_scale: Some(adc_full_scale), ..CalibrationOptions::default() },
            cost: Feedback::Simulation.into(),
            search: SearchOptions { evaluations: 40, ..SearchOptions::default() },
        }
        .run(&mut |_, _| ())
        .unwrap();
        let table = outcome.judged().table;
        let (fitted, code) = (outcome.problem.deadband, f64::from(table.adc.gain_v_per_code));
        assert!((fitted - 0.3).abs() <= 0.5 * code && fitted != 0.3, "{model}: {fitted} V, codes of {code} V");
        let runs = table.engine::<f64>();
        assert_eq!(f64::from(table.retreat_v()), fitted, "{model}");
        let as_fitted = Trial::model(&table.parameters, &outcome.problem.discretisation());
        assert_eq!(runs, as_fitted, "{model}");
        if let Parameters::Narx(of) = table.parameters {
            assert_eq!(f64::from(of.deadband_v), fitted);
        }
    }
}
