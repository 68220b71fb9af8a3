//! The network: Zenoh sessions, who may take part in them, and how much is on its way.
//!
//! | file | what |
//! |---|---|
//! | `endpoint` | addresses, and whether they leave this machine |
//! | `outlet` | sends the messages of one direction of a session |
//! | `security` | certificates, and rules of access for each host |
//! | `session` | opens a Zenoh session |
//! | `threads` | on which threads encrypted connections are read and written |
//! | `window` | how many messages of a session may be on their way |

mod endpoint;
mod outlet;
mod security;
mod session;
mod threads;
pub mod window;

pub use endpoint::{DEFAULT_ADDRESS, Endpoint, Side};
pub use outlet::{Outlet, Received};
pub use security::{Tls, check};
pub use session::{LOST_AFTER, Network, Urgency, open};
pub use threads::begin_with_one_thread;
