//! Pairs of primitives.

use nalgebra::Vector3;

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    predicates::distance::{
        edge_distance_below, edge_edge_distance, edge_edge_weights, vertex_distance_below, vertex_face_distance,
        vertex_face_weights,
    },
};

/// Two primitives without a common vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Primitives {
    /// A vertex and a face of which it is no corner.
    VertexFace {
        /// The vertex.
        vertex: VertexId,
        /// The face.
        face: FaceId,
    },
    /// Two edges, the lower id first.
    EdgeEdge {
        /// The edges.
        edges: [EdgeId; 2],
    },
}

/// Two primitives and their distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProximityPair {
    /// The primitives.
    pub primitives: Primitives,
    /// Their distance in metres, rounded.
    pub distance_m: f64,
}

/// The closest points of two primitives, in floating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoints {
    /// The vertices of both primitives. Where there are fewer than three, the last one is repeated.
    pub vertices: [[VertexId; 3]; 2],
    /// Their weights; 0 for those that are repeated. Each three sum to 1.
    pub weights: [[f64; 3]; 2],
    /// From the second point to the first, in metres.
    pub offset: Vector3<f64>,
}

impl Primitives {
    pub(super) fn edges(first: EdgeId, second: EdgeId) -> Self {
        Self::EdgeEdge { edges: [first.min(second), first.max(second)] }
    }

    /// A number in the order of pairs, which is compared faster than they are.
    pub(super) fn rank(self) -> u128 {
        let (kind, first, second) = match self {
            Self::VertexFace { vertex, face } => (0, vertex.0, face.0),
            Self::EdgeEdge { edges: [first, second] } => (1, first.0, second.0),
        };
        kind << 64 | u128::from(first) << 32 | u128::from(second)
    }

    /// The vertices of both: one and three, or two and two.
    pub fn vertices(self, mesh: &Mesh) -> impl Iterator<Item = VertexId> + Clone + use<> {
        let [first, second] = self.corners(mesh);
        let num_first = if matches!(self, Self::VertexFace { .. }) { 1 } else { 2 };
        first.into_iter().take(num_first).chain(second.into_iter().take(4 - num_first))
    }

    fn corners(self, mesh: &Mesh) -> [[VertexId; 3]; 2] {
        match self {
            Self::VertexFace { vertex, face } => [[vertex; 3], mesh.face(face)],
            Self::EdgeEdge { edges } => edges.map(|edge| {
                let [a, b] = mesh.edge(edge);
                [a, b, b]
            }),
        }
    }

    /// Whether they are nearer to each other than a distance, exactly.
    #[must_use]
    pub fn are_nearer(self, mesh: &Mesh, frame: &Frame, distance_m: f64) -> bool {
        self.distance_below(mesh, frame, distance_m).is_some()
    }

    /// Their distance in metres, rounded, if they are nearer to each other than `below_m`, exactly.
    pub(super) fn distance_below(self, mesh: &Mesh, frame: &Frame, below_m: f64) -> Option<f64> {
        let at = |vertex| frame.position(vertex).into();
        match self {
            Self::VertexFace { vertex, face } => vertex_distance_below(at(vertex), mesh.face(face).map(at), below_m),
            Self::EdgeEdge { edges } => {
                let [first, second] = edges.map(|edge| mesh.edge(edge).map(at));
                edge_distance_below(first, second, below_m)
            }
        }
    }

    /// Their distance in metres, rounded.
    #[must_use]
    pub fn distance_m(self, mesh: &Mesh, frame: &Frame) -> f64 {
        let at = |vertex| frame.position(vertex).into();
        match self {
            Self::VertexFace { vertex, face } => vertex_face_distance(at(vertex), mesh.face(face).map(at)),
            Self::EdgeEdge { edges } => {
                let [first, second] = edges.map(|edge| mesh.edge(edge).map(at));
                edge_edge_distance(first, second)
            }
        }
    }
}

/// The closest points of two primitives.
#[must_use]
pub fn closest_points(mesh: &Mesh, frame: &Frame, primitives: Primitives) -> ClosestPoints {
    let at = |vertex: VertexId| frame.position(vertex).into();
    let vertices = primitives.corners(mesh);
    let weights = match primitives {
        Primitives::VertexFace { vertex, .. } => {
            [[1.0, 0.0, 0.0], vertex_face_weights(at(vertex), vertices[1].map(at))]
        }
        Primitives::EdgeEdge { edges } => {
            let [first, second] = edges.map(|edge| mesh.edge(edge).map(at));
            edge_edge_weights(first, second).map(|[a, b]| [a, b, 0.0])
        }
    };
    // Relative to one of the vertices, so that nothing is lost far from the origin.
    let origin = frame.position(vertices[0][0]);
    let mut offset = Vector3::zeros();
    for (side, sign) in [(0, 1.0), (1, -1.0)] {
        for (&vertex, weight) in vertices[side].iter().zip(weights[side]) {
            offset += (frame.position(vertex) - origin) * (sign * weight);
        }
    }
    ClosestPoints { vertices, weights, offset }
}
