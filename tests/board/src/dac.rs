//! DAC1, channel 1 (RM0440): holding register, output register, and what loads the one into the other: TIM6's or TIM7's
//! trigger or, while the channel is on and untriggered, a write of the holding register. No other write does: the
//! manual's words ("data written into DHR is transferred") leave open whether what was written before a change of TEN1
//! or EN1 counts, so here it does not; a channel that is switched off forgets its output. The pin is driven while the
//! channel is on and its mode connects it.
//!
//! With DMAEN1 a trigger that loads asks for DMA, which brings what the next one loads. A trigger that comes before it
//! was served flags an underrun: it loads what there is, and no further one asks.
//!
//! Loading takes no clock, and the output amplifier wakes soon (up to 7.5 µs on silicon). Other triggers load nothing.
//! Waves, the underrun's interrupt, channel 2 and the other holding registers are plain memory.

use anyhow::{Result, ensure};

use crate::{
    layout::{field, layout},
    microseconds,
    record::Latch,
};

layout! {
    "DAC1" {
        CR @ 0x00 { EN1 = 0, TEN1 = 1, TSEL1 = 2..=5, DMAEN1 = 12 }
        DHR12R1 @ 0x08 { DACC1DHR = 0..=11 }
        DOR1 @ 0x2C {}
        SR @ 0x34 { DMAUDR1 = 13 }
        MCR @ 0x3C { MODE1 = 0..=2, HFSEL = 14..=15 }
    }
}

/// TSEL1: which timer's TRGO.
pub const TIM6_TRGO: u32 = 7;
pub const TIM7_TRGO: u32 = 2;
/// MODE1 without its highest bit, which chooses sample and hold: the one mode without the pin.
const INTERNAL: u32 = MODE1 >> 1;

/// HFSEL: what it must say where the core's bus, which is the DAC's, is faster than 160 MHz.
const FASTEST: u32 = 2;
/// How soon the pin shows the output of a channel that has been switched on, core clocks: what is loaded before,
/// it never shows.
const WAKE: u64 = microseconds(1);

#[derive(Default)]
pub struct Dac {
    control: u32,
    mode: u32,
    holding: u16,
    output: u16,
    /// A request for DMA waits.
    requests: bool,
    /// One came too late.
    underrun: bool,
    /// The clock at which the output amplifier wakes, before it has.
    wakes: Option<u64>,
}

impl Dac {
    /// A timer's trigger.
    pub fn trigger(&mut self, at: u64, trigger: u32, outputs: &mut Vec<Latch>) {
        self.wake(at, outputs);
        if self.control & (EN1 | TEN1) == EN1 | TEN1 && field(self.control, TSEL1) == trigger {
            self.output = self.holding;
            outputs.push(Latch { clock: at, code: self.output });
            if self.control & DMAEN1 != 0 {
                self.underrun |= self.requests;
                self.requests = !self.underrun;
            }
        }
    }

    /// Whether DMA is asked for the next code.
    pub fn requests(&self) -> bool {
        self.requests
    }

    /// The code that DMA brings.
    pub fn take(&mut self, code: u16) {
        (self.holding, self.requests) = (field(code.into(), DACC1DHR) as u16, false);
    }

    fn wake(&mut self, now: u64, outputs: &mut Vec<Latch>) {
        if let Some(clock) = self.wakes.take_if(|at| *at <= now) {
            outputs.extend(self.output().map(|code| Latch { clock, code }));
        }
    }

    /// What the pin shows: nothing while it is not driven.
    pub fn output(&self) -> Option<u16> {
        (self.control & EN1 != 0 && self.mode & INTERNAL != INTERNAL).then_some(self.output)
    }

    pub fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            CR => self.control,
            DOR1 => self.output.into(),
            SR => u32::from(self.underrun) * DMAUDR1,
            MCR => self.mode,
            _ => return None,
        })
    }

    pub fn write(&mut self, offset: u32, value: u32, now: u64, outputs: &mut Vec<Latch>) -> Result<bool> {
        self.wake(now, outputs);
        let before = self.output();
        match offset {
            CR => {
                match (self.control & EN1, value & EN1) {
                    (0, EN1) => self.wakes = Some(now + WAKE),
                    (EN1, 0) => (self.output, self.wakes) = (0, None),
                    _ => {}
                }
                self.control = value;
                self.requests &= value & DMAEN1 != 0;
            }
            SR => self.underrun &= value & DMAUDR1 == 0,
            DHR12R1 => {
                self.holding = field(value, DACC1DHR) as u16;
                if self.control & (EN1 | TEN1) == EN1 {
                    self.output = self.holding;
                }
            }
            // Writable while the channel is off.
            MCR if self.control & EN1 == 0 => self.mode = value,
            MCR => {}
            _ => return Ok(false),
        }
        ensure!(
            self.output().is_none() || field(self.mode, HFSEL) == FASTEST,
            "the DAC drives its pin, and its MCR ({:#x}) does not say how fast its clock is",
            self.mode
        );
        if let Some(code) = self.output().filter(|&code| before != Some(code) && self.wakes.is_none()) {
            outputs.push(Latch { clock: now, code });
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAST: u32 = FASTEST << HFSEL.trailing_zeros();

    fn fast() -> Dac {
        Dac { mode: FAST, ..Dac::default() }
    }

    /// What the pin shows of these writes and triggers, each an amplifier's wake-up after the one before.
    fn shown(dac: &mut Dac, steps: &[Option<(u32, u32)>]) -> Vec<(u64, u16)> {
        let mut outputs = Vec::new();
        for (step, write) in (0..).zip(steps) {
            match *write {
                Some((offset, value)) => assert!(dac.write(offset, value, step * WAKE, &mut outputs).unwrap()),
                None => dac.trigger(step * WAKE, TIM6_TRGO, &mut outputs),
            }
        }
        outputs.into_iter().map(|Latch { clock, code }| (clock / WAKE, code)).collect()
    }

    #[test]
    fn triggered_it_waits_untriggered_it_takes_what_is_written_and_nothing_else() {
        let mut dac = fast();
        let steps = [
            Some((DHR12R1, 100)),
            Some((CR, EN1 | TEN1 | TIM6_TRGO << 2)),
            Some((DHR12R1, 200)),
            None,
            Some((DHR12R1, 300)),
            Some((CR, EN1)),
            Some((DHR12R1, 300)),
            None,
            Some((CR, EN1 | TEN1)),
            Some((DHR12R1, 400)),
            None,
        ];
        let expected = [(2, 0), (3, 200), (6, 300)];
        assert_eq!(shown(&mut dac, &steps), expected, "no write of CR loads, and the last trigger is another's");
        assert_eq!(dac.read(DOR1), Some(300));
        dac.write(CR, 0, 0, &mut Vec::new()).unwrap();
        assert_eq!(dac.output(), None);
    }

    #[test]
    fn the_pin_shows_nothing_before_it_is_connected_and_forgets_when_switched_off() {
        let writes =
            [(MCR, INTERNAL), (CR, EN1), (DHR12R1, 100), (MCR, FAST), (CR, 0), (MCR, FAST), (CR, EN1), (MCR, FAST)];
        let outputs = shown(&mut Dac::default(), &writes.map(Some));
        assert_eq!(outputs, [(7, 0)], "the mode cannot change while the channel is on");
    }

    #[test]
    fn what_is_loaded_before_the_amplifier_wakes_is_all_that_shows() {
        let (mut dac, mut outputs) = (fast(), Vec::new());
        for (clock, (offset, value)) in (0..).zip([(CR, EN1), (DHR12R1, 100), (CR, EN1 | TEN1 | TIM6_TRGO << 2)]) {
            dac.write(offset, value, clock, &mut outputs).unwrap();
        }
        dac.trigger(2 * WAKE, TIM6_TRGO, &mut outputs);
        assert_eq!(outputs, [WAKE, 2 * WAKE].map(|clock| Latch { clock, code: 100 }));
    }

    #[test]
    fn dma_brings_what_the_next_trigger_loads_and_one_that_is_late_is_the_last() {
        let (mut dac, mut outputs) = (fast(), Vec::new());
        for (offset, value) in [(DHR12R1, 1), (CR, EN1 | TEN1 | DMAEN1 | TIM7_TRGO << 2)] {
            dac.write(offset, value, 0, &mut Vec::new()).unwrap();
        }
        assert!(!dac.requests(), "a trigger asks");
        for code in [2, 3] {
            dac.trigger(WAKE, TIM6_TRGO, &mut outputs);
            assert!(!dac.requests(), "another's trigger does not");
            dac.trigger(WAKE, TIM7_TRGO, &mut outputs);
            assert!(dac.requests());
            dac.take(code);
        }
        for _ in 0..3 {
            assert_eq!(dac.read(SR), Some(0));
            dac.trigger(WAKE, TIM7_TRGO, &mut outputs);
            if dac.read(SR) == Some(0) {
                dac.trigger(WAKE, TIM7_TRGO, &mut outputs);
            }
            assert_eq!((dac.read(SR), dac.requests()), (Some(DMAUDR1), false));
            dac.write(SR, DMAUDR1, WAKE, &mut outputs).unwrap();
        }
        let shown: Vec<u16> = outputs.iter().map(|latch| latch.code).collect();
        assert_eq!(shown[..4], [0, 1, 2, 3]);
        assert!(shown[4..].iter().all(|&code| code == 3));
    }

    #[test]
    fn its_clock_must_be_told_before_the_pin_is_driven() {
        for (mode, fine) in [(0, false), (1 << HFSEL.trailing_zeros(), false), (INTERNAL, true), (FAST, true)] {
            let mut dac = Dac { mode, ..Dac::default() };
            assert_eq!(dac.write(CR, EN1, 0, &mut Vec::new()).is_ok(), fine, "{mode:#x}");
        }
    }
}
