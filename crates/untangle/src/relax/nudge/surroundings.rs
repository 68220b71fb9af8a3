//! What the faces of a vertex, or of two neighbours, intersect, and the step that takes them out of that.

use std::collections::BTreeSet;

use nalgebra::Vector3;

use super::face_tree::{Extent, FaceTree};
use crate::{
    frame::Frame,
    geometry::mean_edge_length,
    intersect::do_intersect,
    mesh::{FaceId, Mesh, VertexId},
    relax::{constraints::ShapeLimits, relaxer::Relaxer, step::stored},
};

/// Lengths of steps, in mean edge lengths of the vertex.
const LENGTHS: [f64; 7] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0];
/// A little wider than those of the descent: few edges are concerned, and recovery follows.
const LIMITS: ShapeLimits = ShapeLimits { max_stretch: 1.6, min_area: 0.1 };
/// Pairs of faces by which directions are found, for each vertex.
const MAX_PAIRS: usize = 4;

/// A displacement of a vertex, or of two neighbours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// The same one twice where it steps alone.
    pub(super) vertices: [VertexId; 2],
    pub(super) displacement: Vector3<f64>,
    /// By how many fewer pairs of faces intersect.
    pub(super) gain: usize,
    pub(super) length_m: f64,
}

/// One vertex or two with their faces, and those that these can reach.
pub(super) struct Surroundings {
    vertices: [VertexId; 2],
    edge_m: f64,
    star: Vec<FaceId>,
    near: Vec<FaceId>,
}

impl Surroundings {
    pub(super) fn of(relaxer: &Relaxer<'_>, tree: &FaceTree, vertices: [VertexId; 2]) -> Self {
        let Relaxer { mesh, frame, .. } = relaxer;
        let star: BTreeSet<FaceId> = vertices.iter().flat_map(|&vertex| mesh.vertex_faces(vertex)).copied().collect();
        let edge_m = mean_edge_length(mesh, frame, star.iter().copied()).unwrap_or(0.0);
        let corners = star.iter().flat_map(|&face| mesh.face(face)).map(|corner| frame.position(corner));
        let near = tree.overlapping(&Extent::of(corners).widened(LENGTHS[LENGTHS.len() - 1] * edge_m));
        Self { vertices, edge_m, star: star.into_iter().collect(), near }
    }

    /// How many pairs of faces the vertices' own are part of.
    pub(super) fn num_pairs(&self, relaxer: &Relaxer<'_>) -> usize {
        self.pairs(relaxer.mesh, &relaxer.frame, usize::MAX).len()
    }

    /// The step that takes most of these pairs away, the shortest of equals. `moved` is a copy of the frame, and is one
    /// again afterwards.
    pub(super) fn best_step(&self, relaxer: &Relaxer<'_>, moved: &mut Frame) -> Option<Step> {
        let Relaxer { mesh, frame, .. } = relaxer;
        let before = self.pairs(mesh, frame, usize::MAX);
        let directions = directions(mesh, frame, &before);
        let mut best: Option<Step> = None;
        for length in LENGTHS {
            if best.is_some_and(|best| best.gain == before.len()) || (relaxer.should_stop)() {
                break;
            }
            for direction in &directions {
                let most = before.len() - best.map_or(0, |best| best.gain);
                let displacement = direction * (length * self.edge_m);
                if !self.make(relaxer, displacement, moved) {
                    continue;
                }
                let num_after = self.pairs(mesh, moved, most).len();
                if num_after < most {
                    let (gain, length_m) = (before.len() - num_after, length * self.edge_m);
                    best = Some(Step { vertices: self.vertices, displacement, gain, length_m });
                }
            }
        }
        for vertex in self.vertices {
            moved.put(vertex, frame.position(vertex));
        }
        best
    }

    /// Moves the vertices; false where the numbers or the limits don't allow it.
    fn make(&self, relaxer: &Relaxer<'_>, displacement: Vector3<f64>, moved: &mut Frame) -> bool {
        let Relaxer { mesh, frame, rest, settings, .. } = relaxer;
        let mut put = |vertex: VertexId| {
            let place = stored(frame.position(vertex) + displacement, settings.single_precision);
            moved.put(vertex, place).is_some()
        };
        if !self.vertices.into_iter().all(&mut put) {
            return false;
        }
        let (from, to) = (frame.positions(), moved.positions());
        !self.vertices.iter().any(|&vertex| LIMITS.are_violated(mesh, rest, from, to, vertex))
    }

    /// The pairs of faces that intersect, no more than `most`, of which one is a face of the vertices, which stands
    /// first.
    fn pairs(&self, mesh: &Mesh, frame: &Frame, most: usize) -> Vec<[FaceId; 2]> {
        let mut pairs = Vec::new();
        for &own in &self.star {
            let extent = Extent::of_face(mesh, frame, own);
            for &other in &self.near {
                let is_second = other <= own && self.star.binary_search(&other).is_ok();
                if !is_second
                    && extent.overlaps(&Extent::of_face(mesh, frame, other))
                    && do_intersect(mesh, frame, [own, other])
                {
                    pairs.push([own, other]);
                    if pairs.len() >= most {
                        return pairs;
                    }
                }
            }
        }
        pairs
    }
}

/// Directions in which vertices may leave what its faces intersect: across both faces of a pair, along their line, and
/// between these.
fn directions(mesh: &Mesh, frame: &Frame, pairs: &[[FaceId; 2]]) -> Vec<Vector3<f64>> {
    let normal = |face: FaceId| {
        let [a, b, c] = mesh.face(face).map(|corner| frame.position(corner));
        (b - a).cross(&(c - a)).try_normalize(0.0)
    };
    // The nearest pairs first: an order by names would be another one under other names.
    let middle = |face: FaceId| -> Vector3<f64> {
        mesh.face(face).iter().map(|&corner| frame.position(corner).coords / 3.0).sum()
    };
    let distance = |[own, other]: [FaceId; 2]| -> f64 { (middle(own) - middle(other)).norm() };
    let mut nearest = pairs.to_vec();
    nearest.sort_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    let mut directions = Vec::new();
    for &[own, other] in nearest.iter().take(MAX_PAIRS) {
        let (Some(own), Some(other)) = (normal(own), normal(other)) else { continue };
        let along = own.cross(&other).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        for weights in 0..27 {
            let [a, b, c] = [weights % 3, weights / 3 % 3, weights / 9].map(|weight| f64::from(weight) - 1.0);
            directions.extend((other * a + own * b + along * c).try_normalize(1e-6));
        }
    }
    directions
}
