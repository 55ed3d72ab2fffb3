//! What can be changed of the synthetic rig.

use clap::Args;
use recordings::rig::Rig;

const DEFAULT: Rig = Rig::DEFAULT;

/// What can be changed of the rig. The defaults are the reference.
#[derive(Args, Clone, Debug)]
pub struct RigArgs {
    /// Voltage amplitude, V.
    #[arg(long, default_value_t = DEFAULT.amplitude, allow_negative_numbers = true)]
    pub amplitude: f64,
    /// Length of a log, s.
    #[arg(long, default_value_t = DEFAULT.duration, allow_negative_numbers = true)]
    pub duration: f64,
    /// Samples a second, Hz.
    #[arg(long, default_value_t = DEFAULT.fs, allow_negative_numbers = true)]
    pub fs: f64,
    /// Cut-off frequency of the amplifier, Hz.
    #[arg(long, default_value_t = DEFAULT.cutoff, allow_negative_numbers = true)]
    pub cutoff: f64,
    /// Factor on the hysteresis (the plays wider than 0).
    #[arg(long, default_value_t = DEFAULT.hysteresis, allow_negative_numbers = true)]
    pub hysteresis: f64,
    /// Factor on the creep.
    #[arg(long, default_value_t = DEFAULT.creep, allow_negative_numbers = true)]
    pub creep: f64,
    /// Asymmetry of the hysteresis, 1/µm.
    #[arg(long, default_value_t = DEFAULT.asymmetry, allow_negative_numbers = true)]
    pub asymmetry: f64,
    /// Sensor noise, nm rms.
    #[arg(long, default_value_t = DEFAULT.noise_nm, allow_negative_numbers = true)]
    pub noise_nm: f64,
    /// Noise of the recorded voltage, V rms.
    #[arg(long, default_value_t = DEFAULT.voltage_noise, allow_negative_numbers = true)]
    pub voltage_noise: f64,
    /// Record the voltage as a converter of this many bits over ±110 % of the amplitude would.
    #[arg(long, value_parser = clap::value_parser!(u8).range(4..=24), allow_negative_numbers = true)]
    pub adc_bits: Option<u8>,
    /// Seed of the noise.
    #[arg(long, default_value_t = DEFAULT.seed, allow_negative_numbers = true)]
    pub seed: u64,
}

options!(RigArgs => Rig {
    amplitude, duration, fs, cutoff, hysteresis, creep, asymmetry, noise_nm, voltage_noise, adc_bits, seed,
});
