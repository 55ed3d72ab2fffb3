//! What the amplifier cannot do is not estimated from: a voltage that leaps farther than its slew rate allows is a glitch, or a wire
//! that is off, and would go through the model's memory of reversals.
//!
//! A code that is too far from the last that was believed is held: the estimator is given that last one instead. It is believed
//! again where it is back near that one; or where it leaps once more, to where the voltage can have gone meanwhile. Nothing else
//! ends it: a voltage that leaps once and stays is no amplifier's. An estimate that was given one voltage for a while and then the
//! present one takes as long to catch up, and the status says so as long. Held for [`TOO_LONG`] ticks in a row, or for more than a fifth
//! of the time as those of a floating input are, codes are a fault.
//!
//! The fault lasts for as long as the wire may be off: nothing but another leap shows that it is back. What comes meanwhile is
//! taken for the open input's. Codes that leap away from it, and for [`TOO_LONG`] ticks in a row neither leap nor come back, are the
//! wire's again. (The leap alone would not do: a plug bounces, a conversion amid a leap lies between the two, and a glitch on
//! an open wire leaps there and back.)

use crate::watch::score;
use estimator_core::table::LeastLeap;
use estimator_core::{AdcCode, Status, Table};
use protocol::Faults;

/// Held ticks in a row that are a fault: 10 ms.
pub const TOO_LONG: u32 = crate::rate::TICK_HZ / 100;

/// The codes so far.
#[derive(Clone, Debug)]
pub struct Leap {
    limit: LeastLeap,
    /// The last that was believed, or taken for the open input's; `None` before the first.
    believed: Option<AdcCode>,
    /// The last that came.
    came: AdcCode,
    /// Ticks since the one that was believed.
    ticks: u32,
    /// Ticks that the estimate takes to catch up.
    behind: u32,
    /// The wire may be off.
    off: bool,
    /// Of codes that are held; of a wire that may be off, ticks since it leapt to where it stays.
    score: u32,
    status: Status,
}

impl Leap {
    /// For a table's codes; `None` where it does not say how fast the amplifier is.
    pub fn new(table: &Table) -> Option<Self> {
        let limit = table.least_leap()?;
        let (believed, came, status) = (None, AdcCode(0), Status::empty());
        Some(Self { limit, believed, came, ticks: 0, behind: 0, off: false, score: 0, status })
    }

    /// The next code is believed, whatever it is.
    pub fn restart(&mut self) {
        (self.believed, self.off) = (None, false);
        (self.behind, self.score) = (0, 0);
        self.status = Status::empty();
    }

    /// [`Status::SLEW_EXCEEDED`], where the last code leapt, or codes that leapt were held no fewer ticks than have passed since.
    #[inline]
    pub fn status(&self) -> Status {
        self.status
    }

    /// [`Faults::SLEW_EXCEEDED`], where the wire may be off.
    #[inline]
    pub fn faults(&self) -> Faults {
        if self.off { Faults::SLEW_EXCEEDED } else { Faults::empty() }
    }

    /// One tick: the code to estimate from, of the one that came, before which so many ticks did not come. (Never inlined: a tick
    /// that has no use for it is not to pay for it.)
    #[inline(never)]
    pub fn tick(&mut self, code: AdcCode, missed: u32) -> AdcCode {
        let limit = self.limit;
        let step = missed.saturating_add(1);
        let ticks = self.ticks.saturating_add(step);
        let way = |from: AdcCode| u32::from(code.0.abs_diff(from.0));
        let farthest = limit.after(step);
        let leapt = way(self.came) > farthest;
        let sound = self.believed.is_none_or(|believed| {
            // An open input does not move as an amplifier does: from there the way of a tick is all.
            way(believed) <= farthest || (leapt && !self.off && way(believed) <= limit.after(ticks))
        });
        self.came = code;
        self.status.set(Status::SLEW_EXCEEDED, !sound || self.behind > 0);
        if sound {
            self.believed = Some(code);
            (self.ticks, self.behind) = (0, self.behind.saturating_sub(step));
        } else {
            (self.ticks, self.behind) = (ticks, self.behind.saturating_add(step));
        }
        let given = self.believed.unwrap_or(code);
        if self.turns(sound, leapt) {
            self.off = !self.off;
            (self.believed, self.ticks, self.score) = (Some(code), 0, 0);
        }
        given
    }

    /// Whether the wire is found to be off; or back, where it is.
    #[inline]
    fn turns(&mut self, sound: bool, leapt: bool) -> bool {
        if !self.off {
            return score(&mut self.score, !sound, TOO_LONG);
        }
        self.score = if sound || leapt { 0 } else { self.score + 1 };
        self.score >= TOO_LONG
    }
}

#[cfg(test)]
mod tests {
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

    /// What an open input reads.
    fn off(code: u16, status: Status) -> Judged {
        Judged { status, faults: Faults::SLEW_EXCEEDED, ..believed(code) }
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
        assert!(judged[TICKS..].iter().all(|one| *one == off(OPEN, one.status)), "the present one, and a fault");
        let catches_up = judged[TICKS..].iter().take_while(|one| !one.status.is_empty());
        assert_eq!(catches_up.count(), TICKS);
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
    fn a_restart_forgets_that_the_wire_is_off() {
        let (mut leap, _) = judged([OPEN; 1_000]);
        leap.restart();
        assert_eq!(judge(&mut leap, OPEN, 0), believed(OPEN));
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
        assert_eq!(
            judged.iter().filter(|judged| !judged.status.is_empty()).count(),
            1_999,
            "the tick after each as well"
        );
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
}
