//! Hands jobs over to the workers of a pool. All that threads share is in here, so that a model can try every order in
//! which they come (`model_tests.rs`).

use std::{collections::VecDeque, sync::PoisonError};

use super::sync::{Condvar, Mutex, MutexGuard};

/// Something to be done by one worker.
pub(crate) trait Job: Send + 'static {
    /// Whether it may take so long that small jobs must not wait for it.
    fn is_large(&self) -> bool;
    /// Does it; returns the job where it is to be done again.
    fn run(self) -> Option<Self>
    where
        Self: Sized;
}

/// Jobs in the order in which they came.
#[derive(Debug)]
pub(super) struct Queue<J> {
    state: Mutex<State<J>>,
    changed: Condvar,
    most_large: usize,
}

#[derive(Debug)]
struct State<J> {
    jobs: VecDeque<J>,
    /// Large jobs in work.
    num_large: usize,
    is_closed: bool,
}

/// A job for the worker that took it.
#[derive(Debug)]
pub(super) struct Taken<J> {
    pub(super) job: J,
    pub(super) is_large: bool,
}

impl<J: Job> Queue<J> {
    /// An empty one, of which at most so many large jobs are in work at a time.
    pub(super) fn new(most_large: usize) -> Self {
        let state = State { jobs: VecDeque::new(), num_large: 0, is_closed: false };
        Self { state: Mutex::new(state), changed: Condvar::new(), most_large }
    }

    fn lock(&self) -> MutexGuard<'_, State<J>> {
        // Nothing in here panics while it holds the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a job and wakes a worker.
    pub(super) fn push(&self, job: J) {
        self.lock().jobs.push_back(job);
        self.changed.notify_one();
    }

    /// Waits for a job that may be begun; none once the queue is closed.
    pub(super) fn take(&self) -> Option<Taken<J>> {
        let mut state = self.lock();
        while !state.is_closed {
            if let Some(taken) = state.take(self.most_large) {
                return Some(taken);
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        None
    }

    /// A job that was taken is done, or is to be done again after the others.
    pub(super) fn finish(&self, was_large: bool, again: Option<J>) {
        let mut state = self.lock();
        state.num_large -= usize::from(was_large);
        if let Some(job) = again
            && !state.is_closed
        {
            // Its worker will take an older one. Others may sleep since what they found was too large, which this one
            // need not be any more.
            let is_behind_others = !state.jobs.is_empty();
            state.jobs.push_back(job);
            drop(state);
            if is_behind_others {
                self.changed.notify_one();
            }
        }
    }

    /// Lets workers end, and returns what none of them has taken.
    pub(super) fn close(&self) -> VecDeque<J> {
        let left = {
            let mut state = self.lock();
            state.is_closed = true;
            std::mem::take(&mut state.jobs)
        };
        self.changed.notify_all();
        left
    }
}

impl<J: Job> State<J> {
    /// The oldest job that may be begun.
    fn take(&mut self, most_large: usize) -> Option<Taken<J>> {
        let place = self.jobs.iter().position(|job| self.num_large < most_large || !job.is_large())?;
        let job = self.jobs.remove(place)?;
        let is_large = job.is_large();
        self.num_large += usize::from(is_large);
        Some(Taken { job, is_large })
    }
}
