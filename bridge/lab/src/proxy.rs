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
    /// There, and back.
    cuts: [AtomicBool; 2],
    has_ended: AtomicBool,
    delay_us: AtomicU64,
    /// Connections of an earlier number are to be broken.
    generation: AtomicU64,
}

impl Proxy {
    /// Starts it.
    ///
    /// # Panics
    /// If no address is free.
    #[must_use]
    pub fn start(target: SocketAddr) -> Self {
        Self::start_at(free_address(), target)
    }

    /// Starts it at an address.
    ///
    /// # Panics
    /// If the address can't be listened on.
    #[must_use]
    pub fn start_at(address: SocketAddr, target: SocketAddr) -> Self {
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
        self.state.cuts[0].store(is_cut, Ordering::Relaxed);
        self.cut_back(is_cut);
    }

    /// Cuts the way back alone.
    pub fn cut_back(&self, is_cut: bool) {
        self.state.cuts[1].store(is_cut, Ordering::Relaxed);
    }

    /// Breaks all connections: what was on its way is lost, and a new one is served.
    pub fn break_off(&self) {
        self.state.generation.fetch_add(1, Ordering::Relaxed);
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
    fn generation(&self) -> u64 {
        self.generation.load(Ordering::Relaxed)
    }

    /// Whether a connection of a generation still stands, after the time that the way was cut.
    fn stands_after_cut(&self, way: usize, generation: u64) -> bool {
        let stands = || !self.has_ended.load(Ordering::Relaxed) && self.generation() == generation;
        while self.cuts[way].load(Ordering::Relaxed) && stands() {
            std::thread::sleep(PERIOD);
        }
        stands()
    }
}

fn carry(near: &TcpStream, target: SocketAddr, state: &Arc<State>) {
    let generation = state.generation();
    if !state.stands_after_cut(0, generation) {
        return;
    }
    let Ok(far) = TcpStream::connect(target) else { return };
    let ways = [(0, near.try_clone(), far.try_clone()), (1, far.try_clone(), near.try_clone())];
    let threads = ways.map(|(way, from, to)| {
        let state = Arc::clone(state);
        std::thread::spawn(move || copy(from.unwrap(), to.unwrap(), &state, (way, generation)))
    });
    for thread in threads {
        let _ = thread.join();
    }
}

/// Two threads for each direction, so that a delay does not limit what is on its way.
fn copy(mut from: TcpStream, mut to: TcpStream, state: &Arc<State>, (way, generation): (usize, u64)) {
    let _ = to.set_nodelay(true);
    from.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
    let (sender, receiver) = std::sync::mpsc::sync_channel::<(Instant, Vec<u8>)>(1 << 10);
    let writing = Arc::clone(state);
    let writer = std::thread::spawn(move || {
        while let Ok((due, bytes)) = receiver.recv() {
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            if !writing.stands_after_cut(way, generation) || to.write_all(&bytes).is_err() {
                break;
            }
        }
        let _ = to.shutdown(Shutdown::Both);
    });
    let mut bytes = vec![0; 1 << 16];
    while state.stands_after_cut(way, generation) {
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
