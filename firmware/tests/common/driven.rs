//! A driving tick behind whose DAC there is an amplifier.

use super::{LinkEnd, PERIOD, driving, tick};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, DacCode, Status};
use firmware::queues::Command;
use firmware::{Conversion, Tick};
use protocol::{Faults, Mode, Sample};

/// Half a volt on the drive's scale.
pub const REST: DacCode = DacCode(512);

/// 40 V/s are 20 mV or 20.5 codes a tick.
pub const STRIDE: u16 = 21;

/// A driving tick and its ADC, which reads the amplifier.
pub struct Bench {
    pub tick: Tick<'static>,
    pub link: LinkEnd,
    pub k: u32,
    pub dac: DacCode,
}

impl Bench {
    pub fn new() -> Self {
        let (tick, link) = tick(Some(&driving()), Faults::empty());
        link.telemetry.streaming.store(true, Relaxed);
        Self { tick, link, k: 0, dac: REST }
    }

    pub fn set(&mut self, mode: Mode) {
        self.link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
    }

    pub fn go(&mut self, hold: bool) {
        self.link.queues.commands.enqueue(Command::Go { hold }).unwrap();
    }

    /// A tick that reads this, and its sample, if it gives one.
    pub fn read(&mut self, conversion: Conversion) -> (DacCode, Option<Sample>) {
        self.k += 1;
        // A part is a code here.
        let dac = DacCode(self.tick.sample(conversion, self.k * PERIOD).0);
        self.dac = dac;
        let sample = std::iter::from_fn(|| self.link.queues.samples.dequeue()).last().map(|numbered| numbered.sample);
        if let Some(sample) = sample {
            assert_eq!(DacCode(sample.dac), dac, "the sample says what the DAC was given");
        }
        (dac, sample)
    }

    pub fn step_with(&mut self, code: AdcCode) -> (DacCode, Status, Faults) {
        let (dac, sample) = self.read(code.into());
        let (status, faults) = sample.map_or((Status::empty(), Faults::all()), |s| (s.status, s.faults));
        (dac, status, faults)
    }

    pub fn step(&mut self) -> (DacCode, Status, Faults) {
        self.step_with(self.amplifier())
    }

    /// What an amplifier does that is told to go where the DAC stands, with a converter's noise.
    pub fn amplifier(&self) -> AdcCode {
        let table = driving();
        let AdcCode(code) = table.adc.code(table.drive.unwrap().voltage::<f32>(self.dac));
        AdcCode(code + (self.k % 2) as u16)
    }
}
