//! Few places that stand for many: Lloyd's k-means (S. P. Lloyd, Least squares quantization in PCM, 1982).

use estimator_core::interval::{PLAYS, PROTOTYPES};
use nalgebra::SVector;

/// A number for each play.
pub type Plays = SVector<f64, PLAYS>;

/// Rounds of Lloyd's iteration; more move no prototype by what an interval would notice.
const ROUNDS: usize = 15;

/// Centres of clusters of places, which start as far from each other as they can be; some coincide where there are
/// fewer places, and all are at 0 where there is none.
pub fn prototypes(places: &[Plays]) -> [Plays; PROTOTYPES] {
    let mut centres = spread_out(places);
    for _ in 0..ROUNDS {
        let mut sums = [(Plays::zeros(), 0.0); PROTOTYPES];
        for place in places {
            let (sum, count) = &mut sums[nearest(&centres, place).0];
            *sum += place;
            *count += 1.0;
        }
        for (centre, (sum, count)) in centres.iter_mut().zip(sums) {
            if count > 0.0 {
                *centre = sum / count;
            }
        }
    }
    centres
}

/// Each is the place that is farthest from those before it (Gonzalez).
fn spread_out(places: &[Plays]) -> [Plays; PROTOTYPES] {
    let mut centres = [places.first().copied().unwrap_or_default(); PROTOTYPES];
    let mut distances = vec![f64::INFINITY; places.len()];
    for number in 1..PROTOTYPES {
        let last = centres[number - 1];
        for (distance, place) in distances.iter_mut().zip(places) {
            *distance = distance.min((place - last).norm_squared());
        }
        let farthest = places.iter().zip(&distances).max_by(|(_, a), (_, b)| a.total_cmp(b));
        centres[number] = farthest.map_or(last, |(place, _)| *place);
    }
    centres
}

/// The centre next to a place: its number, and the square of the distance.
pub fn nearest(centres: &[Plays; PROTOTYPES], place: &Plays) -> (usize, f64) {
    let distances = centres.iter().map(|centre| (centre - place).norm_squared()).enumerate();
    distances.fold((0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places about as many points as there are prototypes: one comes to stand in the middle of each.
    #[test]
    fn every_cluster_has_a_prototype() {
        let middle = |cluster: usize| {
            Plays::from_fn(|row, _| if row == cluster % PLAYS { 1.0 + (cluster / PLAYS) as f64 } else { 0.0 })
        };
        let about = |cluster: usize| [-0.1, 0.1].map(|by| middle(cluster).add_scalar(by));
        let places: Vec<Plays> = (0..PROTOTYPES).flat_map(about).collect();
        let found = prototypes(&places);
        for cluster in 0..PROTOTYPES {
            assert!(nearest(&found, &middle(cluster)).1 < 1e-20, "{cluster}");
        }
    }

    #[test]
    fn fewer_places_than_prototypes_are_met_exactly() {
        let place = Plays::repeat(0.5);
        assert_eq!(prototypes(&[place]), [place; PROTOTYPES]);
        assert_eq!(prototypes(&[]), [Plays::zeros(); PROTOTYPES]);
    }
}
