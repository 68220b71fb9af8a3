//! What a C or C++ host links to talk to the untangled daemon: the Rust client behind a C interface.
//!
//! `untangled.h` is made from this crate (see `tests/header.rs`); `untangled.hpp` wraps it for C++17; `example.c` is a
//! whole host.
//!
//! - Handles are numbers, not addresses, and are looked up in a [table](handles): one that was closed, or never opened,
//!   is an error.
//! - Arguments are checked as far as possible: null, alignment, lengths, codes, UTF-8.
//! - No panic leaves a function; messages of errors are kept by thread, in a buffer of fixed size.
//! - The calls of a frame allocate nothing here (iceoryx2 keeps each loan in one small block): positions are written
//!   into, corrections read from, shared memory.
//!
//! `unsafe` stands where addresses of the caller are read or written, in the signatures that take them, and where a
//! view is zeroed.

mod connect;
mod contacts;
mod error;
mod frames;
mod handles;
mod input;
mod registration;
mod repairs;
mod types;

pub use connect::*;
pub use contacts::*;
pub use error::*;
pub use frames::*;
pub use registration::*;
pub use repairs::*;
pub use types::*;
