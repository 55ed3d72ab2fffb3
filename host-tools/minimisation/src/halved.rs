//! Where a cost is least along a line that may have a kink or several minima, by few evaluations of a cost
//! that is dear.

/// The best of some points, which increase, and of the middles between the best so far and its neighbours, `turns`
/// times over: what belongs to it. `at` gives that and the cost. `None` where there is nothing at any of the points.
pub fn halved<T>(points: &[f64], turns: usize, at: impl Fn(f64) -> Option<(T, f64)>) -> Option<T> {
    let mut best = None;
    let mut tried: Vec<(f64, f64)> = Vec::new();
    let mut next = points.to_vec();
    for turn in 0..=turns {
        for point in std::mem::take(&mut next) {
            let Some((found, cost)) = at(point) else { continue };
            if best.as_ref().is_none_or(|(_, least)| cost.total_cmp(least).is_lt()) {
                best = Some((found, cost));
            }
            tried.push((point, cost));
        }
        tried.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        tried.dedup_by(|(a, _), (b, _)| a == b);
        let least = tried.iter().enumerate().min_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b));
        if let Some((index, &(point, _))) = least.filter(|_| turn < turns) {
            let beside = [index.checked_sub(1), Some(index + 1)].into_iter().flatten();
            next = beside.filter_map(|beside| Some(0.5 * (tried.get(beside)?.0 + point))).collect();
        }
    }
    best.map(|(found, _)| found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kink_between_the_points_and_a_minimum_at_an_end_are_found() {
        for (kink, points) in [(0.12, [-1.0, 0.0, 0.4]), (-0.9, [-1.0, 0.0, 0.4]), (-1.0, [-1.0, -0.1, 0.0])] {
            let found = halved(&points, 5, |x: f64| Some((x, (x - kink).abs()))).unwrap();
            assert!((found - kink).abs() < 0.03, "{found}, not {kink}");
        }
    }

    #[test]
    fn where_there_is_nothing_is_passed_over() {
        assert_eq!(halved(&[0.0, 1.0, 2.0], 1, |x: f64| (x > 0.9).then_some((x, x))), Some(1.0));
        assert_eq!(halved(&[0.0], 3, |_| None::<(f64, f64)>), None);
    }
}
