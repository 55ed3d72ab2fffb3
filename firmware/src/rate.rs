//! How often a tick comes, which is a choice of the image's build: `TICK_HZ=5000 cargo fw`. All that lasts a time and
//! is counted in ticks follows from it.

use core::num::NonZeroU8;
use protocol::stream_every;

/// Ticks a second: 1,000, 2,000, 5,000 or 10,000.
pub const TICK_HZ: u32 = chosen(option_env!("TICK_HZ"));
/// From one tick to the next, µs.
pub const TICK_US: u32 = 1_000_000 / TICK_HZ;
/// Ticks of which one is streamed: as few as the line carries.
pub const STREAM_EVERY: NonZeroU8 = stream_every(TICK_HZ);

const fn chosen(rate: Option<&str>) -> u32 {
    let Some(rate) = rate else { return 2_000 };
    match rate.as_bytes() {
        b"1000" => 1_000,
        b"2000" => 2_000,
        b"5000" => 5_000,
        b"10000" => 10_000,
        _ => panic!("TICK_HZ must be 1000, 2000, 5000 or 10000"),
    }
}

/// The ticks in so many milliseconds.
pub const fn ticks_in(ms: u32) -> u32 {
    TICK_HZ / 1_000 * ms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_one_of_four_and_2_khz_where_none_is_chosen() {
        assert_eq!(chosen(None), 2_000);
        for (text, rate) in [("1000", 1_000), ("2000", 2_000), ("5000", 5_000), ("10000", 10_000)] {
            assert_eq!(chosen(Some(text)), rate);
        }
        for text in ["", "0", "2 000", "2000 ", "2001", "100000"] {
            assert!(std::panic::catch_unwind(|| chosen(Some(text))).is_err(), "{text}");
        }
    }
}
