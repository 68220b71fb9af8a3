//! The thread that serves metrics: all connections side by side, so that an idle one keeps no other waiting.

use std::{
    collections::VecDeque,
    io::ErrorKind,
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::JoinHandle,
    time::Duration,
};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use untangled_transport::throttle::Throttle;

use super::{connection::Connection, text::prometheus};
use crate::service::{
    error::ServeError,
    requests::{Registry, status},
};

/// Connections at a time; the oldest is closed for one more.
const MAX_CONNECTIONS: usize = 64;
/// Longest time for the connection that ends the thread.
const PATIENCE: Duration = Duration::from_secs(1);

/// A thread that answers until it is dropped.
#[derive(Debug)]
pub(crate) struct MetricsServer {
    address: SocketAddr,
    ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl MetricsServer {
    pub(crate) fn start(address: SocketAddr, registry: Arc<Registry>) -> Result<Self, ServeError> {
        let failed = |source| ServeError::System { what: format!("serving metrics at {address}"), source };
        let listener = TcpListener::bind(address).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let ending = Arc::new(AtomicBool::new(false));
        let ends = Arc::clone(&ending);
        let work = move || serve(&listener, &ends, &|| prometheus(&status::report(&registry)));
        let thread = std::thread::Builder::new().name("metrics".to_owned()).spawn(work).map_err(failed)?;
        tracing::info!(%address, "metrics at http://{address}/metrics");
        Ok(Self { address, ending, thread: Some(thread) })
    }
}

impl Drop for MetricsServer {
    fn drop(&mut self) {
        self.ending.store(true, Ordering::Release);
        // The thread waits for a connection; this one wakes it.
        let woken = TcpStream::connect_timeout(&self.address, PATIENCE);
        if woken.is_ok()
            && let Some(thread) = self.thread.take()
        {
            let _ = thread.join();
        }
    }
}

fn serve(listener: &TcpListener, ending: &AtomicBool, body: &dyn Fn() -> String) {
    let mut connections = VecDeque::new();
    loop {
        wait(listener, &connections);
        if ending.load(Ordering::Acquire) {
            return;
        }
        accept(listener, &mut connections);
        connections.retain_mut(|connection| {
            connection.advance(body).unwrap_or_else(|error| {
                report("a request for metrics failed", &error);
                false
            })
        });
    }
}

/// Sleeps until something has come, or time is up for a connection.
fn wait(listener: &TcpListener, connections: &VecDeque<Connection>) {
    let mut fds = vec![PollFd::new(listener, PollFlags::IN)];
    fds.extend(connections.iter().map(|connection| PollFd::new(connection.stream(), connection.interest())));
    // A millisecond more, so that it is over then.
    let left = connections.iter().map(|connection| connection.time_left() + Duration::from_millis(1)).min();
    let left = left.and_then(|left| Timespec::try_from(left).ok());
    // An interrupted wait is a shorter one.
    let _ = poll(&mut fds, left.as_ref());
}

fn accept(listener: &TcpListener, connections: &mut VecDeque<Connection>) {
    loop {
        match listener.accept().and_then(|(stream, _)| Connection::new(stream)) {
            Ok(connection) => {
                if connections.len() == MAX_CONNECTIONS {
                    connections.pop_front();
                }
                connections.push_back(connection);
            }
            Err(error) if error.kind() == ErrorKind::WouldBlock => return,
            Err(error) => {
                report("a connection for metrics failed", &error);
                // Without free descriptors `accept` fails at once; do not spin.
                connections.pop_front();
                std::thread::sleep(Duration::from_millis(10));
                return;
            }
        }
    }
}

fn report(what: &str, error: &std::io::Error) {
    static FAILED: Throttle = Throttle::new();
    if let Some(num_suppressed) = FAILED.admit() {
        tracing::info!(%error, num_suppressed, "{what}");
    }
}
