//! A pool of workers that shares its threads fairly among sessions.
//!
//! Jobs are taken in the order in which they came. Large jobs may occupy all workers but one at a time, so that small
//! jobs wait for other small jobs only. A job that is to be done again queues behind the others.

mod alone;
#[cfg(test)]
#[cfg(model)]
mod model_tests;
mod priority;
mod queue;
mod sync;

use std::{cell::LazyCell, sync::Arc, thread::JoinHandle};

use rayon::ThreadPoolBuilder;

use queue::{Queue, Taken};

pub(crate) use alone::Alone;
pub(crate) use queue::Job;

/// Most threads that a large job is spread over.
const MOST_THREADS: usize = 8;

/// How many threads a pool has, and what for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PoolOptions {
    /// Of its threads, with a number behind.
    pub(crate) name: &'static str,
    pub(crate) num_workers: usize,
    /// Most large jobs in work at a time.
    pub(crate) most_large: usize,
    /// Threads that a large job is spread over, at most 8.
    pub(crate) num_threads: usize,
    /// Whether its threads get less of a processor than others that want it.
    pub(crate) in_background: bool,
}

impl PoolOptions {
    /// For frames: at least two workers, of which one is for small jobs only.
    pub(crate) fn frames(num_workers: usize) -> Self {
        let num_workers = num_workers.max(2);
        let most_large = num_workers - 1;
        Self { name: "worker", num_workers, most_large, num_threads: num_workers, in_background: false }
    }

    /// For long work that frames must not wait for, spread over as many threads as frames are.
    pub(crate) fn background(name: &'static str, num_workers: usize, num_threads: usize) -> Self {
        let num_workers = num_workers.max(1);
        Self { name, num_workers, most_large: num_workers, num_threads, in_background: true }
    }
}

/// A fixed number of threads, asleep while there is no job.
#[derive(Debug)]
pub(crate) struct Pool<J: Job> {
    shared: Arc<Shared<J>>,
    threads: Vec<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared<J> {
    queue: Queue<J>,
    options: PoolOptions,
}

impl<J: Job> Pool<J> {
    /// Starts its threads.
    pub(crate) fn start(options: PoolOptions) -> std::io::Result<Self> {
        let shared = Arc::new(Shared { queue: Queue::new(options.most_large), options });
        let mut pool = Self { shared, threads: Vec::with_capacity(options.num_workers) };
        for index in 0..options.num_workers {
            let shared = Arc::clone(&pool.shared);
            // Where a thread can't be started, those that were started end when `pool` is dropped.
            let name = format!("{}-{index}", options.name);
            let thread = std::thread::Builder::new().name(name).spawn(move || shared.work())?;
            pool.threads.push(thread);
        }
        Ok(pool)
    }

    /// Queues a job and wakes a worker.
    pub(crate) fn push(&self, job: J) {
        self.shared.queue.push(job);
    }
}

impl<J: Job> Drop for Pool<J> {
    /// Waits for the jobs in work; drops those in the queue.
    fn drop(&mut self) {
        let left = self.shared.queue.close();
        for thread in self.threads.drain(..) {
            // The panic hook has reported a job that panicked.
            let _ = thread.join();
        }
        drop(left);
    }
}

impl<J: Job> Shared<J> {
    fn work(&self) {
        // So that a small job waits for no other thread.
        let _alone = Alone::begin();
        let PoolOptions { num_threads, in_background, .. } = self.options;
        // Threads begin with the priority of the one that starts them, so that it is lowered once.
        let priority = in_background.then(priority::lower).flatten();
        let yield_to_others = move || {
            if let Some(priority) = priority {
                priority::set(priority);
            }
        };
        yield_to_others();
        let wide = LazyCell::new(|| {
            let threads = ThreadPoolBuilder::new().num_threads(num_threads.clamp(1, MOST_THREADS));
            threads.start_handler(move |_| yield_to_others()).build()
        });
        while let Some(Taken { job, is_large }) = self.queue.take() {
            let again = match is_large.then(|| &*wide) {
                Some(Ok(wide)) => wide.install(|| job.run()),
                _ => job.run(),
            };
            self.queue.finish(is_large, again);
        }
    }
}

#[cfg(test)]
#[cfg(not(model))]
mod tests {
    use std::{
        sync::mpsc::{Receiver, Sender, channel},
        time::Duration,
    };

    use super::{priority::NICE, *};

    /// Reports the priority of its thread, and of one of those that its work is spread over.
    struct Priority(Sender<[i32; 2]>);

    impl Job for Priority {
        fn is_large(&self) -> bool {
            true
        }

        fn run(self) -> Option<Self> {
            let of_thread = || rustix::process::getpriority_process(None).unwrap();
            let spread = rayon::broadcast(|_| of_thread());
            let _ = self.0.send([of_thread(), spread.into_iter().max().unwrap()]);
            None
        }
    }

    #[test]
    fn threads_for_long_work_get_half_of_what_others_get_and_those_of_frames_all() {
        let own = rustix::process::getpriority_process(None).unwrap();
        for (options, lower) in [(PoolOptions::background("long", 1, 2), NICE), (PoolOptions::frames(2), 0)] {
            let pool = Pool::start(options).unwrap();
            let (sender, receiver) = channel();
            pool.push(Priority(sender));
            assert_eq!(receiver.recv().unwrap(), [(own + lower).min(19); 2]);
        }
        // The weight of a priority falls by a fifth with each step.
        assert!((0.8f64.powi(NICE) - 0.5).abs() < 0.02);
    }

    /// Reports when it begins, and ends when the test releases it. Done again it is small.
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
            self.large = false;
            Some(self)
        }
    }

    #[test]
    fn pool_keeps_one_worker_free_of_large_jobs() {
        let (begun, log) = channel();
        let pool = Pool::start(PoolOptions::frames(2)).unwrap();
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
        let pool = Pool::start(PoolOptions::frames(1)).unwrap();
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

    #[test]
    fn job_that_became_small_behind_a_large_one_wakes_the_worker_that_sleeps() {
        let (begun, log) = channel();
        let next = || log.recv_timeout(Duration::from_secs(60)).expect("a worker takes the job");
        let pool = Pool::start(PoolOptions::frames(2)).unwrap();
        let task = |name, large, again| {
            let (release, end) = channel();
            pool.push(Task { name, large, begun: begun.clone(), end: Some(end), again });
            release
        };
        let shrinking = task("shrinking", true, 1);
        assert_eq!(next(), "shrinking");
        let large = task("large", true, 0);
        // The other worker does a small job, finds that the large one is not for it, and sleeps.
        task("small", false, 0).send(()).unwrap();
        assert_eq!(next(), "small");
        std::thread::sleep(Duration::from_millis(100));
        shrinking.send(()).unwrap();
        let mut both = [next(), next()];
        both.sort_unstable();
        assert_eq!(both, ["large", "shrinking"]);
        large.send(()).unwrap();
    }
}
