//! A Thumb instruction, as far as counting needs to know it (Armv7-M Architecture Reference Manual, A5 and A7.7).

use std::ffi::c_void;

/// Where it stands and what it is.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Instruction {
    /// Address, without the Thumb bit.
    pub address: u32,
    /// Its one or two halfwords, the first one higher.
    pub code: u32,
}

impl Instruction {
    /// Address of the instruction behind it.
    pub fn next(self) -> u32 {
        // The first of two halfwords is never 0.
        self.address.wrapping_add(if self.code > 0xFFFF { 4 } else { 2 })
    }

    /// Whether it calls: BL, or BLX with a register.
    pub fn is_call(self) -> bool {
        self.code & 0xF800_D000 == 0xF000_D000 || self.code & !0x78 == 0x4780
    }

    /// As a value that QEMU keeps and hands back; it is never followed as a pointer.
    pub fn to_data(self) -> *mut c_void {
        const { assert!(usize::BITS == 64, "an address and a code need 64 bits") };
        std::ptr::without_provenance_mut((self.address as usize) << 32 | self.code as usize)
    }

    /// What [`Self::to_data`] was made of.
    pub fn from_data(data: *mut c_void) -> Self {
        Self { address: (data.addr() >> 32) as u32, code: data.addr() as u32 }
    }
}
