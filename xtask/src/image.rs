//! A linked firmware image: what it takes of the chip's memory, and its symbols.

use std::{collections::BTreeMap, fs, ops::Range, path::Path};

use anyhow::{Context, Result, ensure};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, elf::SHF_ALLOC, read::elf::ElfFile32};

/// Both banks of the STM32G474RE's flash (RM0440, 3.3.1). What lies outside is RAM.
const FLASH: Range<u64> = 0x0800_0000..0x0808_0000;

/// What is read of an ELF file.
pub struct Image {
    /// Bytes of flash: code, constants, and the initial values of variables.
    pub flash_bytes: u64,
    /// Bytes of RAM that are taken for good: variables, initialised or not, without the stack.
    pub ram_bytes: u64,
    symbols: BTreeMap<String, u64>,
}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// It is none, or its symbols have been stripped.
    pub fn read(path: &Path) -> Result<Self> {
        let image = fs::read(path).map_err(Into::into).and_then(|bytes| Self::parse(&bytes));
        image.with_context(|| path.display().to_string())
    }

    fn parse(bytes: &[u8]) -> Result<Self> {
        let elf: ElfFile32<'_> = ElfFile32::parse(bytes)?;
        let mut image = Self { flash_bytes: 0, ram_bytes: 0, symbols: BTreeMap::new() };
        for section in elf.sections() {
            if !matches!(section.flags(), SectionFlags::Elf { sh_flags, .. } if sh_flags.0 & SHF_ALLOC.0 != 0) {
                continue;
            }
            if section.kind() != SectionKind::UninitializedData {
                image.flash_bytes += section.size();
            }
            if !FLASH.contains(&section.address()) {
                image.ram_bytes += section.size();
            }
        }
        for symbol in elf.symbols() {
            image.symbols.insert(symbol.name()?.to_owned(), symbol.address());
        }
        ensure!(image.symbols.contains_key("Reset"), "no symbol `Reset`: not the firmware, or stripped");
        Ok(image)
    }

    /// The address of a function's first instruction.
    ///
    /// # Errors
    /// The image has no such symbol.
    pub fn function(&self, name: &str) -> Result<u64> {
        // A function's symbol has the Thumb bit set.
        self.symbols.get(name).map(|address| address & !1).with_context(|| format!("the image has no symbol `{name}`"))
    }

    /// The routines that compute in `f64`, which this chip does in software: those of the Arm run-time ABI (IHI 0043,
    /// 5.1.2) and of libgcc.
    pub fn soft_doubles(&self) -> Vec<&str> {
        self.symbols.keys().map(String::as_str).filter(|name| is_soft_double(name)).collect()
    }
}

fn is_soft_double(name: &str) -> bool {
    match name.strip_prefix("__aeabi_") {
        // dadd, cdcmple, f2d, ui2d; but not idiv.
        Some(routine) => routine.starts_with('d') || routine.starts_with("cd") || routine.ends_with("2d"),
        // __adddf3, __fixdfsi; double is "DF", double float, there.
        None => name.starts_with("__") && name.contains("df") && !name.contains("defmt"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_routines_of_doubles_are_told_from_others() {
        for name in ["__aeabi_dadd", "__aeabi_d2f", "__aeabi_cdrcmple", "__aeabi_f2d", "__aeabi_ul2d", "__muldf3"] {
            assert!(is_soft_double(name), "{name}");
        }
        for name in ["__truncdfsf2", "__floatsidf", "__unorddf2", "__powidf2", "__fixunsdfdi", "__extendsfdf2"] {
            assert!(is_soft_double(name), "{name}");
        }
        for name in ["__aeabi_fadd", "__aeabi_uldivmod", "__aeabi_idiv", "__aeabi_memcpy8", "__addsf3", "__sdata"] {
            assert!(!is_soft_double(name), "{name}");
        }
    }
}
