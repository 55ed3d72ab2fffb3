//! What the runs of an exception's handler cost: their instructions are recorded and then counted by a model of the
//! core and of the flash, which [`pipeline`] describes. It is a model made from manuals, not a measurement on silicon;
//! what it is good for is to tell by how much the clocks exceed the instructions, and by how much more they could.
//!
//! Recording costs the emulator a third of its speed and is off before [`Board::measure`](crate::Board::measure).

mod flash;
mod instruction;
mod pipeline;

pub use pipeline::Level;

use anyhow::{Context, Result};

use crate::image::Image;
use flash::Caches;
use instruction::{Decoder, ENOUGH, Instruction};
use pipeline::Step;

/// Of a word of a trace: it is the address of data that was read from the flash, not of an instruction.
const DATA: u32 = 1 << 31;
/// One in so many runs is counted for the mean; all are that come within a fiftieth of the longest.
const EVERY: u64 = 37;

/// What the runs of a handler cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measured {
    /// How often it ran.
    pub runs: u64,
    /// Most instructions of one.
    pub most_instructions: u64,
    /// Their sum over all runs.
    pub instructions: u64,
    /// Most clocks of one, by [level](Level).
    pub most_clocks: [u64; 3],
    /// Runs of which the clocks were summed.
    sampled: u64,
    clocks: [u64; 3],
}

impl Measured {
    /// The mean of a run's clocks, by [level](Level).
    #[must_use]
    pub fn mean_clocks(&self) -> [f64; 3] {
        self.clocks.map(|sum| sum as f64 / self.sampled.max(1) as f64)
    }
}

/// Records an exception's handler.
pub struct Meter {
    pub(crate) exception: u8,
    /// What its present run has executed, and read from the flash.
    pub(crate) trace: Vec<u32>,
    code: Vec<u8>,
    wait_states: u64,
    decoder: Decoder,
    /// Instructions by their half-word in bank 1, as far as they have been met.
    decoded: Vec<Option<Instruction>>,
    measured: Measured,
}

impl Meter {
    /// Of an exception's handler in the code of bank 1, which the flash gives after so many wait states.
    pub(crate) fn new(exception: u8, code: Vec<u8>, wait_states: u64) -> Result<Self> {
        Ok(Self {
            exception,
            trace: Vec::new(),
            code,
            wait_states,
            decoder: Decoder::new()?,
            decoded: std::iter::repeat_with(|| None).take(Image::SIZE / 2).collect(),
            measured: Measured::default(),
        })
    }

    /// What the runs so far cost.
    pub(crate) fn measured(&self) -> Measured {
        self.measured
    }

    /// The data at an address of the flash is read.
    pub(crate) fn load(&mut self, address: u32) {
        self.trace.push(address | DATA);
    }

    /// The handler has returned.
    pub(crate) fn finish(&mut self) -> Result<()> {
        let trace = std::mem::take(&mut self.trace);
        let count = trace.iter().filter(|&&word| word & DATA == 0).count() as u64;
        let sampled = self.measured.runs.is_multiple_of(EVERY);
        self.measured.runs += 1;
        self.measured.instructions += count;
        let long = 50 * count >= 49 * self.measured.most_instructions;
        self.measured.most_instructions = self.measured.most_instructions.max(count);
        if long || sampled {
            let clocks = self.clocks(&trace)?;
            let Measured { most_clocks, clocks: sums, .. } = &mut self.measured;
            for ((most, sum), clocks) in most_clocks.iter_mut().zip(sums).zip(clocks) {
                *most = clocks.max(*most);
                *sum += if sampled { clocks } else { 0 };
            }
            self.measured.sampled += u64::from(sampled);
        }
        self.trace = trace;
        self.trace.clear();
        Ok(())
    }

    /// The clocks of a run, by level.
    fn clocks(&mut self, trace: &[u32]) -> Result<[u64; 3]> {
        let half_word = |address: u32| (address.wrapping_sub(Image::START) / 2) as usize;
        for &address in trace.iter().filter(|&&word| word & DATA == 0) {
            let place = self.decoded.get_mut(half_word(address));
            let place = place.with_context(|| format!("the code at {address:#x} is not in bank 1: not modelled"))?;
            if place.is_none() {
                let bytes = &self.code[2 * half_word(address)..];
                *place = Some(self.decoder.decode(&bytes[..bytes.len().min(ENOUGH)], address)?);
            }
        }
        let step = |&word: &u32| match self.decoded.get(half_word(word)) {
            Some(Some(instruction)) if word & DATA == 0 => Step::Executed(word, instruction),
            _ => Step::Loaded(word & !DATA),
        };
        let steps: Vec<Step<'_>> = trace.iter().map(step).collect();
        Ok(Level::ALL.map(|level| {
            let mut caches = Caches::empty();
            let mut run = || pipeline::clocks(steps.iter().copied(), level, self.wait_states, &mut caches);
            if level == Level::Optimistic {
                run();
            }
            run()
        }))
    }
}
