//! A line now and then, however long one step takes: a thread of its own says what was last heard of.

use std::{
    io::Write,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// Says what is being done, at intervals, until it is dropped.
#[derive(Debug)]
pub(super) struct Beat {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    is_over: Condvar,
}

#[derive(Debug, Default)]
struct State {
    what: String,
    is_over: bool,
}

impl Beat {
    /// Starts with nothing to say. Where no thread can be had, nothing is ever said.
    pub(super) fn start(interval: Duration, out: impl Write + Send + 'static) -> Self {
        let shared = Arc::new(Shared::default());
        let own = Arc::clone(&shared);
        let thread = thread::Builder::new().name("progress".to_owned()).spawn(move || own.say(interval, out)).ok();
        Self { shared, thread }
    }

    /// What is being done from now on.
    pub(super) fn set(&self, what: String) {
        self.shared.lock().what = what;
    }
}

impl Drop for Beat {
    fn drop(&mut self) {
        self.shared.lock().is_over = true;
        self.shared.is_over.notify_all();
        if let Some(thread) = self.thread.take() {
            // It does not panic.
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing panics while it holds the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn say(&self, interval: Duration, mut out: impl Write) {
        let start = Instant::now();
        let mut state = self.lock();
        loop {
            let waited = self.is_over.wait_timeout_while(state, interval, |state| !state.is_over);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
            if state.is_over {
                return;
            }
            if state.what.is_empty() {
                continue;
            }
            let line = format!("untangled: {} s: {}\n", start.elapsed().as_secs(), state.what);
            // Who reads slowly keeps this thread waiting, and no other.
            drop(state);
            // Nobody may be there to read it.
            let _ = out.write_all(line.as_bytes());
            state = self.lock();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{io, sync::mpsc};

    use super::*;

    /// Sends each line on.
    struct Lines(mpsc::Sender<String>);

    impl Write for Lines {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let _ = self.0.send(String::from_utf8_lossy(bytes).into_owned());
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn beat_says_what_is_done_again_and_again_and_what_is_new() {
        let (sender, lines) = mpsc::channel();
        let beat = Beat::start(Duration::from_millis(1), Lines(sender));
        beat.set("reading".to_owned());
        for _ in 0..3 {
            assert!(lines.recv().unwrap().ends_with(" s: reading\n"));
        }
        beat.set("untangling".to_owned());
        assert!(lines.iter().any(|line| line.ends_with(": untangling\n")));
        drop(beat);
        // The end of the thread ends the channel.
        assert_eq!(lines.iter().find(|line| line.contains("reading")), None);
    }

    #[test]
    fn beat_that_ends_before_its_interval_says_nothing() {
        let (sender, lines) = mpsc::channel();
        let beat = Beat::start(Duration::from_secs(3600), Lines(sender));
        beat.set("reading".to_owned());
        drop(beat);
        assert_eq!(lines.recv(), Err(mpsc::RecvError));
    }
}
