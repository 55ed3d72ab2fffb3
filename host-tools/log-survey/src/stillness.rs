//! A displacement that is one number while the voltage moves: a sensor that was off, out of its range, or
//! read too slowly.

use serde::Serialize;

use crate::series::Series;

/// Fewest rows that are a stretch.
const ROWS: u64 = 8;
/// Smallest part of the voltage's range that is a movement.
const PART: f64 = 0.05;

/// A stretch in which the displacement is one number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Stillness {
    /// Its first row, counted from 0.
    pub first_row: u64,
    /// How many rows it has.
    pub rows: u64,
    /// How far the voltage moves in it, V.
    pub voltage_v: f64,
    /// The displacement in it, µm.
    pub displacement_um: f64,
}

/// The stretch of now, and the one so far in which the voltage moves most.
#[derive(Default)]
pub(crate) struct Watch {
    now: Option<(Stillness, f64, f64)>,
    most: Option<Stillness>,
}

impl Watch {
    pub fn add(&mut self, row: u64, voltage: f64, displacement: f64) {
        if let Some((stretch, low, high)) = &mut self.now
            && stretch.displacement_um == displacement
        {
            (*low, *high) = (low.min(voltage), high.max(voltage));
            stretch.rows += 1;
            stretch.voltage_v = *high - *low;
            return;
        }
        self.finish();
        let stretch = Stillness { first_row: row, rows: 1, voltage_v: 0.0, displacement_um: displacement };
        self.now = Some((stretch, voltage, voltage));
    }

    fn finish(&mut self) {
        let Some((stretch, ..)) = self.now.take() else { return };
        if stretch.rows >= ROWS && self.most.is_none_or(|most| stretch.voltage_v > most.voltage_v) {
            self.most = Some(stretch);
        }
    }

    /// The stretch, if the voltage moves in it by a good part of its range.
    pub fn result(mut self, voltage: Option<&Series>) -> Option<Stillness> {
        self.finish();
        let range = voltage.map_or(0.0, |voltage| voltage.high - voltage.low);
        self.most.filter(|most| most.voltage_v > PART * range)
    }
}
