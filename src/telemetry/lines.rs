//! Lines to standard error that never fail and never keep their writer waiting.
//!
//! Whoever started the daemon may close the other end of standard error, or stop reading from it. So a thread of its
//! own writes; where it can't keep up, lines are dropped and counted.

use std::{
    io::{self, Write},
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, Sender, SyncSender, TrySendError, channel, sync_channel},
    },
    time::{Duration, Instant},
};

/// Lines that wait to be written.
const CAPACITY: usize = 1024;
/// Time between two attempts to hand the thread something while it can't keep up.
const RETRY: Duration = Duration::from_millis(5);

/// Says in a line how many lines were dropped.
pub(super) type Report = fn(u64) -> String;

#[derive(Debug)]
enum Message {
    Line(Vec<u8>),
    /// To be answered when all lines before it have been written.
    Flush(Sender<()>),
}

/// Takes lines; each write is one.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    messages: SyncSender<Message>,
    num_dropped: Arc<AtomicU64>,
}

impl Lines {
    /// Starts the thread that writes to `out`; it ends with the process.
    pub(super) fn start(out: impl Write + Send + 'static, report: Report) -> io::Result<Self> {
        let (messages, received) = sync_channel(CAPACITY);
        let num_dropped = Arc::new(AtomicU64::new(0));
        let dropped = Arc::clone(&num_dropped);
        std::thread::Builder::new().name("log".to_owned()).spawn(move || write(&received, out, &dropped, report))?;
        Ok(Self { messages, num_dropped })
    }

    /// Waits until all lines so far have been written, at most for `patience`.
    pub(super) fn flush(&self, patience: Duration) {
        let end = Instant::now() + patience;
        let (done, flushed) = channel();
        let mut message = Message::Flush(done);
        while let Err(TrySendError::Full(again)) = self.messages.try_send(message) {
            if Instant::now() >= end {
                return;
            }
            message = again;
            std::thread::sleep(RETRY);
        }
        let _ = flushed.recv_timeout(end.saturating_duration_since(Instant::now()));
    }
}

impl Write for Lines {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        if self.messages.try_send(Message::Line(line.to_vec())).is_err() {
            self.num_dropped.fetch_add(1, Ordering::Relaxed);
        }
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn write(messages: &Receiver<Message>, mut out: impl Write, num_dropped: &AtomicU64, report: Report) {
    for message in messages {
        // An error means that nobody reads any more; there is no one to tell.
        match message {
            Message::Line(line) => drop(out.write_all(&line)),
            Message::Flush(done) => drop(out.flush().map(|()| done.send(()))),
        }
        let dropped = num_dropped.swap(0, Ordering::Relaxed);
        if dropped > 0 {
            drop(out.write_all(report(dropped).as_bytes()));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// Writes nothing until it is told that there is a reader.
    struct Pipe {
        reader: Receiver<()>,
        is_read: bool,
        text: Arc<Mutex<Vec<u8>>>,
    }

    impl Write for Pipe {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if !self.is_read {
                self.reader.recv().unwrap();
                self.is_read = true;
            }
            self.text.lock().unwrap().extend(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn lines_that_nobody_reads_are_dropped_and_counted() {
        let (read, reader) = channel();
        let text = Arc::new(Mutex::new(Vec::new()));
        let pipe = Pipe { reader, is_read: false, text: Arc::clone(&text) };
        let mut lines = Lines::start(pipe, |dropped| format!("dropped {dropped}\n")).unwrap();
        for k in 0..3 * CAPACITY {
            lines.write_all(format!("line {k}\n").as_bytes()).unwrap();
        }
        lines.flush(Duration::from_millis(20));
        read.send(()).unwrap();
        lines.flush(Duration::from_secs(10));
        let text = String::from_utf8(text.lock().unwrap().clone()).unwrap();
        let dropped: usize = text.lines().filter_map(|line| line.strip_prefix("dropped ")?.parse::<usize>().ok()).sum();
        let written = text.lines().filter(|line| line.starts_with("line ")).count();
        assert_eq!(dropped + written, 3 * CAPACITY);
        assert!(written >= CAPACITY && dropped > 0, "{written} lines written, {dropped} dropped");
    }

    #[test]
    fn lines_to_a_closed_pipe_are_no_error() {
        let (reader, writer) = io::pipe().unwrap();
        drop(reader);
        let mut lines = Lines::start(writer, |_| String::new()).unwrap();
        lines.write_all(b"nobody reads this\n").unwrap();
        lines.flush(Duration::from_secs(10));
        lines.write_all(b"nor this\n").unwrap();
    }
}
