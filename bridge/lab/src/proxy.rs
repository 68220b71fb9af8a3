//! A TCP connection that can be cut without its ends being told, as a network does it.

use std::{
    io::{ErrorKind, Read, Write},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use super::ends::free_address;

const PERIOD: Duration = Duration::from_millis(2);

/// A way to an address: what it gets it passes on, later by a delay, unless it is cut. A connection that is made while
/// it is cut is not answered.
#[derive(Debug)]
pub struct Proxy {
    /// Where to connect to.
    pub address: SocketAddr,
    state: Arc<State>,
}

#[derive(Debug, Default)]
struct State {
    is_cut: AtomicBool,
    has_ended: AtomicBool,
    delay_us: AtomicU64,
}

impl Proxy {
    /// Starts it.
    ///
    /// # Panics
    /// If no address is free.
    #[must_use]
    pub fn start(target: SocketAddr) -> Self {
        let address = free_address();
        let listener = TcpListener::bind(address).unwrap();
        let state = Arc::new(State::default());
        let accepting = Arc::clone(&state);
        std::thread::spawn(move || {
            for near in listener.incoming().map_while(Result::ok) {
                if accepting.has_ended.load(Ordering::Relaxed) {
                    return;
                }
                let state = Arc::clone(&accepting);
                std::thread::spawn(move || carry(&near, target, &state));
            }
        });
        Self { address, state }
    }

    /// Cuts the way, or opens it again: what was on its way then arrives late.
    pub fn cut(&self, is_cut: bool) {
        self.state.is_cut.store(is_cut, Ordering::Relaxed);
    }

    /// Delays all bytes by so much in each direction.
    pub fn delay(&self, delay: Duration) {
        self.state.delay_us.store(u64::try_from(delay.as_micros()).unwrap(), Ordering::Relaxed);
    }
}

impl Drop for Proxy {
    fn drop(&mut self) {
        self.state.has_ended.store(true, Ordering::Relaxed);
        let _ = TcpStream::connect(self.address);
    }
}

impl State {
    fn wait_while_cut(&self) {
        while self.is_cut.load(Ordering::Relaxed) && !self.has_ended.load(Ordering::Relaxed) {
            std::thread::sleep(PERIOD);
        }
    }
}

fn carry(near: &TcpStream, target: SocketAddr, state: &Arc<State>) {
    state.wait_while_cut();
    let Ok(far) = TcpStream::connect(target) else { return };
    let ways = [(near.try_clone(), far.try_clone()), (far.try_clone(), near.try_clone())];
    let ways = ways.map(|(from, to)| (from.unwrap(), to.unwrap()));
    let threads = ways.map(|(from, to)| {
        let state = Arc::clone(state);
        std::thread::spawn(move || copy(from, to, &state))
    });
    for thread in threads {
        let _ = thread.join();
    }
}

/// Two threads for each direction, so that a delay does not limit what is on its way.
fn copy(mut from: TcpStream, mut to: TcpStream, state: &Arc<State>) {
    let _ = to.set_nodelay(true);
    from.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
    let (sender, receiver) = std::sync::mpsc::sync_channel::<(Instant, Vec<u8>)>(1 << 10);
    let writing = Arc::clone(state);
    let writer = std::thread::spawn(move || {
        while let Ok((due, bytes)) = receiver.recv() {
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            writing.wait_while_cut();
            if to.write_all(&bytes).is_err() {
                break;
            }
        }
        let _ = to.shutdown(Shutdown::Both);
    });
    let mut bytes = vec![0; 1 << 16];
    while !state.has_ended.load(Ordering::Relaxed) {
        state.wait_while_cut();
        match from.read(&mut bytes) {
            Ok(0) => break,
            Ok(count) => {
                let due = Instant::now() + Duration::from_micros(state.delay_us.load(Ordering::Relaxed));
                if sender.send((due, bytes[..count].to_vec())).is_err() {
                    break;
                }
            }
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
            Err(_) => break,
        }
    }
    drop(sender);
    let _ = writer.join();
    let _ = from.shutdown(Shutdown::Both);
}
