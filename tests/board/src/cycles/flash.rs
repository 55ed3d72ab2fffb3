//! What the flash makes the core wait: wait states, and ST's caches before it (RM0440, "Adaptive
//! real-time memory accelerator").
//!
//! In dual-bank mode the flash gives 64 bits an access. The instruction cache has 32 lines, the data cache 8,
//! each of four such words; a full cache gives up the line that was used longest ago. A word that is in its
//! cache costs nothing.

/// Bytes that an access gives.
pub const WORD: u32 = 8;
const LINE: u32 = 4 * WORD;

/// A cache, the line used last in front.
#[derive(Clone)]
struct Cache {
    /// A line's number, and a bit for every word of it that is there.
    lines: Vec<(u32, u8)>,
    most: usize,
}

impl Cache {
    fn of(most: usize) -> Self {
        Self { lines: Vec::with_capacity(most), most }
    }

    /// Whether the word at an address has to be fetched; it is there from now on.
    fn misses(&mut self, address: u32) -> bool {
        let (number, word) = (address / LINE, 1u8 << (address % LINE / WORD));
        let found = self.lines.iter().position(|(line, _)| *line == number);
        let (_, words) = found.map_or((number, 0), |at| self.lines.remove(at));
        self.lines.truncate(self.most - 1);
        self.lines.insert(0, (number, words | word));
        words & word == 0
    }
}

/// The instruction cache and the data cache.
#[derive(Clone)]
pub struct Caches {
    instructions: Cache,
    data: Cache,
}

impl Caches {
    /// With nothing in them.
    pub fn empty() -> Self {
        Self { instructions: Cache::of(32), data: Cache::of(8) }
    }

    /// Whether the flash must be asked for the instruction word at an address.
    pub fn fetch_misses(&mut self, address: u32) -> bool {
        self.instructions.misses(address)
    }

    /// Whether the flash must be asked for the data at an address.
    pub fn load_misses(&mut self, address: u32) -> bool {
        self.data.misses(address)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_fetched_once_until_its_line_is_the_one_used_longest_ago() {
        let mut cache = Cache::of(2);
        assert!(cache.misses(0) && cache.misses(8), "each word of a line by itself");
        assert!(!cache.misses(4), "within the first word");
        assert!(cache.misses(32) && !cache.misses(0) && cache.misses(64));
        assert!(cache.misses(32), "line 1 had to go");
        assert!(cache.misses(0), "then line 0 had");
        assert!(!cache.misses(32));
    }
}
