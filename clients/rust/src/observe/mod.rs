//! Watching sessions of other processes: positions, corrections and paths of their newest frames.
//!
//! ```no_run
//! use std::time::Duration;
//! use untangled_client::observe::{self, Observer, ObserverOptions};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let options = ObserverOptions::default();
//! let session = observe::sessions(&options)?.first().ok_or("no session")?.session;
//! let mut observer = Observer::open(options, session)?;
//! let num_triangles = observer.mesh().triangles.len();
//! while let Some(seen) = observer.latest(Duration::from_secs(1))? {
//!     println!("frame {}: {num_triangles} triangles, {} paths", seen.frame(), seen.paths().records.len());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! An observer asks for the mesh once and sends nothing after that. The session waits for none: one that is slow, or
//! was stopped, misses frames. At most 16 may watch a session at a time.
//!
//! Files, each using only those before it: `error`; `mesh` (what stays the same), `observation` (one frame), `sessions`
//! (what there is to watch); `link` (the ports), `observer`.

mod error;
mod link;
mod mesh;
mod observation;
mod observer;
mod sessions;

pub use error::ObserveError;
pub use mesh::ObservedMesh;
pub use observation::Observation;
pub use observer::Observer;
pub use sessions::{ObservedProcess, ObservedSession, ObserverOptions, sessions};
pub use untangled_proto::{
    limits::MAX_OBSERVERS,
    view::{InsideEntry, path_state},
};
