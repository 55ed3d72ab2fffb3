//! Where RAM is: SRAM1, SRAM2 and CCM behind each other.

/// Its first address.
pub const RAM: u64 = 0x2000_0000;
/// Bytes of the RAM.
pub const RAM_SIZE: u64 = 128 << 10;
