//! Rate limit for log lines that a peer can cause.

use std::{
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

/// Lines that are admitted at once.
const BURST: u32 = 10;
/// Time until one more line is admitted.
const REFILL: Duration = Duration::from_secs(1);

/// The rate limit (token bucket) of one place in the code. All peers share it: a peer that floods the log suppresses
/// only lines from the same place.
#[derive(Debug)]
pub struct Throttle(Mutex<State>);

#[derive(Debug)]
struct State {
    left: u32,
    refilled: Option<Instant>,
    num_suppressed: u64,
}

impl Throttle {
    /// A full bucket.
    #[must_use]
    pub const fn new() -> Self {
        Self(Mutex::new(State { left: BURST, refilled: None, num_suppressed: 0 }))
    }

    /// Whether a line may be written now; if so, the number of lines that were suppressed since the last one.
    pub fn admit(&self) -> Option<u64> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).admit(Instant::now())
    }
}

impl Default for Throttle {
    fn default() -> Self {
        Self::new()
    }
}

impl State {
    fn admit(&mut self, now: Instant) -> Option<u64> {
        let refilled = *self.refilled.get_or_insert(now);
        let seconds = now.saturating_duration_since(refilled).as_secs() / REFILL.as_secs();
        if seconds > 0 {
            self.left = self.left.saturating_add(u32::try_from(seconds).unwrap_or(u32::MAX)).min(BURST);
            self.refilled = Some(refilled + REFILL * u32::try_from(seconds).unwrap_or(u32::MAX));
        }
        match self.left.checked_sub(1) {
            Some(left) => {
                self.left = left;
                Some(std::mem::take(&mut self.num_suppressed))
            }
            None => {
                self.num_suppressed += 1;
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn throttle_admits_burst_then_one_line_per_second_and_counts_suppressed() {
        let mut state = State { left: BURST, refilled: None, num_suppressed: 0 };
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs_f64(seconds);
        let lines = (0..1000).filter(|_| state.admit(at(0.5)).is_some()).count();
        assert_eq!(lines, BURST as usize);
        assert_eq!(state.admit(at(1.6)), Some(990));
        assert_eq!(state.admit(at(1.7)), None);
        assert_eq!(state.admit(at(3600.0)), Some(1));
        let lines = (0..1000).filter(|_| state.admit(at(3600.0)).is_some()).count();
        assert_eq!(lines, BURST as usize - 1);
    }
}
