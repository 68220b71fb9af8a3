//! From a frame to its sorted intersections.

use rayon::prelude::*;

use super::{
    Intersections, Segment, SegmentEnd,
    broad::{FaceTree, NodePair},
    locate::locate,
    narrow::{Contact, Crossing, contact},
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// Subtrees into which the search is split, at least, where the tree has as many.
const NUM_SUBTREES: usize = 8;

/// Finds all intersections of a frame, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Intersector {
    tree: FaceTree,
    parts: Vec<NodePair>,
    /// Of each part, so that the parts can be searched side by side.
    contacts_of_part: Vec<Vec<([FaceId; 2], Contact)>>,
    contacts: Vec<([FaceId; 2], Contact)>,
    crossings: Vec<Crossing>,
}

impl Intersector {
    /// Finds all intersections of `frame`.
    ///
    /// The answer is complete and exact: the same as that of testing every edge against every face. It does not depend on the
    /// number of threads.
    ///
    /// # Panics
    /// If the signs contradict each other, which consistent perturbation rules out.
    ///
    /// Cost: O(n log n) for n faces of bounded overlap, plus O(k log k) for k intersecting pairs.
    pub fn intersect(&mut self, mesh: &Mesh, frame: &Frame, found: &mut Intersections) {
        self.tree.fit(mesh, frame);
        self.tree.parts(NUM_SUBTREES, &mut self.parts);
        if self.contacts_of_part.len() < self.parts.len() {
            self.contacts_of_part.resize_with(self.parts.len(), Vec::new);
        }
        let tree = &self.tree;
        self.parts.par_iter().zip(&mut self.contacts_of_part).for_each(|(&part, contacts)| {
            contacts.clear();
            tree.search(part, &mut |a, b| {
                if let Some(contact) = contact(mesh, frame, [a, b]) {
                    contacts.push((if a < b { [a, b] } else { [b, a] }, contact));
                }
            });
        });
        self.contacts.clear();
        for contacts in &self.contacts_of_part[..self.parts.len()] {
            self.contacts.extend_from_slice(contacts);
        }
        self.contacts.sort_unstable_by_key(|&(faces, _)| faces);
        self.assemble(mesh, frame, found);
    }

    /// Numbers the crossings, each of which belongs to all pairs round its edge, and refers the segments to them.
    fn assemble(&mut self, mesh: &Mesh, frame: &Frame, found: &mut Intersections) {
        self.crossings.clear();
        for (_, contact) in &self.contacts {
            match *contact {
                Contact::Crossings(crossings) => self.crossings.extend(crossings),
                Contact::FromLoopVertex(crossing, _) => self.crossings.push(crossing),
            }
        }
        self.crossings.sort_unstable();
        self.crossings.dedup();
        found.edge_face.clear();
        found.edge_face.extend(self.crossings.iter().map(|&crossing| locate(mesh, frame, crossing)));

        let crossings = &self.crossings;
        let end_at = |crossing: Crossing| {
            let index = crossings.binary_search(&crossing).expect("every crossing was collected above");
            SegmentEnd::EdgeFace(u32::try_from(index).expect("fewer crossings than 2^32"))
        };
        found.segments.clear();
        found.segments.extend(self.contacts.iter().map(|&(faces, contact)| {
            let ends = match contact {
                Contact::Crossings([a, b]) => [end_at(a.min(b)), end_at(a.max(b))],
                Contact::FromLoopVertex(crossing, vertex) => [end_at(crossing), SegmentEnd::LoopVertex(vertex)],
            };
            Segment { faces, ends }
        }));
    }
}
