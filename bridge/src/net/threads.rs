//! On which threads Zenoh reads and writes encrypted connections: on one.
//!
//! A TLS link of Zenoh 1.10 has one connection of rustls, which the task that reads and the task that writes both use
//! without a lock (<https://github.com/eclipse-zenoh/zenoh/issues/2557>). On two threads that is a data race: links
//! break with "handshake not complete" every few thousand large frames, and worse is possible. On one thread the tasks
//! take turns. Zenoh takes the numbers of its threads from the environment alone, so the process begins again with
//! them there.

use std::{env, os::unix::process::CommandExt, process::Command};

use crate::error::BridgeError;

const VARIABLE: &str = "ZENOH_RUNTIME";
/// Tasks that read run where those do that write.
const ONE_THREAD: &str = "(rx: (handover: tx), tx: (worker_threads: 1))";

/// Begins this process again, with the same arguments, unless it has begun with one thread for the network. For a
/// process that has not done anything yet.
///
/// # Errors
/// [`BridgeError::System`] where the program can't be executed again.
pub fn begin_with_one_thread() -> Result<(), BridgeError> {
    if env::var(VARIABLE).is_ok_and(|value| value == ONE_THREAD) {
        return Ok(());
    }
    let what = || "beginning again with one thread for the network".to_owned();
    // By its own path: under another one, the process would be listed by another name.
    let program = env::current_exe().map_err(|source| BridgeError::System { what: what(), source })?;
    let mut arguments = env::args_os();
    let mut again = Command::new(program);
    if let Some(name) = arguments.next() {
        again.arg0(name);
    }
    let source = again.args(arguments).env(VARIABLE, ONE_THREAD).exec();
    Err(BridgeError::System { what: what(), source })
}
