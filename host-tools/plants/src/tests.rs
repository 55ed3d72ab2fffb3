//! Laws that the plants must obey, whatever their numbers.

use super::*;

const VOLTS: f64 = 20.0;

/// A plant that shows its hysteresis alone.
fn bare(kind: Kind, device: u64) -> Plant {
    Plant { creep: 0.0, lag_s: 0.0, instruments: Instruments::EXACT, ..Plant::drawn(kind, device) }
}

fn relays() -> impl Iterator<Item = Kind> {
    CATALOGUE.into_iter().filter(|kind| matches!(kind, Kind::Relays(_)))
}

/// Voltages from one target to the next in steps of 0.02 V.
fn path(targets: &[f64]) -> Vec<f64> {
    let mut path = vec![0.0];
    for &target in targets {
        let from = path[path.len() - 1];
        let steps = ((target - from).abs() / 0.02).ceil().max(1.0);
        path.extend((1..=steps as usize).map(|k| from + (target - from) * k as f64 / steps));
    }
    path
}

/// Where the plant stands after such a path.
fn after(plant: &Plant, targets: &[f64]) -> f64 {
    plant.respond(&path(targets)).pop().unwrap()
}

fn stroke(positions: &[f64]) -> f64 {
    positions.iter().copied().fold(f64::MIN, f64::max) - positions.iter().copied().fold(f64::MAX, f64::min)
}

#[test]
fn strokes_are_8_to_12_um_and_loops_some_per_cent_to_a_quarter_of_it() {
    for kind in CATALOGUE {
        for device in 0..4 {
            let plant = bare(kind, device);
            let positions = plant.respond(&path(&[VOLTS, -VOLTS, VOLTS]));
            assert!((8.0..=12.0).contains(&stroke(&positions)), "{kind:?} {device}: {}", stroke(&positions));
            let up = after(&plant, &[VOLTS, -VOLTS, 0.0]);
            let down = after(&plant, &[VOLTS, 0.0]);
            let width = (down - up) / plant.stroke_um;
            assert!((0.05..0.3).contains(&width), "{kind:?} {device}: loop of {width}");
        }
    }
}

#[test]
fn a_loop_is_run_through_with_its_falling_branch_above() {
    for kind in CATALOGUE {
        let (plant, cycle) = (bare(kind, 1), path(&[VOLTS, -VOLTS, VOLTS, -VOLTS, VOLTS]));
        let positions = plant.respond(&cycle);
        let last = cycle.len() - 4001..cycle.len();
        let area: f64 =
            last.clone().skip(1).map(|k| (positions[k] + positions[k - 1]) / 2.0 * (cycle[k] - cycle[k - 1])).sum();
        // ∮ y dV < 0: the energy that the hysteresis takes, ∮ V dy, is positive.
        assert!(area < -0.02 * plant.stroke_um * VOLTS, "{kind:?}: {area}");
    }
}

#[test]
fn relays_forget_what_a_larger_swing_wipes_out() {
    for kind in relays() {
        let plant = bare(kind, 2);
        let plain = after(&plant, &[15.0, -10.0, 3.0]);
        let with_minor_loops = after(&plant, &[15.0, 8.0, 12.0, -10.0, -4.0, -7.0, 3.0]);
        assert!((plain - with_minor_loops).abs() < 1e-9, "{kind:?}: {plain} {with_minor_loops}");
    }
}

#[test]
fn minor_loops_of_relays_between_the_same_voltages_are_congruent() {
    for kind in relays() {
        let plant = bare(kind, 3);
        let swing = |history: &[f64]| {
            let low = after(&plant, &[history, &[-4.0]].concat());
            let high = after(&plant, &[history, &[-4.0, 6.0]].concat());
            let middle = after(&plant, &[history, &[-4.0, 6.0, 1.0]].concat());
            (high - low, high - middle)
        };
        let (one, other) = (swing(&[VOLTS, -8.0, 6.0]), swing(&[-VOLTS, 12.0]));
        assert!((one.0 - other.0).abs() < 1e-9 && (one.1 - other.1).abs() < 1e-9, "{kind:?}: {one:?} {other:?}");
    }
}

#[test]
fn relays_know_no_rate_and_rate_dependent_plays_do() {
    let difference = |kind: Kind| {
        let plant = bare(kind, 4);
        let at = |hertz: f64| {
            let wave = Waveform::Triangle { amplitude: VOLTS, hertz, offset: 0.0 };
            let positions = plant.respond(&wave.command(1.25 / hertz, 0));
            // At −20 V rising through 0 V after a period and a bit: the same voltages in other times.
            positions[positions.len() * 4 / 5]
        };
        (at(1.0) - at(20.0)).abs()
    };
    for kind in relays() {
        assert!(difference(kind) < 1e-9, "{kind:?}: {}", difference(kind));
    }
    assert!(difference(Kind::RateDependent) > 0.05, "{}", difference(Kind::RateDependent));
}

#[test]
fn creep_goes_by_the_decade() {
    let plant = Plant { creep: 0.015, ..bare(Kind::Relays(Density::Gaussian), 5) };
    let positions = plant.respond(&Waveform::Step { amplitude: 10.0, at_s: 0.0 }.command(40.0, 0));
    let at = |seconds: f64| positions[(seconds / STEP_S) as usize];
    let first = positions[0];
    for from in [0.03, 0.3, 3.0] {
        let decade = (at(10.0 * from) - at(from)) / first;
        assert!((decade / 0.015 - 1.0).abs() < 0.1, "{from} s: {decade}");
    }
}

#[test]
fn the_seed_decides_noise_and_drift_and_the_device_the_rest() {
    let wave = Waveform::Multisine { amplitude: 15.0, from_hz: 1.0, to_hz: 40.0, tones: 8 };
    let log = |device, seed| Plant::drawn(Kind::JilesAtherton, device).log("multisine", &wave, 1.0, seed);
    assert_eq!(log(1, 3), log(1, 3));
    assert_ne!(log(1, 3).displacement, log(1, 4).displacement);
    assert_ne!(log(1, 3).displacement, log(2, 3).displacement);
    assert_eq!(log(1, 3).voltage, log(2, 3).voltage);
}

#[test]
fn every_waveform_starts_at_0_and_keeps_within_its_voltages() {
    let (amplitude, hertz) = (8.0, 3.0);
    for wave in [
        Waveform::Sine { amplitude, hertz, offset: 4.0 },
        Waveform::Triangle { amplitude, hertz, offset: -4.0 },
        Waveform::AmplitudeModulated { amplitude, hertz, swell_hz: 0.5 },
        Waveform::Staircase { amplitude, steps: 4, hold_s: 0.05 },
        Waveform::Multisine { amplitude, from_hz: 1.0, to_hz: 40.0, tones: 8 },
        Waveform::Decaying { amplitude, hertz, tau_s: 0.5 },
        Waveform::MoveAndRest { amplitude, move_s: 0.1, rest_s: 0.2 },
        Waveform::Step { amplitude, at_s: 0.5 },
    ] {
        let command = wave.command(2.0, 1);
        let most = command.iter().fold(0.0f64, |most, volts| most.max(volts.abs()));
        assert!(command.len() == 20_000 && command[0].abs() < 1e-9, "{wave:?}: {}", command[0]);
        assert!(most <= 12.0 + 1e-9 && most > 4.0, "{wave:?}: {most}");
    }
}

#[test]
fn what_has_changed_is_seen() {
    let plant = bare(Kind::BoucWen, 6);
    let wave = Waveform::Sine { amplitude: VOLTS, hertz: 1.0, offset: 0.0 };
    let of = |change: Change| plant.after(change).respond(&wave.command(3.0, 0));
    let whole = |positions: &[f64]| stroke(&positions[20_000..]);
    let new = of(Change::NONE);
    assert!((whole(&of(Change::load(0.25, 2.0))) / whole(&new) - 0.8).abs() < 1e-9);
    let warm = of(Change::warming(2.0));
    assert!(warm[29_999] - new[29_999] > 0.2, "it expands: {}", warm[29_999] - new[29_999]);
    let width = |positions: &[f64]| positions[25_000] - positions[20_000];
    let (aged, before) = (of(Change::ageing(0.1)), &new);
    assert!(whole(&aged) < 0.95 * whole(before));
    let relative = |positions: &[f64]| width(positions).abs() / whole(positions);
    assert!(relative(&aged) > 1.01 * relative(before), "{} {}", relative(&aged), relative(before));
}

#[test]
fn a_resonance_rings_and_a_slew_limit_holds() {
    let plant = bare(Kind::BoucWen, 7);
    let step = Waveform::Step { amplitude: 10.0, at_s: 0.01 }.command(0.5, 0);
    let ringing = Plant { resonance: Some(Resonance { hertz: 200.0, damping: 0.05 }), ..plant }.respond(&step);
    let (most, end) = (ringing.iter().copied().fold(f64::MIN, f64::max), ringing[ringing.len() - 1]);
    assert!(most > 1.5 * end, "{most} {end}");
    let slow = Plant { slew_v_per_s: Some(100.0), ..plant }.respond(&step);
    let there = slow.iter().position(|y| *y > 0.99 * slow[slow.len() - 1]).unwrap();
    assert!((900..1_200).contains(&there), "10 V at 100 V/s take 0.1 s: {there} steps");
}
