//! From contacts of pairs of faces to numbered edge-face intersections and the segments between them.

use super::{
    exact::{Contact, Crossing, locate},
    intersections::{Intersections, Segment, SegmentEnd},
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// Assembles the answer, reusing its memory.
#[derive(Debug, Default)]
pub(super) struct Assembler {
    /// Each with a segment that ends there, and which end it is.
    crossings: Vec<(Crossing, usize, usize)>,
    /// Scratch of the check in debug builds.
    #[cfg(debug_assertions)]
    num_segments: Vec<usize>,
}

impl Assembler {
    /// Numbers the crossings, each of which belongs to all pairs around its edge, and refers the segments to them.
    ///
    /// `contacts` are sorted by their faces. Cost: O(k log k) for k contacts.
    pub(super) fn assemble(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        contacts: &[([FaceId; 2], Contact)],
        found: &mut Intersections,
    ) {
        self.crossings.clear();
        found.segments.clear();
        for &(faces, contact) in contacts {
            let segment = found.segments.len();
            // Their numbers follow.
            let mut ends = [SegmentEnd::EdgeFace(u32::MAX); 2];
            match contact {
                Contact::Crossings([a, b]) => self.crossings.extend([(a.min(b), segment, 0), (a.max(b), segment, 1)]),
                Contact::FromLoopVertex(crossing, vertex) => {
                    self.crossings.push((crossing, segment, 0));
                    ends[1] = SegmentEnd::LoopVertex(vertex);
                }
            }
            found.segments.push(Segment { faces, ends });
        }
        self.crossings.sort_unstable();
        found.edge_face.clear();
        for alike in self.crossings.chunk_by(|a, b| a.0 == b.0) {
            let number = u32::try_from(found.edge_face.len()).expect("fewer crossings than 2^32");
            found.edge_face.push(locate(mesh, frame, alike[0].0));
            for &(_, segment, end) in alike {
                found.segments[segment].ends[end] = SegmentEnd::EdgeFace(number);
            }
        }
        #[cfg(debug_assertions)]
        self.assert_every_crossing_joins_all_faces(mesh, found);
    }

    /// A crossing of an edge ends one segment for each face of the edge: with fewer a path would end in the middle of
    /// the cloth.
    #[cfg(debug_assertions)]
    fn assert_every_crossing_joins_all_faces(&mut self, mesh: &Mesh, found: &Intersections) {
        let num_segments = &mut self.num_segments;
        num_segments.clear();
        num_segments.resize(found.edge_face.len(), 0);
        for Segment { faces, ends } in &found.segments {
            let count = if ends[0] == ends[1] { 1 } else { 2 };
            for end in &ends[..count] {
                let SegmentEnd::EdgeFace(number) = *end else { continue };
                let face = found.edge_face[number as usize].face;
                num_segments[number as usize] += 1;
                assert!(faces.contains(&face), "a crossing of face {} between others", face.0);
            }
        }
        for (crossing, &mut count) in found.edge_face.iter().zip(num_segments) {
            let (edge, face) = (crossing.edge, crossing.face);
            let expected = mesh.edge_faces(edge).len();
            assert_eq!(count, expected, "segments that end where edge {} pierces face {}", edge.0, face.0);
        }
    }
}
