//! Shared memory of a domain: its files in `/dev/shm`, free space, committed pages, unfinished segments.
//!
//! | file | what it does |
//! |---|---|
//! | `segments` | lists the files of a domain, asks for free space, closes files to other users |
//! | `commit` | takes all pages of a port's segments, so that no later write fails |
//! | `unfinished` | removes segments that a crashed peer was still creating |

mod commit;
mod segments;
mod unfinished;

pub use commit::{commit, commit_first};
pub use segments::{FOLDER, close_to_others, free};
pub use unfinished::{UNFINISHED_AGE, remove_unfinished};
