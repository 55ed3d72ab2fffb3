//! Ticks in columns: the least and the largest of each quantity, so that what lasted one tick is still seen.
//!
//! A column's ticks are those whose numbers, divided by its length, have the same whole part. What is drawn of a loop
//! are the ticks at which a quantity was least or largest, as in M4 (Jugel et al., "M4: A visualization-oriented time
//! series data aggregation", 2014).

use crate::feed::Tick;

/// The least and the largest value of a quantity in a column.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Extent {
    /// The smallest value of the column's ticks.
    pub min: f32,
    /// The largest value of the column's ticks.
    pub max: f32,
}

/// What a column of ticks has of each quantity.
#[derive(Clone, PartialEq, Debug)]
pub struct Column {
    /// Of its first tick, since the feed's first, s.
    pub seconds: f64,
    /// Whether a tick is missing within it or right before it.
    pub gap: bool,
    /// The amplifier's voltage, V.
    pub voltage_v: Extent,
    /// The estimated displacement, µm.
    pub displacement_um: Extent,
    /// Largest half-width of the estimate's interval, µm, where one of the ticks has one.
    pub half_width_um: Option<f32>,
    /// The sensor, µm, where there is one.
    pub sensor_um: Option<Extent>,
    /// Estimate less sensor, µm, where there is one.
    pub error_um: Option<Extent>,
    /// The ticks at which voltage, estimate, sensor or error was least or largest, in their order.
    pub extremes: Vec<Tick>,
}

/// Makes columns of ticks.
#[derive(Clone, Debug)]
pub struct Columns {
    length: u64,
    ticks: Vec<Tick>,
}

impl Columns {
    /// Columns of so many ticks, at least one.
    pub fn new(length: u32) -> Self {
        Self { length: u64::from(length.max(1)), ticks: Vec::new() }
    }

    /// Takes the next tick; gives the column that ends with it, or had ended before it.
    pub fn take(&mut self, tick: &Tick) -> Option<Column> {
        let of = |tick: &Tick| tick.number / self.length;
        if self.ticks.first().is_some_and(|first| of(first) != of(tick)) {
            let before = self.end();
            self.ticks.push(*tick);
            return before;
        }
        self.ticks.push(*tick);
        // It need not wait for a tick that may not come soon.
        if of(tick) == (tick.number + u64::from(tick.every)) / self.length { None } else { self.end() }
    }

    fn end(&mut self) -> Option<Column> {
        let ticks = std::mem::take(&mut self.ticks);
        let first = ticks.first()?;
        let mut at = Vec::new();
        let voltage_v = extent(&ticks, &mut at, |tick| Some(tick.voltage_v))?;
        let displacement_um = extent(&ticks, &mut at, |tick| Some(tick.displacement_um))?;
        let sensor_um = extent(&ticks, &mut at, |tick| tick.sensor_um);
        let error_um = extent(&ticks, &mut at, |tick| Some(tick.displacement_um - tick.sensor_um?));
        at.sort_unstable();
        at.dedup();
        Some(Column {
            seconds: first.seconds,
            gap: ticks.iter().any(|tick| tick.after_gap),
            voltage_v,
            displacement_um,
            half_width_um: ticks.iter().filter_map(|tick| tick.half_width_um).reduce(f32::max),
            sensor_um,
            error_um,
            extremes: at.into_iter().map(|index| ticks[index]).collect(),
        })
    }
}

/// Least and largest of a quantity where there is one; the first places of both are added to `at`.
fn extent(ticks: &[Tick], at: &mut Vec<usize>, of: impl Fn(&Tick) -> Option<f32>) -> Option<Extent> {
    let values = || ticks.iter().enumerate().filter_map(|(index, tick)| Some((index, of(tick)?)));
    let (least, min) = values().min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let (largest, max) = values().max_by(|(i, a), (j, b)| a.total_cmp(b).then(j.cmp(i)))?;
    at.extend([least, largest]);
    Some(Extent { min, max })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp of 1 mV and 1 nm a tick, its sensor 2 µm below.
    fn tick(number: u64) -> Tick {
        let height = number as f32 * 1e-3;
        Tick {
            number,
            every: 1,
            seconds: number as f64 * 5e-4,
            after_gap: false,
            voltage_v: height,
            displacement_um: height,
            half_width_um: number.is_multiple_of(2).then_some(0.25),
            sensor_um: Some(height - 2.0),
        }
    }

    #[test]
    fn what_lasts_one_tick_is_in_its_column_wherever_it_falls() {
        for glitch in 0..40 {
            let mut columns = Columns::new(10);
            let found: Vec<Column> = (0..40)
                .filter_map(|number| {
                    let spoilt = Tick { voltage_v: 9.0, displacement_um: -9.0, ..tick(number) };
                    columns.take(&if number == glitch { spoilt } else { tick(number) })
                })
                .collect();
            assert_eq!(found.len(), 4);
            for (index, column) in (0u64..).zip(&found) {
                let spoilt = index == glitch / 10;
                assert_eq!(column.voltage_v.max == 9.0, spoilt, "tick {glitch}, column {index}");
                assert_eq!(column.displacement_um.min == -9.0, spoilt, "tick {glitch}, column {index}");
                assert_eq!(column.extremes.iter().any(|tick| tick.number == glitch), spoilt, "{column:?}");
            }
        }
    }

    #[test]
    fn a_column_has_its_extents_and_its_extremes_in_order() {
        let mut columns = Columns::new(4);
        let found: Vec<Column> = (4..12).filter_map(|number| columns.take(&tick(number))).collect();
        let [first, _] = &found[..] else { panic!("{found:?}") };
        assert_eq!((first.seconds, first.gap, first.half_width_um), (2e-3, false, Some(0.25)));
        assert_eq!(first.voltage_v, Extent { min: 4e-3, max: 7e-3 });
        assert!(first.error_um.is_some_and(|error| (error.max - 2.0).abs() < 1e-6));
        let numbers: Vec<u64> = first.extremes.iter().map(|tick| tick.number).collect();
        assert!(numbers.is_sorted() && numbers.first() == Some(&4) && numbers.last() == Some(&7), "{numbers:?}");
    }

    #[test]
    fn a_gap_ends_a_column_and_shows_in_the_next() {
        let mut columns = Columns::new(10);
        let mut found: Vec<Column> = (0..3).filter_map(|number| columns.take(&tick(number))).collect();
        found.extend(columns.take(&Tick { after_gap: true, ..tick(35) }));
        assert_eq!(found.iter().map(|column| (column.extremes.len(), column.gap)).collect::<Vec<_>>(), [(2, false)]);
        found.extend((36..40).filter_map(|number| columns.take(&tick(number))));
        assert_eq!((found.len(), found[1].gap, found[1].seconds), (2, true, tick(35).seconds));
    }

    #[test]
    fn columns_of_one_tick_are_all_of_them() {
        let mut columns = Columns::new(0);
        let found: Vec<Column> = (0..5).filter_map(|number| columns.take(&tick(number))).collect();
        assert!(found.len() == 5 && found.iter().all(|column| column.extremes.len() == 1), "{found:?}");
    }
}
