//! Checks of shared memory, with errors of requests.

use untangled_transport::{Domain, memory};

use crate::error::RequestError;

/// Checks that shared memory has `needed` bytes free. Called before a port is created, since creating it writes
/// already.
///
/// # Errors
/// [`RequestError::NotEnoughMemory`].
pub fn check_memory(needed: u64) -> Result<(), RequestError> {
    match memory::free() {
        Ok(free) if free < needed => Err(RequestError::NotEnoughMemory { needed, free }),
        // Without an answer of the system, try.
        _ => Ok(()),
    }
}

/// Takes all shared memory of a port. Drop the port on an error: running out of memory later would end the process
/// (SIGBUS).
///
/// # Errors
/// [`RequestError::NotEnoughMemory`], or what the system says.
pub fn commit_memory(domain: &Domain, port_id: u128, needed: u64) -> Result<(), RequestError> {
    match memory::commit(domain, port_id) {
        Ok(_) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::StorageFull => {
            Err(RequestError::NotEnoughMemory { needed, free: memory::free().unwrap_or(0) })
        }
        Err(error) => Err(RequestError::in_words("taking shared memory", &error)),
    }
}
