//! Intersection paths as lines in the world.

use std::collections::HashSet;

use serde::Serialize;

use untangle::{mesh::FaceId, paths::IntersectionPaths};

use super::numbers::{index, singles, whole};

/// The lines of all pairs. A segment of a chain is drawn once, though both copies of the pair run through it, or one
/// copy runs through it there and back.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct LineData {
    /// `num_points x 3`, singles, relative to the centre of the page, in metres.
    points: String,
    /// `num_lines x 3`, whole: the pair, the first point, the number of points.
    lines: String,
}

impl LineData {
    pub(super) fn new(paths: &IntersectionPaths, centre: [f64; 3]) -> Self {
        let (mut points, mut lines): (Vec<[f64; 3]>, Vec<[u32; 3]>) = Default::default();
        for (number, pair) in paths.pairs.iter().enumerate() {
            let mut drawn: HashSet<[FaceId; 2]> = HashSet::new();
            for copy in &paths.copies[pair.copies.clone()] {
                let own = &paths.points[copy.points.clone()];
                let mut is_open = false;
                for (segment, ends) in paths.segments[copy.segments.clone()].iter().zip(own.windows(2)) {
                    let faces = [segment.own.min(segment.partner), segment.own.max(segment.partner)];
                    if !drawn.insert(faces) {
                        is_open = false;
                        continue;
                    }
                    if !is_open {
                        lines.push([index(number), index(points.len()), 1]);
                        points.push(ends[0].position.into());
                    }
                    is_open = true;
                    points.push(ends[1].position.into());
                    if let Some([.., count]) = lines.last_mut() {
                        *count += 1;
                    }
                }
            }
        }
        Self { points: singles(relative(&points, centre)), lines: whole(lines.into_iter().flatten()) }
    }
}

/// Coordinates relative to a centre, so that single precision suffices far from the origin.
pub(super) fn relative(positions: &[[f64; 3]], centre: [f64; 3]) -> impl Iterator<Item = f64> {
    positions.iter().flat_map(move |position| [0, 1, 2].map(|axis| position[axis] - centre[axis]))
}
