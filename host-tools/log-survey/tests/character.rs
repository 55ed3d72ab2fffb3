//! What logs exercise, of signals whose frequencies and amplitudes are known.

use log_survey::Character;
use recordings::session::Session;

fn session(voltage: Vec<f64>) -> Session {
    let count = voltage.len() as u32;
    Session::new("x".into(), voltage, (0..count).collect(), vec![0.0; count as usize], 1e-3)
}

fn sine(amplitude: f64, hertz: f64) -> Session {
    session((0..2000).map(|k| amplitude * (std::f64::consts::TAU * hertz * 1e-3 * f64::from(k)).sin()).collect())
}

#[test]
fn one_sine_is_one_frequency_and_one_amplitude() {
    let sessions = [sine(20.0, 5.0)];
    let character = Character::of(sessions.iter(), 0.02);
    assert_eq!(character.reversals, 20);
    assert!(character.single_amplitude() && character.single_frequency());
}

#[test]
fn two_frequencies_and_two_amplitudes_are_seen() {
    let frequencies = [sine(20.0, 5.0), sine(20.0, 50.0)];
    let character = Character::of(frequencies.iter(), 0.02);
    assert!(character.single_amplitude() && !character.single_frequency());
    let amplitudes = [sine(20.0, 5.0), sine(10.0, 5.0)];
    let character = Character::of(amplitudes.iter(), 0.02);
    assert!(!character.single_amplitude() && character.single_frequency());
}

#[test]
fn the_thesis_s_frequencies_are_several_though_most_half_cycles_are_fast() {
    let sessions = [sine(20.0, 1.0), sine(20.0, 100.0)];
    assert!(!Character::of(sessions.iter(), 0.02).single_frequency());
}

#[test]
fn a_square_wave_has_one_frequency_however_steep_it_is() {
    for ticks in [1, 2, 3] {
        let ramp = move |k: u32| f64::from((k % 1000).min(ticks)) / f64::from(ticks);
        let square: Vec<f64> = (0..8000).map(|k| if (k / 1000) % 2 == 0 { ramp(k) } else { 1.0 - ramp(k) }).collect();
        let character = Character::of([&session(square)].into_iter(), 0.02);
        assert!(character.single_frequency() && character.rests() && character.steps > 5, "{ticks}: {character:?}");
    }
}

/// Half a second at the lower end between one cycle and the next, and one in the middle.
#[test]
fn a_rest_is_no_second_frequency() {
    let cycle = |k: u32| 10.0 - 10.0 * (std::f64::consts::TAU * 1e-3 * f64::from(k)).cos();
    let rests = |at: f64, ticks: usize| std::iter::repeat_n(at, ticks);
    let cycles = |middle: usize| -> Vec<f64> {
        (0..6)
            .flat_map(|_| {
                (0..250).map(cycle).chain(rests(10.0, middle)).chain((250..1000).map(cycle)).chain(rests(0.0, 500))
            })
            .collect()
    };
    let characters = [0, 600].map(|middle| Character::of([&session(cycles(middle))].into_iter(), 0.02));
    let going_on = session((0..6000).map(cycle).collect());
    let without = Character::of([&going_on].into_iter(), 0.02);
    for rested in characters {
        assert!(rested.single_frequency() && rested.rests(), "{rested:?}");
    }
    assert!(without.single_frequency() && !without.rests());
    let slower = session((0..6000).map(|k| cycle(k / 3)).collect());
    let both = Character::of([&session(cycles(0)), &slower].into_iter(), 0.02);
    assert!(!both.single_frequency(), "a slower cycle is one");
}

#[test]
fn a_glitch_is_no_second_amplitude() {
    let mut glitched = sine(20.0, 5.0);
    for (volts, reversals) in [(1.5, 20), (6.0, 22)] {
        let before = glitched.voltage[1033];
        glitched.voltage[1033] -= volts;
        let character = Character::of([&glitched].into_iter(), 0.02);
        glitched.voltage[1033] = before;
        assert_eq!(character.reversals, reversals);
        assert!(character.single_amplitude() && character.single_frequency(), "{volts} V");
    }
}

#[test]
fn a_ramp_teaches_no_reversal() {
    let ramp = [session((0..100).map(f64::from).collect())];
    let character = Character::of(ramp.iter(), 0.02);
    assert!(character.reversals == 0 && character.single_amplitude() && character.single_frequency());
}

/// An amplifier that takes some milliseconds to each of the levels of a staircase.
#[test]
fn the_steps_of_a_staircase_are_counted_and_a_fast_sine_has_none() {
    let level = |k: u32| f64::from((k / 200).min(5)) * 20.0;
    let mut at = 0.0;
    let amplifier = (0..1600).map(|k| {
        at += 0.7 * (level(k) - at);
        at
    });
    let stairs = session(amplifier.collect());
    assert_eq!(Character::of([&stairs].into_iter(), 0.02).steps, 5);
    assert_eq!(Character::of([&sine(20.0, 80.0)].into_iter(), 0.02).steps, 0);
    // A slower one, of 25 ms a level.
    let slow =
        session((0..1600_u32).map(|k| (0..25).map(|back| level(k.saturating_sub(back))).sum::<f64>() / 25.0).collect());
    let character = Character::of([&slow].into_iter(), 0.02);
    assert_eq!((character.steps, character.fast_moves), (0, 5));
    assert_eq!(Character::of([&sine(20.0, 10.0)].into_iter(), 0.02).fast_moves, 0);
    // Read every 10 ms, a step shows no lag.
    let instants: Vec<u32> = (0..160).map(|k| 10 * k).collect();
    let seldom = Session::new("x".into(), stairs.voltage, instants, vec![0.0; 160], 1e-3);
    assert_eq!(Character::of([&seldom].into_iter(), 0.02).steps, 0);
}
