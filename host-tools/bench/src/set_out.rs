//! Having a device follow its set-point, and waiting until it does.

use device_link::{Client, LinkError};
use protocol::{Faults, Health, Mode};
use std::time::{Duration, Instant};

/// How long to wait for it; the device goes to rest and looks at its inputs for a second first.
const PATIENCE: Duration = Duration::from_secs(5);
const POLL: Duration = Duration::from_millis(50);

/// How the device is as soon as it follows the set-point, or when it has had time enough to.
///
/// # Errors
/// The device does not answer, or refuses.
pub fn set_out(client: &mut Client) -> Result<Health, LinkError> {
    client.set_mode(Mode::Linearise)?;
    let start = Instant::now();
    loop {
        let health = client.health()?;
        if !health.faults.contains(Faults::SAFE_OUTPUT) || start.elapsed() > PATIENCE {
            return Ok(health);
        }
        std::thread::sleep(POLL);
    }
}
