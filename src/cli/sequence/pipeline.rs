//! Work on frames, on all processors, in stages.
//!
//! A stage may use what the stage before it found within a window of frames. The order in which frames are finished
//! changes nothing: each piece of work sees the frames of its window, and the results are taken in order.

use std::{
    collections::BTreeMap,
    ops::RangeInclusive,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread,
};

/// What is to be done.
#[derive(Clone, Debug)]
pub(super) struct Pipeline {
    /// All frames there are.
    pub(super) frames: RangeInclusive<u64>,
    /// The frames that are asked for.
    pub(super) part: RangeInclusive<u64>,
    /// Number of stages, one or more.
    pub(super) num_stages: usize,
    /// Frames on both sides that a stage sees of the stage before.
    pub(super) window: u64,
}

/// Results of the stage before, by frame; empty in the first stage.
pub(super) type Window<R> = BTreeMap<u64, Arc<R>>;

/// The work of a stage on a frame.
pub(super) type Work<'w, R, E> = &'w (dyn Fn(usize, u64, &Window<R>) -> Result<R, E> + Sync);

/// What all threads know.
struct Board<R, E> {
    /// For each stage the next frame that is to be begun.
    next: Vec<u64>,
    /// For each stage the first frame that is not finished.
    complete: Vec<u64>,
    results: Vec<BTreeMap<u64, Arc<R>>>,
    /// The next frame that is to be taken.
    taken: u64,
    /// The first frame that failed.
    failure: Option<(u64, E)>,
    is_over: bool,
}

struct Shared<'p, R, E> {
    pipeline: &'p Pipeline,
    num_threads: u64,
    board: Mutex<Board<R, E>>,
    changed: Condvar,
}

impl Pipeline {
    /// The frames on which a stage works: those asked for, and those that later stages see.
    pub(super) fn range(&self, stage: usize) -> RangeInclusive<u64> {
        let margin = self.margin(stage);
        let first = self.part.start().saturating_sub(margin).max(*self.frames.start());
        first..=self.part.end().saturating_add(margin).min(*self.frames.end())
    }

    fn margin(&self, stage: usize) -> u64 {
        (self.num_stages - 1 - stage) as u64 * self.window
    }

    /// Works on all frames. `take` gets the results of the last stage, in the order of frames. Results are kept as long
    /// as a window needs them.
    ///
    /// # Errors
    /// The error of the first frame that failed; of one stage, after all frames before it were taken. Or that of
    /// `take`.
    pub(super) fn run<R: Send + Sync, E: Send>(
        &self,
        work: Work<'_, R, E>,
        take: &mut dyn FnMut(u64, &R) -> Result<(), E>,
    ) -> Result<(), E> {
        let num_threads = rayon::current_num_threads().max(1);
        let starts: Vec<u64> = (0..self.num_stages).map(|stage| *self.range(stage).start()).collect();
        let shared = Shared {
            pipeline: self,
            num_threads: num_threads as u64,
            board: Mutex::new(Board {
                next: starts.clone(),
                complete: starts,
                results: (0..self.num_stages).map(|_| BTreeMap::new()).collect(),
                taken: *self.part.start(),
                failure: None,
                is_over: false,
            }),
            changed: Condvar::new(),
        };
        thread::scope(|scope| {
            for _ in 0..num_threads {
                scope.spawn(|| shared.work(work));
            }
            shared.take_all(take)
        })
    }
}

/// Ends the others where a thread panics.
struct EndOthers<'s, 'p, R, E>(&'s Shared<'p, R, E>);

impl<R, E> Drop for EndOthers<'_, '_, R, E> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.end();
        }
    }
}

impl<R, E> Shared<'_, R, E> {
    fn lock(&self) -> MutexGuard<'_, Board<R, E>> {
        // Nothing panics while it holds the lock.
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end(&self) {
        self.lock().is_over = true;
        self.changed.notify_all();
    }

    fn wait<'g>(&self, board: MutexGuard<'g, Board<R, E>>) -> MutexGuard<'g, Board<R, E>> {
        self.changed.wait(board).unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes results in order, until all are taken or something failed.
    fn take_all(&self, take: &mut dyn FnMut(u64, &R) -> Result<(), E>) -> Result<(), E> {
        let _end_others = EndOthers(self);
        let last_stage = self.pipeline.num_stages - 1;
        let mut board = self.lock();
        let result = loop {
            let frame = board.taken;
            if frame > *self.pipeline.part.end() || board.is_over {
                break Ok(());
            }
            if let Some(result) = board.results[last_stage].remove(&frame) {
                board.taken += 1;
                drop(board);
                self.changed.notify_all();
                if let Err(error) = take(frame, &result) {
                    self.end();
                    return Err(error);
                }
                board = self.lock();
                continue;
            }
            // What was begun before the failure is finished first.
            let is_idle = board.next == board.complete;
            if is_idle && let Some((_, error)) = board.failure.take() {
                break Err(error);
            }
            board = self.wait(board);
        };
        drop(board);
        self.end();
        result
    }

    /// Works until nothing is left to do.
    fn work(&self, work: Work<'_, R, E>) {
        let _end_others = EndOthers(self);
        let mut board = self.lock();
        loop {
            if board.is_over {
                return;
            }
            let Some(stage) = (0..self.pipeline.num_stages).rev().find(|&stage| self.is_ready(&board, stage)) else {
                board = self.wait(board);
                continue;
            };
            let frame = board.next[stage];
            board.next[stage] += 1;
            let window = self.window(&board, stage, frame);
            drop(board);
            let result = work(stage, frame, &window);
            board = self.lock();
            board.finish(self.pipeline, stage, frame, result);
            self.changed.notify_all();
        }
    }

    /// Whether the next frame of a stage can be begun.
    fn is_ready(&self, board: &Board<R, E>, stage: usize) -> bool {
        let frame = board.next[stage];
        let ahead = self.pipeline.margin(stage) + 2 * self.num_threads;
        if board.failure.is_some() || frame > *self.pipeline.range(stage).end() || frame > board.taken + ahead {
            return false;
        }
        stage.checked_sub(1).is_none_or(|before| {
            let needed = (frame + self.pipeline.window).min(*self.pipeline.range(before).end());
            board.complete[before] > needed
        })
    }

    fn window(&self, board: &Board<R, E>, stage: usize, frame: u64) -> Window<R> {
        let Some(before) = stage.checked_sub(1) else { return Window::new() };
        let seen = frame.saturating_sub(self.pipeline.window)..=frame + self.pipeline.window;
        board.results[before].range(seen).map(|(&frame, result)| (frame, Arc::clone(result))).collect()
    }
}

impl<R, E> Board<R, E> {
    /// Takes the result of a frame, and forgets what no later frame sees.
    fn finish(&mut self, pipeline: &Pipeline, stage: usize, frame: u64, result: Result<R, E>) {
        match result {
            Ok(result) => drop(self.results[stage].insert(frame, Arc::new(result))),
            Err(error) if self.failure.as_ref().is_none_or(|(first, _)| frame < *first) => {
                self.failure = Some((frame, error));
            }
            Err(_) => {}
        }
        let is_last = stage + 1 == pipeline.num_stages;
        while self.complete[stage] < self.next[stage] && self.is_finished(stage, is_last) {
            self.complete[stage] += 1;
        }
        if let Some(before) = stage.checked_sub(1) {
            let first = self.complete[stage].saturating_sub(pipeline.window);
            self.results[before] = self.results[before].split_off(&first);
        }
    }

    /// Whether the first frame of a stage that is not complete is finished.
    fn is_finished(&self, stage: usize, is_last: bool) -> bool {
        let frame = self.complete[stage];
        let is_failed = self.failure.as_ref().is_some_and(|(failed, _)| *failed <= frame);
        is_failed || self.results[stage].contains_key(&frame) || is_last && frame < self.taken
    }
}
