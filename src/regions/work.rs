//! The side of a path that takes less work to bring back.
//!
//! The work of a correction is the sum over the vertices of area times squared distance from the target (Wicke, Lanker and Gross
//! 2006 ask for the smallest possible correction). Targets are known only later, and only for the side that was chosen; the distance from the
//! path stands in for them: on the path it is zero for both, and it grows with the depth of the penetration.

use std::collections::VecDeque;

use nalgebra::Point3;

use super::{finder::vertex_area, flood::Flood, side::Scene};
use crate::paths::{PathPoint, SurfacePoint};

/// The side with less work, after a fill that is complete on both sides; nothing where both take the same.
///
/// The nearest point of the path is handed on from vertex to vertex, outwards from the crossed edges. Cost: linear in the piece.
pub(crate) fn by_work(flood: &Flood, scene: &Scene<'_>, points: &[PathPoint]) -> Option<usize> {
    let mut nearest: Vec<Option<Point3<f64>>> = vec![None; scene.mesh.num_vertices()];
    let mut queue = VecDeque::new();
    for point in points {
        let SurfacePoint::Edge { edge, .. } = point.own else { continue };
        for end in scene.mesh.edge(edge).into_iter().filter(|&end| flood.side_of(end).is_some()) {
            let here = scene.frame.position(end);
            let slot = &mut nearest[end.index()];
            if slot.is_none() {
                queue.push_back(end);
            }
            if slot.is_none_or(|known| (point.position - here).norm() < (known - here).norm()) {
                *slot = Some(point.position);
            }
        }
    }
    let mut work = [0.0; 2];
    while let Some(vertex) = queue.pop_front() {
        let (Some(side), Some(from)) = (flood.side_of(vertex), nearest[vertex.index()]) else { continue };
        work[side] += vertex_area(scene, vertex) * (scene.frame.position(vertex) - from).norm_squared();
        for &edge in scene.mesh.vertex_edges(vertex) {
            let neighbour = scene.mesh.opposite_vertex(edge, vertex);
            if flood.side_of(neighbour) == Some(side) && nearest[neighbour.index()].is_none() {
                nearest[neighbour.index()] = Some(from);
                queue.push_back(neighbour);
            }
        }
    }
    if work[0] < work[1] {
        Some(0)
    } else if work[1] < work[0] {
        Some(1)
    } else {
        None
    }
}
