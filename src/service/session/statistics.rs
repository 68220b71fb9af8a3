//! Counts and times of one session, for status and metrics.

use std::time::Instant;

use untangled_proto::{CorrectionHeader, Status, correction::TRUNCATED};

/// Counts and times of one session since it was registered.
#[derive(Clone, Debug, Default)]
pub(crate) struct Statistics {
    pub(crate) num_frames: u64,
    pub(crate) num_refused_frames: u64,
    pub(crate) num_truncated_frames: u64,
    /// Times of all frames together, by stage, in nanoseconds.
    pub(crate) stage_ns: [u64; 8],
    /// Header of the last correction.
    pub(crate) last: Option<CorrectionHeader>,
    last_at: Option<Instant>,
    mean_interval_s: Option<f64>,
}

impl Statistics {
    /// Adds the header of a correction.
    pub(crate) fn record(&mut self, header: &CorrectionHeader) {
        const WEIGHT: f64 = 0.1;
        let now = Instant::now();
        if let Some(last_at) = self.last_at.replace(now) {
            let interval_s = now.duration_since(last_at).as_secs_f64();
            let mean_s = self.mean_interval_s.get_or_insert(interval_s);
            *mean_s += WEIGHT * (interval_s - *mean_s);
        }
        self.num_frames += 1;
        let is_truncated = header.flags & TRUNCATED != 0;
        self.num_refused_frames += u64::from(header.status != Status::Ok.code() && !is_truncated);
        self.num_truncated_frames += u64::from(is_truncated);
        for (sum, ns) in self.stage_ns.iter_mut().zip(header.stage_ns) {
            *sum = sum.saturating_add(ns);
        }
        self.last = Some(*header);
    }

    /// Frames per second as an exponential mean; falls while no frame comes.
    pub(crate) fn rate_hz(&self) -> f64 {
        match (self.mean_interval_s, self.last_at) {
            (Some(mean_s), Some(last_at)) => 1.0 / mean_s.max(last_at.elapsed().as_secs_f64()).max(1e-9),
            _ => 0.0,
        }
    }
}
