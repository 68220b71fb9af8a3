//! How many messages of a session may be on their way: as many as the link carries without a queue.
//!
//! The newest state waits in shared memory until one may leave, and takes the place of an older one there, so that a
//! frame that was overtaken costs no bandwidth. The window is that of delay-based congestion control (Brakmo and
//! Peterson 1995, TCP Vegas): it grows while the round trip takes little longer than the shortest one, and shrinks when
//! messages begin to queue.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

/// Most messages on their way.
const MOST: u32 = 16;
/// The window is counted in parts of a message, by which it grows.
const PARTS: u32 = 256;
/// A message that was not acknowledged for so long is lost: the connection was broken and made again.
pub(super) const LOST: Duration = Duration::from_secs(2);
/// How much longer than the shortest a round trip may take before messages count as queued: half as long again, and
/// what threads wait for a busy processor.
const SLACK: f64 = 1.5;
const JITTER: Duration = Duration::from_millis(4);
/// How long the shortest round trip is remembered: the route may change.
const MEMORY: Duration = Duration::from_secs(30);

/// Messages of one direction of a session that are on their way.
#[derive(Debug)]
pub struct Window {
    sent: VecDeque<(u64, Instant)>,
    /// In parts of a message.
    size: u32,
    shortest: Option<(Duration, Instant)>,
}

impl Default for Window {
    fn default() -> Self {
        Self { sent: VecDeque::with_capacity(MOST as usize), size: 2 * PARTS, shortest: None }
    }
}

impl Window {
    /// Whether one more message may leave.
    #[must_use]
    pub fn is_open(&mut self, now: Instant) -> bool {
        while self.sent.front().is_some_and(|(_, sent)| now.duration_since(*sent) > LOST) {
            self.sent.pop_front();
            self.size = PARTS;
        }
        self.sent.len() < self.most()
    }

    /// Messages that may be on their way.
    fn most(&self) -> usize {
        (self.size / PARTS) as usize
    }

    /// Whether messages are on their way.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        !self.sent.is_empty()
    }

    /// A message leaves.
    pub fn send(&mut self, sequence: u64, now: Instant) {
        self.sent.push_back((sequence, now));
    }

    /// The other end has all messages up to this one; gives back how long the newest of them took there and back.
    pub fn acknowledge(&mut self, sequence: u64, now: Instant) -> Option<Duration> {
        let was_full = self.sent.len() + 1 >= self.most();
        let mut newest = None;
        while let Some(&(number, sent)) = self.sent.front()
            && number <= sequence
        {
            self.sent.pop_front();
            newest = Some(now.duration_since(sent));
        }
        let trip = newest?;
        let shortest = match self.shortest {
            Some((shortest, seen)) if shortest <= trip && now.duration_since(seen) < MEMORY => shortest,
            _ => {
                self.shortest = Some((trip, now));
                trip
            }
        };
        if trip <= shortest.mul_f64(SLACK) + JITTER {
            if was_full {
                self.size = (self.size + PARTS * PARTS / self.size).min(MOST * PARTS);
            }
        } else {
            self.size = (self.size / 4 * 3).max(PARTS);
        }
        Some(trip)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A link that carries one message at a time, each for `transfer`, and has `delay` there and back. Sends whenever
    /// the window is open, and gives back the mean trip and the number of messages of the second half.
    fn run(transfer: Duration, delay: Duration, messages: u32) -> (Duration, f64) {
        let mut window = Window::default();
        let start = Instant::now();
        let (mut now, mut free) = (start, start);
        let mut acks: VecDeque<(u64, Instant)> = VecDeque::new();
        let (mut sequence, mut trips, mut since) = (0, Vec::new(), start);
        while trips.len() < messages as usize {
            while window.is_open(now) {
                sequence += 1;
                window.send(sequence, now);
                free = free.max(now) + transfer;
                acks.push_back((sequence, free + delay));
            }
            let (number, at) = acks.pop_front().unwrap();
            now = at;
            trips.push(window.acknowledge(number, now).unwrap());
            if trips.len() == messages as usize / 2 {
                since = now;
            }
        }
        let half = &trips[trips.len() / 2..];
        let mean = half.iter().sum::<Duration>() / u32::try_from(half.len()).unwrap();
        (mean, half.len() as f64 / now.duration_since(since).as_secs_f64())
    }

    #[test]
    fn window_fills_long_links_and_builds_no_queue_on_slow_ones() {
        let ms = Duration::from_millis;
        let (trip, rate) = run(ms(2), ms(20), 2000);
        assert!(rate > 400.0 && trip < ms(40), "2 ms at a time and 20 ms away: {rate:.0} a second in {trip:?}");
        let (trip, rate) = run(ms(30), ms(1), 2000);
        assert!(rate > 32.0 && trip < ms(100), "30 ms at a time: {rate:.0} a second in {trip:?}");
    }

    #[test]
    fn window_opens_again_after_messages_were_lost_and_ignores_late_acknowledgements() {
        let mut window = Window::default();
        let now = Instant::now();
        window.send(1, now);
        window.send(2, now);
        assert!(!window.is_open(now));
        assert!(window.is_open(now + LOST + Duration::from_millis(1)));
        assert!(!window.is_waiting());
        assert_eq!(window.acknowledge(2, now), None);
        assert_eq!(window.acknowledge(u64::MAX, now), None);
    }
}
