//! What must hold of any bytes, one function a target of `fuzz/`. Each takes the fuzzer's input and panics where a
//! promise is broken. `tests/replay.rs` calls the same functions on the inputs that are kept in `tests/data/fuzz/`.

mod asked;
mod device;
pub mod frame;
pub mod link;
pub mod log;
pub mod precision;
pub mod record;
pub mod store;
pub mod table;
mod torn_flash;
