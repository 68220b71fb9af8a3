//! Log lines that never keep their writer waiting: a thread writes them, and those for which there is no room are
//! dropped and counted.

use std::{
    io::{self, Write},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{SyncSender, sync_channel},
    },
    time::{Duration, Instant},
};

/// Lines that may wait to be written.
const MAX_LINES: usize = 1024;
/// How long the end of a process waits for a reader of its last lines.
const PATIENCE: Duration = Duration::from_millis(500);

/// Hands lines to the thread that writes them.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    sender: SyncSender<Vec<u8>>,
    num_waiting: Arc<AtomicU64>,
    num_dropped: Arc<AtomicU64>,
}

impl Lines {
    /// Starts the thread.
    pub(super) fn start(mut to: impl Write + Send + 'static) -> io::Result<Self> {
        let (sender, receiver) = sync_channel::<Vec<u8>>(MAX_LINES);
        let [num_waiting, num_dropped] = [(); 2].map(|()| Arc::new(AtomicU64::new(0)));
        let (waiting, dropped) = (Arc::clone(&num_waiting), Arc::clone(&num_dropped));
        std::thread::Builder::new().name("log".into()).spawn(move || {
            for line in receiver {
                // A reader that is gone is no error of ours.
                let _ = to.write_all(&line);
                waiting.fetch_sub(1, Ordering::Relaxed);
                let dropped = dropped.swap(0, Ordering::Relaxed);
                if dropped > 0 {
                    let _ = writeln!(to, "{dropped} log lines were dropped, since nobody read them");
                }
            }
        })?;
        Ok(Self { sender, num_waiting, num_dropped })
    }

    /// Waits until what was handed over is written, as far as somebody reads it.
    pub(super) fn flush(&self) {
        let begin = Instant::now();
        while self.num_waiting.load(Ordering::Relaxed) > 0 && begin.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

impl Write for Lines {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.num_waiting.fetch_add(1, Ordering::Relaxed);
        if self.sender.try_send(bytes.to_vec()).is_err() {
            self.num_waiting.fetch_sub(1, Ordering::Relaxed);
            self.num_dropped.fetch_add(1, Ordering::Relaxed);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Mutex, mpsc};

    use super::*;

    /// Writes when it is told to.
    struct Gate(mpsc::Receiver<()>, Arc<Mutex<Vec<u8>>>);

    impl Write for Gate {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let _ = self.0.recv();
            self.1.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn lines_that_nobody_reads_keep_nobody_waiting_and_are_counted() {
        let (open, gate) = mpsc::channel();
        let written = Arc::new(Mutex::new(Vec::new()));
        let mut lines = Lines::start(Gate(gate, Arc::clone(&written))).unwrap();
        let begin = Instant::now();
        for _ in 0..MAX_LINES + 100 {
            lines.write_all(b"line\n").unwrap();
        }
        assert!(begin.elapsed() < Duration::from_secs(5));
        // From here on all writes pass.
        drop(open);
        lines.flush();
        let begin = Instant::now();
        while !String::from_utf8_lossy(&written.lock().unwrap()).contains("log lines were dropped") {
            assert!(begin.elapsed() < Duration::from_secs(5));
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}
