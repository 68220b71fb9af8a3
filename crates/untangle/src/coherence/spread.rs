//! Corrections of a window of frames, averaged and faded.

use std::{cmp::Ordering, collections::BTreeMap};

use nalgebra::Vector3;

use super::{SparseField, fade::Fade};

/// What a vertex gets from frames on one side, that of the frame itself included.
#[derive(Clone, Copy, Debug, Default)]
struct Share {
    sum: Vector3<f64>,
    weight: f64,
    nearest: Option<u64>,
}

impl Share {
    fn add(&mut self, vector: &Vector3<f64>, weight: f64, distance: u64) {
        self.sum += vector * weight;
        self.weight += weight;
        self.nearest = Some(self.nearest.map_or(distance, |nearest| nearest.min(distance)));
    }

    fn average(&self) -> Vector3<f64> {
        if self.weight > 0.0 { self.sum / self.weight } else { Vector3::zeros() }
    }
}

/// The shares before, at and after a frame.
#[derive(Clone, Copy, Debug, Default)]
struct Shares {
    before: Share,
    own: Share,
    after: Share,
}

impl Shares {
    /// The average at a frame that is repaired; else that before and that after, each faded.
    fn correction(&self, fade: Fade) -> Vector3<f64> {
        let Self { before, own, after } = self;
        if own.nearest.is_some() {
            let sum = before.sum + own.sum + after.sum;
            return sum / (before.weight + own.weight + after.weight);
        }
        let [first, second] = fade.parts(before.nearest, after.nearest);
        before.average() * first + after.average() * second
    }
}

/// The correction of a frame, out of those of a window round it, its own among them: for each vertex the average of the
/// frames in which it is corrected, the nearest of which count most. In a frame in which it is not, the averages before
/// and after are faded by the distance to the nearest ones, or go over into each other where the gap is no longer than
/// the fade. All in directions of the material.
///
/// `window` gives frames with their corrections, ascending; those beyond the fade count for nothing.
#[must_use]
pub fn spread<'f>(frame: u64, window: impl IntoIterator<Item = (u64, &'f SparseField)>, fade: Fade) -> SparseField {
    let mut shares: BTreeMap<u32, Shares> = BTreeMap::new();
    for (other, field) in window {
        let distance = frame.abs_diff(other);
        if distance > fade.num_frames {
            continue;
        }
        let weight = fade.weight(distance);
        for (&vertex, vector) in field {
            let shares = shares.entry(vertex).or_default();
            let share = match other.cmp(&frame) {
                Ordering::Less => &mut shares.before,
                Ordering::Equal => &mut shares.own,
                Ordering::Greater => &mut shares.after,
            };
            share.add(vector, weight, distance);
        }
    }
    shares.into_iter().map(|(vertex, shares)| (vertex, shares.correction(fade))).collect()
}
