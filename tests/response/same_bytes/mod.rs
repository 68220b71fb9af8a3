//! The same input gives the same bytes, with any instructions, threads and sessions, and on every machine.

mod digests;
mod instruction_sets;
