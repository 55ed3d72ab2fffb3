//! What every method of the search keeps to, and how well it does on functions whose minimum is known.

use identification::search::{Budget, Minimum, Optimiser, each, minimise};
use std::sync::atomic::{AtomicUsize, Ordering};

const SEEDS: std::ops::Range<u64> = 1..6;

/// A search without starts whose every point is checked to be a point of the cube.
fn search(optimiser: Optimiser, dimension: usize, evaluations: usize, seed: u64, cost: fn(&[f64]) -> f64) -> Minimum {
    let checked = |x: &[f64]| {
        assert_eq!(x.len(), dimension);
        assert!(x.iter().all(|x| (0.0..=1.0).contains(x)), "{x:?}");
        cost(x)
    };
    let found = minimise(optimiser, dimension, Budget { evaluations, seed }, &[], &each(checked), &mut |_, _| ());
    assert!(found.at.iter().all(|x| (0.0..=1.0).contains(x)), "{found:?}");
    if found.cost.is_finite() {
        assert_eq!(found.cost, cost(&found.at));
    }
    found
}

/// Every method comes within its excess of a known least cost, with several seeds.
fn finds(dimension: usize, evaluations: usize, cost: fn(&[f64]) -> f64, least: f64, excess: impl Fn(Optimiser) -> f64) {
    for optimiser in Optimiser::ALL {
        for seed in SEEDS {
            let found = search(optimiser, dimension, evaluations, seed, cost);
            assert!(found.cost - least < excess(optimiser), "{optimiser} {seed}: {:e}", found.cost - least);
        }
    }
}

/// Least at 0.3, 0.35, 0.4 …
fn sphere(x: &[f64]) -> f64 {
    x.iter().enumerate().map(|(i, x)| (x - 0.3 - 0.05 * i as f64).powi(2)).sum()
}

/// On −2 … 2.
fn rosenbrock(x: &[f64]) -> f64 {
    let x: Vec<f64> = x.iter().map(|x| 4.0 * x - 2.0).collect();
    x.windows(2).map(|x| 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2)).sum()
}

/// Inadmissible on half of the cube, least at its edge, where x₀ + x₁ = 1.
fn halved(x: &[f64]) -> f64 {
    if x[0] + x[1] < 1.0 { f64::INFINITY } else { sphere(x) }
}

#[test]
fn each_finds_the_least_of_a_shifted_sphere() {
    finds(5, 4000, sphere, 0.0, |optimiser| if optimiser == Optimiser::Genetic { 2e-3 } else { 1e-8 });
    finds(1, 2000, sphere, 0.0, |optimiser| if optimiser == Optimiser::Genetic { 1e-6 } else { 1e-8 });
}

#[test]
fn each_follows_the_valley_of_rosenbrock() {
    finds(4, 10_000, rosenbrock, 0.0, |optimiser| match optimiser {
        Optimiser::Genetic => 0.5,
        Optimiser::ParticleSwarm => 0.3,
        _ => 1e-8,
    });
}

#[test]
fn each_finds_the_least_at_the_edge_of_what_is_admissible() {
    finds(4, 4000, halved, 2.0 * 0.175 * 0.175, |optimiser| if optimiser == Optimiser::Genetic { 0.03 } else { 2e-3 });
}

#[test]
fn each_finds_the_least_in_a_corner_of_the_cube() {
    let beyond = |x: &[f64]| x.iter().map(|x| (x + 0.2).powi(2) - 0.04).sum::<f64>() + 10.0 * (x[0] - x[1]).powi(2);
    finds(4, 4000, beyond, 0.0, |optimiser| if optimiser == Optimiser::Genetic { 0.02 } else { 1e-7 });
}

#[test]
fn the_same_seed_gives_the_same_result_on_any_number_of_threads() {
    for optimiser in Optimiser::ALL {
        let on = |threads, seed| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| search(optimiser, 4, 700, seed, rosenbrock))
        };
        assert_eq!(on(1, 3), on(4, 3), "{optimiser}");
        assert_ne!(on(1, 3).at, on(1, 4).at, "{optimiser}");
    }
}

#[test]
fn the_budget_is_spent_and_never_exceeded_whatever_the_cost() {
    let costs: [fn(&[f64]) -> f64; 5] = [sphere, halved, |_| 1.0, |_| f64::INFINITY, |_| f64::NAN];
    for optimiser in Optimiser::ALL {
        for evaluations in [0, 1, 2, 3, 4, 5, 17, 100, 1000, 3000] {
            for cost in costs {
                for starts in [0, 1, 7] {
                    let asked = AtomicUsize::new(0);
                    let counted = |x: &[f64]| {
                        asked.fetch_add(1, Ordering::Relaxed);
                        cost(x)
                    };
                    let starts = vec![vec![0.25, 0.75]; starts];
                    let mut seen = (0, f64::INFINITY);
                    let budget = Budget { evaluations, seed: 1 };
                    let found = minimise(optimiser, 2, budget, &starts, &each(counted), &mut |made, best| {
                        assert!(made > seen.0 && best.cost <= seen.1 && made == best.evaluations);
                        seen = (made, best.cost);
                    });
                    let asked = asked.into_inner();
                    assert_eq!((found.evaluations, found.cost), seen);
                    assert_eq!(found.evaluations, asked, "{optimiser}");
                    assert!(asked <= evaluations, "{optimiser} {evaluations}: {asked}");
                    let least = match optimiser {
                        // It makes whole generations and does not ask again what it knows.
                        Optimiser::Genetic => evaluations / 2,
                        // It ends once it finds nothing better than what it has.
                        Optimiser::Local if found.cost.is_finite() => evaluations.min(3),
                        _ => evaluations,
                    };
                    assert!(asked >= least, "{optimiser} {evaluations}: {asked}");
                }
            }
        }
    }
}

#[test]
fn nelder_mead_leaves_a_shallow_basin_and_ends_long_before_its_budget() {
    /// A deep basin, and a shallow one around the start.
    fn basins(x: &[f64]) -> f64 {
        let around = |centre: f64| x.iter().map(|x| (x - centre).powi(2)).sum::<f64>();
        (around(0.2) + 0.1).min(around(0.75) + 0.01)
    }
    for seed in SEEDS {
        let budget = Budget { evaluations: 100_000, seed };
        let found = minimise(Optimiser::Local, 3, budget, &[vec![0.2; 3]], &each(basins), &mut |_, _| ());
        assert!((found.cost - 0.01).abs() < 1e-6 && found.evaluations < 2000, "{seed}: {found:?}");
    }
}

#[test]
fn without_an_admissible_point_the_first_start_or_the_centre_is_left() {
    for optimiser in Optimiser::ALL {
        for cost in [f64::INFINITY, f64::NAN] {
            let with = |starts: &[Vec<f64>]| {
                minimise(
                    optimiser,
                    2,
                    Budget { evaluations: 200, seed: 1 },
                    starts,
                    &each(|_: &[f64]| cost),
                    &mut |_, _| (),
                )
            };
            assert_eq!((with(&[]).at, with(&[]).cost), (vec![0.5; 2], f64::INFINITY));
            assert_eq!(with(&[vec![0.1, 0.2], vec![0.3, 0.4]]).at, [0.1, 0.2]);
        }
    }
}

#[test]
fn dimension_zero_takes_one_evaluation() {
    for optimiser in Optimiser::ALL {
        let expected = Minimum { at: vec![], cost: 3.0, evaluations: 1 };
        assert_eq!(search(optimiser, 0, 100, 1, |_| 3.0), expected);
        assert_eq!(search(optimiser, 0, 0, 1, |_| 3.0).evaluations, 0);
    }
}

#[test]
fn the_best_start_is_kept_exactly_as_it_is() {
    let hidden = [0.123_456_789, 1.0, 0.0];
    let cost = |x: &[f64]| if x == hidden { 0.0 } else { 1.0 + sphere(x) };
    // Another dimension is left out, what lies beyond the cube limited to it.
    let starts = [vec![0.9; 3], vec![0.1; 2], vec![hidden[0], 1.5, -2.0], vec![f64::NAN; 3]];
    for optimiser in Optimiser::ALL {
        let found = minimise(optimiser, 3, Budget { evaluations: 500, seed: 1 }, &starts, &each(cost), &mut |_, _| ());
        assert_eq!((found.at.as_slice(), found.cost), (hidden.as_slice(), 0.0), "{optimiser}");
    }
}

#[test]
fn a_start_in_a_small_admissible_place_is_searched_around() {
    let start = vec![0.31, 0.35, 0.4];
    // A ball of radius 0.02, some 3·10⁻⁵ of the cube.
    let cost = |x: &[f64]| if sphere(x) < 4e-4 { sphere(x) } else { f64::INFINITY };
    for optimiser in [Optimiser::Genetic, Optimiser::CmaEs, Optimiser::Local] {
        let budget = Budget { evaluations: 4000, seed: 1 };
        let found = minimise(optimiser, 3, budget, std::slice::from_ref(&start), &each(cost), &mut |_, _| ());
        let least = if optimiser == Optimiser::Genetic { 5e-5 } else { 1e-10 };
        assert!(found.cost < least, "{optimiser}: {:e}", found.cost);
    }
}

#[test]
fn a_name_is_the_same_in_a_sentence_and_in_a_file() {
    for optimiser in Optimiser::ALL {
        let name = optimiser.to_string();
        assert_eq!(serde_json::to_string(&optimiser).unwrap(), format!("\"{name}\""));
    }
    assert_eq!(Optimiser::CmaEs.to_string(), "cma-es");
}
