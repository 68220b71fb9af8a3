//! One session that pages look at: a thread that fetches a frame whenever a page waits for one, and ends when none has
//! asked for a while. However many pages there are, the session has one observer.

use std::{
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use super::source::{Feed, Source};

/// Time without a question after which a session is no longer observed.
const IDLE: Duration = Duration::from_secs(5);
/// Longest time that the thread does not look whether it is to end.
const TICK: Duration = Duration::from_millis(100);

/// A frame with its number among all that were fetched.
#[derive(Clone, Debug)]
pub(super) struct Fetched {
    pub(super) serial: u64,
    pub(super) message: Arc<[u8]>,
}

/// What pages and the thread share.
#[derive(Debug, Default)]
struct State {
    mesh: Option<Arc<[u8]>>,
    newest: Option<Fetched>,
    num_waiting: usize,
    is_ending: bool,
    /// Why there will be no more.
    end: Option<String>,
}

/// See the module. Dropping it waits for its thread.
#[derive(Debug)]
pub(super) struct Channel {
    shared: Arc<Shared>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

impl Channel {
    pub(super) fn open(source: &Arc<dyn Source>, session: &str, num_fetched: &Arc<AtomicU64>) -> Result<Self, String> {
        let (shared, source) = (Arc::new(Shared::default()), Arc::clone(source));
        let (session, num_fetched) = (session.to_owned(), Arc::clone(num_fetched));
        let own = Arc::clone(&shared);
        let work = move || {
            let end = match source.open(&session) {
                Ok(mut feed) => own.follow(&mut *feed, &num_fetched),
                Err(words) => words,
            };
            own.lock().end = Some(end);
            own.changed.notify_all();
        };
        let thread = std::thread::Builder::new().name("observer".to_owned()).spawn(work);
        let thread = thread.map_err(|error| format!("starting a thread: {error}"))?;
        Ok(Self { shared, thread: Mutex::new(Some(thread)) })
    }

    /// The mesh, as soon as it is there.
    pub(super) fn mesh(&self, patience: Duration) -> Result<Option<Arc<[u8]>>, String> {
        self.shared.wait(patience, |state| state.mesh.clone())
    }

    /// The first frame that is fetched after number `after`; nothing within `patience`.
    pub(super) fn frame(&self, after: u64, patience: Duration) -> Result<Option<Fetched>, String> {
        self.shared.wait(patience, |state| state.newest.clone().filter(|newest| newest.serial > after))
    }

    /// Whether there will be no more.
    pub(super) fn has_ended(&self) -> bool {
        self.shared.lock().end.is_some()
    }

    /// Ends the thread, and waits until it has left the daemon.
    pub(super) fn close(&self) {
        self.shared.lock().is_ending = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take() {
            // A panic has been printed by now.
            let _ = thread.join();
        }
    }
}

impl Drop for Channel {
    fn drop(&mut self) {
        self.close();
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Each change is whole, so that a panic elsewhere leaves nothing half done.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for something, and lets the thread know that somebody waits.
    fn wait<T>(&self, patience: Duration, find: impl Fn(&State) -> Option<T>) -> Result<Option<T>, String> {
        let mut state = self.lock();
        state.num_waiting += 1;
        self.changed.notify_all();
        let is_open = |state: &mut State| state.end.is_none() && find(state).is_none();
        let waited = self.changed.wait_timeout_while(state, patience, is_open);
        state = waited.unwrap_or_else(PoisonError::into_inner).0;
        state.num_waiting -= 1;
        match (find(&state), &state.end) {
            (Some(found), _) => Ok(Some(found)),
            (None, Some(words)) => Err(words.clone()),
            (None, None) => Ok(None),
        }
    }

    /// Fetches frames while they are asked for. Returns why it has ended.
    fn follow(&self, feed: &mut dyn Feed, num_fetched: &AtomicU64) -> String {
        let mut state = self.lock();
        state.mesh = Some(feed.mesh());
        self.changed.notify_all();
        let mut asked = Instant::now();
        loop {
            let is_idle = state.num_waiting == 0;
            if state.is_ending || is_idle && asked.elapsed() > IDLE {
                return "nobody looks at it".to_owned();
            }
            if is_idle {
                let waited = self.changed.wait_timeout(state, TICK);
                state = waited.unwrap_or_else(PoisonError::into_inner).0;
                continue;
            }
            asked = Instant::now();
            drop(state);
            let latest = feed.latest(TICK);
            state = self.lock();
            match latest {
                Ok(None) => {}
                Ok(Some(message)) => {
                    let serial = 1 + num_fetched.fetch_add(1, Ordering::Relaxed);
                    state.newest = Some(Fetched { serial, message });
                    self.changed.notify_all();
                }
                Err(words) => return words,
            }
        }
    }
}
