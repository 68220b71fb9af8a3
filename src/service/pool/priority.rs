//! How much of a processor a thread gets.

/// How much lower the priority of threads for long work is. With 3 a thread gets half of what another one gets that
/// wants the same processor. With 10, a tenth, a repair took minutes where other programs kept all processors busy; and
/// short frames wait for neither, since a thread that wakes goes first.
pub(super) const NICE: i32 = 3;

/// The lower priority, by that of this thread.
pub(super) fn lower() -> Option<i32> {
    // Of this thread alone, which is what Linux takes no process id for.
    let own = rustix::process::getpriority_process(None);
    own.map(|own| (own + NICE).min(19)).ok()
}

/// Sets the priority of this thread.
pub(super) fn set(priority: i32) {
    if let Err(error) = rustix::process::setpriority_process(None, priority) {
        tracing::warn!(%error, "a thread for long work has the priority of others");
    }
}
