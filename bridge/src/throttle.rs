//! Rate limit for log lines that a peer can cause.

use std::{
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

/// Lines that are admitted at once.
const BURST: u32 = 10;
/// Time until one more line is admitted.
const REFILL: Duration = Duration::from_secs(1);

/// The rate limit of one place in the code, which all peers share.
#[derive(Debug)]
pub(crate) struct Throttle(Mutex<(u32, Option<Instant>, u64)>);

impl Throttle {
    pub(crate) const fn new() -> Self {
        Self(Mutex::new((BURST, None, 0)))
    }

    /// Whether a line may be written now; if so, the number of lines that were suppressed since the last one.
    pub(crate) fn admit(&self) -> Option<u64> {
        self.admit_at(Instant::now())
    }

    fn admit_at(&self, now: Instant) -> Option<u64> {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (left, refilled, num_suppressed) = &mut *state;
        let since = refilled.get_or_insert(now);
        let periods = u32::try_from(now.duration_since(*since).as_secs() / REFILL.as_secs()).unwrap_or(u32::MAX);
        if periods > 0 {
            *left = left.saturating_add(periods).min(BURST);
            *since = now;
        }
        match left.checked_sub(1) {
            Some(rest) => {
                *left = rest;
                Some(std::mem::take(num_suppressed))
            }
            None => {
                *num_suppressed += 1;
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn throttle_admits_a_burst_then_one_line_a_second_and_counts_the_rest() {
        let throttle = Throttle::new();
        let start = Instant::now();
        let admitted = (0..100).filter(|_| throttle.admit_at(start).is_some()).count();
        assert_eq!(admitted, 10);
        let later = start + Duration::from_millis(1100);
        assert_eq!((throttle.admit_at(later), throttle.admit_at(later)), (Some(90), None));
    }
}
