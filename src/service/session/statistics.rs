//! Counts and times, for status and metrics: of one session, and of all.

use std::{
    sync::atomic::{AtomicU64, Ordering},
    time::Instant,
};

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
    /// Adds the header of a correction, to `totals` as well.
    pub(crate) fn record(&mut self, header: &CorrectionHeader, totals: &Totals) {
        const WEIGHT: f64 = 0.1;
        let now = Instant::now();
        if let Some(last_at) = self.last_at.replace(now) {
            let interval_s = now.duration_since(last_at).as_secs_f64();
            let mean_s = self.mean_interval_s.get_or_insert(interval_s);
            *mean_s += WEIGHT * (interval_s - *mean_s);
        }
        self.num_frames += 1;
        self.num_refused_frames += u64::from(is_refused(header));
        self.num_truncated_frames += u64::from(header.flags & TRUNCATED != 0);
        let num_skipped_before = self.last.map_or(0, |last| last.num_skipped_frames);
        totals.add(header, header.num_skipped_frames.saturating_sub(num_skipped_before));
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

/// Counts and times of all sessions since the daemon started, those that have ended included: they never fall.
#[derive(Debug, Default)]
pub(crate) struct Totals {
    pub(crate) num_frames: AtomicU64,
    pub(crate) num_refused_frames: AtomicU64,
    pub(crate) num_skipped_frames: AtomicU64,
    pub(crate) num_truncated_frames: AtomicU64,
    /// By stage, in nanoseconds.
    pub(crate) stage_ns: [AtomicU64; 8],
}

/// Whether a frame was refused, rather than ended by a limit.
fn is_refused(header: &CorrectionHeader) -> bool {
    header.status != Status::Ok.code() && header.flags & TRUNCATED == 0
}

impl Totals {
    fn add(&self, header: &CorrectionHeader, num_skipped: u64) {
        let add = |sum: &AtomicU64, number| {
            sum.fetch_add(number, Ordering::Relaxed);
        };
        add(&self.num_frames, 1);
        add(&self.num_refused_frames, u64::from(is_refused(header)));
        add(&self.num_skipped_frames, num_skipped);
        add(&self.num_truncated_frames, u64::from(header.flags & TRUNCATED != 0));
        for (sum, ns) in self.stage_ns.iter().zip(header.stage_ns) {
            add(sum, ns);
        }
    }
}
