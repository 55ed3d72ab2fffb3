//! What follows the plugin's name on QEMU's command line.

use std::{
    ffi::{CStr, c_char, c_int},
    fs::File,
};

/// What is counted: `function=0xADDRESS,out=FILE[,mark=0xADDRESS]`
pub struct Options {
    /// Address of the function to be measured.
    pub function: u32,
    /// Address of the instruction with which counting starts anew; what was counted before is kept.
    pub mark: Option<u32>,
    /// Where the result goes.
    pub out: File,
}

impl Options {
    /// Reads options, each of them `name=value`, and creates the file.
    ///
    /// # Errors
    /// An option is missing, unknown or of no use.
    pub fn parse<'a>(options: impl Iterator<Item = &'a str>) -> Result<Self, String> {
        let (mut function, mut mark, mut out) = (None, None, None);
        for option in options {
            match option.split_once('=') {
                Some(("function", value)) => function = Some(address(value)?),
                Some(("mark", value)) => mark = Some(address(value)?),
                Some(("out", path)) => out = Some(File::create(path).map_err(|error| format!("{path}: {error}"))?),
                _ => return Err(format!("{option}: there are function=, mark= and out=")),
            }
        }
        Ok(Self {
            function: function.ok_or("function=0xADDRESS is missing")?,
            mark,
            out: out.ok_or("out=FILE is missing")?,
        })
    }
}

fn address(text: &str) -> Result<u32, String> {
    text.strip_prefix("0x")
        .and_then(|digits| u32::from_str_radix(digits, 16).ok())
        .ok_or_else(|| format!("{text}: no address, such as 0x1f4"))
}

/// The strings of an argument vector.
///
/// # Safety
/// `arguments` points to `count` pointers to strings that end in a NUL and live as long as is said.
///
/// # Errors
/// One is not UTF-8.
pub unsafe fn strings<'a>(count: c_int, arguments: *const *const c_char) -> Result<Vec<&'a str>, String> {
    (0..usize::try_from(count).unwrap_or(0))
        .map(|index| {
            // SAFETY: as the caller promises.
            let string = unsafe { CStr::from_ptr(*arguments.add(index)) };
            string.to_str().map_err(|error| format!("{}: {error}", string.to_string_lossy()))
        })
        .collect()
}
