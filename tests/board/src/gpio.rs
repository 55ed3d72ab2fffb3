//! GPIOA, GPIOB and GPIOC (RM0440): the levels that outputs are driven to, and those that others drive inputs to.
//!
//! Neither pull resistors nor open drains, nor what an alternate function does with its pin: these registers are plain
//! memory. A pin that nobody drives reads low.

use std::collections::BTreeMap;

use crate::{
    field,
    pin::{Pin, Port},
    record::Edge,
};

const MODER: u32 = 0x00;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const BRR: u32 = 0x28;

const OUTPUT: u32 = 1;

/// The levels that pins are driven to from outside.
pub type Levels = BTreeMap<Pin, bool>;

pub struct Gpio {
    port: Port,
    modes: u32,
    output: u32,
}

impl Gpio {
    pub fn new(port: Port) -> Self {
        let modes = match port {
            // The debug port's pins.
            Port::A => 0xABFF_FFFF,
            Port::B => 0xFFFF_FEBF,
            Port::C => 0xFFFF_FFFF,
        };
        Self { port, modes, output: 0 }
    }

    pub fn mode(&self, number: u8) -> u32 {
        field(self.modes, 2 * u32::from(number), 2)
    }

    /// The level of an output.
    fn driven(&self, number: u8) -> Option<bool> {
        (self.mode(number) == OUTPUT).then_some(self.output >> number & 1 != 0)
    }

    pub fn read(&self, offset: u32, levels: &Levels) -> Option<u32> {
        Some(match offset {
            MODER => self.modes,
            IDR => (0..16)
                .filter(|&number| {
                    let outside = || levels.get(&Pin { port: self.port, number }).copied();
                    self.driven(number).or_else(outside).unwrap_or(false)
                })
                .fold(0, |all, number| all | 1 << number),
            ODR => self.output,
            BSRR | BRR => 0,
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, now: u64, edges: &mut BTreeMap<Pin, Vec<Edge>>) -> bool {
        let before: [Option<bool>; 16] = std::array::from_fn(|number| self.driven(number as u8));
        match offset {
            MODER => self.modes = value,
            ODR => self.output = value & 0xFFFF,
            BSRR => self.output = self.output & !(value >> 16) | value & 0xFFFF,
            BRR => self.output &= !value,
            _ => return false,
        }
        for (number, before) in (0..).zip(before) {
            let after = self.driven(number);
            if let Some(high) = after.filter(|_| after != before) {
                edges.entry(Pin { port: self.port, number }).or_default().push(Edge { clock: now, high });
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_make_edges_and_inputs_show_what_is_outside() {
        let pin = |number| Pin { port: Port::B, number };
        let (mut gpio, mut edges) = (Gpio::new(Port::B), BTreeMap::new());
        // Pin 2 an output, pin 3 an input, the others as after a reset.
        let modes = 0xFFFF_FEBF & !(0xF << 4) | 1 << 4;
        for (clock, (offset, value)) in (0..).zip([
            (BSRR, 1 << 2 | 1 << 5),
            (MODER, modes),
            (BSRR, 1 << 2),
            (BRR, 1 << 2),
            (ODR, 4),
            (BSRR, 4 << 16),
        ]) {
            assert!(gpio.write(offset, value, clock, &mut edges));
        }
        let expected = [(1, true), (3, false), (4, true), (5, false)].map(|(clock, high)| Edge { clock, high });
        assert_eq!(edges, BTreeMap::from([(pin(2), expected.to_vec())]));
        assert_eq!(gpio.read(IDR, &Levels::from([(pin(3), true), (pin(2), true)])), Some(1 << 3));
        assert_eq!((gpio.read(BSRR, &Levels::new()), gpio.read(0x0C, &Levels::new())), (Some(0), None));
    }
}
