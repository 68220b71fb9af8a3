//! A pool of workers that shares its threads fairly among sessions.
//!
//! Jobs are taken in the order in which they came. Large jobs may occupy all workers but one at a time, so that small
//! jobs wait for other small jobs only. A job that is to be done again queues behind the others.

use std::{
    cell::LazyCell,
    collections::VecDeque,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::JoinHandle,
};

use rayon::ThreadPoolBuilder;

/// Most threads that a large job is spread over.
const MOST_THREADS: usize = 8;

/// Something to be done by one worker.
pub(crate) trait Job: Send + 'static {
    /// Whether it may take so long that small jobs must not wait for it.
    fn is_large(&self) -> bool;
    /// Does it; returns the job where it is to be done again.
    fn run(self) -> Option<Self>
    where
        Self: Sized;
}

/// A fixed number of threads, asleep while there is no job.
#[derive(Debug)]
pub(crate) struct Pool<J: Job> {
    shared: Arc<Shared<J>>,
    threads: Vec<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared<J> {
    queue: Mutex<Queue<J>>,
    changed: Condvar,
    most_large: usize,
    /// Threads that a large job is spread over.
    num_threads: usize,
}

#[derive(Debug)]
struct Queue<J> {
    jobs: VecDeque<J>,
    /// Large jobs in work.
    num_large: usize,
    ending: bool,
}

impl<J: Job> Pool<J> {
    /// Starts `num_workers` threads, at least two: one of them is for small jobs only.
    pub(crate) fn start(num_workers: usize) -> std::io::Result<Self> {
        let num_workers = num_workers.max(2);
        let queue = Mutex::new(Queue { jobs: VecDeque::new(), num_large: 0, ending: false });
        let shared = Arc::new(Shared {
            queue,
            changed: Condvar::new(),
            most_large: num_workers - 1,
            num_threads: num_workers.min(MOST_THREADS),
        });
        let mut pool = Self { shared, threads: Vec::with_capacity(num_workers) };
        for index in 0..num_workers {
            let shared = Arc::clone(&pool.shared);
            // Where a thread can't be started, those that were started end when `pool` is dropped.
            let thread = std::thread::Builder::new().name(format!("worker-{index}")).spawn(move || shared.work())?;
            pool.threads.push(thread);
        }
        Ok(pool)
    }

    /// Queues a job and wakes a worker.
    pub(crate) fn push(&self, job: J) {
        self.shared.lock().jobs.push_back(job);
        self.shared.changed.notify_one();
    }
}

impl<J: Job> Drop for Pool<J> {
    /// Waits for the jobs in work; drops those in the queue.
    fn drop(&mut self) {
        let left = {
            let mut queue = self.shared.lock();
            queue.ending = true;
            std::mem::take(&mut queue.jobs)
        };
        self.shared.changed.notify_all();
        for thread in self.threads.drain(..) {
            // The panic hook has reported a job that panicked.
            let _ = thread.join();
        }
        drop(left);
    }
}

impl<J: Job> Shared<J> {
    fn lock(&self) -> MutexGuard<'_, Queue<J>> {
        // Nothing in here panics while it holds the lock.
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn work(&self) {
        // A small job runs on this thread alone, the library's parallel loops included, so that it waits for no other
        // thread.
        let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
        if let Err(error) = &alone {
            tracing::warn!(%error, "a worker shares the threads of others");
        }
        let wide = LazyCell::new(|| ThreadPoolBuilder::new().num_threads(self.num_threads).build());
        let mut queue = self.lock();
        while !queue.ending {
            let Some(job) = queue.take(self.most_large) else {
                queue = self.changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let is_large = job.is_large();
            queue.num_large += usize::from(is_large);
            drop(queue);
            let again = match is_large.then(|| &*wide) {
                Some(Ok(wide)) => wide.install(|| job.run()),
                _ => job.run(),
            };
            queue = self.lock();
            queue.num_large -= usize::from(is_large);
            if let Some(job) = again
                && !queue.ending
            {
                queue.jobs.push_back(job);
            }
        }
    }
}

impl<J: Job> Queue<J> {
    /// The oldest job that may be begun.
    fn take(&mut self, most_large: usize) -> Option<J> {
        let place = self.jobs.iter().position(|job| self.num_large < most_large || !job.is_large())?;
        self.jobs.remove(place)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, Sender, channel};

    use super::*;

    /// Reports when it begins, and ends when the test releases it.
    struct Task {
        name: &'static str,
        large: bool,
        begun: Sender<&'static str>,
        end: Option<Receiver<()>>,
        again: u32,
    }

    impl Job for Task {
        fn is_large(&self) -> bool {
            self.large
        }

        fn run(mut self) -> Option<Self> {
            self.begun.send(self.name).unwrap();
            if let Some(end) = self.end.take() {
                end.recv().unwrap();
            }
            self.again = self.again.checked_sub(1)?;
            Some(self)
        }
    }

    #[test]
    fn pool_keeps_one_worker_free_of_large_jobs() {
        let (begun, log) = channel();
        let pool = Pool::start(2).unwrap();
        let task = |name, large| {
            let (release, end) = channel();
            pool.push(Task { name, large, begun: begun.clone(), end: Some(end), again: 0 });
            release
        };
        let first = task("large 1", true);
        assert_eq!(log.recv().unwrap(), "large 1");
        let second = task("large 2", true);
        let small = task("small", false);
        // A second worker is free, but not for the second large job.
        assert_eq!(log.recv().unwrap(), "small");
        first.send(()).unwrap();
        assert_eq!(log.recv().unwrap(), "large 2");
        second.send(()).unwrap();
        small.send(()).unwrap();
        drop(pool);
    }

    #[test]
    fn pool_requeues_unfinished_job_behind_others() {
        let (begun, log) = channel();
        let pool = Pool::start(1).unwrap();
        // One worker is kept busy, so that the other one's order shows.
        let (release, end) = channel();
        pool.push(Task { name: "busy", large: false, begun: begun.clone(), end: Some(end), again: 0 });
        assert_eq!(log.recv().unwrap(), "busy");
        let (go, end) = channel();
        pool.push(Task { name: "a", large: false, begun: begun.clone(), end: Some(end), again: 2 });
        assert_eq!(log.recv().unwrap(), "a");
        pool.push(Task { name: "b", large: false, begun: begun.clone(), end: None, again: 1 });
        go.send(()).unwrap();
        let order: Vec<_> = log.iter().take(4).collect();
        assert_eq!(order, ["b", "a", "b", "a"]);
        release.send(()).unwrap();
    }
}
