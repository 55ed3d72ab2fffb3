//! The watch beside ticks that are odd.

use super::*;
use crate::ends::MARGIN;

const FULL: u16 = 65_520;
const GOOD: Status = Status::empty();

fn moving(k: u32) -> AdcCode {
    AdcCode(30_000 + (k % 2) as u16)
}

/// Ticks until a fault shows, and from its last cause until it has passed.
fn life(tick: impl Fn(u32) -> (AdcCode, Status, bool, bool)) -> (u32, Faults, u32) {
    life_of(|k| seen(tick(k)))
}

fn seen((monitor, status, late, astray): (AdcCode, Status, bool, bool)) -> Seen {
    Seen { monitor, setpoint: None, status, late_or_lost: late.into(), astray, faults: Faults::empty() }
}

/// The same of ticks of which more is seen.
fn life_of(tick: impl Fn(u32) -> Seen) -> (u32, Faults, u32) {
    let mut watch = Watch::new(FULL);
    let update = |watch: &mut Watch, seen: Seen| watch.update(seen);
    let good = |k| Seen { setpoint: Some(moving(k)), ..seen((moving(k), GOOD, false, false)) };
    let (after, faults) = (1..100_000)
        .find_map(|k| match update(&mut watch, tick(k)) {
            FaultState::Faulty(faults) => Some((k, faults)),
            _ => None,
        })
        .expect("a fault");
    let passed = (1..)
        .find(|&k| match update(&mut watch, good(k)) {
            FaultState::Healthy => panic!("it has not been said that it passed"),
            FaultState::Recovered(lasted) => {
                assert_eq!(lasted, faults);
                true
            }
            FaultState::Faulty(_) => false,
        })
        .expect("its end");
    assert_eq!(update(&mut watch, good(passed + 1)), FaultState::Healthy);
    (after, faults, passed)
}

#[test]
fn lasting_oddities_become_faults_and_pass_a_second_after_their_end() {
    let beyond = Status::VOLTAGE_OUT_OF_RANGE;
    for end in [0, FULL / MARGIN, FULL - FULL / MARGIN, FULL] {
        let at_the_end = |k| (AdcCode(end.saturating_add((k % 2) as u16).min(end)), GOOD, false, false);
        assert_eq!(life(at_the_end), (SATURATED, Faults::ADC_SATURATED, HOLD), "{end}");
    }
    assert_eq!(life(|k| (moving(k), beyond, false, false)), (OUT_OF_RANGE, Faults::OUT_OF_CALIBRATION, HOLD));
    assert_eq!(life(|k| (moving(k), GOOD, true, false)), (MISSED, Faults::MISSED_DEADLINE, HOLD));
    assert_eq!(life(|k| (moving(k), GOOD, false, true)), (ASTRAY, Faults::AMPLIFIER, HOLD));
    let stuck = life(|_| (AdcCode(7_000), GOOD, false, false));
    assert_eq!(stuck, (STUCK + 1, Faults::ADC_STUCK, HOLD), "the first code is no repetition");
}

#[test]
fn a_gap_in_the_ticks_is_as_long_a_fault_as_ticks_that_are_late_for_as_long() {
    let gap = |late_or_lost: u32| {
        let mut watch = Watch::new(FULL);
        let missing = Seen { late_or_lost, ..seen((moving(0), GOOD, false, false)) };
        (watch.update(missing), watch.deadline_missed())
    };
    assert_eq!(gap(MISSED - 1), (FaultState::Healthy, false));
    for late_or_lost in [MISSED, u32::MAX] {
        assert_eq!(gap(late_or_lost), (FaultState::Faulty(Faults::MISSED_DEADLINE), true));
    }
}

#[test]
fn what_is_clipped_a_third_of_the_time_is_found_and_a_tenth_is_not() {
    // A sine of 100 Hz: twenty ticks.
    let clipped = |part: u32| {
        move |k: u32| (AdcCode(if k % 20 < part { FULL } else { 30_000 + k as u16 % 2 }), GOOD, false, false)
    };
    let (after, faults, _) = life(clipped(7));
    assert!(faults == Faults::ADC_SATURATED && after < 4_000, "{after}");
    let mut watch = Watch::new(FULL);
    let tick = clipped(2);
    assert!((0..100_000).all(|k| { watch.update(seen(tick(k))) == FaultState::Healthy }));
}

#[test]
fn a_set_point_at_an_end_or_one_that_has_stopped_is_a_fault_where_it_matters() {
    let with = |k, code| Seen { setpoint: Some(AdcCode(code)), ..seen((moving(k), GOOD, false, false)) };
    for end in [0, FULL / MARGIN, FULL - FULL / MARGIN, FULL] {
        assert_eq!(life_of(|k| with(k, end)), (SATURATED, Faults::SETPOINT, HOLD), "{end}");
    }
    assert_eq!(life_of(|k| with(k, 7_000)), (SETPOINT_STUCK + 1, Faults::SETPOINT, HOLD));
    let mut watch = Watch::new(FULL);
    let unused = |k| seen((moving(k), GOOD, false, false));
    assert!((0..2 * SETPOINT_STUCK).all(|k| watch.update(unused(k)) == FaultState::Healthy));
}

/// Else a host that sets the mode again and again could drive an amplifier that does not follow for ever.
#[test]
fn modes_that_are_set_again_and_again_forget_nothing_of_an_amplifier_that_goes_astray() {
    let mut watch = Watch::new(FULL);
    let found = (0..3 * ASTRAY).find(|&k| {
        // For a tick in between, none that drives.
        let rests = k % (ASTRAY / 2) == 0;
        if rests {
            watch.change_mode();
        }
        watch.update(seen((moving(k), GOOD, false, !rests))) != FaultState::Healthy
    });
    assert!(found.is_some_and(|k| k < ASTRAY + 10), "{found:?}");
}

/// Else a controller that is off for hours would have whatever befell the monitor meanwhile last as long.
#[test]
fn each_fault_passes_a_second_after_its_own_cause_whatever_else_lasts() {
    for (lasting, begins_anew) in [(Faults::SETPOINT, true), (Faults::SLEW_EXCEEDED, false)] {
        let mut watch = Watch::new(FULL);
        let mut tick = |monitor: AdcCode| {
            let setpoint = (lasting == Faults::SETPOINT).then_some(AdcCode(0));
            let faults = lasting & Watch::KEPT;
            watch.update(Seen { setpoint, faults, ..seen((monitor, GOOD, false, false)) })
        };
        let both = lasting | Faults::ADC_SATURATED;
        assert_eq!((0..=SATURATED).map(|k| tick(moving(k))).last(), Some(FaultState::Faulty(lasting)));
        assert_eq!((0..=SATURATED).map(|_| tick(AdcCode(FULL))).last(), Some(FaultState::Faulty(both)));
        let states: Vec<FaultState> = (0..2 * HOLD).map(|k| tick(moving(k))).collect();
        let (still, later) = states.split_at(HOLD as usize);
        let at_its_end = if begins_anew { FaultState::Recovered(both) } else { FaultState::Faulty(both) };
        assert!(still.iter().all(|state| state.lasting() == both) && still.last() == Some(&at_its_end));
        assert!(later.iter().all(|state| *state == FaultState::Faulty(lasting)));
    }
}

#[test]
fn every_fault_that_is_found_passes() {
    let mut watch = Watch::new(FULL);
    let seen = |faults: Faults, bad: bool| Seen {
        monitor: AdcCode(if bad { FULL } else { 30_000 }),
        setpoint: bad.then_some(AdcCode(0)),
        status: if bad { Status::VOLTAGE_OUT_OF_RANGE } else { GOOD },
        late_or_lost: bad.into(),
        astray: bad,
        faults,
    };
    let found = (0..STUCK + OUT_OF_RANGE).map(|_| watch.update(seen(Faults::all(), true))).last();
    let of_watch = Faults::ADC_SATURATED
        | Faults::ADC_STUCK
        | Faults::OUT_OF_CALIBRATION
        | Faults::SETPOINT
        | Faults::MISSED_DEADLINE
        | Faults::AMPLIFIER;
    assert_eq!(found, Some(FaultState::Faulty(of_watch | Watch::KEPT)));
    // Scores fall by 1 a tick, and a code that moves has not stopped.
    let good = |k: u32| Seen { monitor: moving(k), ..seen(Faults::empty(), false) };
    let states: Vec<FaultState> = (0..ODD * OUT_OF_RANGE + 2 * HOLD).map(|k| watch.update(good(k))).collect();
    assert_eq!(states.last(), Some(&FaultState::Healthy));
}
