//! Whether the insides of two corresponding paths lie on the same side of the path in space.

use nalgebra::Vector3;

use super::{InsideRegions, view::FrameView};
use crate::{
    mesh::{FaceId, VertexId},
    paths::PathSegment,
};

/// The mean, over the length of a pair of paths, of the dot product of two unit vectors: on each of both sheets the one
/// that lies in the sheet at right angles to the path and points into the inside.
///
/// It is 1 where the sheets lie upon each other with the insides on the same side, -1 where the insides are on opposite
/// sides, 0 where the sheets cross at a right angle or where one of them has no inside.
pub(crate) fn agreement(view: &FrameView<'_>, copy: usize, regions: &InsideRegions) -> f64 {
    let path = &view.paths.copies[copy];
    let insides = [copy, path.partner].map(|copy| regions.vertices_of(copy));
    if insides.iter().any(|inside| inside.is_empty()) {
        return 0.0;
    }
    let (mut sum, mut length) = (0.0, 0.0);
    for (pair, &PathSegment { own, partner }) in view.points_of(path).windows(2).zip(view.segments_of(path)) {
        let step = pair[1].position - pair[0].position;
        let middle = nalgebra::center(&pair[0].position, &pair[1].position);
        length += step.norm();
        let inward_conormal = |face: FaceId, inside: &[VertexId]| {
            let [a, b, c] = view.mesh.face(face).map(|corner| view.frame.position(corner));
            let across = (b - a).cross(&(c - a)).cross(&step).try_normalize(0.0)?;
            let mut side = 0.0;
            for corner in view.mesh.face(face) {
                let reach = (view.frame.position(corner) - middle).dot(&across);
                side += if inside.binary_search(&corner).is_ok() { reach } else { -reach };
            }
            Some::<Vector3<f64>>(if side < 0.0 { -across } else { across })
        };
        if let (Some(one), Some(other)) = (inward_conormal(own, insides[0]), inward_conormal(partner, insides[1])) {
            sum += step.norm() * one.dot(&other);
        }
    }
    if length > 0.0 { sum / length } else { 0.0 }
}
