use super::*;
use crate::compiled::TABLE;

const FULL: u16 = TABLE.adc.full_scale;
/// Codes that the amplifier goes in a tick.
const SLEW: u16 = 1_000;
const NOISE_CODES: u16 = FULL / 96;
const TICKS: usize = TOO_LONG as usize;
/// What an open input reads.
const OPEN: u16 = 5_000;
const AT: u16 = 30_000;

/// What is made of a code.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Judged {
    code: AdcCode,
    status: Status,
    faults: Faults,
}

fn judge(leap: &mut Leap, code: u16, missed: u32) -> Judged {
    let code = leap.tick(AdcCode(code), missed);
    Judged { code, status: leap.status(), faults: leap.faults() }
}

fn leap(codes_per_tick: f32) -> Leap {
    let slew = codes_per_tick * TABLE.adc.gain_v_per_code / TABLE.sample_period::<f32>();
    Leap::new(&Table { amplifier_slew_v_per_s: Some(slew), ..TABLE }).unwrap()
}

/// One that has believed a code, and what it makes of those after it.
fn judged(codes: impl IntoIterator<Item = u16>) -> (Leap, Vec<Judged>) {
    // Rounding up adds one.
    let mut leap = leap(f32::from(SLEW) - 0.5);
    assert_eq!(judge(&mut leap, AT, 0), believed(AT));
    let judged = codes.into_iter().map(|code| judge(&mut leap, code, 0)).collect();
    (leap, judged)
}

fn believed(code: u16) -> Judged {
    Judged { code: AdcCode(code), status: Status::empty(), faults: Faults::empty() }
}

fn held(code: u16, lasting: bool) -> Judged {
    let faults = if lasting { Faults::SLEW_EXCEEDED } else { Faults::empty() };
    Judged { faults, ..back(code) }
}

/// A code that is believed while the estimate catches up.
fn back(code: u16) -> Judged {
    Judged { status: Status::SLEW_EXCEEDED, ..believed(code) }
}

/// A normal distribution's noise, of so many codes rms.
struct Gaussian {
    state: u32,
    rms: f64,
}

impl Gaussian {
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.state >> 8) / f64::from(1 << 24)
    }

    fn next(&mut self) -> f64 {
        let sum: f64 = (0..12).map(|_| self.uniform()).sum();
        self.rms * (sum - 6.0)
    }
}

#[test]
fn a_glitch_of_less_than_ten_milliseconds_is_held_and_one_that_stays_is_a_fault_that_stays() {
    for ticks in [1, 2, TICKS - 1] {
        for glitch in [AT + SLEW + NOISE_CODES + 1, AT - SLEW - NOISE_CODES - 1, 0, FULL] {
            let (_, judged) = judged([vec![glitch; ticks], vec![AT + SLEW; ticks + 1]].concat());
            let expected = [vec![held(AT, false); ticks], vec![back(AT + SLEW); ticks], vec![believed(AT + SLEW)]];
            assert_eq!(judged, expected.concat(), "{ticks}, {glitch}");
        }
    }
    let (_, judged) = judged([OPEN; 2_000]);
    assert!(judged[..TICKS - 1].iter().all(|&one| one == held(AT, false)));
    assert_eq!(judged[TICKS - 1], held(AT, true));
    assert!(judged[TICKS..].iter().all(|&one| one == held(OPEN, true)), "the present one, and a fault");
}

#[test]
fn a_wire_that_is_back_is_believed_after_ten_milliseconds_whatever_its_plug_did_before() {
    let bounces = [AT, OPEN, 17_000, AT, OPEN, 24_000, 9_000];
    for plugged in [&[][..], &bounces[..], &bounces[..3]] {
        let (mut leap, _) = judged([OPEN; 1_000]);
        for &code in plugged {
            assert_eq!(judge(&mut leap, code, 0).faults, Faults::SLEW_EXCEEDED);
        }
        // At the first it leaps.
        for k in 0..=TICKS as u16 {
            let judged = judge(&mut leap, AT + 10 * k, 0);
            assert_eq!((judged.code, judged.faults.is_empty()), (AdcCode(OPEN), k == TICKS as u16), "tick {k}");
        }
        let judged = judge(&mut leap, AT + SLEW, 0);
        assert_eq!((judged.code, judged.faults), (AdcCode(AT + SLEW), Faults::empty()));
        // And off again.
        for _ in 0..TICKS {
            judge(&mut leap, OPEN, 0);
        }
        assert_eq!(leap.faults(), Faults::SLEW_EXCEEDED);
    }
}

#[test]
fn a_glitch_on_a_wire_that_is_off_does_not_bring_it_back_nor_does_what_moves_slowly() {
    let (mut leap, _) = judged([OPEN; 1_000]);
    for glitch in [vec![FULL], vec![20_000, 40_000], vec![AT; TICKS]] {
        for code in [glitch, vec![OPEN; 100]].concat() {
            assert_eq!(judge(&mut leap, code, 0).faults, Faults::SLEW_EXCEEDED);
        }
    }
    for code in (OPEN..FULL).step_by(usize::from(SLEW)) {
        assert_eq!(judge(&mut leap, code, 0).faults, Faults::SLEW_EXCEEDED);
    }
}

#[test]
fn a_restart_believes_the_next_code_but_not_that_of_a_wire_that_is_off() {
    let (mut leap, _) = judged([OPEN; TICKS - 1]);
    leap.restart();
    assert_eq!(judge(&mut leap, OPEN, 0), believed(OPEN));
    let (mut leap, _) = judged([OPEN; 1_000]);
    leap.restart();
    assert_eq!(judge(&mut leap, OPEN, 0), held(OPEN, true));
    (0..TICKS).for_each(|_| _ = judge(&mut leap, AT, 0));
    assert_eq!(leap.faults(), Faults::SLEW_EXCEEDED, "the tick that leaps is none that stays");
    assert_eq!(judge(&mut leap, AT, 0).faults, Faults::empty());
}

#[test]
fn what_the_amplifier_can_do_is_believed_to_the_code() {
    let most = SLEW + NOISE_CODES;
    assert_eq!(judged([AT + most]).1, [believed(AT + most)]);
    assert_eq!(judged([AT - most - 1]).1, [held(AT, false)]);
}

#[test]
fn a_voltage_that_went_on_moving_meanwhile_is_believed_where_it_leaps_back_to() {
    for (ticks, way) in [(3, 4), (TOO_LONG as u16 - 1, TOO_LONG as u16)] {
        let most = AT + way * SLEW + NOISE_CODES;
        // And not where it is farther than the voltage can have gone.
        for (code, expected) in [(most, most), (most + 1, AT)] {
            let (_, judged) = judged([vec![2_000; ticks.into()], vec![code]].concat());
            assert_eq!(judged.last().map(|judged| judged.code), Some(AdcCode(expected)), "{ticks}, {code}");
        }
    }
    // One that drifts there does not leap: it must come as near as a tick's way.
    let (_, drifts) = judged((0..TICKS as u16 - 1).map(|k| 40_000 - 700 * k));
    assert_eq!(drifts.iter().take_while(|judged| judged.code == AdcCode(AT)).count(), 12);
}

#[test]
fn a_staircase_at_the_amplifiers_own_slew_rate_is_believed_with_any_noise_of_five_codes_of_twelve_bits() {
    for rms in [0.0, 1.0, 16.0, 5.0 * 16.0] {
        for slew in [1.0, 37.3, 1_000.0, 20_000.0] {
            let (mut leap, mut noise) = (leap(slew as f32), Gaussian { state: 1, rms });
            let (mut volts, mut way) = (30_000.0, slew);
            for k in 0..100_000 {
                if !(1_000.0..64_000.0).contains(&(volts + way)) {
                    way = -way;
                }
                volts += way;
                let code = (volts + noise.next()).round() as u16;
                assert_eq!(judge(&mut leap, code, 0), believed(code), "{rms}, {slew}, tick {k}");
            }
        }
    }
}

#[test]
fn ticks_that_did_not_come_let_it_go_farther() {
    for missed in [1u16, 5] {
        let most = (missed + 1) * SLEW + NOISE_CODES;
        for (way, sound) in [(most, true), (most + 1, false)] {
            let (mut leap, _) = judged([]);
            assert_eq!(judge(&mut leap, AT + way, missed.into()).status.is_empty(), sound, "{missed}");
        }
    }
    let (mut leap, _) = judged([]);
    assert_eq!(judge(&mut leap, 0, u32::MAX), believed(0));
}

#[test]
fn an_input_that_floats_is_a_fault_for_as_long_as_it_does() {
    let mut noise = Gaussian { state: 1, rms: 0.0 };
    let (_, judged) = judged((0..10_000).map(|_| (noise.uniform() * f64::from(FULL)) as u16));
    let first = judged.iter().position(|judged| !judged.faults.is_empty()).expect("a fault");
    assert!(first < 2 * TICKS, "{first}");
    assert!(judged[first..].iter().all(|judged| judged.faults == Faults::SLEW_EXCEEDED));
}

#[test]
fn what_leaps_a_tenth_of_the_time_is_no_fault() {
    let (_, judged) = judged((0..10_000).map(|k| if k % 10 == 9 { OPEN } else { AT }));
    assert_eq!(judged.iter().filter(|judged| !judged.status.is_empty()).count(), 1_999, "the tick after each as well");
    assert!(judged.iter().all(|judged| judged.code == AdcCode(AT) && judged.faults.is_empty()));
}

#[test]
fn nothing_is_held_where_nobody_says_how_fast_the_amplifier_is_nor_after_a_start() {
    assert!(Leap::new(&TABLE).is_none());
    let (mut leap, _) = judged([0; TICKS - 5]);
    leap.restart();
    assert_eq!(judge(&mut leap, 50_000, 0), believed(50_000));
    assert_eq!(judge(&mut leap, 0, 0), held(50_000, false));
}
