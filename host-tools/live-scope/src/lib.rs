//! What a device measures and estimates, live.
//!
//! ```text
//! device ─► Feed ── ticks ─► Columns ── least and largest ─┬► Server ─► a page in a browser
//!    ▲                                                     └► Datagrams ─► another program that plots
//!    └──────────────── zero, record ◄── Server ◄── the page
//! ```
//!
//! Beside them what a terminal shows of the last second ([`terminal`]). The page is one file, with its plotting
//! library; it asks nobody but the program that served it, and only it can ask that program for anything ([`server`]).

mod column;
mod datagrams;
mod device;
mod error;
mod feed;
mod figures;
mod guard;
mod http;
mod log;
mod message;
mod page;
mod scope;
pub mod server;
mod subscribers;
pub mod terminal;
mod unread;

pub use column::{Column, Columns, Extent};
pub use datagrams::{Datagrams, Format, UnknownReceiver};
pub use device::Device;
pub use error::{Gone, Undone, Unkept};
pub use feed::{Feed, Tick};
pub use page::PAGE;
pub use scope::{Ended, Scope, run};
pub use server::{Server, ServerError};
