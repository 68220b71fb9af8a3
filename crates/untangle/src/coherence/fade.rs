//! Weights in time.

/// How corrections grow in and fade out: over a window of frames, as the movement of least jerk does (Flash and Hogan
/// 1985), with neither speed nor acceleration at both ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fade {
    /// Frames beside a repaired one that get a part of its correction; the frame after them gets none.
    pub num_frames: u64,
}

/// The largest acceleration of the movement of least jerk over a unit of length in a unit of time: `10 / sqrt(3)`.
const LARGEST_ACCELERATION: f64 = 5.773_502_691_896_258;
/// The power of the weights in an average: the larger, the nearer the frames that count.
const SHARPNESS: i32 = 6;

impl Fade {
    /// The part of a correction that is left so many frames away: 1 at its own, 0 beyond the window.
    #[must_use]
    pub fn part(self, distance: u64) -> f64 {
        let at = self.place(distance);
        1.0 - at * at * at * (10.0 - 15.0 * at + 6.0 * at * at)
    }

    /// The parts of the corrections before and after a frame that is not repaired, the last and the next one of them so
    /// many frames away where there are such. In gaps no longer than the window they add up to 1: one goes over into
    /// the other.
    pub(super) fn parts(self, last: Option<u64>, next: Option<u64>) -> [f64; 2] {
        let part = |distance: Option<u64>| distance.map_or(0.0, |distance| self.part(distance));
        match (last, next) {
            (Some(last), Some(next)) if last + next <= self.num_frames => {
                let gap = Self { num_frames: last + next - 1 };
                [gap.part(last), gap.part(next)]
            }
            _ => [part(last), part(next)],
        }
    }

    /// The weight of a correction in the average of a frame so many frames away.
    pub(super) fn weight(self, distance: u64) -> f64 {
        let at = self.place(distance);
        (1.0 - at * at).powi(SHARPNESS)
    }

    /// The largest second difference that a correction of this height needs to grow in or to fade out, in metres for
    /// each frame squared.
    #[must_use]
    pub fn smooth_second_difference(self, height_m: f64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "numbers of frames")]
        let length = (self.num_frames + 1) as f64;
        LARGEST_ACCELERATION * height_m / (length * length)
    }

    /// The place within the window, from 0 to 1.
    fn place(self, distance: u64) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "numbers of frames")]
        let place = distance as f64 / (self.num_frames + 1) as f64;
        place.min(1.0)
    }
}
