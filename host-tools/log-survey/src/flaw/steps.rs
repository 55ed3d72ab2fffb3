//! Where the sensor steps: the displacement goes on at another level, and the voltage does not step there, as where a
//! sensor was touched, an interferometer lost a fringe, or recordings with different zeros were joined.
//!
//! Straight lines through the rows on either side of two neighbours end in between at values that differ by the step; a
//! bend makes no difference, for it is the voltage's, too.

use super::leaps::EXPLAINED;
use crate::noise::noise_of;
use crate::signal::{ends, resolution};

/// Rows of a line, on either side.
pub(crate) const ROWS: usize = 8;
/// A step is over within so many rows on either side of where it is steepest.
pub(crate) const SPREAD: usize = 2;
/// It is this part of the stroke, or this where the voltage stands, since little else moves the displacement there,
const LEAST: f64 = 0.03;
const LEAST_STANDING: f64 = 0.008;
/// as it does where it goes over no more than this part of its range.
pub(crate) const STANDS: f64 = 0.01;
/// so many deviations of the noise,
const DEVIATIONS: f64 = 8.0;
/// so many times the least step between two rows, for a coarse sensor does nothing but step,
pub(crate) const RESOLUTIONS: f64 = 4.0;
/// and this many times whatever is like one near it.
const FURTHER: f64 = 4.0;
/// A displacement is behind its voltage by so many s at most.
pub(crate) const LATE_S: f64 = 0.05;
/// So many leaps that are alike are the actuator's, as of one that sticks and slips, or a simulated one of few relays.
const MANY: usize = 5;
/// Those are like a leap that are this part of it or more.
const ALIKE: f64 = 0.5;

/// The row before each step of the displacement, and how far it goes, µm, up or down. The rows are one a `period`, s;
/// voltage and displacement have these ranges.
pub fn steps(voltage: &[f64], displacement: &[f64], volts: f64, stroke: f64, period: f64) -> Vec<(usize, f64)> {
    let (measured, commanded) = (gaps(displacement), gaps(voltage));
    let noise = DEVIATIONS * noise_of(displacement).unwrap_or(0.0);
    let read = noise.max(RESOLUTIONS * resolution(displacement));
    let late = ((LATE_S / period) as usize).max(2 * ROWS);
    let largest = |gaps: &[f64], from: usize, end: usize| {
        let end = end.min(gaps.len());
        gaps[from.min(end)..end].iter().map(|gap| gap.abs()).fold(0.0, f64::max)
    };
    let early = |at: usize, rows: usize| at.saturating_sub(rows);
    let stands = |at: usize| {
        let (low, high) = ends(&voltage[early(at, late)..(at + 4 * ROWS).min(voltage.len())]);
        high - low <= STANDS * volts
    };
    let least = |at: usize| (if stands(at) { LEAST_STANDING } else { LEAST } * stroke).max(read);
    let unexplained = |&(at, gap): &(usize, f64)| {
        let gap = gap.abs();
        // Of two that are alike it is the first.
        let steepest =
            gap > largest(&measured, early(at, 2 * ROWS), at) && gap >= largest(&measured, at + 1, at + 2 * ROWS + 1);
        steepest && {
            let leap_v = largest(&commanded, early(at, late), at + 2 * ROWS);
            leap_v == 0.0 || gap * volts > EXPLAINED * stroke * leap_v
        }
    };
    // What a log begins with may follow a voltage before it.
    let seen = measured.iter().copied().enumerate().take(measured.len().saturating_sub(2 * ROWS)).skip(late);
    let large = |(_, gap): &(usize, f64)| gap.abs() > ALIKE * read.max(LEAST_STANDING * stroke);
    let leaps: Vec<(usize, f64)> = seen.filter(large).filter(unexplained).collect();
    let mut sizes: Vec<f64> = leaps.iter().map(|(_, gap)| gap.abs()).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let is_step = |&&(at, gap): &&(usize, f64)| {
        let before = largest(&measured, early(at, 4 * ROWS), early(at, 2 * ROWS));
        let behind = largest(&measured, at + 2 * ROWS + 1, at + 4 * ROWS + 1);
        let alike = sizes.len() - sizes.partition_point(|other| *other <= ALIKE * gap.abs());
        gap.abs() > least(at).max(FURTHER * before.max(behind)) && alike < MANY
    };
    let step = |&(at, _): &_| (at + ROWS - 1, gap(&displacement[at - SPREAD..at + 2 * ROWS + SPREAD], SPREAD));
    leaps.iter().filter(is_step).map(step).collect()
}

/// The gap between any two rows that have as many on either side; the first is between rows `ROWS - 1` and `ROWS`.
fn gaps(values: &[f64]) -> Vec<f64> {
    values.windows(2 * ROWS).map(|window| gap(window, 0)).collect()
}

/// What the straight line through the last rows is above that through the first, in their middle, which so many rows on
/// either side of it are left out of.
fn gap(values: &[f64], left_out: usize) -> f64 {
    end(values[ROWS + 2 * left_out..].iter(), left_out) - end(values[..ROWS].iter().rev(), left_out)
}

/// The straight line through so many values, half a row and so many more before the first of them.
fn end<'v>(values: impl Iterator<Item = &'v f64>, before: usize) -> f64 {
    let (rows, half) = (ROWS as f64, 0.5 * ROWS as f64);
    let squares = rows * (rows * rows - 1.0) / 12.0;
    let weight = |row: usize| 1.0 / rows - (half + before as f64) * (row as f64 + 0.5 - half) / squares;
    values.enumerate().map(|(row, value)| weight(row) * value).sum()
}

#[cfg(test)]
mod tests {
    use crate::flaw::{Flaw, flaws, in_rows, measured, sound};
    use plants::{CATALOGUE, Plant, Waveform};
    use recordings::log::Log;
    use recordings::prepare::PrepareOptions;
    use recordings::session::Session;

    /// A log with a sensor that steps by so many µm at a row, over so many rows.
    fn stepped(log: &Log, at: usize, leap_um: f64, over: usize) -> Log {
        let step = |(row, y): (usize, &f64)| {
            let part = (row + 1).saturating_sub(at).min(over) as f64 / over as f64;
            y + part * leap_um
        };
        Log {
            displacement: log.displacement.as_ref().map(|of| of.iter().enumerate().map(step).collect()),
            ..log.clone()
        }
    }

    fn largest_difference(a: &Session, b: &Session) -> f64 {
        let of = |(at, y): (&u32, &f64)| {
            let other = b.instants.binary_search(at).ok()?;
            Some((y - b.displacement[other]).abs())
        };
        a.instants.iter().zip(&a.displacement).filter_map(of).fold(0.0, f64::max)
    }

    #[test]
    fn a_step_of_the_sensor_is_found_and_taken_back_on_devices_of_every_class() {
        for (seed, kind) in (1u32..).zip(CATALOGUE) {
            let plant = Plant::drawn(kind, seed.into());
            let amplitude = 0.8 * plant.full_v;
            for waveform in [
                Waveform::Sine { amplitude, hertz: 1.0, offset: 0.0 },
                Waveform::Triangle { amplitude, hertz: 2.0, offset: 0.0 },
                Waveform::Staircase { amplitude, steps: 6, hold_s: 0.4 },
            ] {
                let clean = plant.log("log", &waveform, 2.0, seed.into());
                let at = (1.15 / clean.sample_period) as usize;
                let stroke = crate::stroke(&clean.voltage, clean.displacement.as_deref().unwrap(), 0.0);
                for (part, over) in [(0.08, 1), (-0.12, 1), (0.3, 2), (0.2, 3)] {
                    let leap = part * stroke;
                    let log = stepped(&clean, at, leap, over);
                    let found = flaws(&log);
                    let which = format!("{} on {waveform:?}, {leap} µm over {over}", kind.name());
                    let [Flaw::Step { at: rows, leap_um }] = found[..] else { panic!("{which}: {found:?}") };
                    let off = 0.1 * leap.abs() + 0.01 * stroke;
                    assert!((leap_um - leap).abs() < off, "{which}: {leap_um} µm");
                    let row = 0.5 * (rows.from_s + rows.to_s) / clean.sample_period;
                    assert!((row - at as f64).abs() < 2.0, "{which}: row {row} of {at}");
                    let recipe = PrepareOptions::default().resolve(&[sound(&log, &found)]);
                    let (whole, (mended, left_out)) =
                        (recipe.session(&clean).unwrap(), measured(&recipe, &log, &found).unwrap());
                    assert!(left_out.is_some_and(|count| (1..=8).contains(&count)), "{which}: {left_out:?}");
                    let largest = largest_difference(&mended, &whole);
                    assert!(largest < off, "{which}: {largest} µm");
                }
            }
        }
    }

    /// Less of the stroke than one in motion has to be, where the noise lets it.
    #[test]
    fn a_small_step_while_the_voltage_stands_is_found() {
        for (seed, kind) in (1u32..).zip(CATALOGUE) {
            let plant = Plant::drawn(kind, seed.into());
            let waveform = Waveform::Staircase { amplitude: 0.8 * plant.full_v, steps: 6, hold_s: 0.4 };
            let clean = plant.log("log", &waveform, 4.0, seed.into());
            assert_eq!(flaws(&clean), [], "{}", kind.name());
            let at = (2.2 / clean.sample_period) as usize;
            let displacement = clean.displacement.as_deref().unwrap();
            let stroke = crate::stroke(&clean.voltage, displacement, 0.0);
            let leap = (0.012 * stroke).max(16.0 * crate::noise_of(displacement).unwrap());
            let found = flaws(&stepped(&clean, at, leap, 1));
            let [Flaw::Step { leap_um, .. }] = found[..] else { panic!("{}, {leap} µm: {found:?}", kind.name()) };
            assert!((leap_um - leap).abs() < 0.3 * leap, "{}: {leap_um} µm of {leap} µm", kind.name());
        }
    }

    /// Too small for a glitch, and gone again within the rows by which a level is judged.
    #[test]
    fn a_small_bump_while_the_voltage_stands_is_no_step() {
        let volts = |row: usize| 20.0 * (row / 2_000) as f64;
        let voltage: Vec<f64> = (0..12_000).map(volts).collect();
        for rows in [20, 33, 41, 50, 60, 66] {
            let bump = |row: usize| if (5_000..5_000 + rows).contains(&row) { 0.2 } else { 0.0 };
            let read = |row: usize| 0.1 * volts(row) + bump(row) + 0.003 * f64::from([1, -1, 1, -1, -1, 1, 1][row % 7]);
            let displacement: Vec<f64> = (0..12_000).map(read).collect();
            assert!(!has_steps(&voltage, &displacement), "{rows} rows");
        }
    }

    fn has_steps(voltage: &[f64], displacement: &[f64]) -> bool {
        in_rows(voltage, displacement, 0.0, 5e-4).iter().any(|flaw| matches!(flaw, Flaw::Step { .. }))
    }

    /// At the start there may have been another voltage before.
    #[test]
    fn a_step_that_the_voltage_commands_is_none_at_once_late_or_where_the_log_begins() {
        let volts = |row: usize| 20.0 * libm::sin(row as f64 * 0.002) + if row >= 3_000 { 10.0 } else { 0.0 };
        for (late, begin) in [(0, 0), (6, 0), (80, 0), (80, 3_010)] {
            let voltage: Vec<f64> = (begin..begin + 6_000).map(volts).collect();
            let displacement: Vec<f64> = (begin..begin + 6_000).map(|row| 0.1 * volts(row - late.min(row))).collect();
            assert!(!has_steps(&voltage, &displacement), "{late} rows late from {begin}");
        }
    }

    /// The lines on either side of a row that is halfway are alike.
    #[test]
    fn a_step_with_a_row_halfway_is_one() {
        let voltage: Vec<f64> = (0..4_000).map(|row| 20.0 * (f64::from(row) * 1e-3).min(1.0)).collect();
        let step = |row: usize| {
            if row < 3_000 {
                2.5
            } else if row == 3_000 {
                6.5
            } else {
                10.5
            }
        };
        let displacement: Vec<f64> = voltage.iter().enumerate().map(|(row, v)| 0.1 * v + step(row)).collect();
        let found = in_rows(&voltage, &displacement, 0.0, 5e-4);
        assert!(matches!(found[..], [Flaw::Step { leap_um, .. }] if (leap_um - 8.0).abs() < 1e-6), "{found:?}");
    }

    #[test]
    fn a_coarse_sensor_that_does_nothing_but_step_has_none() {
        let voltage: Vec<f64> = (0..20_000).map(|row| 20.0 * libm::sin(f64::from(row) * 5e-4)).collect();
        for step_um in [0.1, 0.3, 1.0] {
            let displacement: Vec<f64> = voltage.iter().map(|v| (0.1 * v / step_um).round() * step_um).collect();
            assert!(!has_steps(&voltage, &displacement), "{step_um} µm");
        }
    }

    /// The uppermost of its levels is left in one row and another, as a glitch is.
    #[test]
    fn the_levels_of_a_coarse_sensor_are_no_glitches() {
        let voltage: Vec<f64> = (0..8_000).map(|row| 20.0 * libm::sin(f64::from(row) * 0.012_566)).collect();
        let displacement: Vec<f64> = voltage.iter().map(|v| (0.023 * v / 0.1).round() * 0.1).collect();
        assert_eq!(in_rows(&voltage, &displacement, 0.0, 1e-3), []);
    }
}
