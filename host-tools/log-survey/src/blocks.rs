//! A log's course in bounded memory: rows next to each other, kept as their extremes.

/// Most blocks that are kept; at more, two become one.
const MOST: usize = 1 << 18;

/// Rows next to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// Voltage and displacement of its first row, V and µm; NaN where there is none.
    pub first: (f64, f64),
    /// Smallest and largest voltage, V.
    pub voltage: (f64, f64),
    /// Whether the smallest voltage comes before the largest.
    pub rising: bool,
    /// Smallest and largest displacement, µm.
    pub displacement: (f64, f64),
}

impl Block {
    fn of(voltage: f64, displacement: f64) -> Self {
        let (first, both) = ((voltage, displacement), |value| (value, value));
        Self { first, voltage: both(voltage), rising: true, displacement: both(displacement) }
    }

    /// This block and the next as one.
    fn and(self, next: Self) -> Self {
        let wider =
            |(low, high): (f64, f64), (other_low, other_high): (f64, f64)| (low.min(other_low), high.max(other_high));
        let voltage = wider(self.voltage, next.voltage);
        // No number is neither here nor there.
        let low_here = self.voltage.0 <= next.voltage.0 || next.voltage.0.is_nan();
        let high_here = self.voltage.1 >= next.voltage.1 || next.voltage.1.is_nan();
        let rising = match (low_here, high_here) {
            (true, true) => self.rising,
            (false, false) => next.rising,
            (low_first, _) => low_first,
        };
        Self { first: self.first, voltage, rising, displacement: wider(self.displacement, next.displacement) }
    }
}

/// The blocks of a log so far, all of the same number of rows.
pub(crate) struct Blocks {
    blocks: Vec<Block>,
    rows_a_block: u64,
    begun: Option<(Block, u64)>,
}

impl Default for Blocks {
    fn default() -> Self {
        Self { blocks: Vec::new(), rows_a_block: 1, begun: None }
    }
}

impl Blocks {
    pub fn add(&mut self, voltage: f64, displacement: f64) {
        let row = Block::of(voltage, displacement);
        let (block, rows) = self.begun.take().map_or((row, 1), |(begun, rows)| (begun.and(row), rows + 1));
        if rows < self.rows_a_block {
            self.begun = Some((block, rows));
            return;
        }
        self.blocks.push(block);
        if self.blocks.len() >= MOST {
            let pairs = self.blocks.chunks_exact(2);
            self.blocks = pairs.map(|pair| pair[0].and(pair[1])).collect();
            self.rows_a_block *= 2;
        }
    }

    pub fn rows_a_block(&self) -> u64 {
        self.rows_a_block
    }

    /// How many rows go by while the voltage stays within `still_v` of its first, V, as many as blocks are wholly so;
    /// rows without a voltage before its first count for nothing.
    pub fn rows_at_rest(&self, still_v: f64) -> u64 {
        let from = self.blocks.iter().position(|block| block.first.0.is_finite()).unwrap_or(self.blocks.len());
        let all = &self.blocks[from..];
        let moved = |volts: f64, first: f64| (volts - first).abs() > still_v;
        let still = |block: &&Block| {
            let (low, high) = block.voltage;
            !moved(low, all[0].first.0) && !moved(high, all[0].first.0)
        };
        (all.iter().take_while(still).count() as u64 * self.rows_a_block).saturating_sub(1)
    }

    /// The blocks, without what is left of a last one.
    pub fn all(&self) -> BlocksView<'_> {
        BlocksView { blocks: &self.blocks, rows_a_block: self.rows_a_block }
    }

    pub fn into_all(mut self) -> Vec<Block> {
        self.blocks.extend(self.begun.map(|(block, _)| block));
        self.blocks
    }
}

/// Blocks and how many rows each has.
#[derive(Clone, Copy)]
pub(crate) struct BlocksView<'a> {
    pub blocks: &'a [Block],
    pub rows_a_block: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_at_rest_are_counted_in_whole_blocks_however_many_rows_one_has() {
        let stands = |rest: u64, rows: u64| {
            let mut blocks = Blocks::default();
            (0..rows).for_each(|row| blocks.add(if row < rest { 1.0 } else { 2.0 }, 0.0));
            (blocks.rows_a_block(), blocks.rows_at_rest(0.5))
        };
        assert_eq!(stands(0, 0), (1, 0));
        assert_eq!(stands(10, 100), (1, 9));
        assert_eq!(stands(1_001, 600_000), (4, 999), "of the block with row 1,001 nobody knows");
        assert_eq!(stands(600_000, 600_000), (4, 599_999));
    }
}
