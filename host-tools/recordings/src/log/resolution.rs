//! The rounding of printed time stamps, found from the stamps themselves.

/// One unit of the last decimal that the time stamps show, for each stamp, s. Stamps printed with a fixed number of
/// significant digits show fewer decimals from one decade to the next, never more than one fewer. 0 where no printed
/// decimals end, as in computed stamps.
pub(super) fn resolution(time: &[f64]) -> Vec<f64> {
    const FINEST: i32 = 12;
    const DECADES: std::ops::RangeInclusive<i32> = -FINEST..=12;
    let decade = |t: f64| match t.abs().log10().floor() {
        exponent if exponent.is_finite() => Some((exponent as i32).clamp(*DECADES.start(), *DECADES.end())),
        _ => None,
    };
    let slot = |decade: i32| (decade - DECADES.start()) as usize;
    let mut decimals = [None::<i32>; 25];
    for &t in time {
        let Some(at) = decade(t) else { continue };
        let shown = &mut decimals[slot(at)];
        let mut places = shown.unwrap_or(0);
        let has_more = |places: i32| {
            let scaled = t * 10_f64.powi(places);
            (scaled - scaled.round()).abs() > 1e-6_f64.max(1e-15 * scaled.abs())
        };
        while places < FINEST && has_more(places) {
            places += 1;
        }
        *shown = Some(places);
    }
    let mut fewest = None;
    for shown in &mut decimals {
        if let (Some(places), Some(fewest)) = (&mut *shown, fewest) {
            *places = (*places).max(fewest);
        }
        fewest = shown.or(fewest).map(|places| places - 1);
    }
    let at_zero = decimals.iter().flatten().next().copied();
    time.iter()
        .map(|&t| decade(t).map_or(at_zero, |at| decimals[slot(at)]))
        .map(|places| match places {
            Some(places) if places < FINEST => 10_f64.powi(-places),
            _ => 0.0,
        })
        .collect()
}

/// The coarsest of the resolutions, s.
pub(super) fn coarsest(resolution: &[f64]) -> f64 {
    resolution.iter().copied().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_decimals_significant_digits_and_none() {
        let milliseconds: Vec<f64> = (0..12_000).map(|k| f64::from(k) / 1e3).collect();
        assert_eq!(resolution(&milliseconds), [1e-3; 12_000]);
        let digits = resolution(&[0.0005, 0.9995, 1.0, 1.001, 10.0, 10.01]);
        assert_eq!(digits, [1e-4, 1e-4, 1e-3, 1e-3, 1e-2, 1e-2]);
        assert_eq!(resolution(&[0.0, 1.0 / 3.0, 2.0 / 3.0]), [0.0; 3]);
        assert_eq!(resolution(&[0.0; 3]), [0.0; 3]);
        assert_eq!(coarsest(&digits), 1e-2);
    }
}
