//! Exchanged columns are told from everything that an actuator, its amplifier and its sensor do.

use log_survey::{Ahead, ahead};
use plants::{CATALOGUE, Instruments, Plant, Waveform};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use recordings::log::Log;
use recordings::rig::{EXCITATIONS, Rig};

/// Logs whose columns are the right ones: every kind of plant, driven in three ways, and the rig's slow logs.
fn sound() -> Vec<Log> {
    let sine = |hertz| Waveform::Sine { amplitude: 15.0, hertz, offset: 0.0 };
    let ways = [
        (sine(1.0), 12.0),
        (Waveform::Multisine { amplitude: 18.0, from_hz: 0.2, to_hz: 10.0, tones: 8 }, 20.0),
        (Waveform::Triangle { amplitude: 10.0, hertz: 10.0, offset: 5.0 }, 4.0),
        (Waveform::MoveAndRest { amplitude: 18.0, move_s: 0.2, rest_s: 0.5 }, 20.0),
        (Waveform::Decaying { amplitude: 19.0, hertz: 2.0, tau_s: 4.0 }, 12.0),
    ];
    let mut logs = Vec::new();
    for (device, kind) in (1..).zip(CATALOGUE) {
        let drift = Instruments { drift_nm_per_s: 50.0, ..Instruments::default() };
        let plant = Plant { instruments: drift, ..Plant::drawn(kind, device) };
        logs.extend(ways.iter().map(|(way, seconds)| plant.log(kind.name(), way, *seconds, device)));
    }
    for seed in 1..=4 {
        let rig = Rig { seed, duration: 6.0, ..Rig::default() };
        logs.extend([EXCITATIONS[0], EXCITATIONS[1], EXCITATIONS[3], EXCITATIONS[4]].map(|of| rig.log(of)));
    }
    logs
}

/// A narrow loop at 1 Hz among many at 10 Hz, 1 kHz: a fifteenth of the stroke at its widest.
fn narrow() -> Log {
    let hertz =
        [1.0, 1.0, 1.0, 10.0, 1.0, 1.0].into_iter().flat_map(|hertz| vec![hertz; if hertz > 1.0 { 40 } else { 1 }]);
    let voltage: Vec<f64> = hertz
        .flat_map(|hertz: f64| {
            let rows = (1e3 / hertz) as u32;
            (0..rows).map(move |row| 50.0 - 50.0 * libm::cos(std::f64::consts::TAU * f64::from(row) / f64::from(rows)))
        })
        .collect();
    let mut play = 0.0_f64;
    let displacement = voltage.iter().map(|volts| {
        play = play.clamp(volts - 3.5, volts + 3.5);
        0.1 * play
    });
    Log {
        name: "narrow".into(),
        path: "narrow".into(),
        sha256: String::new(),
        start_s: 0.0,
        sample_period: 1e-3,
        displacement: Some(displacement.collect()),
        voltage,
        displacement_estimated: false,
        holes: Vec::new(),
    }
}

#[test]
fn exchanged_columns_are_found_on_a_few_slow_loops_among_fast_ones() {
    assert_eq!(ahead(&narrow()), None);
    assert!(ahead(&exchanged(narrow())).is_some());
}

fn exchanged(log: Log) -> Log {
    let displacement = Some(log.voltage);
    Log { voltage: log.displacement.expect("it has one"), displacement, ..log }
}

#[test]
fn no_sound_log_runs_ahead() {
    for log in sound() {
        assert_eq!(ahead(&log), None, "{}", log.name);
    }
}

#[test]
fn a_voltage_that_is_read_a_tick_late_is_not_ahead() {
    for log in sound() {
        for rows in [1, 2] {
            let late = log.voltage.iter().take(rows).chain(&log.voltage).take(log.voltage.len()).copied().collect();
            let late = Log { voltage: late, ..log.clone() };
            assert_eq!(ahead(&late), None, "{}, {rows} rows", log.name);
        }
    }
}

#[test]
fn exchanged_columns_are_ahead_on_slow_loops_whichever_way_the_sensor_is_mounted() {
    for (device, kind) in (1..).zip(CATALOGUE) {
        let log = Plant::drawn(kind, device).log(
            kind.name(),
            &Waveform::Sine { amplitude: 18.0, hertz: 1.0, offset: 0.0 },
            12.0,
            device,
        );
        let found = ahead(&exchanged(log.clone()));
        assert!(found.is_some_and(|Ahead { percent, loops }| percent > 3.0 && loops >= 5), "{}: {found:?}", log.name);
        let falling = Log { displacement: log.displacement.clone().map(|y| y.iter().map(|y| -y).collect()), ..log };
        assert_eq!(ahead(&falling), None, "{}", falling.name);
        assert!(ahead(&exchanged(falling)).is_some(), "{}", kind.name());
    }
}

#[test]
fn the_noise_of_a_sensor_without_hysteresis_is_not_ahead() {
    for seed in 0..40 {
        let mut draw = ChaCha8Rng::seed_from_u64(seed);
        let noise = Normal::new(0.0, 0.3).unwrap();
        let hertz = [0.5, 1.0, 5.0][seed as usize % 3];
        let voltage: Vec<f64> = (0..12_000)
            .map(|row| 50.0 - 50.0 * libm::cos(std::f64::consts::TAU * hertz * f64::from(row) * 1e-3))
            .collect();
        let displacement = voltage.iter().map(|volts| 0.1 * volts + noise.sample(&mut draw)).collect();
        let log = Log {
            name: "linear".into(),
            path: "linear".into(),
            sha256: String::new(),
            start_s: 0.0,
            sample_period: 1e-3,
            voltage,
            displacement: Some(displacement),
            displacement_estimated: false,
            holes: Vec::new(),
        };
        assert_eq!([ahead(&log), ahead(&exchanged(log))], [None, None], "{seed}");
    }
}
