//! `untangled` as a user or a script runs it.
#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod certificate;
mod check;
mod demo;
mod fix;
mod fix_files;
mod fix_inputs;
mod gap;
mod html;
mod manual;
mod mesh_folder;
mod publish;
mod roles;
mod sequence;
mod strangers;
mod watch;
mod weld;
