//! Plays against the native device, over lines that lose, damage and hesitate.

use super::*;
use crate::pages;
use crate::table::to_record;
use emulator::faults::{lose_samples_at, messages, replies};
use emulator::{Direction, Emulator, Fault, FaultyLine, Plant, TABLE, amplifier};
use estimator_core::{AdcCode, Admitted, DacCode, DriveCalibration, DriveLimits, Range, Table};
use parameter_store::RamFlash;
use protocol::{Refusal, Reply, Sample, ToHost};
use std::num::NonZeroU8;

const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
/// An amplifier of 0 … 4 V on the DAC's scale.
const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits: LIMITS, setpoint: None };

/// The device's own table, its DAC driving the amplifier.
fn driving() -> Admitted {
    Table { drive: Some(DRIVE), ..TABLE }.admit().unwrap()
}

fn wave() -> Vec<f32> {
    (0..1000).map(|k| 20.0 + 5.0 * (k as f32 * 0.02).sin()).collect()
}

fn sound(_: Direction, _: &mut Vec<u8>) {}

/// Follows the wave; the device's queue of references lasts for half a second.
fn run(plant: impl Plant, fault: impl Fault) -> Result<Followed, PlayError> {
    run_at(0.25, plant, fault)
}

fn run_at(speed: f64, plant: impl Plant, fault: impl Fault) -> Result<Followed, PlayError> {
    let flash = RamFlash::new(pages::with(&to_record(&driving()), 4096).unwrap());
    let device = Emulator::new().flash(flash).plant(plant).speed(speed).start().unwrap();
    let line = FaultyLine::to(device.address(), fault).unwrap();
    let (mut client, _) = Client::connect(&line.address().into()).unwrap();
    let wave = wave();
    followed(&mut client, &Play { mode: Mode::Follow, goes_on: None, references: &wave, hold: true, ticks: 1000 })
}

/// A play and its samples.
struct Followed {
    samples: Vec<Sample>,
    starved: u32,
    stopped: Faults,
    held: Held,
}

fn followed(client: &mut Client, of: &Play<'_>) -> Result<Followed, PlayError> {
    let mut samples = Vec::new();
    let Played { starved, stopped, held, .. } = play(client, of, &Interrupt::default(), &mut |of| {
        samples.push(of.sample);
        true
    })?;
    Ok(Followed { samples, starved, stopped, held })
}

#[test]
fn every_reference_gives_a_sample_and_the_voltage_of_the_core_s_inverse() {
    let followed = run(amplifier(DRIVE, TABLE.adc), sound).unwrap();
    assert_eq!((followed.samples.len(), followed.starved, followed.stopped), (1000, 0, Faults::empty()));
    let last = followed.samples.last().unwrap().displacement;
    assert!((last - (20.0 + 5.0 * (999f32 * 0.02).sin())).abs() < 1.0, "{last}");
    let mut inverse = driving().inverse::<f32>(&LIMITS).unwrap();
    for (tick, (sample, reference)) in followed.samples.iter().zip(wave()).enumerate() {
        let expected = DRIVE.code(inverse.tick(reference).voltage, TABLE.dac.full_scale);
        assert_eq!(DacCode(sample.dac), expected, "tick {tick}");
    }
}

#[test]
fn a_fault_ends_it_and_starved_ticks_are_told() {
    // The ADC is saturated from the 280th tick on at which the amplifier has moved: two ticks after the first reference
    // it begins to, and after twenty saturated ticks that is a fault.
    let (mut amplifier, mut moved) = (amplifier(DRIVE, TABLE.adc), 0);
    let rest = DRIVE.code(LIMITS.rest_v, TABLE.dac.full_scale);
    let breaks = move |dac| {
        moved += u32::from(moved > 0 || dac != rest);
        let conversion = amplifier.sample(dac);
        if moved < 280 { conversion } else { AdcCode(TABLE.adc.full_scale).into() }
    };
    let starves = messages(|message| match message {
        ToHost::Reply { to, reply: Reply::Referred { next, .. } } => {
            Some(ToHost::Reply { to, reply: Reply::Referred { next, starved: 7 } })
        }
        other => Some(other),
    });
    let followed = run(breaks, starves).unwrap();
    assert_eq!(followed.samples.len(), 300);
    assert_eq!((followed.starved, followed.stopped), (7, Faults::ADC_SATURATED | Faults::SAFE_OUTPUT));
}

#[test]
fn a_lost_reply_and_a_frame_that_comes_twice_cost_nothing() {
    // Of the replies to references, those to the first and to two in the midst of the wave.
    let (mut referred, mut twice) = (0, 0);
    let mut loses = replies(move |_, reply, frame| {
        if matches!(reply, Reply::Referred { .. }) {
            referred += 1;
            if [2, 7, 11].contains(&referred) {
                frame.clear();
            }
        }
    });
    let fault = move |direction, frame: &mut Vec<u8>| match direction {
        Direction::ToDevice => {
            // A frame of 64 references, its delimiter included.
            if frame.len() > 250 {
                twice += 1;
                if twice % 3 == 0 {
                    frame.extend_from_within(..);
                }
            }
        }
        Direction::ToHost => loses(direction, frame),
    };
    let followed = run(amplifier(DRIVE, TABLE.adc), fault).unwrap();
    assert_eq!((followed.samples.len(), followed.starved, followed.stopped), (1000, 0, Faults::empty()));
    let mut inverse = driving().inverse::<f32>(&LIMITS).unwrap();
    for (tick, (sample, reference)) in followed.samples.iter().zip(wave()).enumerate() {
        let expected = DRIVE.code(inverse.tick(reference).voltage, TABLE.dac.full_scale);
        assert_eq!(DacCode(sample.dac), expected, "tick {tick}");
    }
}

#[test]
fn a_line_that_hesitates_starves_the_drive_and_the_device_counts_it() {
    let mut requests = 0;
    let hesitates = move |direction, _: &mut Vec<u8>| {
        // Every request comes behind an empty frame. Connecting and starting takes some ten; four fill the queue.
        requests += u32::from(direction == Direction::ToDevice);
        if requests == 24 {
            requests += 1;
            // Longer than the queue of references lasts at this pace, and no reason to give a reply up for lost.
            std::thread::sleep(Duration::from_millis(150));
        }
    };
    let followed = run_at(2.0, amplifier(DRIVE, TABLE.adc), hesitates).unwrap();
    assert!(followed.starved > 0);
    assert_eq!((followed.samples.len(), followed.stopped), (1000 + followed.starved as usize, Faults::empty()));
}

#[test]
fn an_emulated_device_in_a_hurry_waits_for_a_busy_host_as_long_as_a_board_does() {
    let flash = RamFlash::new(pages::with(&to_record(&driving()), 4096).unwrap());
    let device = Emulator::new().flash(flash).plant(amplifier(DRIVE, TABLE.adc)).speed(16.0).start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let wave = wave();
    let of = Play { mode: Mode::Follow, goes_on: None, references: &wave, hold: true, ticks: 1000 };
    let mut taken = 0;
    let played = play(&mut client, &of, &Interrupt::default(), &mut |_| {
        taken += 1;
        // Six seconds of the device's, had it not waited.
        if taken == 300 {
            std::thread::sleep(Duration::from_millis(400));
        }
        true
    })
    .unwrap();
    assert!(played.starved > 0 && played.stopped.is_empty(), "{played:?}");
}

#[test]
fn a_host_that_is_kept_from_sending_while_the_samples_of_all_ticks_arrive_is_told_of_those_that_starved() {
    // Three replies are lost when 640 references are taken, and with them 60 ms each, 240 ticks at this pace: more than
    // the device's queue lasts, and than are left of those that are wanted.
    let mut lost = 0;
    let loses = messages(move |message| {
        let late = matches!(message, ToHost::Reply { reply: Reply::Referred { next: 640.., .. }, .. });
        lost += u32::from(late);
        (!late || lost > 3).then_some(message)
    });
    let followed = run_at(2.0, amplifier(DRIVE, TABLE.adc), loses).unwrap();
    assert!(followed.starved > 100 && followed.stopped.is_empty(), "{} starved", followed.starved);
    assert_eq!(followed.samples.len(), 1000 + followed.starved as usize);
}

#[test]
fn what_is_odd_before_the_first_reference_ends_nothing_but_an_unsafe_fault_does() {
    let sample = |faults| Sample {
        code: 1,
        sensor: None,
        displacement: 0.0,
        half_width: None,
        dac: 0,
        status: Default::default(),
        faults,
    };
    let from = |mut first, faults: &[Faults]| {
        let mut played = Played::default();
        let batch =
            Samples { first: 7, every: NonZeroU8::MIN, samples: faults.iter().map(|&faults| sample(faults)).collect() };
        played.take(&batch, &mut first, 10, &mut |_| true);
        (played.ticks, played.stopped)
    };
    let after = |faults: &[Faults]| from(None, faults);
    let safe = Faults::SAFE_OUTPUT;
    let none = Faults::empty();
    assert_eq!(after(&[safe, safe | Faults::MISSED_DEADLINE, safe, none, none]), (2, none));
    assert_eq!(after(&[safe, safe | Faults::ADC_STUCK, none]), (0, safe | Faults::ADC_STUCK));
    assert_eq!(after(&[none, Faults::MISSED_DEADLINE, safe]), (2, safe));
    // One that goes on from a hold does not wait at rest, and does not take what was held for its own.
    assert_eq!(from(Some(10), &[none, safe]), (0, safe));
    assert_eq!(from(Some(10), &[none; 5]), (2, none));
}

#[test]
fn a_device_without_a_drive_and_lost_samples_are_errors() {
    let device = Emulator::new().start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let one = Play { mode: Mode::Follow, goes_on: None, references: &[1.0], hold: true, ticks: 1 };
    let Err(refused) = followed(&mut client, &one) else { panic!("it followed") };
    let PlayError::Link(LinkError::Refused { refusal, .. }) = refused else { panic!("{refused}") };
    assert_eq!(*refusal, Refusal::NoDrive);
    let lost = run(amplifier(DRIVE, TABLE.adc), lose_samples_at(500)).err().unwrap().to_string();
    assert!(lost.contains("samples were lost"), "{lost}");
}

#[test]
fn voltages_go_out_as_they_are_and_a_second_play_goes_on_where_the_first_held() {
    let flash = RamFlash::new(pages::with(&to_record(&driving()), 4096).unwrap());
    let device = Emulator::new().flash(flash).plant(amplifier(DRIVE, TABLE.adc)).start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let (up, down): (Vec<f32>, Vec<f32>) =
        ((0..100).map(|k| 0.5 + 0.01 * k as f32).collect(), (0..100).map(|k| 1.49 - 0.01 * k as f32).collect());
    let excite = |references, goes_on| Play { mode: Mode::Excite, goes_on, references, hold: true, ticks: 100 };
    let first = followed(&mut client, &excite(&up, None)).unwrap();
    let driven = |sample: &Sample| DRIVE.voltage::<f32>(DacCode(sample.dac));
    for (tick, (sample, wanted)) in first.samples.iter().zip(&up).enumerate() {
        assert!((driven(sample) - wanted).abs() < 2e-3, "tick {tick}");
    }
    // Longer than a reference that is not to be held is waited for.
    std::thread::sleep(Duration::from_millis(1500));
    let second = followed(&mut client, &excite(&down, Some(first.held))).unwrap();
    assert!(second.stopped.is_empty());
    assert_eq!(second.samples.len(), 100 + second.starved as usize);
    // It goes on from where it stood, and its first row is of its first reference.
    for (tick, (sample, wanted)) in second.samples.iter().zip(&down).take(MOST_VALUES).enumerate() {
        assert!((driven(sample) - wanted).abs() < 2e-3, "tick {tick}: {} V, not {wanted} V", driven(sample));
    }
}

#[test]
fn whoever_takes_the_samples_may_have_enough() {
    let flash = RamFlash::new(pages::with(&to_record(&driving()), 4096).unwrap());
    let device = Emulator::new().flash(flash).plant(amplifier(DRIVE, TABLE.adc)).start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let wave = wave();
    let of = Play { mode: Mode::Follow, goes_on: None, references: &wave, hold: false, ticks: 1000 };
    let mut left = 50;
    let played = play(&mut client, &of, &Interrupt::default(), &mut |_| {
        left -= 1;
        left > 0
    })
    .unwrap();
    assert_eq!((played.ticks, played.enough), (50, true));
}
