//! Rows in which a log has no number, or which were never written: put on the straight line between those beside them.

use super::resolution::resolution;
use std::ops::Range;

/// The part of a log's rows that may be holes: one with more is refused.
pub const MOST_HOLES: f64 = 0.1;

/// Puts each value that is none (NaN) on the straight line between its neighbours, in every series, and gives the rows
/// in which any series had none. At an end the nearest value stands; a series without any stays as it is.
pub fn bridge<'s>(series: impl IntoIterator<Item = &'s mut [f64]>) -> Vec<Range<usize>> {
    let mut rows: Vec<usize> = Vec::new();
    for values in series {
        let missing: Vec<usize> = (0..values.len()).filter(|&row| values[row].is_nan()).collect();
        missing.chunk_by(|a, b| a + 1 == *b).for_each(|run| straighten(values, run[0]..run[0] + run.len()));
        rows.extend(missing);
    }
    rows.sort_unstable();
    rows.dedup();
    rows.chunk_by(|a, b| a + 1 == *b).map(|run| run[0]..run[0] + run.len()).collect()
}

fn straighten(values: &mut [f64], run: Range<usize>) {
    let before = run.start.checked_sub(1).map(|row| values[row]);
    let (from, to) = match (before, values.get(run.end).copied()) {
        (Some(from), Some(to)) => (from, to),
        (Some(only), None) | (None, Some(only)) => (only, only),
        (None, None) => return,
    };
    let step = (to - from) / (run.len() + 1) as f64;
    values[run].iter_mut().zip(1..).for_each(|(value, nth)| *value = from + f64::from(nth) * step);
}

/// So many rows put into a series before each of the rows `at`, which increase: NaN, for [`bridge`].
pub(super) fn put_back(values: &[f64], at: &[(usize, usize)]) -> Vec<f64> {
    let missing = at.iter().map(|(_, count)| count).sum::<usize>();
    let mut filled = Vec::with_capacity(values.len() + missing);
    let mut from = 0;
    for &(row, count) in at {
        filled.extend_from_slice(&values[from..row]);
        filled.extend(std::iter::repeat_n(f64::NAN, count));
        from = row;
    }
    filled.extend_from_slice(&values[from..]);
    filled
}

/// The time stamps with those of the samples that are missing, at even steps and with as many decimals as the others.
pub(super) fn put_stamps_back(time: &[f64], gaps: &[(usize, usize)]) -> Vec<f64> {
    let resolution = resolution(time);
    let mut filled = put_back(time, gaps);
    for (rows, &(behind, _)) in bridge([&mut filled[..]]).into_iter().zip(gaps) {
        let decimal = resolution[behind];
        if decimal > 0.0 {
            filled[rows].iter_mut().for_each(|stamp| *stamp = (*stamp / decimal).round() * decimal);
        }
    }
    filled
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: f64 = f64::NAN;

    #[test]
    fn what_is_none_lies_between_its_neighbours_and_its_rows_are_told() {
        let (mut voltage, mut displacement) = ([NONE, 1.0, NONE, NONE, 4.0, 5.0], [1.0, NONE, 3.0, 4.0, 5.0, NONE]);
        assert_eq!(bridge([&mut voltage[..], &mut displacement]), [0..4, 5..6]);
        assert_eq!((voltage, displacement), ([1.0, 1.0, 2.0, 3.0, 4.0, 5.0], [1.0, 2.0, 3.0, 4.0, 5.0, 5.0]));
        let (mut none, mut one) = ([NONE; 2], [NONE, 1.0]);
        assert_eq!(bridge([&mut none[..], &mut one]).len(), 1);
        assert!(none[0].is_nan() && one == [1.0, 1.0]);
    }

    #[test]
    fn rows_are_put_back_where_they_are_missing() {
        let mut filled = put_back(&[0.0, 1.0, 4.0, 6.0], &[(2, 2), (3, 1)]);
        assert_eq!(bridge([&mut filled[..]]), [2..4, 5..6]);
        assert_eq!(filled, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }
}
