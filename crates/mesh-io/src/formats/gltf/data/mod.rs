//! The data of a glTF document: its buffers, the files that these may be, and the accessors that give them a meaning.
//! Nothing here is believed: every length is checked, and what a document asks for is bounded by its own bytes.

pub(crate) mod accessor;
mod budget;
mod buffers;
mod link;

pub(crate) use budget::Budget;
pub(crate) use buffers::Buffers;
