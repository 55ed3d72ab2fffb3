//! What tests of several modules are made with.

use crate::prepared;
use estimator_core::{DuhemParameters, Parameters};
use recordings::log::Log;
use recordings::prepare::PrepareOptions;
use recordings::rig::{Excitation, Rig};
use recordings::session::Session;

/// Of about the rig's gain.
pub(crate) fn duhem() -> Parameters {
    Parameters::Duhem(DuhemParameters {
        lag_s: 1e-3,
        alpha_per_v: 0.1,
        saturation_v: 40.0,
        voltage_centre_v: 0.0,
        offset_um: 0.0,
        f1_um_per_v: 0.2,
        f3_um_per_v3: 0.0,
        g0_um_per_v: 0.15,
        g2_um_per_v3: 0.0,
    })
}

/// Half a second of the rig.
pub(crate) fn session(excitation: Excitation) -> Session {
    let log = Rig { duration: 0.5, ..Rig::default() }.log(excitation);
    prepared(&PrepareOptions::default().resolve(std::slice::from_ref(&log)), &log).unwrap()
}

/// A log of simulated instruments, every sample of which has a reading.
pub(crate) fn recorded(log: Log) -> Session {
    let instants = (0..log.voltage.len() as u32).collect();
    Session::new(log.name, log.voltage, instants, log.displacement.unwrap(), log.sample_period)
}
