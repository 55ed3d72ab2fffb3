//! The parameter pages as a debug probe writes them: erased flash in which the firmware's own store holds one record.

use embassy_futures::block_on;
use object::{Object, ObjectSymbol, read::elf::ElfFile32};
use parameter_store::{ParameterStore, RamFlash, StoreError};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Where the NUCLEO-G474RE's parameter pages are: `memory.x`, at the root of the sources, says so.
pub const NUCLEO_G474RE: Range<u32> = 0x0807_F000..0x0808_0000;

/// Flash of Cortex-M microcontrollers lies below this address, RAM from it on (Armv7-M, B3.1).
const RAM: u32 = 0x2000_0000;

/// Why there are no parameter pages to write.
#[derive(Debug, thiserror::Error)]
pub enum PagesError {
    /// The image cannot be read.
    #[error("{}: cannot be read", image.display())]
    Unreadable {
        /// The firmware image.
        image: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The file is something else.
    #[error("{}: is no 32-bit ELF image; `cargo fw` builds one", image.display())]
    NoImage {
        /// The firmware image.
        image: PathBuf,
        /// What the ELF reader says.
        source: object::read::Error,
    },
    /// The image does not say where its pages are.
    #[error("{}: has no symbol {symbol}: is it this project's firmware, not stripped?", image.display())]
    NoSymbol {
        /// The firmware image.
        image: PathBuf,
        /// What is missing.
        symbol: &'static str,
    },
    /// The image is for an emulated board.
    #[error(
        "{}: keeps its parameters in RAM (0x{start:08x}): it is the image of an emulated board, which nobody can flash",
        image.display()
    )]
    InRam {
        /// The firmware image.
        image: PathBuf,
        /// Address of the pages.
        start: u32,
    },
    /// So many bytes are no pages of a microcontroller.
    #[error("{0} bytes of parameter pages are no few pages")]
    TooLong(usize),
    /// The store refuses the length or the record.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Where the parameter pages of a firmware image are, by its symbols.
///
/// # Errors
/// The file is no ELF image of this project's firmware, or its pages are not flash.
pub fn of_image(path: &Path) -> Result<Range<u32>, PagesError> {
    let image = || path.to_owned();
    let bytes = std::fs::read(path).map_err(|source| PagesError::Unreadable { image: image(), source })?;
    let elf: ElfFile32<'_> =
        ElfFile32::parse(&*bytes).map_err(|source| PagesError::NoImage { image: image(), source })?;
    let symbol = |symbol: &'static str| -> Result<u32, PagesError> {
        let found = elf.symbols().find(|found| found.name() == Ok(symbol));
        let address = found.and_then(|found| u32::try_from(found.address()).ok());
        address.ok_or_else(|| PagesError::NoSymbol { image: image(), symbol })
    };
    let pages = symbol("__parameters_start")?..symbol("__parameters_end")?;
    if pages.start >= RAM {
        return Err(PagesError::InRam { image: image(), start: pages.start });
    }
    Ok(pages)
}

/// The content of empty pages of `length` bytes, with a record stored in them.
///
/// # Errors
/// The store refuses the length or the record.
pub fn with(record: &[u8], length: usize) -> Result<Vec<u8>, PagesError> {
    if length > 1 << 20 {
        return Err(PagesError::TooLong(length));
    }
    let mut memory = vec![0xFF; length];
    let mut store = ParameterStore::new(RamFlash::new(&mut memory), 0..length as u32)?;
    block_on(store.store(record))?;
    Ok(memory)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_in_the_pages_is_what_the_firmware_finds() {
        let record = include_bytes!("../../../tests/data/table/table.bin");
        let mut pages = with(record, NUCLEO_G474RE.len()).unwrap();
        assert_eq!(pages.len(), 4096);
        let mut store = ParameterStore::new(RamFlash::new(&mut pages), 0..4096).unwrap();
        assert_eq!(block_on(store.load()).unwrap(), Some(&record[..]));
    }

    /// An ELF image of nothing but two symbols.
    fn elf(start: u32, end: u32) -> Vec<u8> {
        const SYMBOLS: u32 = 52;
        const NAMES: u32 = SYMBOLS + 3 * 16;
        let names = b"\0__parameters_start\0__parameters_end\0";
        let sections = NAMES + names.len() as u32;
        let symbol = |name: u32, value: u32| [name, value, 0, 0xFFF1_0010];
        // Little-endian ELF32 of type "executable" for Arm; then the header's other fields.
        let mut image = b"\x7FELF\x01\x01\x01\0\0\0\0\0\0\0\0\0\x02\0\x28\0".to_vec();
        let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
        image.extend(words(&[1, 0, 0, sections, 0, 52, 40 << 16, 3 | 2 << 16]));
        image.extend(words(&[[0; 4], symbol(1, start), symbol(20, end)].concat()));
        image.extend(names);
        image.extend(words(&[0; 10]));
        image.extend(words(&[0, 2, 0, 0, SYMBOLS, 3 * 16, 2, 1, 4, 16]));
        image.extend(words(&[0, 3, 0, 0, NAMES, names.len() as u32, 0, 0, 1, 0]));
        image
    }

    #[test]
    fn the_image_says_where_its_pages_are() {
        let place = |image: &[u8]| {
            let file = tempfile::NamedTempFile::new().unwrap();
            std::fs::write(file.path(), image).unwrap();
            of_image(file.path()).map_err(|error| error.to_string())
        };
        assert_eq!(place(&elf(0x0807_F000, 0x0808_0000)), Ok(NUCLEO_G474RE));
        let refused = |image: &[u8], why: &str| assert!(place(image).is_err_and(|error| error.contains(why)), "{why}");
        refused(&elf(0x203F_F000, 0x2040_0000), "emulated");
        let mut stripped = elf(0, 0);
        stripped[52 + 48 + 1] = b'x';
        refused(&stripped, "__parameters_start");
        refused(b"PZTB", "ELF");
    }

    #[test]
    fn one_page_or_half_a_page_is_refused() {
        for length in [0, 2048, 3000] {
            assert!(with(&[1], length).is_err(), "{length}");
        }
    }

    #[test]
    fn the_board_s_pages_are_those_of_its_memory_map() {
        let map = include_str!("../../../memory.x");
        let line =
            map.lines().find(|line| line.contains("NUCLEO_G474RE_PARAMETERS") && line.contains("ORIGIN")).unwrap();
        assert!(line.contains(&format!("ORIGIN = {:#010X}", NUCLEO_G474RE.start).replace("0X", "0x")), "{line}");
        assert!(line.contains(&format!("LENGTH = {}K", NUCLEO_G474RE.len() / 1024)), "{line}");
    }
}
