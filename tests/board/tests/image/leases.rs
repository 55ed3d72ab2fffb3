//! A host that vanishes: the modes that it has set end five seconds after its last frame, by a ramp where
//! the DAC drives.

use crate::common::{Bench, PERIOD, shown, valid_since};
use anyhow::{Result, ensure};
use estimator_core::*;
use protocol::{Mode, Reply, Request};

const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
const DRIVE: DriveCalibration =
    DriveCalibration { gain_codes_per_v: 1024.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
/// How long a mode lasts, s, and what is looked at before and after.
const LEASE: f64 = 5.0;
const ABOUT: f64 = 0.1;

/// A device in this mode; after that nobody has spoken.
fn left_in(mode: Mode) -> Result<Bench> {
    let mut bench = Bench::started()?;
    bench.does(Request::SetMode(mode))?;
    Ok(bench)
}

#[test]
fn pause_and_pil_end_when_nobody_speaks() -> Result<()> {
    for mode in [Mode::Pause, Mode::Pil] {
        let mut bench = left_in(mode)?;
        bench.run(LEASE - ABOUT)?;
        assert_eq!(valid_since(&bench.board, bench.board.clock() - 1000 * PERIOD), 0, "{mode:?}: not before");
        bench.run(2.0 * ABOUT)?;
        let clock = bench.board.clock();
        bench.run(0.5)?;
        assert!(valid_since(&bench.board, clock) > 950, "{mode:?}: it estimates");
        assert_eq!(bench.health()?.mode, Mode::Estimate, "{mode:?}");
    }
    Ok(())
}

#[test]
fn a_mode_lasts_as_long_as_somebody_speaks() -> Result<()> {
    let mut bench = left_in(Mode::Pause)?;
    for _ in 0..3 {
        bench.run(LEASE - ABOUT)?;
        assert_eq!(bench.health()?.mode, Mode::Pause);
    }
    // Noise is no word.
    bench.board.send(&[1, 2, 3, 0]);
    bench.run(LEASE / 2.0)?;
    bench.board.send(&[1, 2, 3, 0]);
    bench.run(LEASE / 2.0 + ABOUT)?;
    assert_eq!(bench.health()?.mode, Mode::Estimate);
    Ok(())
}

#[test]
fn a_drive_rests_and_its_mode_ends_but_where_it_is_to_stay() -> Result<()> {
    for (mode, hold, stays) in [
        (Mode::Follow, false, false),
        (Mode::Follow, true, true),
        // A host that is gone goes on with no session.
        (Mode::Excite, true, false),
    ] {
        let mut bench = Bench::started()?;
        let table = Table { drive: Some(DRIVE), ..*bench.table()? }.admit()?;
        bench.connect(&table, |volts| volts);
        bench.push(&table)?;
        bench.restart()?;
        bench.does(Request::SetMode(mode))?;
        let wanted = if mode == Mode::Follow { 30.0 } else { 2.0 };
        let references = [wanted; 64].iter().copied().collect();
        let reply = bench.ask(Request::Refer { first: 0, references, go: true, hold })?;
        ensure!(reply == Reply::Referred { next: 64, starved: 0 }, "{reply:?}");
        bench.run(0.5)?;
        let away = bench.board.output();
        bench.run(LEASE)?;
        let rest = DRIVE.code(LIMITS.rest_v, 4095).0;
        assert_eq!(bench.board.output(), if stays { away } else { Some(rest) }, "{mode:?}, {hold}");
        assert_ne!(away, Some(rest), "{mode:?}: it has moved");
        assert_eq!(bench.health()?.mode, if stays { mode } else { Mode::Estimate }, "{mode:?}, {hold}");
        let shown = shown(bench.board.record(), 0);
        let steps = shown.windows(2).map(|pair| pair[0].code.abs_diff(pair[1].code));
        // The table before, which drove nothing, moved as it liked.
        assert!(steps.rev().take(10_000).all(|step| step <= 328), "{mode:?}, {hold}");
    }
    Ok(())
}
