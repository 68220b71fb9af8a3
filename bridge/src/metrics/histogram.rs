//! A histogram of times, in powers of two.

use std::{
    sync::atomic::{AtomicU64, Ordering},
    time::Duration,
};

use serde_json::{Value, json};

/// Upper ends of the buckets: 64 us times powers of two, up to 4 s; the last bucket has no end.
const FIRST_US: u64 = 64;
const NUM_BUCKETS: usize = 18;

/// Counts of times by their length.
#[derive(Debug, Default)]
pub struct Histogram {
    buckets: [AtomicU64; NUM_BUCKETS],
    sum_us: AtomicU64,
}

impl Histogram {
    /// One more.
    pub fn add(&self, time: Duration) {
        let us = u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        let bucket = (0..NUM_BUCKETS - 1).find(|&k| us <= Self::end_us(k)).unwrap_or(NUM_BUCKETS - 1);
        self.buckets[bucket].fetch_add(1, Ordering::Relaxed);
        self.sum_us.fetch_add(us, Ordering::Relaxed);
    }

    fn end_us(bucket: usize) -> u64 {
        FIRST_US << bucket
    }

    /// Upper ends of all buckets but the last in seconds, each with the number of times up to it; then the number and
    /// the sum of all.
    #[must_use]
    pub fn cumulative(&self) -> (Vec<(f64, u64)>, u64, f64) {
        let mut total = 0;
        let mut ends = Vec::with_capacity(NUM_BUCKETS - 1);
        for (bucket, count) in self.buckets.iter().enumerate() {
            total += count.load(Ordering::Relaxed);
            if bucket < NUM_BUCKETS - 1 {
                ends.push((seconds(Self::end_us(bucket)), total));
            }
        }
        (ends, total, seconds(self.sum_us.load(Ordering::Relaxed)))
    }

    /// The upper end in seconds of the bucket in which the given part of all times ends; nothing where there are none.
    #[must_use]
    pub fn quantile_s(&self, part: f64) -> Option<f64> {
        let (ends, total, _) = self.cumulative();
        #[expect(clippy::cast_precision_loss, reason = "a count of messages")]
        let wanted = part * total as f64;
        #[expect(clippy::cast_precision_loss, reason = "a count of messages")]
        let end = ends.iter().find(|(_, count)| *count as f64 >= wanted).or(ends.last());
        (total > 0).then_some(end?.0)
    }

    /// Number, mean and quantiles as JSON.
    #[must_use]
    pub fn report(&self) -> Value {
        let (_, total, sum_s) = self.cumulative();
        #[expect(clippy::cast_precision_loss, reason = "a count of messages")]
        let mean_s = if total == 0 { 0.0 } else { sum_s / total as f64 };
        json!({
            "count": total, "mean_s": mean_s,
            "p50_s": self.quantile_s(0.5), "p90_s": self.quantile_s(0.9), "p99_s": self.quantile_s(0.99),
        })
    }
}

#[expect(clippy::cast_precision_loss, reason = "2^53 us are 285 years")]
fn seconds(us: u64) -> f64 {
    us as f64 / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_ends_of_buckets_and_long_times_stay_in_the_last_one() {
        let histogram = Histogram::default();
        assert_eq!(histogram.quantile_s(0.5), None);
        for us in [10, 64, 65, 1000] {
            histogram.add(Duration::from_micros(us));
        }
        histogram.add(Duration::from_secs(3600));
        let (ends, total, sum_s) = histogram.cumulative();
        assert_eq!((ends[0], ends[1], total), ((64e-6, 2), (128e-6, 3), 5));
        assert!((sum_s - 3_600.001_139).abs() < 1e-6);
        assert_eq!(histogram.quantile_s(0.5), Some(128e-6));
        assert_eq!(ends.last().map(|end| end.1), Some(4));
    }
}
