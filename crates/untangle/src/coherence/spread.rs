//! Corrections of a window of frames, averaged and faded.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::{SparseField, fade::Fade};

/// What a vertex gets from the frames of a window.
#[derive(Clone, Copy, Debug, Default)]
struct Share {
    sum: Vector3<f64>,
    weight: f64,
    last: Option<u64>,
    next: Option<u64>,
}

/// The correction of a frame, out of those of a window round it, its own among them: for each vertex the average of
/// the frames in which it is corrected, the nearest of which count most, and faded by the distance to the nearest
/// ones. All in directions of the material.
///
/// `window` gives frames with their corrections, ascending; those beyond the fade count for nothing.
#[must_use]
pub fn spread<'f>(frame: u64, window: impl IntoIterator<Item = (u64, &'f SparseField)>, fade: Fade) -> SparseField {
    let mut shares: BTreeMap<u32, Share> = BTreeMap::new();
    for (other, field) in window {
        let distance = frame.abs_diff(other);
        if distance > fade.num_frames {
            continue;
        }
        let weight = fade.weight(distance);
        for (&vertex, vector) in field {
            let share = shares.entry(vertex).or_default();
            share.sum += vector * weight;
            share.weight += weight;
            if other <= frame {
                share.last = Some(distance);
            }
            if other >= frame {
                share.next = share.next.or(Some(distance));
            }
        }
    }
    let of_share = |Share { sum, weight, last, next }: Share| sum * (fade.part_between(last, next) / weight);
    shares.into_iter().map(|(vertex, share)| (vertex, of_share(share))).collect()
}
