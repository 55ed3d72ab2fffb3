//! The one finder of reversals.

use log_survey::reversals::reversals;

#[test]
fn the_extremes_are_found_and_a_ripple_is_none() {
    let voltage = [0.0, 1.0, 3.0, 2.9, 3.1, 1.0, 0.0, 0.05, 0.0, 2.0];
    assert_eq!(reversals(&voltage, 0.5), [4, 8]);
    assert_eq!(reversals(&voltage, 0.0), [2, 3, 4, 6, 7, 8]);
    assert!(reversals(&[], 0.5).is_empty() && reversals(&[1.0; 9], 0.0).is_empty());
}
