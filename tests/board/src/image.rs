//! The firmware's ELF file: what goes into bank 1 of the flash.

use std::{env, fs, path::Path};

use anyhow::{Context, Result, bail, ensure};
use object::{
    LittleEndian as Le,
    read::elf::{ElfFile32, ProgramHeader},
};

/// A firmware image in bank 1.
pub struct Image {
    flash: Vec<u8>,
}

impl Image {
    /// Address of bank 1.
    pub(crate) const START: u32 = 0x0800_0000;
    pub(crate) const SIZE: usize = 256 << 10;

    /// The image that an environment variable names.
    ///
    /// # Errors
    /// There is no such variable, or [`Image::open`] failed.
    pub fn from_environment(variable: &str) -> Result<Self> {
        let path = env::var_os(variable)
            .with_context(|| format!("{variable} names no firmware image: `cargo xtask test board` builds one"))?;
        Self::open(Path::new(&path))
    }

    /// Reads an ELF file.
    ///
    /// # Errors
    /// It is none for this microcontroller, or puts bytes outside bank 1.
    pub fn open(path: &Path) -> Result<Self> {
        let bytes = fs::read(path).with_context(|| format!("{} cannot be read", path.display()))?;
        Self::parse(&bytes).with_context(|| format!("{} is no image for this board", path.display()))
    }

    fn parse(bytes: &[u8]) -> Result<Self> {
        let elf = ElfFile32::<Le>::parse(bytes)?;
        let mut flash = vec![0xFF; Self::SIZE];
        for header in elf.elf_program_headers() {
            let Ok(data) = header.data(Le, bytes) else { bail!("a segment lies outside the file") };
            if header.p_type(Le) != object::elf::PT_LOAD || data.is_empty() {
                continue;
            }
            let address = header.p_paddr(Le);
            let start = address.wrapping_sub(Self::START) as usize;
            let place = start.checked_add(data.len()).and_then(|end| flash.get_mut(start..end));
            place
                .with_context(|| format!("{} bytes at {address:#x} are not in bank 1", data.len()))?
                .copy_from_slice(data);
        }
        ensure!(flash[..8] != [0xFF; 8], "there is no vector table at {:#x}", Self::START);
        Ok(Self { flash })
    }

    /// An image of these half-words at these offsets in bank 1.
    #[cfg(test)]
    pub fn assembled(parts: &[(usize, &[u16])]) -> Self {
        let mut flash = vec![0xFF; Self::SIZE];
        for &(offset, code) in parts {
            for (place, half) in flash[offset..].chunks_exact_mut(2).zip(code) {
                place.copy_from_slice(&half.to_le_bytes());
            }
        }
        Self { flash }
    }

    pub(crate) fn flash(&self) -> &[u8] {
        &self.flash
    }
}
