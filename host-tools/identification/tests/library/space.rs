//! The coordinates of a search and the parameters that follow from them.

use estimator_core::{Discretisation, Model, Scheme, Voigt, VoigtParameters};
use identification::search::space::{Extent, Ranges, Space};
use identification::search::{Gene, Scale};

const EXTENT: Extent = Extent { voltage: 20.0, displacement: 4.0, tick: 5e-4 };

#[test]
fn coordinates_mean_what_they_say() {
    let space = Space::new(Model::Enhanced, Ranges::Data, EXTENT);
    let values = [300.0, 0.9, 0.8, -0.2, 0.1, -0.1, 0.7, 0.2, 1.1];
    let parameters = space.parameters(&values);
    let model = Voigt::build(
        &parameters,
        &Discretisation { sample_period: EXTENT.tick, scheme: Scheme::ForwardEuler, deadband: 0.0 },
    );
    let close = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    close(model.rate(0.0), 300.0);
    close(model.drive(20.0) / model.rate(20.0), 0.9 * 4.0);
    close(model.voltage_term(20.0), -0.3 * model.drive(20.0));
    close(model.displacement_term(4.0), 0.2 * model.drive(20.0));
    let ln_rate = |v: f64| model.rate(20.0 * v).ln();
    close((ln_rate(1e-3) - ln_rate(-1e-3)) / 2e-3, -0.2);
    close((ln_rate(1e-2) + ln_rate(-1e-2) - 2.0 * ln_rate(0.0)) / 1e-4, 0.1);
}

#[test]
fn the_simpler_model_is_a_candidate_of_the_richer() {
    for ranges in [Ranges::Data, Ranges::Table45] {
        let simple = Space::new(Model::Voigt, ranges, EXTENT);
        let rich = Space::new(Model::Enhanced, ranges, EXTENT);
        let values: Vec<f64> = simple.genes.iter().map(|gene| gene.value(0.3)).collect();
        let (ours, theirs) = (rich.parameters(&rich.adopt(&simple, &values)), simple.parameters(&values));
        assert_eq!((ours.g_um_per_s, ours.e_m_per_s), (0.0, 0.0));
        assert_eq!(VoigtParameters { h: 0.0, f: 0.0, ..ours }, theirs);
    }
}

#[test]
fn a_limit_of_the_model_is_no_bound_but_every_other_end_is() {
    let gene = |name| Gene { name, meaning: "", unit: "", min: 1e-4, max: 2.0, scale: Scale::Linear };
    assert!(!gene("curvature").undetermined(1e-4) && gene("curvature").undetermined(2.0));
    assert!(!gene("memory").undetermined(1e-4) && !gene("memory").undetermined(2.0));
    assert!(gene("p").undetermined(1e-4) && gene("p").undetermined(1.999) && !gene("p").undetermined(1.0));
}

#[test]
fn a_gene_and_its_fraction_are_inverse_and_shrinking_stays_inside() {
    for gene in Space::new(Model::Enhanced, Ranges::Data, EXTENT).genes {
        for fraction in [0.0, 0.2, 0.5, 1.0] {
            let value = gene.value(fraction);
            assert!((gene.fraction(value) - fraction).abs() < 1e-12);
            let smaller = gene.around(value, 0.3);
            let tiny = 1e-9 * gene.max;
            assert!(smaller.min >= gene.min - tiny && smaller.max <= gene.max + tiny);
            assert!(smaller.min <= value + tiny && value <= smaller.max + tiny);
        }
    }
}
