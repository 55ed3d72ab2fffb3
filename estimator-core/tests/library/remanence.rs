//! How a model begins where nothing is known and the table says how an actuator rests.

use crate::common::models::table_of;
use estimator_core::*;

const REMANENCE: [f32; 2] = [0.5, -0.3];

fn remembering() -> impl Iterator<Item = Model> {
    Model::ALL.into_iter().filter(|model| model.remembers())
}

fn resting(model: Model, remanence_um: [f32; 2]) -> Admitted {
    Table { remanence_um, ..table_of(model) }.admit().unwrap()
}

fn first(table: &Admitted, volts: f64) -> f64 {
    Estimator::<f64>::new(table).tick_volts(volts + f64::from(table.voltage_zero_v)).displacement
}

#[test]
fn at_an_end_the_estimate_begins_so_far_off_and_between_in_proportion() {
    assert_eq!(remembering().count(), 3);
    let mut exact = 0;
    for model in remembering() {
        let [rests, plain] = [REMANENCE, [0.0; 2]].map(|remanence| resting(model, remanence));
        let Range { min, max } = rests.voltage_range_v.of::<f64>();
        for part in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let volts = min + part * (max - min);
            let off = first(&rests, volts) - first(&plain, volts);
            let expected = 0.5 - 0.8 * part;
            exact += u32::from((off - expected).abs() < 1e-3);
            // What no memory can be is left out.
            let between = Range { min: expected.min(0.0) - 1e-3, max: expected.max(0.0) + 1e-3 };
            assert!(between.contains(off), "{model} at {volts} V: {off} µm, not {expected}");
        }
    }
    assert!(exact >= 12, "{exact} of 15");
}

#[test]
fn what_no_memory_gives_begins_at_the_nearest_and_within_the_limits() {
    for model in remembering() {
        let rests = Table { remanence_um: [1e6, -1e6], drive: None, ..table_of(model) }.admit().unwrap();
        let Range { min, max } = rests.voltage_range_v.of::<f64>();
        let limits: Range<f64> = rests.displacement_limits_um.of();
        for volts in [min, 0.5 * (min + max), max] {
            assert!(limits.contains(first(&rests, volts)), "{model} at {volts} V");
        }
    }
}

#[test]
fn a_swing_wipes_it_out_and_a_restart_brings_it_back() {
    // The stiffest of this Maxwell-slip table's blocks never slips.
    for model in remembering().filter(|model| *model != Model::MaxwellSlip) {
        let [rests, middle] = [REMANENCE, [0.0; 2]].map(|remanence| resting(model, remanence));
        let Range { min, max } = rests.voltage_range_v.of::<f64>();
        let half = 0.5 * (max - min);
        let mut both = [&rests, &middle].map(Estimator::<f64>::new);
        let mut run = |ticks: u32| {
            let of = |estimator: &mut Estimator<f64>| {
                let volts = |tick: u32| min + half * (1.0 - libm::cos(0.01 * f64::from(tick + 80)));
                (0..ticks).map(|tick| estimator.tick_volts(volts(tick)).displacement).last()
            };
            let [rests, middle] = both.each_mut().map(|estimator| of(estimator).unwrap());
            both.iter_mut().for_each(Estimator::restart);
            rests - middle
        };
        let begins = run(1);
        assert!(begins > 0.1, "{model}: {begins}");
        let settled = run(1_900);
        assert!(settled.abs() < 0.02 * begins, "{model}: {settled} µm of {begins} are left");
        assert_eq!(run(1), begins, "{model}");
    }
}

#[test]
fn the_inverse_begins_where_the_estimate_does() {
    for model in remembering() {
        let table = resting(model, REMANENCE);
        let drive = table.drive.unwrap();
        let limits = DriveLimits { range_v: Range { min: 0.0, max: 60.0 }, rest_v: 15.0, ..drive.limits };
        let mut inverse = table.inverse::<f64>(&limits).unwrap();
        let estimate = Estimator::<f64>::new(&table).of_held_voltage().tick_volts(15.0).displacement;
        assert!((inverse.steer(15.0).displacement - estimate).abs() < 1e-9, "{model}");
    }
}

#[test]
fn a_model_that_knows_how_it_rests_takes_none() {
    for model in Model::ALL.into_iter().filter(|model| !model.remembers()) {
        let error = Table { remanence_um: [0.1, 0.0], ..table_of(model) }.admit().unwrap_err();
        assert!(error.to_string().contains("remanence_um"), "{model}: {error}");
    }
}
