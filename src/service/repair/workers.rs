//! The threads that work on the repairs of all sessions.

use std::{
    io,
    sync::{Arc, OnceLock},
};

use super::{desk::RepairJob, requests::Totals};
use crate::service::pool::{Pool, PoolOptions};

/// Threads for repairs, which are started for the first session that asks for repairs.
#[derive(Debug)]
pub(crate) struct RepairWorkers {
    pool: OnceLock<Pool<RepairJob>>,
    options: PoolOptions,
    totals: Arc<Totals>,
}

impl RepairWorkers {
    /// For so many repairs at a time, each spread over as many threads as frames are.
    pub(crate) fn new(num_workers: usize, num_threads: usize) -> Self {
        let options = PoolOptions::background("repair", num_workers, num_threads);
        Self { pool: OnceLock::new(), options, totals: Arc::default() }
    }

    /// Starts the threads, unless they run.
    ///
    /// # Errors
    /// What the system says.
    pub(crate) fn start(&self) -> io::Result<()> {
        if self.pool.get().is_none() {
            // Of two that start them at once, one drops its own.
            let _ = self.pool.set(Pool::start(self.options)?);
        }
        Ok(())
    }

    /// Counts of the repairs of all sessions.
    pub(crate) fn totals(&self) -> &Arc<Totals> {
        &self.totals
    }

    /// Queues a job, once the threads are started.
    pub(crate) fn push(&self, job: RepairJob) {
        if let Some(pool) = self.pool.get() {
            pool.push(job);
        }
    }
}
