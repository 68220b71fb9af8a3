//! The queue with the locks of a model (loom), which tries every order in which threads may come, but for those in
//! which threads are interrupted more than twice in all where they need not wait. A worker that nobody wakes is a
//! deadlock there.

use std::collections::VecDeque;

use loom::{
    model::Builder,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use super::{
    queue::{Job, Queue, Taken},
    sync::{Condvar, Mutex},
};

/// Keeps threads waiting until it is open.
#[derive(Debug)]
struct Gate {
    is_open: Mutex<bool>,
    changed: Condvar,
}

impl Gate {
    fn new() -> Arc<Self> {
        Arc::new(Self { is_open: Mutex::new(false), changed: Condvar::new() })
    }

    fn open(&self) {
        *self.is_open.lock().unwrap() = true;
        self.changed.notify_all();
    }

    fn wait(&self) {
        let mut is_open = self.is_open.lock().unwrap();
        while !*is_open {
            is_open = self.changed.wait(is_open).unwrap();
        }
    }
}

/// What the jobs of a model share.
#[derive(Debug)]
struct Counts {
    num_left: AtomicUsize,
    num_large: AtomicUsize,
    most_large: usize,
}

/// A job that is done once for each of its runs.
#[derive(Debug)]
struct Task {
    /// Whether each of them is large.
    runs: VecDeque<bool>,
    /// What its first run waits for, and its last one opens.
    waits_for: Option<Arc<Gate>>,
    opens: Option<Arc<Gate>>,
    counts: Arc<Counts>,
}

impl Job for Task {
    fn is_large(&self) -> bool {
        self.runs[0]
    }

    fn run(mut self) -> Option<Self> {
        let is_large = usize::from(self.runs.pop_front().unwrap());
        let num_large = self.counts.num_large.fetch_add(is_large, Ordering::SeqCst) + is_large;
        assert!(num_large <= self.counts.most_large, "{num_large} large jobs at a time");
        if let Some(gate) = self.waits_for.take() {
            gate.wait();
        }
        self.counts.num_large.fetch_sub(is_large, Ordering::SeqCst);
        if !self.runs.is_empty() {
            return Some(self);
        }
        if let Some(gate) = self.opens.take() {
            gate.open();
        }
        None
    }
}

/// A worker; the last of all runs closes the queue.
fn work(queue: &Queue<Task>, counts: &Counts) {
    while let Some(Taken { job, is_large }) = queue.take() {
        let again = job.run();
        queue.finish(is_large, again);
        if counts.num_left.fetch_sub(1, Ordering::SeqCst) == 1 {
            assert!(queue.close().is_empty());
        }
    }
}

/// Two workers do jobs that come while they work, at most one large job at a time.
fn in_every_order(jobs: fn(&Arc<Counts>) -> Vec<Task>) {
    let mut model = Builder::new();
    model.preemption_bound = Some(2);
    model.check(move || {
        let counts = Counts { num_left: AtomicUsize::new(0), num_large: AtomicUsize::new(0), most_large: 1 };
        let counts = Arc::new(counts);
        let jobs = jobs(&counts);
        counts.num_left.store(jobs.iter().map(|job| job.runs.len()).sum(), Ordering::SeqCst);
        let queue = Arc::new(Queue::new(1));
        let workers = [(); 2].map(|()| {
            let (queue, counts) = (Arc::clone(&queue), Arc::clone(&counts));
            thread::spawn(move || work(&queue, &counts))
        });
        jobs.into_iter().for_each(|job| queue.push(job));
        workers.into_iter().for_each(|worker| worker.join().unwrap());
        assert_eq!(counts.num_left.load(Ordering::SeqCst), 0);
    });
}

fn task(counts: &Arc<Counts>, runs: &[bool]) -> Task {
    Task { runs: runs.iter().copied().collect(), waits_for: None, opens: None, counts: Arc::clone(counts) }
}

#[test]
fn each_job_is_done_as_often_as_it_wants_in_every_order_of_threads() {
    in_every_order(|counts| vec![task(counts, &[true, true]), task(counts, &[false]), task(counts, &[true])]);
}

#[test]
fn small_job_waits_for_no_large_one_in_any_order_of_threads() {
    in_every_order(|counts| {
        let gate = Gate::new();
        let large = Task { waits_for: Some(Arc::clone(&gate)), ..task(counts, &[true]) };
        vec![large, Task { opens: Some(gate), ..task(counts, &[false, false]) }]
    });
}

#[test]
fn job_that_became_small_waits_for_no_large_one_in_any_order_of_threads() {
    in_every_order(|counts| {
        let gate = Gate::new();
        let large = Task { waits_for: Some(Arc::clone(&gate)), ..task(counts, &[true]) };
        vec![Task { opens: Some(gate), ..task(counts, &[true, false]) }, large]
    });
}

#[test]
fn closed_queue_lets_all_workers_end_and_returns_what_none_has_taken() {
    let mut model = Builder::new();
    model.preemption_bound = Some(2);
    model.check(|| {
        let counts = Counts { num_left: AtomicUsize::new(9), num_large: AtomicUsize::new(0), most_large: 1 };
        let counts = Arc::new(counts);
        let queue = Arc::new(Queue::new(1));
        let workers = [(); 2].map(|()| {
            let (queue, counts) = (Arc::clone(&queue), Arc::clone(&counts));
            thread::spawn(move || work(&queue, &counts))
        });
        queue.push(task(&counts, &[false, true]));
        queue.push(task(&counts, &[true]));
        let num_left: usize = queue.close().iter().map(|job| job.runs.len()).sum();
        workers.into_iter().for_each(|worker| worker.join().unwrap());
        assert!(num_left + 9 - counts.num_left.load(Ordering::SeqCst) <= 3);
    });
}
