//! When the daemon asks for a repair by itself: where a tangle has not shrunk over some frames.
//!
//! The daemon keeps no history. What it knows of the progress of a motion it sends with each correction, and the host
//! sends it back with its next state of that motion: a daemon that was restarted goes on where the last one ended.

/// A tangle has shrunk where its number of intersections, or the length of its paths, is below this part of the best so
/// far.
const SHRUNK: f64 = 0.95;
/// Frames without progress before the first repair.
const PATIENCE: u32 = 10;
/// Each repair that left something doubles the patience, up to so many times.
const MOST_DOUBLINGS: u32 = 6;

/// The progress of a motion; zeros on the wire for one that begins, or in which nothing intersects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Progress {
    /// Least length of all paths so far, in metres.
    best_length_m: f64,
    /// Fewest edge-face intersections so far.
    best_count: u32,
    /// Frames since the best.
    num_frames: u16,
    /// Repairs that were begun.
    num_repairs: u16,
}

impl Progress {
    /// As it stands in the header of a state. A peer may write anything; a length that is none begins anew.
    pub(crate) fn from_bits([length, rest]: [u64; 2]) -> Self {
        let best_length_m = f64::from_bits(length);
        if !best_length_m.is_finite() || best_length_m < 0.0 {
            return Self::default();
        }
        let [a, b, c, d, e, f, g, h] = rest.to_le_bytes();
        Self {
            best_length_m,
            best_count: u32::from_le_bytes([a, b, c, d]),
            num_frames: u16::from_le_bytes([e, f]),
            num_repairs: u16::from_le_bytes([g, h]),
        }
    }

    /// As it stands in headers.
    pub(crate) fn to_bits(self) -> [u64; 2] {
        let [a, b, c, d] = self.best_count.to_le_bytes();
        let ([e, f], [g, h]) = (self.num_frames.to_le_bytes(), self.num_repairs.to_le_bytes());
        [self.best_length_m.to_bits(), u64::from_le_bytes([a, b, c, d, e, f, g, h])]
    }

    /// Takes note of a frame, and says whether it is to be repaired. While a repair is in work, `busy`, nothing is
    /// asked for, and no frame counts against the motion.
    pub(crate) fn is_repair_due(&mut self, num_edge_face: u64, length_m: f64, busy: bool) -> bool {
        let count = u32::try_from(num_edge_face).unwrap_or(u32::MAX);
        if count == 0 {
            *self = Self::default();
            return false;
        }
        let has_best = self.best_count > 0;
        let is_better =
            f64::from(count) < SHRUNK * f64::from(self.best_count) || length_m < SHRUNK * self.best_length_m;
        if !has_best || is_better {
            (self.best_count, self.best_length_m) = if has_best {
                (self.best_count.min(count), self.best_length_m.min(length_m))
            } else {
                (count, length_m)
            };
            self.num_frames = 0;
            return false;
        }
        if busy {
            self.num_frames = 0;
            return false;
        }
        self.num_frames = self.num_frames.saturating_add(1);
        if u32::from(self.num_frames) < PATIENCE << u32::from(self.num_repairs).min(MOST_DOUBLINGS) {
            return false;
        }
        // What comes after the repair is measured by what it was before.
        *self = Self {
            best_length_m: length_m,
            best_count: count,
            num_frames: 0,
            num_repairs: self.num_repairs.saturating_add(1),
        };
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames until a repair is due, at most `most`, of a motion whose tangle has this size in each frame.
    fn frames_to_repair(progress: &mut Progress, most: usize, size: impl Fn(usize) -> f64) -> Option<usize> {
        (1..=most).find(|&frame| {
            let length_m = size(frame);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "sizes of tests")]
            let count = (100.0 * length_m) as u64;
            // As it goes over the wire.
            *progress = Progress::from_bits(progress.to_bits());
            progress.is_repair_due(count, length_m, false)
        })
    }

    #[test]
    fn repair_is_due_where_a_tangle_does_not_shrink_and_ever_later_where_repairs_help_little() {
        let mut progress = Progress::default();
        assert_eq!(frames_to_repair(&mut progress, 1000, |_| 1.0), Some(11), "a best, and ten frames");
        assert_eq!(frames_to_repair(&mut progress, 1000, |_| 1.0), Some(20));
        assert_eq!(frames_to_repair(&mut progress, 1000, |_| 1.0), Some(40));
        let shrinks = |frame| 0.99f64.powi(i32::try_from(frame).unwrap_or(i32::MAX));
        assert_eq!(frames_to_repair(&mut Progress::default(), 300, shrinks), None);
        let wobbles = |frame| if frame % 2 == 0 { 1.0 } else { 0.97 };
        assert_eq!(frames_to_repair(&mut Progress::default(), 300, wobbles), Some(11));
    }

    #[test]
    fn progress_ends_with_a_clean_frame_and_waits_for_a_repair_in_work() {
        let mut progress = Progress::default();
        for _ in 0..9 {
            assert!(!progress.is_repair_due(50, 0.5, false));
        }
        assert!(!progress.is_repair_due(0, 0.0, false));
        assert_eq!(progress.to_bits(), [0; 2]);
        for _ in 0..100 {
            assert!(!progress.is_repair_due(50, 0.5, true));
        }
        assert_eq!(frames_to_repair(&mut progress, 100, |_| 0.5), Some(10));
    }

    #[test]
    fn progress_from_bits_takes_anything() {
        for bits in [[u64::MAX; 2], [f64::INFINITY.to_bits(), 3], [(-1.0f64).to_bits(), 3]] {
            assert_eq!(Progress::from_bits(bits), Progress::default());
        }
        let progress = Progress::from_bits([1.5f64.to_bits(), u64::MAX]);
        assert_eq!(progress.to_bits(), [1.5f64.to_bits(), u64::MAX]);
        assert!(!{ progress }.is_repair_due(u64::MAX, f64::NAN, false) || progress.num_frames == u16::MAX);
    }
}
