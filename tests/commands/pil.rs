//! `piezo pil` on a line on which things go wrong.

use super::{MEASURED, piezo};
use device_link::Client;
use emulator::faults::{lose_samples_at, wrong_bit_at};
use emulator::{Emulator, Fault, FaultyLine};
use protocol::Mode;

#[test]
fn whatever_happens_the_device_estimates_again() {
    let ends: [(&str, Box<dyn Fault>, i32); 3] = [
        ("nothing", Box::new(|_, _: &mut Vec<u8>| {}), 0),
        ("a wrong bit", Box::new(wrong_bit_at(100)), 1),
        ("lost samples", Box::new(lose_samples_at(100)), 2),
    ];
    for (what, fault, expected) in ends {
        let device = Emulator::new().speed(8.0).start().unwrap();
        let line = FaultyLine::to(device.address(), fault).unwrap();
        let port = format!("tcp:{}", line.address());
        let done = piezo().args(["pil", MEASURED, "--limit", "1000", "--json", "--port", &port]).output().unwrap();
        assert_eq!(done.status.code(), Some(expected), "{what}");
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        assert_eq!(client.health().unwrap().mode, Mode::Estimate, "{what}");
    }
}
