//! A cycle of the emulated triangle, of noise, and on lines on which things go wrong.

use super::*;
use emulator::faults::{lose_samples_at, samples, silent_from};
use emulator::{Emulator, Fault, FaultyLine, Plant, TABLE, triangle};

/// Looks for a cycle for four seconds of the device.
fn found(plant: impl Plant, fault: impl Fault) -> Result<Cycle, CycleError> {
    let device = Emulator::new().plant(plant).speed(8.0).start().unwrap();
    let line = FaultyLine::to(device.address(), fault).unwrap();
    let (mut client, _) = Client::connect(&line.address().into()).unwrap();
    let request = CycleRequest::new(&TABLE.admit().unwrap(), 4.0);
    let found = over_cycle(&mut client, &request, &Interrupt::default(), &mut |_| {});
    assert_eq!(client.samples(Duration::from_millis(100)).unwrap(), None, "the stream was stopped");
    found
}

/// Lets `edit` change every sample after the first thousand.
fn after_a_thousand(edit: impl Fn(&mut Sample) + Send + 'static) -> impl Fault {
    let mut seen = 0;
    samples(move |batch| {
        if seen > 1000 {
            batch.samples.iter_mut().for_each(&edit);
        }
        seen += batch.samples.len();
        true
    })
}

fn sound(_: emulator::Direction, _: &mut Vec<u8>) {}

#[test]
fn the_mean_over_a_cycle_is_0_once_it_is_taken_off() {
    let device = Emulator::new().speed(8.0).start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let request = CycleRequest::new(&TABLE.admit().unwrap(), 4.0);
    let over_cycle = |client: &mut Client| {
        let cycle = over_cycle(client, &request, &Interrupt::default(), &mut |_| {}).unwrap();
        assert_eq!(cycle.ticks, 2_000, "the triangle's period");
        cycle
    };
    // The first may have the start in it.
    over_cycle(&mut client);
    let cycle = over_cycle(&mut client);
    assert_eq!(cycle.status, Status::empty());
    assert!(cycle.mean_um.abs() > 0.1 && cycle.voltage_v.span() > 1.0, "{cycle:?}");
    client.shift_bias(-cycle.mean_um as f32).unwrap();
    let mean_um = over_cycle(&mut client).mean_um;
    assert!(mean_um.abs() < 0.01, "{mean_um}");
}

#[test]
fn noise_at_a_flat_top_moves_neither_a_cycle_s_length_nor_its_mean() {
    let mut draw = 1u32;
    let mut noise = || {
        draw = draw.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(draw >> 8) / f64::from(1 << 24) - 0.5
    };
    let sine = |tick: u32| libm::cos(std::f64::consts::TAU * f64::from(tick) / 4_000.0 + 1.0);
    let voltage = (0..11_000).map(|tick| 50.0 + 50.0 * sine(tick) + noise()).collect();
    let estimated = (0..11_000).map(|tick| (5.0 + 5.0 * sine(tick)) as f32).collect();
    let heard = Heard { voltage, estimated, status: vec![Status::empty(); 11_000], last: None };
    let cycle = heard.cycle(1.0, 1).unwrap();
    assert!(cycle.ticks.abs_diff(4_000) < 20, "{cycle:?}");
    assert!((cycle.mean_um - 5.0).abs() < 2e-3, "{cycle:?}");
    let not_yet = Heard { voltage: heard.voltage[..6_200].to_vec(), ..heard };
    assert!(not_yet.cycle(1.0, 1).is_none());
}

#[test]
fn noise_at_rest_is_no_cycle() {
    let mut noise = 0;
    let rest = move |_| {
        noise = 1 - noise;
        AdcCode(30_000 + 20 * noise).into()
    };
    let error = found(rest, sound).unwrap_err();
    assert!(matches!(error, CycleError::NoCycle { span_v, .. } if span_v > 0.0), "{error}");
}

#[test]
fn what_is_not_whole_gives_no_mean() {
    let error = found(triangle(), lose_samples_at(1_000)).unwrap_err();
    assert!(matches!(error, CycleError::SamplesLost(lost) if lost > 0), "{error}");
    let error = found(triangle(), silent_from(1_000)).unwrap_err();
    assert!(matches!(error, CycleError::Silent), "{error}");
}

#[test]
fn what_is_not_sound_gives_no_mean() {
    let error = found(triangle(), after_a_thousand(|sample| sample.faults |= Faults::ADC_STUCK)).unwrap_err();
    assert!(matches!(error, CycleError::Faulty(Faults::ADC_STUCK)), "{error}");
    for bit in WORTHLESS {
        let said = after_a_thousand(move |sample| sample.status |= bit | Status::DAC_SATURATED);
        let error = found(triangle(), said).unwrap_err();
        assert!(matches!(error, CycleError::Worthless(only) if only == bit), "{bit:?}: {error}");
    }
    let late = after_a_thousand(|sample| {
        sample.faults |= Faults::MISSED_DEADLINE | Faults::SAFE_OUTPUT;
        sample.status |= Status::NOT_SETTLED;
    });
    assert_eq!(found(triangle(), late).unwrap().status, Status::NOT_SETTLED, "and is said");
}
