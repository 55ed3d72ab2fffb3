//! Whether the voltages that a table was learnt on are those that a board is driven over.

use ::calibration::drive::trained_on;
use estimator_core::{Range, Table};
use std::fmt;

/// By how much the ends of two ranges may differ, of the driven one: a log's ends are noisy and fall a little short.
const NEAR: f32 = 0.05;

/// The voltages at the amplifier that a table was learnt on and those that it is driven over, where they differ, V.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OtherRange {
    /// The table was learnt on these.
    pub learnt: Range,
    /// The board is driven over these.
    pub driven: Range,
}

impl OtherRange {
    /// Of a table that is driven over a range, V; `None` where it was learnt on the same.
    pub fn of(table: &Table, driven: Range) -> Option<Self> {
        let Range { min, max } = trained_on(table);
        let of = Self { learnt: Range { min: to_mv(min), max: to_mv(max) }, driven };
        (of.lacks() || of.exceeds()).then_some(of)
    }

    /// Whether it is driven to voltages that the table does not know.
    pub fn lacks(&self) -> bool {
        let near = NEAR * self.driven.span();
        self.learnt.min > self.driven.min + near || self.learnt.max < self.driven.max - near
    }

    /// Whether the table knows voltages to which it is not driven.
    fn exceeds(&self) -> bool {
        let near = NEAR * self.driven.span();
        self.learnt.min < self.driven.min - near || self.learnt.max > self.driven.max + near
    }

    /// The voltages of both; `None` where there are none.
    pub fn common(&self) -> Option<Range> {
        let common = self.learnt.intersection(self.driven);
        (common.max > common.min).then_some(common)
    }
}

/// A voltage, V, to a millivolt, as it is read by people; never −0.
fn to_mv(volts: f32) -> f32 {
    (volts * 1e3).round() / 1e3 + 0.0
}

impl fmt::Display for OtherRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let knows = match (self.lacks(), self.exceeds()) {
            (true, false) => "only part of",
            (false, _) => "more than",
            (true, true) => "something beside",
        };
        let Self { learnt, driven } = self;
        write!(
            f,
            "the table knows {knows} the board's range: it was learnt on {} … {} V, and the board may drive {} … {} V",
            learnt.min, learnt.max, driven.min, driven.max
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_knows_part_of_more_than_or_something_beside_a_range() {
        let table = Table { voltage_range_v: Range { min: -12.0, max: 32.0 }, voltage_zero_v: 10.0, ..emulator::TABLE };
        let said = |min, max| OtherRange::of(&table, Range { min, max }).map(|of| of.to_string());
        assert_eq!((said(0.0, 40.0), said(-1.0, 41.0)), (None, None));
        assert!(
            said(0.0, 100.0)
                .unwrap()
                .starts_with("the table knows only part of the board's range: it was learnt on 0 … 40 V, and")
        );
        assert!(said(0.0, 20.0).unwrap().contains("knows more than"));
        assert!(said(20.0, 100.0).unwrap().contains("knows something beside"));
        let beside = OtherRange::of(&table, Range { min: 60.0, max: 100.0 }).unwrap();
        assert_eq!(beside.common(), None);
        assert!(beside.to_string().contains("knows something beside"));
    }
}
