//! Threads whose work is not spread over others.

use rayon::{ThreadPool, ThreadPoolBuilder};

/// While it lives, the library's parallel loops stay on the thread that began it. For threads that are this program's
/// own, and once for each: rayon never gives back the some kilobytes of such a pool.
#[derive(Debug)]
pub(crate) struct Alone {
    _pool: Option<ThreadPool>,
}

impl Alone {
    pub(crate) fn begin() -> Self {
        let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
        if let Err(error) = &pool {
            tracing::warn!(%error, "a thread shares the threads of others");
        }
        Self { _pool: pool.ok() }
    }
}
