//! A second host comes while a first one streams.

use std::{process::Stdio, time::Duration};

use device_link::Client;

use crate::Attacked;

impl Attacked<'_> {
    /// The second host waits, learns that another may be there, and does not disturb the first; once that one has gone,
    /// it is answered.
    ///
    /// # Panics
    /// The first misses a sample, or the second is answered too early, or never.
    pub fn a_second_host_comes(&self) {
        let device = (self.power_on)();
        let (mut first, _) = Client::connect(&device.address().into()).unwrap();
        first.stream(true).unwrap();
        let info = || self.host(&["info"], self.folder, device.address());
        let mut second = info().stderr(Stdio::piped()).spawn().unwrap();
        let mut next = None;
        let status = loop {
            while let Some(batch) = first.samples(Duration::ZERO).unwrap() {
                assert!(next.is_none_or(|next| next == batch.first), "a gap before {}", batch.first);
                next = Some(batch.first + batch.samples.len() as u32);
            }
            first.health().unwrap();
            if let Some(status) = second.try_wait().unwrap() {
                break status;
            }
        };
        assert_eq!(status.code(), Some(2));
        assert!(next.is_some(), "the stream went on");
        let said = String::from_utf8(second.wait_with_output().unwrap().stderr).unwrap();
        assert!(said.contains("no answer") && said.contains("other program connected"), "{said}");
        drop(first);
        let after = info().output().unwrap();
        assert!(after.status.success(), "{}", String::from_utf8_lossy(&after.stderr));
    }
}
