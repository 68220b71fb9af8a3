//! The wire protocol of untangled: what crosses shared memory between a host and the daemon.
//!
//! Plain data: `repr(C)` structs, names of services, codes, limits with the formulas for the memory they stand for, and
//! the table of sections that a request consists of. Files, locks, ports and memory are the business of
//! `untangled_transport`; of iceoryx2 this crate knows only the trait by which a struct may lie in shared memory.
//!
//! `PROTOCOL.md` beside this crate says the same in words, enough to write a client in another language. Every struct
//! is `repr(C)`, has an explicit type name with the protocol's version in it, and `tests/layout.rs` pins its layout.
//!
//! How to change it: a field may move into reserved bytes, which are zero until then, without a new version. Anything
//! else is a new [`PROTOCOL_VERSION`] with new type names. The control structs keep their names and layout for good, so
//! that peers of different versions can still tell each other why they don't talk.

pub mod control;
pub mod correction;
pub mod limits;
pub mod memory;
pub mod names;
pub mod observe;
pub mod repair;
pub mod sections;
pub mod state;
pub mod status;

pub use control::{CorrectionKind, Precision, RegisterParams, ReplyHeader, RequestHeader, RequestKind, SessionOptions};
pub use correction::{CorrectionHeader, VertexCorrection, VertexEntry, VertexLabel, flags, pair_type};
pub use memory::PayloadLayout;
pub use observe::{paths, view};
pub use repair::RepairHeader;
pub use state::{PositionF32, PositionF64, StateHeader};
pub use status::Status;

/// Version of this protocol.
pub const PROTOCOL_VERSION: u32 = 1;

/// The only iceoryx2 version that peers may run: its shared structures differ from version to version.
pub const ICEORYX2_VERSION: &str = "0.10.0";

/// Version of the library that this crate was released with.
pub const LIBRARY_VERSION: &str = env!("CARGO_PKG_VERSION");
