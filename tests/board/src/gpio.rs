//! GPIOA, GPIOB and GPIOC (RM0440): the levels that outputs are driven to, and those that others drive inputs to.
//!
//! Neither pull resistors nor open drains, nor what an alternate function does with its pin: these registers are plain
//! memory. A pin that nobody drives reads low.

use std::collections::BTreeMap;

use crate::{
    layout::{field, layout},
    pin::{Pin, Port},
    record::Edge,
};

layout! {
    "GPIOA" {
        MODER @ 0x00 { MODER0 = 0..=1, MODER15 = 30..=31 }
        IDR @ 0x10 { IDR0 = 0, IDR15 = 15 }
        ODR @ 0x14 { ODR0 = 0, ODR15 = 15 }
        BSRR @ 0x18 { BS0 = 0, BS15 = 15, BR0 = 16, BR15 = 31 }
        BRR @ 0x28 { RESET0 as "BR0" = 0, RESET15 as "BR15" = 15 }
    }
}

/// A bit a pin, from the lowest on; two in MODER.
const PINS: u32 = 0xFFFF;
const _: () = assert!(MODER0 == 3 && MODER15 == MODER0 << (2 * 15));
const _: () = assert!(IDR0 | IDR15 == ODR0 | ODR15 && IDR0 | IDR15 == RESET0 | RESET15 && IDR0 | IDR15 == BS0 | BS15);
const _: () = assert!(BR0 == BS0 << 16 && BR15 == BS15 << 16 && BS0 | BS15 == PINS & !(PINS >> 1) | 1);

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
        field(self.modes, MODER0 << (2 * number))
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
            ODR => self.output = value & PINS,
            BSRR => self.output = self.output & !field(value, PINS << 16) | value & PINS,
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
