//! Times of many frames.

use std::time::Duration;

/// Times, to be asked for parts of them.
#[derive(Clone, Debug, Default)]
pub struct Times(Vec<Duration>);

impl Times {
    /// One more.
    pub fn add(&mut self, time: Duration) {
        self.0.push(time);
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The time within which this part of all lies, in milliseconds; zero where there are none.
    #[must_use]
    pub fn quantile_ms(&mut self, part: f64) -> f64 {
        self.0.sort_unstable();
        let last = self.0.len().saturating_sub(1);
        #[expect(clippy::cast_sign_loss, reason = "parts are from 0 to 1")]
        let place = (part * last as f64).round() as usize;
        self.0.get(place).map_or(0.0, |time| 1e3 * time.as_secs_f64())
    }

    /// Times of another series as well.
    pub fn append(&mut self, mut other: Self) {
        self.0.append(&mut other.0);
    }
}
