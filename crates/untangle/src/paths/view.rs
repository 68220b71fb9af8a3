//! Chains together with the mesh, frame and intersections that they refer to: where each copy runs and how it ends.

use nalgebra::Point3;

use super::{
    ChainEnd, SurfacePoint,
    contact::Contact,
    trace::{Chain, Chains},
};
use crate::{
    frame::Frame,
    intersect::{EdgeFaceIntersection, Intersections, SegmentEnd},
    mesh::{EdgeId, FaceId, Mesh, VertexId},
};

/// How a chain ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Ends {
    /// It does not end.
    Closed,
    /// In two loop vertices, or twice in one.
    LoopLoop(VertexId, VertexId),
    /// From a loop vertex to a boundary.
    LoopBoundary(VertexId, BoundaryEnd),
    /// From boundary to boundary.
    BoundaryBoundary([BoundaryEnd; 2]),
}

/// The end of a chain where an edge of the boundary pierces a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundaryEnd {
    /// The edge.
    pub(crate) edge: EdgeId,
    /// The copy that owns the edge and ends there.
    pub(crate) bounded: usize,
    /// Where the other copy ends on a boundary too, because both touch exactly.
    pub(crate) contact: Option<Contact>,
}

impl BoundaryEnd {
    pub(crate) fn ends_on_boundary(&self, copy: usize) -> bool {
        copy == self.bounded || self.contact.is_some()
    }
}

/// The chains of a frame, to be asked by index.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainView<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) found: &'a Intersections,
    pub(crate) chains: &'a Chains,
}

impl ChainView<'_> {
    pub(crate) fn chain(&self, chain: usize) -> &Chain {
        &self.chains.chains[chain]
    }

    pub(crate) fn num_segments(&self, chain: usize) -> usize {
        self.chain(chain).steps.len()
    }

    /// The face that a copy runs through in a step.
    pub(crate) fn face(&self, chain: usize, copy: usize, step: usize) -> FaceId {
        self.chains.steps[self.chain(chain).steps.start + step].faces[copy]
    }

    /// Chains with a loop vertex start at one: see [`Chains::trace`].
    pub(crate) fn ends(&self, chain: usize) -> Ends {
        if self.chain(chain).closed {
            return Ends::Closed;
        }
        let last = self.num_segments(chain);
        match (self.node(chain, 0), self.node(chain, last)) {
            (SegmentEnd::LoopVertex(first), SegmentEnd::LoopVertex(last)) => Ends::LoopLoop(first, last),
            (SegmentEnd::LoopVertex(vertex), SegmentEnd::EdgeFace(end)) => {
                Ends::LoopBoundary(vertex, self.boundary_end(chain, last, end))
            }
            (SegmentEnd::EdgeFace(end), SegmentEnd::LoopVertex(vertex)) => {
                Ends::LoopBoundary(vertex, self.boundary_end(chain, 0, end))
            }
            (SegmentEnd::EdgeFace(first), SegmentEnd::EdgeFace(end)) => {
                Ends::BoundaryBoundary([self.boundary_end(chain, 0, first), self.boundary_end(chain, last, end)])
            }
        }
    }

    fn boundary_end(&self, chain: usize, place: usize, index: u32) -> BoundaryEnd {
        let crossing = self.crossing(index);
        BoundaryEnd {
            edge: crossing.edge,
            bounded: usize::from(self.runs_in_face(chain, 0, place, crossing.face)),
            contact: Contact::at(self.mesh, self.frame, crossing),
        }
    }

    /// The place of a copy on the cloth at a node: the copy that runs through the pierced face is inside of it, the
    /// other one on the edge. Where boundaries touch exactly, both are on an edge or in a vertex.
    pub(crate) fn surface_point(&self, chain: usize, copy: usize, place: usize) -> SurfacePoint {
        match self.node(chain, place) {
            SegmentEnd::LoopVertex(vertex) => SurfacePoint::Vertex(vertex),
            SegmentEnd::EdgeFace(index) => {
                let crossing = self.crossing(index);
                if !self.runs_in_face(chain, copy, place, crossing.face) {
                    return SurfacePoint::Edge { edge: crossing.edge, parameter: crossing.edge_parameter };
                }
                let is_end = !self.chain(chain).closed && (place == 0 || place == self.num_segments(chain));
                let contact = if is_end { Contact::at(self.mesh, self.frame, crossing) } else { None };
                contact
                    .map_or(SurfacePoint::Face { face: crossing.face, barycentric: crossing.barycentric }, |contact| {
                        contact.on_face
                    })
            }
        }
    }

    fn runs_in_face(&self, chain: usize, copy: usize, place: usize, face: FaceId) -> bool {
        let step = place.min(self.num_segments(chain) - 1);
        self.face(chain, copy, step) == face
    }

    /// The edge-face intersection in which a chain ends, as ids that do not depend on the order of the faces.
    pub(crate) fn last_crossing(&self, chain: usize) -> (EdgeId, [VertexId; 3]) {
        match self.node(chain, self.num_segments(chain)) {
            SegmentEnd::LoopVertex(vertex) => (EdgeId(u32::MAX), [vertex; 3]),
            SegmentEnd::EdgeFace(index) => {
                let crossing = self.crossing(index);
                let mut corners = self.mesh.face(crossing.face);
                corners.sort_unstable();
                (crossing.edge, corners)
            }
        }
    }

    /// World position of a node.
    pub(crate) fn position(&self, chain: usize, place: usize) -> Point3<f64> {
        match self.node(chain, place) {
            SegmentEnd::LoopVertex(vertex) => self.frame.position(vertex),
            SegmentEnd::EdgeFace(index) => self.crossing(index).position,
        }
    }

    /// World length in metres.
    pub(crate) fn length_m(&self, chain: usize) -> f64 {
        (0..self.num_segments(chain))
            .map(|step| (self.position(chain, step + 1) - self.position(chain, step)).norm())
            .sum()
    }

    /// The first or the last end of an open chain, as reported.
    pub(crate) fn end(&self, chain: usize, last: bool) -> ChainEnd {
        let place = if last { self.num_segments(chain) } else { 0 };
        match self.node(chain, place) {
            SegmentEnd::LoopVertex(vertex) => ChainEnd::Loop { vertex: vertex.0 },
            SegmentEnd::EdgeFace(index) => {
                let crossing = self.crossing(index);
                let edge = self.mesh.edge(crossing.edge).map(|vertex| vertex.0);
                let face = crossing.face.0;
                if self.mesh.is_boundary_edge(crossing.edge) {
                    ChainEnd::Boundary { edge, face }
                } else {
                    ChainEnd::Junction { edge, face }
                }
            }
        }
    }

    fn node(&self, chain: usize, place: usize) -> SegmentEnd {
        self.chains.nodes[self.chain(chain).nodes.start + place]
    }

    fn crossing(&self, index: u32) -> &EdgeFaceIntersection {
        &self.found.edge_face[index as usize]
    }
}
