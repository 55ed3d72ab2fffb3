//! Trajectories through the inverse and back through the model.

use estimator_core::{Admitted, DriveLimits, Estimator, Range};
use feedforward::{Trajectory, approach, near, plan};
use recordings::log::Log;
use table_files::TableFile;

fn table() -> Admitted {
    TableFile::load("../../tests/data/table/table.toml".as_ref()).unwrap().1
}

const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.0, slew_v_per_s: 200.0 };

#[test]
fn a_trajectory_between_samples_and_ticks() {
    let log = Log {
        name: "a".into(),
        path: "a".into(),
        sha256: String::new(),
        start_s: 0.0,
        sample_period: 1e-3,
        voltage: Vec::new(),
        displacement: Some(vec![0.0, 2.0, 2.0, 0.0]),
        displacement_estimated: false,
        holes: Vec::new(),
    };
    assert_eq!(Trajectory::of(&log, 5e-4).0, [0.0, 1.0, 2.0, 2.0, 2.0, 1.0, 0.0]);
    assert_eq!(Trajectory::of(&log, 2e-3).0, [0.0, 2.0]);
    assert_eq!(Trajectory(vec![1.0, 3.0]).at(7.0), 3.0);
    assert_eq!(Trajectory(vec![1.0, 3.0]).at(-0.5), 1.0);
}

#[test]
fn the_model_meets_the_trajectory_at_its_own_ticks() {
    let table = table();
    let start = Estimator::<f64>::new(&table).tick_volts(1.5).displacement;
    let wave = |k: u32| start + 12.0 * (f64::from(k) * 0.003).sin();
    let plan =
        plan(&table, &DriveLimits { rest_v: 1.5, ..LIMITS }, &Trajectory((0..6000).map(wave).collect())).unwrap();
    let errors = plan.round_trip(5).unwrap();
    assert!(errors.max_um < 1e-4, "{errors:?}");
    assert!(plan.out_of_reach < 5, "it begins at full speed: {}", plan.out_of_reach);
    assert!(plan.fastest() < 0.1 + 1e-9);
}

#[test]
fn what_is_too_fast_is_counted() {
    let steps = Trajectory((0..400).map(|k| if k < 200 { 5.0 } else { 25.0 }).collect());
    let slow = DriveLimits { slew_v_per_s: 20.0, ..LIMITS };
    let plan = plan(&table(), &slow, &steps).unwrap();
    assert!(plan.out_of_reach > 50, "{}", plan.out_of_reach);
    assert!(plan.fastest() <= 0.01 + 1e-6);
}

#[test]
fn the_way_from_rest_to_the_beginning_is_within_the_limits_and_does_not_overshoot() {
    let (table, near) = (table(), near(&table()));
    let hold = Trajectory(vec![20.0; 2000]);
    let without = plan(&table, &LIMITS, &hold).unwrap();
    assert!(without.out_of_reach > 0);
    let lead = approach(&table, &LIMITS, &hold).unwrap();
    let with = plan(&table, &LIMITS, &Trajectory([&lead[..], &hold.0].concat())).unwrap();
    let highest = with.displacement.iter().copied().fold(f64::MIN, f64::max);
    assert!(with.out_of_reach == 0 && highest < 20.0 + near, "{highest}");
    assert_eq!(with.shortfall(lead.len(), near), None);
    let rest = Trajectory(vec![with.displacement[0]; 10]);
    assert!(approach(&table, &LIMITS, &rest).unwrap().is_empty(), "it begins at rest");
    assert!(approach(&table, &LIMITS, &Trajectory(vec![900.0; 10])).unwrap().is_empty(), "it is out of reach");
}
