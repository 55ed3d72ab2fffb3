//! Logs without flaws, and with flaws put in.

use super::*;
use plants::{CATALOGUE, Plant, Waveform};
use recordings::log::{ReadOptions, read};
use recordings::prepare::PrepareOptions;
use recordings::rig::{EXCITATIONS, Rig};
use recordings::session::Session;
use std::path::Path;

fn log() -> Log {
    Rig { duration: 0.5, ..Rig::default() }.log(EXCITATIONS[1])
}

fn changed(change: impl Fn(usize, f64, f64) -> (f64, f64)) -> Log {
    let mut log = log();
    let displacement = log.displacement.take().unwrap();
    let changed = log.voltage.iter().zip(&displacement).enumerate().map(|(row, (&v, &y))| change(row, v, y));
    let (voltage, displacement): (Vec<f64>, Vec<f64>) = changed.unzip();
    Log { voltage, displacement: Some(displacement), ..log }
}

#[test]
fn logs_as_they_should_be_have_none() {
    for seed in 1..=20 {
        for excitation in EXCITATIONS {
            let log = Rig { duration: 0.5, seed, ..Rig::default() }.log(excitation);
            assert_eq!(flaws(&log), [], "{} of seed {seed}", excitation.name);
        }
    }
}

/// Stairs, holds and noise among them.
#[test]
fn devices_of_other_classes_have_none_either() {
    for (seed, kind) in (1u32..).zip(CATALOGUE) {
        let plant = Plant::drawn(kind, seed.into());
        let amplitude = 0.8 * plant.full_v;
        for waveform in [
            Waveform::Sine { amplitude, hertz: 100.0, offset: 0.0 },
            Waveform::AmplitudeModulated { amplitude, hertz: 5.0, swell_hz: 0.5 },
            Waveform::Triangle { amplitude, hertz: 20.0, offset: 0.0 },
            Waveform::Staircase { amplitude, steps: 6, hold_s: 0.1 },
            Waveform::Staircase { amplitude, steps: 1, hold_s: 0.3 },
            Waveform::Staircase { amplitude, steps: 1, hold_s: 0.01 },
            Waveform::Staircase { amplitude, steps: 40, hold_s: 0.004 },
            Waveform::Multisine { amplitude, from_hz: 1.0, to_hz: 40.0, tones: 12 },
        ] {
            let log = plant.log("log", &waveform, 2.0, seed.into());
            assert_eq!(flaws(&log), [], "{} on {waveform:?}", kind.name());
        }
    }
}

#[test]
fn spikes_are_found_one_by_one() {
    let spiky = changed(|row, v, y| (v, if [300, 700, 701].contains(&row) { y + 20.0 } else { y }));
    let found = flaws(&spiky);
    let rows = |flaw: &Flaw| {
        let Stretch { from_s, to_s } = flaw.at();
        [from_s, to_s].map(|time| (time / spiky.sample_period).round() as usize)
    };
    assert_eq!(found.iter().map(rows).collect::<Vec<_>>(), [[300, 300], [700, 701]]);
    assert!(found.iter().all(|flaw| matches!(flaw, Flaw::Spike { leap_um, .. } if (leap_um - 20.0).abs() < 1.0)));
}

/// At a crest each of two spikes has a step that is steeper than what is beside it.
#[test]
fn what_lies_between_two_spikes_is_sound() {
    let voltage: Vec<f64> = (0..4_000).map(|row| 20.0 - 20.0 * (f64::from(row) * 0.003_141_6).cos()).collect();
    let noise = |row: usize| 0.002 * f64::from([1, -1, 0, 1, -1, 1, 0][row % 7]);
    let spike = |row: usize| if [980, 1_020, 3_000, 3_040, 3_080].contains(&row) { 2.0 } else { 0.0 };
    let displacement: Vec<f64> = voltage.iter().enumerate().map(|(row, v)| 0.3 * v + noise(row) + spike(row)).collect();
    let found = in_rows(&voltage, &displacement, 0.0, 5e-4);
    let rows: Vec<usize> = found.iter().map(|flaw| (flaw.at().from_s / 5e-4).round() as usize).collect();
    assert_eq!(rows, [980, 1_020, 3_000, 3_040, 3_080], "{found:?}");
    assert!(found.iter().all(|flaw| flaw.at().from_s == flaw.at().to_s), "{found:?}");
}

/// As a last line cut in mid-number has it.
#[test]
fn a_leap_at_either_end_need_not_come_back() {
    let last = log().voltage.len() - 1;
    for rows in [last..last + 1, last - 2..last + 1, 0..1, 0..2] {
        let leaps = changed(|row, v, y| (v, if rows.contains(&row) { y - 15.0 } else { y }));
        let found = flaws(&leaps);
        let [Flaw::Spike { at, leap_um, back: false }] = found[..] else { panic!("{rows:?}: {found:?}") };
        let row = |time: f64| (time / leaps.sample_period).round() as usize;
        assert_eq!(row(at.from_s)..row(at.to_s) + 1, rows, "{found:?}");
        assert!((leap_um - 15.0).abs() < 1.0, "{rows:?}: {found:?}");
        let recipe = PrepareOptions { tick_us: 100, ..PrepareOptions::default() }.resolve(&[sound(&leaps, &found)]);
        let clean = recipe.session(&log()).unwrap();
        let mut session = recipe.session(&leaps).unwrap();
        let off = |session: &Session| {
            let pairs = session.instants.iter().zip(&session.displacement);
            let off = pairs.map(|(&at, y)| (y - clean.displacement[clean.instants.binary_search(&at).unwrap()]).abs());
            off.fold(0.0, f64::max)
        };
        assert!(off(&session) > 5.0, "{rows:?}");
        assert!(
            leave_out(&mut session, &found, 0.0) > Some(0) && session.instants[0] == 0 && off(&session) < 1.0,
            "{rows:?}"
        );
    }
}

/// Two broken rows that leap away from each other, too, whether the last of them comes near the sound ones or not.
#[test]
fn broken_rows_at_an_end_are_found_whole() {
    let last = log().voltage.len() - 1;
    for leap in [[90.0, 40.0], [90.0, 25.0]] {
        let leaps = changed(|row, v, y| (v, if row + 1 >= last { y + leap[row + 1 - last] } else { y }));
        let found = flaws(&leaps);
        let [Flaw::Spike { at, back: false, .. }] = found[..] else { panic!("{leap:?}: {found:?}") };
        assert!((at.to_s - at.from_s - leaps.sample_period).abs() < 1e-9, "{leap:?}: {found:?}");
    }
}

/// The voltage leaps, too, or had leapt before the log began.
#[test]
fn a_leap_at_either_end_that_the_voltage_explains_is_none() {
    let last = log().voltage.len() - 1;
    let ends_with_a_step = changed(|row, v, y| if row >= last - 2 { (v - 40.0, y - 15.0) } else { (v, y) });
    assert_eq!(flaws(&ends_with_a_step), []);
    let switched_on = changed(|row, v, y| (v + 60.0, if row < 2 { y - 15.0 } else { y }));
    assert_eq!(flaws(&switched_on), []);
}

#[test]
fn a_sensor_that_stands_still_or_is_cut_off_is_found_and_so_is_a_voltage() {
    let stopped = changed(|row, v, y| (v, if (200..500).contains(&row) { 1.25 } else { y }));
    assert!(matches!(flaws(&stopped)[..], [Flaw::Frozen { voltage_v, .. }] if voltage_v > 10.0));
    let top = ends(&log().displacement.unwrap()).1;
    let beyond = changed(|_, v, y| (v, y.min(0.6 * top)));
    assert!(flaws(&beyond).iter().all(|flaw| matches!(flaw, Flaw::Frozen { .. })) && !flaws(&beyond).is_empty());
    let cut = changed(|_, v, y| (v.min(12.0), y));
    let found = flaws(&cut);
    assert!(!found.is_empty() && found.iter().all(|flaw| matches!(flaw, Flaw::Clipped { voltage_v: 12.0, .. })));
}

/// As an amplifier at its rail is read by a converter, which has steps and noise of its own.
#[test]
fn a_sensor_that_is_cut_off_at_either_end_is_found_beneath_its_noise() {
    let whole = log();
    let (low, high) = ends(whole.displacement.as_ref().unwrap());
    let step = 1e-4 * (high - low);
    for (least, most) in [(low, 0.7 * high), (0.7 * low, high)] {
        let cut = changed(|row, v, y| (v, y.clamp(least, most) + step * (row * 7 % 5) as f64));
        let found = flaws(&cut);
        assert!(!found.is_empty(), "{least} … {most} µm");
        for flaw in found {
            let Flaw::Frozen { at, voltage_v } = flaw else { panic!("{flaw:?}") };
            let row = |time: f64| (time / whole.sample_period).round() as usize;
            let sound = &whole.displacement.as_ref().unwrap()[row(at.from_s)..=row(at.to_s)];
            let beyond = sound.iter().filter(|y| !(least..=most).contains(*y)).count();
            assert!(voltage_v > 1.0 && 10 * beyond > 8 * sound.len(), "{flaw:?}: {beyond} of {}", sound.len());
        }
    }
    assert_eq!(flaws(&changed(|row, v, y| (v, y + step * (row * 7 % 5) as f64))), []);
}

#[test]
fn a_hold_after_which_the_actuator_rings_is_none() {
    let rings = |row: usize| 40.0 - 40.0 * libm::exp(-(row as f64) / 60.0) * libm::cos(row as f64 * 0.3);
    let rows = 0..4000;
    let voltage = rows.clone().map(|row| if row % 1000 < 500 { 100.0 } else { 0.0 }).collect();
    let step = |row: usize| if row % 1000 < 500 { rings(row % 1000) } else { 40.0 - rings(row % 1000 - 500) };
    let ringing = Log { voltage, displacement: Some(rows.map(step).collect()), ..log() };
    assert_eq!(flaws(&ringing), []);
}

#[test]
fn what_is_left_out_is_what_was_measured_there() {
    let spiky = changed(|row, v, y| (v, if row == 300 { y + 20.0 } else { y }));
    let flaws = flaws(&spiky);
    assert_eq!(sound(&spiky, &flaws).voltage.len(), spiky.voltage.len() - 1);
    let recipe = PrepareOptions::default().resolve(std::slice::from_ref(&spiky));
    let whole = recipe.session(&spiky).unwrap();
    let mut session = Session { lead_in: 100, ..whole.clone() };
    let left_out = leave_out(&mut session, &flaws, 0.0).unwrap();
    assert!((1..=3).contains(&left_out), "{left_out}");
    assert_eq!(session.instants.len() + left_out, whole.instants.len());
    assert_eq!((session.instants.len(), &session.voltage), (session.displacement.len(), &whole.voltage));
    let largest = |session: &Session| ends(&session.displacement).1;
    assert!(largest(&whole) - largest(&session) > 10.0);
    // Of a log that is nothing but flaws nothing is left out.
    let all = [Flaw::Frozen { at: Stretch { from_s: 0.0, to_s: 1e3 }, voltage_v: 1.0 }];
    assert_eq!(leave_out(&mut session.clone(), &all, 0.0), None);
    // A late sensor shows the spike later than the tick that it stands at.
    let late = recordings::prepare::Recipe { delay_ticks: 20, ..recipe };
    let mut session = late.session(&spiky).unwrap();
    assert!(leave_out(&mut session, &flaws, 20.0 * late.tick_s()) > Some(0));
    assert!(largest(&whole) - largest(&session) > 10.0);
}

#[test]
fn the_measured_logs_have_none() {
    for name in ["picma-p885-1hz.csv", "picma-p885-session2.csv"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(name);
        let log = read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(flaws(&log), [], "{name}");
        let displacement = log.displacement.as_deref().unwrap();
        assert_eq!(crate::stroke(&log.voltage, displacement, 0.0), extent(displacement), "{name}");
    }
}

fn rows_of(flaw: &Flaw, log: &Log) -> [usize; 2] {
    let Stretch { from_s, to_s } = flaw.at();
    [from_s, to_s].map(|time| (time / log.sample_period).round() as usize)
}

#[test]
fn spikes_of_the_voltage_are_found_where_the_displacement_does_not_go_along() {
    for excitation in EXCITATIONS {
        let clean = Rig { duration: 0.5, ..Rig::default() }.log(excitation);
        let last = clean.voltage.len() - 1;
        for leap_v in [-300.0, 25.0] {
            let voltage: Vec<f64> = clean
                .voltage
                .iter()
                .enumerate()
                .map(|(row, v)| if [300, 700, 701, last].contains(&row) { v + leap_v } else { *v })
                .collect();
            let spiky = Log { voltage, ..clean.clone() };
            let found = flaws(&spiky);
            let rows: Vec<_> = found.iter().map(|flaw| rows_of(flaw, &spiky)).collect();
            assert_eq!(rows, [[300, 300], [700, 701], [last, last]], "{} and {leap_v} V", excitation.name);
            assert!(
                found.iter().all(
                    |flaw| matches!(flaw, Flaw::VoltageSpike { leap_v: of, .. } if (of - leap_v.abs()).abs() < 3.0)
                ),
                "{found:?}"
            );
            let mended = mended(&spiky, &found);
            let off = mended.voltage.iter().zip(&clean.voltage).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1.5, "{}: {off} V", excitation.name);
            assert_eq!(mended.displacement, clean.displacement);
        }
    }
}

/// What is commanded shows in the displacement, at once or soon; what is broken in both columns is found in both.
#[test]
fn a_short_pulse_that_the_displacement_follows_is_no_spike_of_the_voltage() {
    let pulse = 3_000..3_003;
    let follows = changed(|row, v, y| {
        let behind = if row < pulse.start + 1 { 0.0 } else { 6.0 * libm::exp(-((row - pulse.start - 1) as f64) / 8.0) };
        (if pulse.contains(&row) { v + 30.0 } else { v }, y + behind)
    });
    assert!(flaws(&follows).iter().all(|flaw| !matches!(flaw, Flaw::VoltageSpike { .. })), "{:?}", flaws(&follows));
    // A log that is slow beside the actuator.
    let at_once = changed(|row, v, y| if pulse.contains(&row) { (v + 30.0, y + 6.0) } else { (v, y) });
    assert_eq!(flaws(&at_once), []);
    let broken = changed(|row, v, y| if row == 3_000 { (v + 900.0, y + 900.0) } else { (v, y) });
    let kinds = flaws(&broken);
    assert!(matches!(kinds[..], [Flaw::Spike { .. }, Flaw::VoltageSpike { .. }]), "{kinds:?}");
}

/// The displacement has not gone along by then. A line that is cut in mid-number ends elsewhere.
#[test]
fn a_drive_that_was_switched_off_in_the_last_row_is_no_spike() {
    let last = log().voltage.len() - 1;
    let ends_at = |offset: f64, end: f64| {
        flaws(&changed(|row, v, y| {
            (if row == last { end } else { v + offset + if row + 200 > last { 30.0 } else { 0.0 } }, y)
        }))
    };
    assert_eq!(ends_at(0.0, 0.0), []);
    assert_eq!(ends_at(60.0, 60.0), [], "where it began");
    assert_eq!(ends_at(60.0, 0.0), []);
    let cut = ends_at(60.0, 9.0);
    assert!(matches!(cut[..], [Flaw::VoltageSpike { .. }]), "{cut:?}");
}

#[test]
fn what_was_seen_at_a_spike_of_the_voltage_is_left_out_and_the_voltage_is_run_through_between_its_neighbours() {
    let spiky = changed(|row, v, y| (if row == 300 { v + 200.0 } else { v }, y));
    let flaws = flaws(&spiky);
    let recipe = PrepareOptions { tick_us: 100, ..PrepareOptions::default() }.resolve(&[sound(&spiky, &flaws)]);
    let (clean, whole) = (recipe.session(&log()).unwrap(), recipe.session(&spiky).unwrap());
    // A late sensor shows at the spike's own time what happened before it.
    for delay_ticks in [0, 20] {
        let late = recordings::prepare::Recipe { delay_ticks, ..recipe.clone() };
        let mut session = late.session(&mended(&spiky, &flaws)).unwrap();
        let delay_s = f64::from(delay_ticks) * late.tick_s();
        // Brought to the tick, it is a tick of the two beside it at most.
        assert!(leave_out(&mut session, &flaws, delay_s).is_some_and(|count| (1..=2).contains(&count)));
        assert!(!session.instants.contains(&300), "the voltage's own instant, a sensor late by {delay_ticks} ticks");
        assert!((session.voltage[300] - clean.voltage[300]).abs() < 0.5 && whole.voltage[300] > 150.0);
    }
}

/// Rows that a recorder lost, with time stamps that go on as if it had not.
fn without_rows(log: &Log, lost: Range<usize>) -> Log {
    let rest = |values: &[f64]| [&values[..lost.start], &values[lost.end..]].concat();
    Log { voltage: rest(&log.voltage), displacement: log.displacement.as_deref().map(rest), ..log.clone() }
}

#[test]
fn lost_samples_are_suspected_where_both_leap_and_go_on() {
    for (excitation, from) in [(EXCITATIONS[0], 500), (EXCITATIONS[1], 1_200), (EXCITATIONS[4], 1_210)] {
        let lost = without_rows(&Rig { duration: 0.5, ..Rig::default() }.log(excitation), from..from + 200);
        let found = flaws(&lost);
        let [Flaw::Missing { leap_v, leap_um, .. }] = found[..] else { panic!("{}: {found:?}", excitation.name) };
        assert_eq!(rows_of(&found[0], &lost), [from - 1, from], "{}", excitation.name);
        assert!(leap_v > 1.0 && leap_um > 0.2, "{found:?}");
        assert!(!found[0].repairable());
        let recipe = PrepareOptions::default().resolve(std::slice::from_ref(&lost));
        assert_eq!(
            leave_out(&mut recipe.session(&lost).unwrap(), &found, 0.0),
            Some(0),
            "nothing there can be left out"
        );
    }
    for kind in CATALOGUE {
        let plant = Plant::drawn(kind, 3);
        let sine = Waveform::Sine { amplitude: 0.8 * plant.full_v, hertz: 1.0, offset: 0.0 };
        let whole = plant.log("log", &sine, 3.0, 3);
        let rows = (0.1 / whole.sample_period) as usize;
        let lost = without_rows(&whole, 8 * rows..10 * rows);
        assert!(matches!(flaws(&lost)[..], [Flaw::Missing { .. }]), "{}: {:?}", kind.name(), flaws(&lost));
    }
}

/// A displacement that follows at once, as of a log that is slow beside the actuator.
#[test]
fn what_a_drive_leaps_by_is_no_loss_of_samples() {
    let of = |volts: &dyn Fn(f64) -> f64| {
        let voltage: Vec<f64> = (0..4_000).map(|row| volts(f64::from(row))).collect();
        let mut draw = 1_u64;
        let mut noise = || {
            draw = draw * 48_271 % 2_147_483_647;
            draw as f64 / 2_147_483_647.0 - 0.5
        };
        let displacement = voltage.iter().map(|v| 0.1 * v + 0.002 * noise()).collect();
        flaws(&Log { voltage, displacement: Some(displacement), ..log() })
    };
    let sine = |row: f64| 40.0 * libm::sin(row * 0.005);
    assert_eq!(of(&|row| 10.0 * (row / 500.0).floor()), [], "stairs up");
    assert_eq!(of(&|row| if row < 2_000.0 { 0.0 } else { 50.0 }), [], "one step");
    assert_eq!(of(&|row| if row < 2_000.0 { 20.0 } else { sine(row) }), [], "a step from rest into a sine");
    assert_eq!(of(&|row| sine(row) + if row % 1_000.0 < 500.0 { 30.0 } else { 0.0 }), [], "steps on a sine");
    assert_eq!(of(&|row| (row % 1_300.0) * 0.05), [], "a sawtooth");
    assert_eq!(of(&|row| if row < 2_500.0 { row * 0.02 } else { (row - 2_500.0) * 0.02 }), [], "one flyback");
    let leaps = of(&|row| if row < 1_700.0 { sine(row) } else { sine(row + 200.0) });
    assert!(matches!(leaps[..], [Flaw::Missing { .. }]), "{leaps:?}");
}
