//! Frames that are no requests.

use super::frame;
use protocol::{Record, Request};

/// A linear congruential generator; its upper bits are good enough for noise.
pub struct Noise(u32);

impl Noise {
    pub fn new(seed: u32) -> Self {
        Self(seed)
    }

    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as usize % limit
    }

    /// A frame, delimiter included, that is no request; never one that would be whole.
    pub fn bad_frame(&mut self) -> Vec<u8> {
        let record = || Record::from_iter([7; 20]);
        let mut bytes = match self.below(6) {
            0 => frame(7, Request::Reset),
            1 => frame(7, Request::Erase { while_estimating: true, rewired: true }),
            2 => frame(7, Request::Push { record: record(), while_estimating: true, rewired: true }),
            3 => frame(7, Request::Health),
            _ => (0..1 + self.below(40)).map(|_| self.below(256) as u8).collect(),
        };
        let last = bytes.len() - 1;
        if self.below(2) == 0 {
            bytes[self.below(last.max(1))] ^= 1 + self.below(255) as u8;
        } else {
            bytes.truncate(self.below(last.max(1)));
        }
        bytes.push(0);
        bytes
    }
}
