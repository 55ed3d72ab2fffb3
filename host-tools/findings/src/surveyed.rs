//! What was understood of a log before anything is fitted to it, in words.

use crate::doubt::{implausible, runs_ahead};
use crate::flaw::{TOO_MANY_HOLES, flaw_found};
use crate::recipe::monitor_asked;
use crate::short::short;
use estimator_core::Range;
use log_survey::{Cell, Clock, ColumnRead, Flaw, Found, HumRead, RESTS_S, RateSource, Series, Survey};
use recordings::log::{Log, Remark};

/// Rows that are further apart are doubted, s: nothing but creep is recorded so slowly.
const SELDOM_S: f64 = 0.1;
/// Logs that last no longer are doubted, s: a cycle of 10 Hz.
const BRIEF_S: f64 = 0.1;
/// Fewest rows at an end of the range that look like a rest or saturation.
const REST: u64 = 8;
/// Smallest part of a mean half cycle that does: a sine's crest, rounded, is one number for less.
const PART_OF_A_HALF_CYCLE: u64 = 20;

/// What a displacement that no sensor has measured is, and what helps.
const ESTIMATED: &str = "the displacement is a device's estimate, no sensor's: nothing is to be learnt from it, and no error read off it; \
                         piezo record records a sensor that board.toml says the span of (--board)";

/// What was understood of a log, a line each, why there is no displacement, and under a name of its own, what hinders
/// learning from it.
pub fn surveyed(survey: &Survey, refusal: Option<&str>, hinders: Option<(&str, &str)>) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = |name: &str, words: &str| lines.push(format!("  {name:<13} {words}"));
    for ColumnRead { quantity, number, name, unit } in &survey.columns {
        let name = if name.is_empty() { String::new() } else { format!(" {name:?}") };
        line(quantity, &format!("column {number}{name}, in {unit}"));
    }
    survey.remarks.iter().for_each(|of| line("", &remark(of)));
    line("rate", &rate(survey));
    if let Some(words) = odd_clock(1.0 / survey.clock.hz, survey.clock.duration_s) {
        line("doubtful", &words);
    }
    for (name, unit, small, series) in
        [("voltage", "V", "mV", &survey.voltage), ("displacement", "µm", "nm", &survey.displacement)]
    {
        match series {
            Some(series) => {
                ranges(&mut line, name, (unit, small), series);
                rests(&mut line, unit, series, survey);
                let volts = Some(Range { min: series.low, max: series.high }).filter(|_| name == "voltage");
                if let Some(asked) = volts.and_then(monitor_asked) {
                    line("", asked);
                }
            }
            None => line(name, refusal.unwrap_or("no column holds it")),
        }
    }
    if survey.displacement_estimated {
        line("", ESTIMATED);
    }
    // Beyond the rows that are kept, only the longest stretch of a sensor that stands still is known.
    let flaws = || survey.flaws.iter().flatten();
    let told = flaws().any(|of| matches!(of.worst, Flaw::Frozen { .. }));
    if let Some(frozen) = survey.frozen.filter(|_| !told) {
        let words = format!(
            "{} µm in {} rows from row {} on, while the voltage moves by {:.4} V: was the sensor off, or out of its range?",
            frozen.displacement_um,
            frozen.rows,
            frozen.first_row + 1,
            frozen.voltage_v
        );
        line("frozen", &words);
    }
    let is_hole = |of: &Found| matches!(of.worst, Flaw::Hole { .. });
    let (measured, holed) = (survey.displacement.is_some(), flaws().any(is_hole));
    for of in flaws().filter(|of| measured || !is_hole(of)) {
        line("flaw", &flaw_found(of, survey.too_many_holes));
    }
    // What is no measurement may be the cause of either.
    if let Some(of) = &survey.implausible {
        line("doubtful", &implausible(of));
    }
    if let Some(of) = &survey.ahead {
        line("doubtful", &runs_ahead(of));
    }
    if let Some(HumRead { hertz, amplitude_um }) = survey.hum {
        let words = format!(
            "the sensor reads ±{} µm at {hertz} Hz beyond what the voltage has there, as its cable picks up from the mains: shield that cable, \
             ground it at one end, and record again",
            short(amplitude_um)
        );
        line("hum", &words);
    }
    let rows = survey.rows_without_a_number;
    if survey.too_many_holes && !(measured && holed) {
        line("flaw", &format!("rows are missing or have no number: {TOO_MANY_HOLES}"));
    } else if !measured && (rows > 0 || holed) {
        line("flaw", "rows are missing or have no voltage: --repair of estimate takes it to go straight on over them");
    } else if rows > 0 && !holed {
        let words = "rows without a number for the voltage or the displacement: --repair of identify leaves them out";
        line("flaw", &format!("{words} ({rows} in all)"));
    }
    if survey.flaws.is_none() {
        line("", "a long log: leaps, and a voltage that is cut off, are not looked for here");
    }
    swings(&mut line, survey);
    if let Some((name, why)) = hinders {
        line(name, why);
    }
    lines
}

/// Whether anything of a log is doubtful that no repair takes away: it is settled before anything is learnt.
pub fn doubtful(survey: &Survey) -> bool {
    let Clock { hz, duration_s, .. } = survey.clock;
    survey.implausible.is_some() || survey.ahead.is_some() || odd_clock(1.0 / hz, duration_s).is_some()
}

/// What is to be said of how a log's columns were understood.
fn remark(of: &Remark) -> String {
    match of {
        Remark::Overruled { quantity, header, stated } => {
            format!("{quantity}: the header says {header}, --columns says {stated}; {stated} is used")
        }
        Remark::Assumed { columns } => {
            format!("the file names no columns: they are taken for {columns}; --columns says otherwise")
        }
    }
}

/// What is to be said of how a log was read; of a plan, which is none, not how far its rows are apart.
pub fn remarked(log: &Log, remarks: &[Remark], recorded: bool) -> Vec<String> {
    let from_first_to_last_s = log.voltage.len().saturating_sub(1) as f64 * log.sample_period;
    let odd_clock = odd_clock(log.sample_period, from_first_to_last_s).filter(|_| recorded);
    remarks.iter().map(remark).chain(odd_clock).collect()
}

/// What is doubtful of rows that are so many s apart, and so many s in all.
fn odd_clock(period_s: f64, duration_s: f64) -> Option<String> {
    let brief = || {
        format!(
            "it lasts {} s from the first row to the last, at {} rows a second, too briefly to show creep: is the unit of the time right, or \
             are these s headed as ms? --columns time=<COLUMN>:<UNIT> states another; where no column has the time, --fs <HZ> a rate",
            short(duration_s),
            short(period_s.recip())
        )
    };
    if duration_s > 0.0 && duration_s < BRIEF_S {
        return Some(brief());
    }
    (period_s > SELDOM_S).then(|| {
        format!(
            "its rows are {} s apart, {} s from the first to the last, too slow to show more than creep, and takes long to learn from: is \
             the unit of the time right, or are these ms headed as s? --columns time=<COLUMN>:<UNIT> states another; where no column has the time, --fs <HZ> a rate; \
             a sample time in the header is corrected there",
            short(period_s),
            short(duration_s)
        )
    })
}

fn rate(survey: &Survey) -> String {
    let Clock { hz, source, steps_s, duration_s, .. } = &survey.clock;
    let source = match source {
        RateSource::Column => "by the time column".to_owned(),
        RateSource::File(name) => format!("by the file's {name:?}"),
        RateSource::Stated => "as stated by --fs".to_owned(),
    };
    let steps = match steps_s {
        Some((low, high)) if high - low > 0.01 / hz => {
            format!("; steps of {} to {} ms", short(low * 1e3), short(high * 1e3))
        }
        _ => String::new(),
    };
    if survey.rows < 2 {
        return format!("{} row, of which there must be two to have a rate", survey.rows);
    }
    if !hz.is_finite() {
        let first_to_last = short(*duration_s);
        return format!(
            "none {source}: from the first of {} rows to the last it goes on by {first_to_last} s",
            survey.rows
        );
    }
    format!("{} Hz, {source}; {} rows, {} s{steps}", short(*hz), survey.rows, short(*duration_s))
}

fn ranges(line: &mut dyn FnMut(&str, &str), name: &str, (unit, small): (&str, &str), series: &Series) {
    let Series { low, high, noise, resolution, .. } = *series;
    let words = format!(
        "{} … {} {unit}; noise {} {small} (1 σ), smallest step {} {small}",
        short(low),
        short(high),
        short(noise * 1e3),
        short(resolution * 1e3)
    );
    line(name, &words);
}

/// How long a series stands at its ends.
fn rests(line: &mut dyn FnMut(&str, &str), unit: &str, series: &Series, survey: &Survey) {
    let Series { low, high, longest_at_low, longest_at_high, .. } = *series;
    let half_cycle = survey.rows / (survey.swings.reversals as u64 + 1);
    let least = REST.max(half_cycle / PART_OF_A_HALF_CYCLE);
    for (end, value, rows) in [("lowest", low, longest_at_low), ("highest", high, longest_at_high)] {
        if rows >= least && low < high {
            let value = short(value);
            line(
                "",
                &format!("stands at its {end}, {value} {unit}, for {rows} rows: a rest, or the end of the range?"),
            );
        }
    }
}

fn swings(line: &mut dyn FnMut(&str, &str), survey: &Survey) {
    let swings = &survey.swings;
    let Some(voltage) = &survey.voltage else { return };
    if let Some(stands_s) = survey.stands_at_first_s.filter(|_| voltage.low < voltage.high) {
        let begins = match stands_s >= RESTS_S {
            true => format!("with a voltage that stands for {} s", short(stands_s)),
            false => "with a voltage that moves at once: whether the actuator had rested until then is not in the log; record some \
                      seconds of that rest, too"
                .to_owned(),
        };
        line("begins", &begins);
    }
    line("reversals", &format!("{} of the voltage, by {} V at least", swings.reversals, short(swings.threshold_v)));
    if survey.rows_a_block > 1 {
        let hz = survey.clock.hz / (2 * survey.rows_a_block) as f64;
        line("", &format!("a long log: oscillations above {} Hz count as one", short(hz)));
    }
    if voltage.low >= voltage.high {
        line("", "the voltage is constant: nothing can be learnt from it");
        return;
    }
    line("half cycles", "amplitude, half of what the voltage goes from turn to turn, V × frequency, Hz: how many");
    for Cell { amplitude_v, frequency_hz, half_cycles } in &swings.cells {
        let from_to = |(from, to): (f64, f64)| format!("{} … {}", short(from), short(to));
        line("", &format!("{:>17} × {:<15} {half_cycles:>8}", from_to(*amplitude_v), from_to(*frequency_hz)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use log_survey::survey;
    use recordings::log::{ReadOptions, open};

    #[test]
    fn rows_too_far_apart_and_logs_too_brief_are_doubted_with_the_remedy() {
        assert_eq!(odd_clock(0.02, 1e5), None);
        assert_eq!(odd_clock(f64::NAN, 0.0), None);
        let brief = odd_clock(5e-6, 0.04).unwrap();
        assert!(brief.contains("lasts 0.04 s") && brief.contains("200000 rows a second"), "{brief}");
        let said = odd_clock(5.0, 40_000.0).unwrap();
        assert!(said.contains("5 s apart, 40000 s from") && said.contains("--columns time=<COLUMN>:<UNIT>"), "{said}");
    }

    fn said(displacement: impl Fn(u32, f64) -> f64) -> String {
        let voltage = |row: u32| 50.0 - 50.0 * (f64::from(row) * 0.01).cos();
        let row =
            |row| format!("{},{},{}\n", f64::from(row) * 1e-3, voltage(row), displacement(row, 0.1 * voltage(row)));
        let rows: String = (0..4000).map(row).collect();
        said_of(&format!("time_s,voltage_V,displacement_um\n{rows}"))
    }

    fn said_of(log: &str) -> String {
        surveyed(&survey_of(log), None, None).join("\n")
    }

    fn survey_of(log: &str) -> Survey {
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        std::fs::write(file.path(), log).unwrap();
        survey(open(file.path(), &ReadOptions::default()).unwrap()).unwrap()
    }

    #[test]
    fn a_clock_that_is_odd_and_a_stroke_that_is_are_doubtful() {
        let of = |period_s: f64, um_per_v: f64| {
            let rows = (0..400).map(|row| {
                let voltage = 50.0 - 50.0 * (f64::from(row) * 0.1).cos();
                format!("{},{voltage},{}\n", f64::from(row) * period_s, um_per_v * voltage)
            });
            doubtful(&survey_of(&format!("time_s,voltage_V,displacement_um\n{}", rows.collect::<String>())))
        };
        assert!(!of(0.01, 0.1) && of(10.0, 0.1) && of(0.01, 1e3));
    }

    #[test]
    fn more_holes_than_a_log_may_have_are_not_said_to_be_repaired() {
        let of = |missing: std::ops::Range<u32>| {
            let row = |row| format!("{},{},{}\n", f64::from(row) * 1e-3, row % 100, row % 100);
            let rows: String = (0..4000).filter(|row| !missing.contains(row)).map(row).collect();
            said_of(&format!("time_s,voltage_V,displacement_um\n{rows}"))
        };
        // A tenth of what is left is 363.6 rows.
        let (few, many) = (of(1_000..1_363), of(1_000..1_364));
        assert!(few.contains("row 1001: --repair of identify leaves it out"), "{few}");
        assert!(many.contains("row 1001: no log may have so many holes, and --repair does not help"), "{many}");
        assert!(!many.contains("leaves"), "{many}");
    }

    #[test]
    fn a_displacement_that_is_an_estimate_is_said_to_be_one() {
        let of = |name: &str| said_of(&format!("time_s,voltage_V,{name}\n0,0,0\n0.1,1,1\n0.2,2,2\n0.3,1,1\n"));
        assert!(
            of("estimated_displacement_um").contains("the displacement is a device's estimate, no sensor's"),
            "{}",
            of("estimated_displacement_um")
        );
        assert!(!of("displacement_um").contains("estimate"));
    }

    #[test]
    fn a_displacement_that_runs_ahead_is_asked_whether_the_columns_are_exchanged() {
        // The displacement of a quarter of a radian later, or earlier.
        let of = |rows: f64| said(|row, _| 5.0 - 5.0 * ((f64::from(row) + rows) * 0.01).cos());
        let (behind, ahead) = (of(-25.0), of(25.0));
        assert!(
            ahead.contains("the displacement runs ahead of the voltage") && ahead.contains("exchanged?"),
            "{ahead}"
        );
        assert!(!behind.contains("exchanged"), "{behind}");
    }

    #[test]
    fn what_is_no_measurement_is_said_with_its_time_and_row() {
        let sound = said(|_, y| y);
        assert!(!sound.contains("flaw") && !sound.contains("frozen"), "{sound}");
        let spike = said(|row, y| if row == 1_500 { 90.0 } else { y });
        assert!(
            spike.contains("leaps away and back by") && spike.contains("at 1.5000 s, row 1501: --repair"),
            "{spike}"
        );
        let far = said(|row, y| if row == 1_500 { 90_000.0 } else { y });
        assert!(far.contains("at 1.5000 s, row 1501") && !far.contains("is the unit right"), "{far}");
        let wrong_unit = said(|row, y| if row == 1_500 { 9e7 } else { 1e3 * y });
        let [flaw, unit] = ["leaps away", "is the unit right"].map(|what| wrong_unit.find(what).unwrap());
        assert!(flaw < unit, "{wrong_unit}");
        let frozen = said(|row, y| if (1_000..1_400).contains(&row) { 3.0 } else { y });
        let flaw = "  flaw          the displacement stands still from 1.0000 to";
        assert!(
            frozen.contains(flaw) && frozen.contains("row 1001: --repair") && !frozen.contains("frozen"),
            "{frozen}"
        );
    }
}
