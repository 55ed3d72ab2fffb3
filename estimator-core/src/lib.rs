//! Displacement of a piezo actuator from the amplifier's voltage alone.
//!
//! No `std`, no allocation, no I/O, no `unsafe`. Everything is generic over [`Real`] (`f32` on the target, `f64` as the
//! reference), so the number that was validated on the host and the number that leaves the DAC come from one source.
//!
//! ```text
//! bytes ─► Table::parse ─► Admitted ─┬► Estimator ── AdcCode ─► tick ─► Estimate { displacement, half_width, DacCode, Status }
//!               │                    ├► Inverse ── reference ─► tick ─► Commanded { voltage, displacement, reached }
//!               │                    └► Engine: any model with its memory, built from the published parameters
//!               └─ refuses what is truncated, corrupt, of another version, not finite, or not admissible
//! ```
//!
//! An estimate, from the bytes that `piezo identify` writes as `table.bin`:
//!
//! ```
//! use estimator_core::{AdcCode, Estimate, Estimator, Status, Table};
//!
//! # fn main() -> Result<(), estimator_core::TableError> {
//! let table = Table::parse(include_bytes!("../../tests/data/table/table.bin"))?;
//! let mut estimator = Estimator::<f32>::new(&table);
//! // Each tick of the table's `sample_period_us`: what the ADC converted.
//! for code in [20_000, 20_010, 20_030, 20_060].map(AdcCode) {
//!     let Estimate { displacement, half_width, dac, status } = estimator.tick(code);
//!     assert!(table.displacement_limits_um.contains(displacement) && dac.0 <= table.dac.full_scale);
//!     // The voltage has not turned yet: where the actuator stood before the first tick still counts. Nor has anybody told where
//!     // it stands, so that how far the estimate may be off is not known.
//!     assert!(status.contains(Status::NOT_SETTLED) && half_width.is_none());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! `examples/tick.rs` runs a table over voltages of a file.
//!
//! Equation, table and page numbers are those of the thesis "An Evolutionary Approach to Physics-based Modelling of
//! Piezoelectric Actuators". Units are µm, V and s throughout; a field that differs says so in its name.
#![cfg_attr(not(test), no_std)]

pub mod admissible;
pub mod calibration;
pub mod estimator;
pub mod extremum;
pub mod interval;
pub mod inverse;
pub mod list;
pub mod math;
pub mod model;
pub mod range;
pub mod record;
pub mod rule;
pub mod sealed;
pub mod settling;
pub mod table;
pub mod transition;

pub use admissible::Inadmissible;
pub use calibration::{
    AdcCalibration, AdcCode, DacCalibration, DacCode, DriveCalibration, DriveLimits, SetpointCalibration,
};
pub use estimator::{Estimate, Estimator, Status};
pub use extremum::{Extremum, Tracker};
pub use interval::IntervalParameters;
pub use inverse::{Commanded, Inverse, InverseContext, NoInverse};
pub use list::List;
pub use math::Real;
pub use model::{
    BoucWen, BoucWenParameters, Discretisation, Duhem, DuhemCondition, DuhemParameters, Engine,
    GeneralisedPrandtlIshlinskii, GeneralisedPrandtlIshlinskiiParameters, Linear, MaxwellSlip, MaxwellSlipParameters,
    Model, Narx, NarxParameters, Parameters, PrandtlIshlinskii, PrandtlIshlinskiiParameters, Preisach,
    PreisachParameters, Process, Published, Recursion, Remanence, Resonance, ResonanceState, Running, Scheme, Stop,
    Superposition, Voigt, VoigtChain, VoigtChainParameters, VoigtParameters, VoigtPoint, VoigtState, VoigtTerms, solve,
};
pub use range::Range;
pub use rule::Rule;
pub use table::{Admitted, Digest, Provenance, Table, TableError};
pub use transition::{Pace, Transition};
