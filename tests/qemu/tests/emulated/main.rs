//! The host tool and the firmware in QEMU. One program, so that its tests run side by side.

mod attacks;
mod follow;
mod link;
mod models;
mod pil;
mod store;
mod stream;
