//! DAC1, channel 1 (RM0440): holding register, output register, and what loads the one into the other: TIM6's trigger or,
//! untriggered, a write. The pin is driven while the channel is on and its mode connects it.
//!
//! Loading takes no clock, and the output amplifier is awake at once (7.5 µs on silicon). Other triggers load nothing. Waves,
//! DMA, channel 2 and the other holding registers are plain memory.

use crate::{field, record::Latch};

const CR: u32 = 0x00;
const DHR12R1: u32 = 0x08;
const DOR1: u32 = 0x2C;
const MCR: u32 = 0x3C;

const EN: u32 = 1 << 0;
const TEN: u32 = 1 << 1;
/// TSEL1: TIM6's TRGO.
const TIM6_TRGO: u32 = 7;
/// MODE1, its lower two bits: the one mode without the pin.
const INTERNAL: u32 = 3;

#[derive(Default)]
pub struct Dac {
    control: u32,
    mode: u32,
    holding: u16,
    output: u16,
}

impl Dac {
    /// TIM6's trigger.
    pub fn trigger(&mut self, at: u64, outputs: &mut Vec<Latch>) {
        if self.control & (EN | TEN) == EN | TEN && field(self.control, 2, 4) == TIM6_TRGO {
            self.output = self.holding;
            outputs.push(Latch { clock: at, code: self.output });
        }
    }

    /// What the pin shows: nothing while it is not driven.
    pub fn output(&self) -> Option<u16> {
        (self.control & EN != 0 && self.mode & INTERNAL != INTERNAL).then_some(self.output)
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            CR => self.control,
            DOR1 => self.output.into(),
            MCR => self.mode,
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, now: u64, outputs: &mut Vec<Latch>) -> bool {
        let before = self.output();
        match offset {
            CR => self.control = value,
            DHR12R1 => self.holding = (value & 0xFFF) as u16,
            // Writable while the channel is off.
            MCR if self.control & EN == 0 => self.mode = value,
            MCR => {}
            _ => return false,
        }
        if self.control & (EN | TEN) == EN {
            self.output = self.holding;
        }
        if let Some(code) = self.output().filter(|&code| before != Some(code)) {
            outputs.push(Latch { clock: now, code });
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triggered_it_waits_untriggered_it_does_not() {
        let (mut dac, mut outputs) = (Dac::default(), Vec::new());
        dac.write(DHR12R1, 100, 0, &mut outputs);
        dac.write(CR, EN | TEN | TIM6_TRGO << 2, 1, &mut outputs);
        dac.write(DHR12R1, 200, 2, &mut outputs);
        dac.trigger(3, &mut outputs);
        dac.write(DHR12R1, 300, 4, &mut outputs);
        dac.write(CR, EN, 5, &mut outputs);
        dac.trigger(6, &mut outputs);
        dac.write(CR, EN | TEN, 7, &mut outputs);
        dac.write(DHR12R1, 400, 8, &mut outputs);
        dac.trigger(9, &mut outputs);
        let expected = [(1, 0), (3, 200), (5, 300)].map(|(clock, code)| Latch { clock, code });
        assert_eq!(outputs, expected, "the last trigger is another's");
        dac.write(CR, 0, 11, &mut outputs);
        assert_eq!(dac.output(), None);
    }

    #[test]
    fn the_pin_shows_nothing_before_it_is_connected() {
        let (mut dac, mut outputs) = (Dac::default(), Vec::new());
        let writes = [(MCR, INTERNAL), (CR, EN), (DHR12R1, 100), (MCR, 0), (CR, 0), (MCR, 0), (CR, EN)];
        for (clock, (offset, value)) in (0..).zip(writes) {
            dac.write(offset, value, clock, &mut outputs);
        }
        assert_eq!(outputs, [Latch { clock: 6, code: 100 }], "the mode cannot change while the channel is on");
    }
}
