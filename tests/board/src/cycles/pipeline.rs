//! What a run of instructions costs: the sum of what they cost by themselves, what they wait for each other and
//! for the flash.
//!
//! | | optimistic | typical | pessimistic |
//! |---|---|---|---|
//! | caches | as the same instructions have left them | empty: other code runs between the ticks | empty |
//! | refill after a branch, clocks | 1 | 2 | 3 |
//! | straight on | the next fetch began when the last word came | likewise | every fetch takes all its wait states |
//! | cost of an instruction ([`super::instruction`]) | least | least | most |
//! | a load behind a load | a clock less, if it does not need it | likewise | in full |
//! | result of the FPU | a clock more where the next needs it | likewise | always, and one for its flags |
//! | the FPU's registers at the exception, clocks | 0 | 17, saved once | 34, saved and restored |
//!
//! Entry (12) and return (10) are counted. Registers of peripherals count as memory.

use super::{
    flash::{Caches, WORD},
    instruction::Instruction,
};

/// How the documented costs are read where they leave room.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Level {
    /// Everything at its best.
    Optimistic,
    /// As it is to be expected.
    Typical,
    /// Everything at its worst.
    Pessimistic,
}

impl Level {
    /// All three, the cheapest first.
    pub const ALL: [Self; 3] = [Self::Optimistic, Self::Typical, Self::Pessimistic];

    const fn choose<T: Copy>(self, of: [T; 3]) -> T {
        of[self as usize]
    }
}

/// What a handler did.
#[derive(Clone, Copy)]
pub enum Step<'a> {
    /// It executed an instruction at an address.
    Executed(u32, &'a Instruction),
    /// It read data from the flash.
    Loaded(u32),
}

const ENTRY_AND_RETURN: u64 = 12 + 10;

/// The clocks of a handler that did this, with `wait_states` of the flash.
pub fn clocks<'a>(steps: impl Iterator<Item = Step<'a>>, level: Level, wait_states: u64, caches: &mut Caches) -> u64 {
    let pessimistic = level == Level::Pessimistic;
    let mut clocks = ENTRY_AND_RETURN + level.choose([0, 17, 34]);
    let mut last: Option<(u32, &Instruction)> = None;
    // The last IT, and where the instructions under its condition are.
    let mut conditional: (u32, &[u32]) = (0, &[]);
    // The word fetched last, and when it came.
    let (mut fetched, mut came) = (None, 0);
    for step in steps {
        let (address, instruction) = match step {
            Step::Loaded(address) => {
                clocks += if caches.load_misses(address) { wait_states } else { 0 };
                continue;
            }
            Step::Executed(address, instruction) => (address, instruction),
        };
        if let Some((at, before)) = last {
            let next = at + before.size;
            if address != next {
                let (it, behind) = conditional;
                let place = |address: u32| behind.iter().position(|&bytes| it + bytes == address);
                match (place(next), place(address)) {
                    // Those between did not run for their condition: a clock each.
                    (Some(from), Some(to)) if to > from => clocks += (to - from) as u64,
                    _ => {
                        clocks += level.choose([1, 2, 3]);
                        fetched = None;
                    }
                }
            }
        }
        for word in [address / WORD, (address + instruction.size - 1) / WORD] {
            if fetched == Some(word) {
                continue;
            }
            if caches.fetch_misses(word * WORD) {
                let straight_on = fetched.is_some_and(|fetched: u32| fetched + 1 == word) && !pessimistic;
                clocks += if straight_on { wait_states.saturating_sub(clocks - came) } else { wait_states };
            }
            (fetched, came) = (Some(word), clocks);
        }
        clocks += cost(instruction, last.map(|(_, before)| before), pessimistic);
        if !instruction.conditional.is_empty() {
            conditional = (address, instruction.conditional.as_slice());
        }
        last = Some((address, instruction));
    }
    clocks
}

/// What an instruction costs behind another.
fn cost(instruction: &Instruction, before: Option<&Instruction>, pessimistic: bool) -> u64 {
    let (least, most) = instruction.clocks;
    let needs = |register| instruction.reads.contains(&register);
    let Some(before) = before else { return if pessimistic { most } else { least } };
    if pessimistic {
        most + u64::from(before.computes.is_some()) + u64::from(before.compares)
    } else {
        let waits = before.computes.is_some_and(needs);
        let overlaps = instruction.loads.is_some() && before.loads.is_some_and(|register| !needs(register));
        least + u64::from(waits) - u64::from(overlaps)
    }
}
