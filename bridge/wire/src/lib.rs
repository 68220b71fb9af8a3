//! What crosses the network between the two ends of a bridge.
//!
//! A message is an envelope, a wire struct of the protocol as its bytes, and its payload. The bridge checks lengths and
//! where a message belongs; what the bytes mean is the business of daemon and host.
//!
//! | file | what |
//! |---|---|
//! | `plain` | wire structs as bytes |
//! | `keys` | key expressions |
//! | `message` | envelopes of frames, acknowledgements and the like |
//! | `element` | elements of arrays, and what they are at rest |
//! | `elements` | arrays of which most elements are at rest, in few bytes |
//! | `request` | requests and replies |
//! | `beacon` | what the ends say of themselves, four times a second |

pub mod beacon;
pub mod element;
pub mod elements;
pub mod keys;
pub mod message;
pub mod plain;
pub mod request;

/// Version of what the ends of a bridge say to each other. It is part of all key expressions, so that ends of
/// different versions do not take each other's messages; beacons are read across versions, so that both can say why.
pub const BRIDGE_VERSION: u16 = 1;
