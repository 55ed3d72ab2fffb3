//! Tells a device its displacement, and sees that it has taken it.
//!
//! A device says that it is done when its next tick has yet to do it, and that may not: where the voltage has gone
//! wrong meanwhile, it keeps the bias that it has; where the estimate has begun anew, it has none. Only a bias that is
//! younger than the request is what came of it.

use crate::client::Client;
use crate::error::LinkError;
use crate::port::Address;
use protocol::Health;
use std::time::{Duration, Instant};

/// How long the device may take to do what it has said it does.
const OBEYED: Duration = Duration::from_secs(1);
/// How often it is looked at meanwhile.
const LOOK: Duration = Duration::from_millis(10);

/// Why a device has not been told its displacement.
#[derive(Debug, thiserror::Error)]
pub enum ToldError {
    /// The link fails, or the device refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// It has said that it is done, and has no bias that is younger than the request.
    #[error(
        "{port}: the device has not taken it: its voltage was not to be believed just then, or its estimate began anew"
    )]
    NotTaken {
        /// Address of the device.
        port: Address,
    },
}

/// Calls the displacement of now `at_um`, µm, and says how the device is once it does.
///
/// # Errors
/// The link fails, the device refuses, or it does not do what it has said.
pub fn zero(client: &mut Client, at_um: f32) -> Result<Health, ToldError> {
    told(client, |client| client.set_zero(at_um))
}

/// Adds `by_um`, µm, to the displacement, and says how the device is once it does.
///
/// # Errors
/// As for [`zero`].
pub fn shift(client: &mut Client, by_um: f32) -> Result<Health, ToldError> {
    told(client, |client| client.shift_bias(by_um))
}

fn told(client: &mut Client, tell: impl FnOnce(&mut Client) -> Result<(), LinkError>) -> Result<Health, ToldError> {
    let before = client.health()?.ticks;
    tell(client)?;
    let start = Instant::now();
    loop {
        let health = client.health()?;
        // What was told by then is at least as old.
        let since = health.ticks.wrapping_sub(before);
        if health.bias_age_ticks.is_some_and(|age| age < since) {
            return Ok(health);
        }
        if start.elapsed() > OBEYED {
            return Err(ToldError::NotTaken { port: client.address().clone() });
        }
        std::thread::sleep(LOOK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use emulator::faults::{requests, told_in_vain};
    use emulator::{EmulatedDevice, Emulator, Fault, FaultyLine};
    use protocol::{Mode, Refusal, Request, ToDevice};

    /// A device that has been told 1 µm, and how it is.
    fn told_before() -> (EmulatedDevice, Health) {
        let device = Emulator::new().speed(8.0).start().unwrap();
        let health = zero(&mut Client::connect(&device.address().into()).unwrap().0, 1.0).unwrap();
        (device, health)
    }

    fn over(device: &EmulatedDevice, fault: impl Fault) -> (FaultyLine, Client) {
        let line = FaultyLine::to(device.address(), fault).unwrap();
        let (client, _) = Client::connect(&line.address().into()).unwrap();
        (line, client)
    }

    #[test]
    fn what_is_taken_is_younger_than_the_request_whatever_was_told_before() {
        let (device, before) = told_before();
        assert!(before.bias_age_ticks.is_some());
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        std::thread::sleep(Duration::from_millis(50));
        let health = shift(&mut client, 2.0).unwrap();
        assert_eq!(health.bias_um, before.bias_um + 2.0);
        assert!(health.bias_age_ticks < Some(health.ticks - before.ticks), "{health:?}");
    }

    #[test]
    fn a_bias_that_was_there_before_is_not_taken_for_what_the_device_says_it_does() {
        let (device, before) = told_before();
        let (_line, mut client) = over(&device, told_in_vain());
        for shifts in [false, true] {
            let done = if shifts { shift(&mut client, 3.0) } else { zero(&mut client, 3.0) };
            assert!(matches!(&done, Err(ToldError::NotTaken { .. })), "{done:?}");
            let health = client.health().unwrap();
            assert!(health.bias_um == before.bias_um && health.bias_age_ticks.is_some(), "it is there: {health:?}");
        }
    }

    #[test]
    fn a_bias_that_is_forgotten_at_once_is_not_taken() {
        let device = Emulator::new().speed(8.0).start().unwrap();
        let paused = requests(|asked| {
            let told = matches!(asked.request, Request::SetZero { .. });
            // Of a number that nobody waits for.
            let pause = ToDevice { sequence: !asked.sequence, request: Request::SetMode(Mode::Pause) };
            std::iter::once(asked).chain(told.then_some(pause))
        });
        let (_line, mut client) = over(&device, paused);
        let done = zero(&mut client, 3.0);
        assert!(matches!(done, Err(ToldError::NotTaken { .. })), "{done:?}");
        let done = zero(&mut client, 3.0);
        let Err(ToldError::Link(LinkError::Refused { refusal, .. })) = done else { panic!("{done:?}") };
        assert_eq!(*refusal, Refusal::NotEstimating);
    }
}
