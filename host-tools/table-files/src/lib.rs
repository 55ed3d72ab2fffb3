//! `table.toml`: a parameter table as people read it, with how its logs were prepared, how it was found, and why not to
//! trust it. The other two faces, the Rust `const` and the binary record, are made from its `[table]`.

mod constant;
mod earlier;
mod error;
mod faces;
mod file;
mod line;
mod name;
mod noise;
mod record;

pub use constant::rust_source;
pub use error::{OtherFace, Refused, TableFileError};
pub use faces::{FACES, RECORD, agree, read_doubted};
pub use file::{MOST_BYTES, TableFile, former, in_folder, read};
pub use line::Line;
pub use name::name;
pub use noise::Noise;
pub use record::record;
