//! Recordings that are known again, and others that are like them.

use recordings::Content;
use recordings::log::Log;

/// A swing with noise, whose seed makes it another recording of the same drive.
fn log(seed: u64) -> Log {
    let mut state = seed;
    let mut noise = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1u32 << 31) - 0.5
    };
    let phase = |k: usize| k as f64 * 0.0625;
    Log {
        name: "swing".into(),
        path: "swing.csv".into(),
        sha256: seed.to_string(),
        start_s: 0.0,
        sample_period: 5e-4,
        voltage: (0..2000).map(|k| 50.0 - 50.0 * phase(k).cos() + 0.01 * noise()).collect(),
        displacement: Some((0..2000).map(|k| 7.0 - 7.0 * (phase(k) - 0.1).cos() + 0.01 * noise()).collect()),
        displacement_estimated: false,
        holes: Vec::new(),
    }
}

/// As another program writes it.
fn rounded(log: &Log) -> Log {
    let to = |digit: f64| move |x: &f64| (x / digit).round() * digit;
    let displacement = log.displacement.as_ref().map(|series| series.iter().map(to(1e-3)).collect());
    Log { voltage: log.voltage.iter().map(to(1e-3)).collect(), displacement, ..log.clone() }
}

#[test]
fn a_recording_is_known_again_rounded_and_cut_and_no_other_is() {
    let (trained, _) = log(1).trimmed(0.1, 0.0).split(0.5);
    let content = Content::of(&trained).unwrap();
    let begins = content.begins_in(&rounded(&log(1))).unwrap();
    assert!((begins - 0.1).abs() < 1e-9, "{begins}");
    let cut = content.begins_in(&rounded(&log(1).trimmed(0.25, 0.1))).unwrap();
    assert!((cut + 0.15).abs() < 1e-9, "{cut}");
    assert_eq!(content.begins_in(&log(2)), None, "the same drive on another day");
    assert_eq!(content.begins_in(&rounded(&log(2))), None);
    let (_, rest) = log(1).split(0.3);
    assert_eq!(content.begins_in(&rest), None, "what it was not trained on");
    assert_eq!(content.begins_in(&Log { sample_period: 1e-3, ..log(1) }), None);
    assert_eq!(Content::of(&log(1).trimmed(0.98, 0.0)), None, "too short to be known by");
}

/// As a program writes it that keeps five significant digits: finer near 0 than elsewhere.
fn to_five_digits(log: &Log) -> Log {
    let to = |series: &[f64]| series.iter().map(|x| format!("{x:.4e}").parse().unwrap()).collect();
    Log { voltage: to(&log.voltage), displacement: log.displacement.as_deref().map(to), ..log.clone() }
}

#[test]
fn digits_may_be_lost_on_either_side_and_each_in_its_own_way() {
    let fine = Content::of(&log(1)).unwrap();
    assert_eq!(fine.begins_in(&to_five_digits(&log(1))), Some(0.0));
    assert_eq!(fine.begins_in(&to_five_digits(&log(2))), None);
    for coarse in [rounded(&log(1)), to_five_digits(&log(1))].map(|log| Content::of(&log).unwrap()) {
        assert_eq!(coarse.begins_in(&log(1)), Some(0.0));
        assert_eq!(coarse.begins_in(&log(2)), None);
    }
}

/// Every n-th sample of a log, from the second on.
fn thinned(log: &Log, n: usize) -> Log {
    let every = |series: &[f64]| series[1..].iter().step_by(n).copied().collect::<Vec<f64>>();
    let displacement = log.displacement.as_deref().map(every);
    Log { voltage: every(&log.voltage), displacement, sample_period: n as f64 * log.sample_period, ..log.clone() }
}

#[test]
fn a_recording_is_known_again_thinned() {
    let content = Content::of(&log(1)).unwrap();
    let begins = content.begins_in(&thinned(&log(1), 2)).unwrap();
    assert!((begins + 5e-4).abs() < 1e-9, "{begins}");
    assert_eq!(content.begins_in(&thinned(&log(1), 4)), None, "too few of the kept samples are left");
    let cut = thinned(&log(1), 2).trimmed(0.3, 0.0).into_owned();
    let begins = content.begins_in(&cut).unwrap();
    assert!((begins + 0.3).abs() < 1e-3, "{begins}");
    assert_eq!(Content::of(&log(2)).unwrap().begins_in(&thinned(&log(1), 2)), None);
    for n in [2, 5, 20] {
        let content = Content::of(&thinned(&log(1), n)).unwrap();
        let begins = content.begins_in(&rounded(&log(1))).unwrap();
        assert!((begins - 5e-4).abs() < 1e-9, "every {n}: {begins}");
        assert_eq!(content.begins_in(&log(2)), None);
    }
}

/// The same with another displacement for each sample's.
fn sensed(log: &Log, of: impl Fn(usize, f64) -> f64) -> Log {
    let displacement = log.displacement.as_ref().unwrap().iter().enumerate().map(|(k, &x)| of(k, x)).collect();
    Log { displacement: Some(displacement), ..log.clone() }
}

#[test]
fn logs_that_rest_alike_are_two() {
    let still = |log: &Log, rests: std::ops::Range<usize>| {
        let rest = |k: usize, x: f64, at: f64| if rests.contains(&k) { at } else { x };
        let voltage = log.voltage.iter().enumerate().map(|(k, &v)| rest(k, v, 0.0)).collect();
        sensed(&Log { voltage, ..log.clone() }, |k, x| (rest(k, x, 0.3) / 0.01).round() * 0.01)
    };
    let (ends, begins) = (still(&log(1), 1000..2000), still(&log(2), 0..1200));
    assert_eq!(Content::of(&ends).unwrap().begins_in(&begins), None);
    assert_eq!(Content::of(&begins).unwrap().begins_in(&ends), None);
    let content = Content::of(&thinned(&ends, 5)).unwrap();
    assert_eq!(content.begins_in(&begins), None, "nor a thinned one");
    assert_eq!(Content::of(&ends).unwrap().begins_in(&rounded(&ends)), Some(0.0), "a copy is known all the same");
}

#[test]
fn a_staircase_that_was_driven_twice_is_two_logs() {
    // Noise of a tenth of the sensor's step.
    let stairs = |day: u64| {
        let level = |k: usize| (k / 100 % 5) as f64;
        let day = Log { voltage: (0..2000).map(|k| 10.0 * level(k)).collect(), ..log(day) };
        let noise = |k: usize, x: f64| x - 7.0 + 7.0 * (0.0625 * k as f64 - 0.1).cos();
        sensed(&day, |k, x| ((2.0 * level(k) + noise(k, x)) / 0.05).round() * 0.05)
    };
    let content = Content::of(&stairs(1)).unwrap();
    assert_eq!(content.begins_in(&stairs(2)), None);
}

#[test]
fn far_from_zero_noise_still_tells_two_logs() {
    let offset = |seed: u64| sensed(&log(seed), |_, x| x + 250.0);
    let commanded = |seed: u64| Log { voltage: log(1).voltage, ..offset(seed) };
    let content = Content::of(&commanded(1)).unwrap();
    assert_eq!(content.begins_in(&commanded(2)), None);
    let coarse = |seed: u64| sensed(&commanded(seed), |_, x| (x * 100.0).round() / 100.0);
    assert_eq!(Content::of(&coarse(1)).unwrap().begins_in(&coarse(2)), None, "of five digits");
    assert_eq!(content.begins_in(&rounded(&commanded(1))), Some(0.0));
}

#[test]
fn a_copy_in_which_holes_were_bridged_is_known() {
    let mut copy = rounded(&log(1));
    let lively = Content::of(&log(1)).unwrap().at;
    copy.holes = vec![lively[0] + 3..lively[0] + 5, 1200..1201];
    for hole in copy.holes.clone() {
        copy.voltage[hole.clone()].fill(1.0 + 1e-7);
        copy.displacement.as_mut().unwrap()[hole].fill(1.0 + 1e-7);
    }
    assert_eq!(Content::of(&log(1)).unwrap().begins_in(&copy), Some(0.0));
    assert_eq!(Content::of(&copy).unwrap().begins_in(&log(1)), Some(0.0));
}

#[test]
fn a_stretch_that_is_nowhere_is_no_reason_to_fail() {
    let mut content = Content::of(&log(1).trimmed(0.1, 0.0)).unwrap();
    content.at[3] = i64::MAX as usize;
    assert!((content.begins_in(&log(1)).unwrap() - 0.1).abs() < 1e-9);
    content.at = vec![usize::MAX; 4];
    assert_eq!(content.begins_in(&log(1)), None);
}
