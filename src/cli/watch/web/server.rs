//! The server: a thread for each connection, few of them, and each with limits of size and time.

use std::{
    io::{self, ErrorKind, Read, Write},
    net::{Ipv4Addr, Shutdown, TcpListener, TcpStream},
    os::unix::net::UnixStream,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use rustix::event::{PollFd, PollFlags, poll};

use super::{guard::Guard, routes};
use crate::{
    cli::watch::hub::Hub,
    http::{Answer, Request},
};

/// Connections at a time. One that has asked nothing yet that it may ask makes room for one more.
const MAX_CONNECTIONS: usize = 32;
/// Longest head of a request in bytes: browsers send the cookies of all that is at this address.
const MAX_HEAD: usize = 16 * 1024;
/// Longest time for a head, from its first byte.
const HEAD_TIME: Duration = Duration::from_secs(2);
/// Longest time between questions, and for a piece of an answer to be taken.
const IDLE: Duration = Duration::from_secs(10);

/// Headers of each answer: only this origin's own scripts and styles, no other page may hold or read this one, and the
/// address, which has the token, is told to nobody.
const HEADERS: [(&str, &str); 6] = [
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    ("Cache-Control", "no-store"),
    ("Cross-Origin-Opener-Policy", "same-origin"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    ("Referrer-Policy", "no-referrer"),
    ("X-Content-Type-Options", "nosniff"),
];

/// What the connections share.
struct Shared {
    guard: Guard,
    hub: Hub,
    connections: Mutex<Vec<Arc<Connection>>>,
}

/// One of them, as the others see it.
#[derive(Debug)]
struct Connection {
    stream: TcpStream,
    /// Whether it has asked something that it may ask.
    is_known: AtomicBool,
}

/// A server that has its address.
pub(in crate::cli::watch) struct Server {
    listener: TcpListener,
    shared: Arc<Shared>,
}

impl Server {
    /// On a loopback address; port 0 for one that is free.
    ///
    /// # Errors
    /// What the system says.
    pub(in crate::cli::watch) fn bind(port: u16, hub: Hub) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let shared = Shared { guard: Guard::new()?, hub, connections: Mutex::default() };
        Ok(Self { listener, shared: Arc::new(shared) })
    }

    /// The address of the page.
    ///
    /// # Errors
    /// What the system says.
    pub(in crate::cli::watch) fn page(&self) -> io::Result<String> {
        Ok(self.shared.guard.page(self.listener.local_addr()?.port()))
    }

    /// Serves until something can be read from `ending`, and leaves the daemon.
    ///
    /// # Errors
    /// What the system says where it can't wait.
    pub(in crate::cli::watch) fn run(&self, ending: &UnixStream) -> io::Result<()> {
        loop {
            let mut fds = [PollFd::new(&self.listener, PollFlags::IN), PollFd::new(ending, PollFlags::IN)];
            match poll(&mut fds, None) {
                Err(rustix::io::Errno::INTR) => continue,
                result => result?,
            };
            if !fds[1].revents().is_empty() {
                break;
            }
            match self.listener.accept() {
                Ok((stream, _)) => self.shared.admit(stream),
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                // Without free descriptors `accept` fails at once; do not spin.
                Err(_) => std::thread::sleep(Duration::from_millis(10)),
            }
        }
        for connection in self.shared.lock().drain(..) {
            let _ = connection.stream.shutdown(Shutdown::Both);
        }
        self.shared.hub.close();
        Ok(())
    }
}

impl Shared {
    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Connection>>> {
        self.connections.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Starts a connection, where there is room for it. One that can't be started is closed.
    fn admit(self: &Arc<Self>, stream: TcpStream) {
        let connection = Arc::new(Connection { stream, is_known: AtomicBool::new(false) });
        {
            let mut all = self.lock();
            if all.len() >= MAX_CONNECTIONS {
                let Some(oldest) = all.iter().position(|other| !other.is_known.load(Ordering::Relaxed)) else {
                    return;
                };
                let _ = all.remove(oldest).stream.shutdown(Shutdown::Both);
            }
            all.push(Arc::clone(&connection));
        }
        let (shared, own) = (Arc::clone(self), Arc::clone(&connection));
        let work = move || {
            // A peer that goes away, or is too slow, ends its connection and nothing else.
            let _ = shared.serve(&own);
            shared.forget(&own);
        };
        if std::thread::Builder::new().name("page".to_owned()).spawn(work).is_err() {
            self.forget(&connection);
        }
    }

    fn forget(&self, connection: &Arc<Connection>) {
        self.lock().retain(|other| !Arc::ptr_eq(other, connection));
    }

    /// Answers one request after the other.
    fn serve(&self, connection: &Connection) -> io::Result<()> {
        let stream = &connection.stream;
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(IDLE))?;
        let mut bytes = Vec::new();
        while let Some(request) = read_head(stream, &mut bytes)? {
            let admitted = request.as_ref().map_err(Clone::clone).and_then(|request| self.guard.admit(request));
            let (answer, is_kept_open) = match admitted {
                Ok(target) => {
                    connection.is_known.store(true, Ordering::Relaxed);
                    (routes::answer(target, &self.hub), request.as_ref().is_ok_and(|request| !wants_close(request)))
                }
                Err(refusal) => (refusal, false),
            };
            let is_head = request.is_ok_and(|request| request.is_head);
            write_answer(stream, answer, is_head, is_kept_open)?;
            if !is_kept_open {
                return Ok(());
            }
        }
        Ok(())
    }
}

fn wants_close(request: &Request) -> bool {
    request.header("connection").is_some_and(|value| value.eq_ignore_ascii_case("close"))
}

/// The next request, of which `bytes` may have the beginning; nothing where the peer has gone.
fn read_head(mut stream: &TcpStream, bytes: &mut Vec<u8>) -> io::Result<Option<Result<Request, Answer>>> {
    let mut buffer = [0; 4096];
    let mut since = (!bytes.is_empty()).then(Instant::now);
    loop {
        if let Some(parsed) = Request::parse(bytes, bytes.len() >= MAX_HEAD) {
            if let Ok(request) = &parsed {
                bytes.drain(..request.len);
            }
            return Ok(Some(parsed));
        }
        let left = since.map_or(IDLE, |since: Instant| HEAD_TIME.saturating_sub(since.elapsed()));
        if left.is_zero() {
            return Ok(None);
        }
        stream.set_read_timeout(Some(left))?;
        match stream.read(&mut buffer) {
            Ok(0) => return Ok(None),
            Ok(read) => bytes.extend_from_slice(&buffer[..read]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
        since = since.or_else(|| Some(Instant::now()));
    }
}

fn write_answer(mut stream: &TcpStream, answer: Answer, is_head: bool, is_kept_open: bool) -> io::Result<()> {
    let answer = HEADERS.iter().fold(answer, |answer, (name, value)| answer.with(name, *value));
    stream.write_all(answer.head(is_kept_open).as_bytes())?;
    if is_head { Ok(()) } else { stream.write_all(answer.body.bytes()) }
}
