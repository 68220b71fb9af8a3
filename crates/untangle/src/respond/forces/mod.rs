//! Forces: the law that says how large they are, their sums, and fields that take the surroundings of a path along.

mod gap;
mod law;
mod spread;
mod sums;

pub(crate) use gap::Gap;
pub(crate) use law::{ForceLaw, limited};
pub(crate) use spread::{Field, Spread};
pub(crate) use sums::{Forces, mass_at, mass_kg};
