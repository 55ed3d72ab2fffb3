//! Instructions from a function's entry to its return, call by call, those of the functions it calls included.
//!
//! A call lasts until the instruction behind the one that called is reached, whichever way the function is left. An
//! instruction that an IT block skips counts, since it takes its cycle all the same.
//!
//! Limits: a function entered by a jump (a tail call) cannot be measured so; such entries are counted as `jumps`. What
//! interrupts the function counts as part of it: measure what runs at the highest priority. Recursion is one call.

use std::{fmt, mem};

use crate::instruction::Instruction;

/// The calls of one function so far.
pub struct Counter {
    function: u32,
    mark: Option<u32>,
    previous: Option<Instruction>,
    call: Option<Call>,
    finished: Vec<Totals>,
    totals: Totals,
}

/// A call under way.
struct Call {
    return_to: u32,
    instructions: u64,
}

#[derive(Default)]
struct Totals {
    calls: u64,
    jumps: u64,
    min: Option<u64>,
    max: u64,
    sum: u64,
}

impl Counter {
    /// Counts the calls of the function at this address, anew whenever the instruction at `mark` runs.
    pub fn new(function: u32, mark: Option<u32>) -> Self {
        Self { function, mark, previous: None, call: None, finished: Vec::new(), totals: Totals::default() }
    }

    /// Takes note of an instruction.
    pub fn execute(&mut self, instruction: Instruction) {
        if self.mark == Some(instruction.address) {
            self.call = None;
            self.finished.push(mem::take(&mut self.totals));
        }
        if let Some(call) = self.call.take_if(|call| call.return_to == instruction.address) {
            self.totals.add(call.instructions);
        }
        if self.call.is_none() && instruction.address == self.function {
            match self.previous.filter(|previous| previous.is_call()) {
                Some(caller) => self.call = Some(Call { return_to: caller.next(), instructions: 0 }),
                None => self.totals.jumps += 1,
            }
        }
        if let Some(call) = &mut self.call {
            call.instructions += 1;
        }
        self.previous = Some(instruction);
    }
}

impl Totals {
    fn add(&mut self, instructions: u64) {
        self.calls += 1;
        self.min = Some(self.min.map_or(instructions, |min| min.min(instructions)));
        self.max = self.max.max(instructions);
        self.sum += instructions;
    }
}

/// A line of JSON for what came before each mark, and one for what came after the last: finished `calls`, entries by
/// `jumps`, and the least, most and sum of the instructions of a call (0 without any).
impl fmt::Display for Counter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Totals { calls, jumps, min, max, sum } in self.finished.iter().chain([&self.totals]) {
            let min = min.unwrap_or(0);
            writeln!(f, r#"{{"calls":{calls},"jumps":{jumps},"min":{min},"max":{max},"sum":{sum}}}"#)?;
        }
        Ok(())
    }
}
