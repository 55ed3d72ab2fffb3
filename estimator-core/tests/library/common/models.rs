//! A table of every model, over −20 … 80 V, as long as a record of it may be.

use super::{VOIGT, table};
use estimator_core::model::{CELLS, ELEMENTS};
use estimator_core::*;

fn list<const N: usize>(numbers: impl IntoIterator<Item = f32>) -> List<N> {
    List::collect(numbers).expect("no more than fit")
}

/// Parameters of a model.
pub fn parameters(model: Model) -> Parameters {
    let memory_v = Range { min: -20.0, max: 80.0 };
    match model {
        Model::VoigtChain => Parameters::VoigtChain(VoigtChainParameters {
            offset_um: -1.5,
            instantaneous_um_per_v: 0.2,
            voltage_extremum_um_per_v: -0.01,
            deadband_v: 0.1,
            gains_um_per_v: list((0..20).map(|i| 0.002 + 0.0001 * i as f32)),
            // (`powi` rounds as the optimiser likes.)
            times_s: list(std::iter::successors(Some(0.001f32), |time| Some(1.7 * time)).take(20)),
            memory_v,
        }),
        Model::PrandtlIshlinskii => Parameters::PrandtlIshlinskii(PrandtlIshlinskiiParameters {
            lag_s: 5e-4,
            thresholds_v: list((0..16).map(|i| 2.5 * i as f32)),
            weights_um_per_v: list((0..16).map(|i| if i == 0 { 0.08 } else { 0.01 })),
            offset_um: 0.5,
            dead_zones_um: list([-6.0, -4.0, -3.0, -1.0, 0.0, 2.0, 4.0, 6.0]),
            dead_zone_slopes: list([0.1, 0.1, 0.3, -0.4, 1.2, 0.5, -0.3, 0.2]),
            memory_v,
        }),
        Model::MaxwellSlip => Parameters::MaxwellSlip(MaxwellSlipParameters {
            lag_s: 1e-3,
            stiffness_v_per_um: list([1.0; ELEMENTS]),
            saturation_v: list((0..ELEMENTS).map(|i| 1.0 + i as f32)),
            base_stiffness_v_per_um: 5.0,
            offset_v: 2.0,
        }),
        Model::Duhem => Parameters::Duhem(DuhemParameters {
            lag_s: 1e-3,
            alpha_per_v: 0.03,
            saturation_v: 80.0,
            voltage_centre_v: 30.0,
            offset_um: 0.0,
            f1_um_per_v: 0.2,
            f3_um_per_v3: 2e-6,
            g0_um_per_v: 0.15,
            g2_um_per_v3: 4e-6,
        }),
        Model::BoucWen => Parameters::BoucWen(BoucWenParameters {
            lag_s: 1e-3,
            a: 1.0,
            beta: 0.08,
            gamma: 0.03,
            delta: 0.02,
            n: 1.5,
            offset_um: 2.0,
            d1_um_per_v: 0.2,
            d2_um_per_v2: 4e-4,
            c_um_per_v: -0.1,
        }),
        Model::Preisach => Parameters::Preisach(PreisachParameters {
            lag_s: 0.0,
            lower_v: -20.0,
            upper_v: 80.0,
            densities_um: list([0.3; CELLS]),
            offset_um: -1.5,
        }),
        Model::Narx => Parameters::Narx(NarxParameters {
            output_order: 3,
            input_order: 3,
            degree: 3,
            with_voltage_extremum: true,
            with_displacement_extremum: true,
            voltage_centre_v: 30.0,
            voltage_scale_v: 50.0,
            displacement_centre_um: 10.0,
            displacement_scale_um: 20.0,
            deadband_v: 0.1,
            coefficients: list((0..39).map(|i| if i == 0 { 0.3 } else { 0.01 })),
            limits_um: Range { min: -20.0, max: 30.0 },
        }),
        Model::GeneralisedPrandtlIshlinskii => {
            Parameters::GeneralisedPrandtlIshlinskii(GeneralisedPrandtlIshlinskiiParameters {
                span_v: memory_v,
                delay_ticks: 1.4,
                slew_v_per_s: 30_000.0,
                lag_s: 1e-3,
                resonance_hz: 400.0,
                damping: 0.1,
                reversible_um_per_v: list((0..9).map(|i| 0.1 + 0.005 * i as f32)),
                envelope_um_per_v: list((0..135).map(|i| 0.12 - 0.01 * (i % 9) as f32)),
                half_widths_v: list((1..16).map(|i| 3.3 * i as f32)),
                weights: list((1..16).map(|i| 0.3 / i as f32)),
                creep_times_s: list([0.01, 0.1, 1.0, 10.0, 100.0]),
                creep_gains: list([0.02; 5]),
                rest_memory: 0.2,
                offset_um: -5.0,
            })
        }
        Model::Voigt | Model::VoltageExtremum | Model::DisplacementExtremum | Model::Enhanced => {
            Parameters::of_voigt_family(model, VOIGT)
        }
    }
}

/// A drive over 0 … 60 V.
pub const DRIVE: DriveCalibration = DriveCalibration {
    gain_codes_per_v: 4095.0 / 80.0,
    offset_code: 409.5,
    limits: DriveLimits { range_v: Range { min: 0.0, max: 60.0 }, rest_v: 5.0, slew_v_per_s: 20_000.0 },
    setpoint: Some(SetpointCalibration { gain_um_per_code: 120.0 / 8191.0, offset_um: -60.0, at_start: true }),
};

/// A table of a model; those beyond the Voigt family as long as they may be.
pub fn table_of(model: Model) -> Table {
    if model.is_voigt() {
        return Table { parameters: parameters(model), ..table() };
    }
    Table {
        voltage_range_v: Range { min: -20.0, max: 80.0 },
        displacement_limits_um: Range { min: -60.0, max: 90.0 },
        parameters: parameters(model),
        remanence_um: if model.remembers() { [0.25, -0.15] } else { [0.0; 2] },
        deadband_v: 0.1,
        drive: (model != Model::Narx).then_some(DRIVE),
        ..table()
    }
}
