//! A scale at which a cost is least, by few evaluations of a cost that is dear.

/// From one scale that is tried to the next.
const FACTOR: f64 = 2.0;

/// From a scale of 1 by factors of 2 downhill, to the scale beyond which the cost rises, and from the best three to the
/// vertex of the parabola over the logarithm. `at` gives what belongs to a scale, and its cost; scales are not less
/// than `least`. `None` where there is nothing at 1.
pub fn scaled<T>(least: f64, at: impl Fn(f64) -> Option<(T, f64)>) -> Option<(f64, T)> {
    let mut scale = 1.0;
    let (mut best, mut cost) = at(scale)?;
    // Costs next to the best one, a step below it and a step above.
    let mut beside = [f64::INFINITY; 2];
    for (side, factor) in [1.0 / FACTOR, FACTOR].into_iter().enumerate() {
        let before = scale;
        while scale * factor >= least
            && let Some((next, next_cost)) = at(scale * factor)
        {
            if next_cost >= cost {
                beside[side] = next_cost;
                break;
            }
            beside[1 - side] = cost;
            (scale, best, cost) = (scale * factor, next, next_cost);
        }
        if scale != before {
            break;
        }
    }
    let [below, above] = beside;
    let curvature = below - 2.0 * cost + above;
    if curvature.is_finite() && curvature > 0.0 {
        let vertex = scale * libm::pow(FACTOR, 0.5 * (below - above) / curvature);
        if let Some((there, there_cost)) = at(vertex)
            && there_cost < cost
        {
            return Some((vertex, there));
        }
    }
    Some((scale, best))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn the_least_is_found_on_either_side_by_few_evaluations() {
        for least in [0.06, 0.3, 0.9, 1.0, 1.1, 3.5] {
            let asked = Cell::new(0);
            let found = scaled(0.01, |scale| {
                asked.set(asked.get() + 1);
                Some(((), libm::pow(libm::log(scale / least), 2.0)))
            });
            let (scale, ()) = found.unwrap();
            assert!((scale / least - 1.0).abs() < 1e-6, "{scale}, not {least}");
            assert!(asked.get() < 9, "{} for {least}", asked.get());
        }
    }

    #[test]
    fn it_goes_no_lower_than_it_may_and_gives_up_where_there_is_nothing() {
        let (scale, ()) = scaled(0.1, |scale| Some(((), scale))).unwrap();
        assert_eq!(scale, 0.125);
        assert!(scaled(0.1, |_| None::<((), f64)>).is_none());
    }
}
