//! Hubs: vertices of so many faces that the pairs around them are not listed.
//!
//! The boxes of all faces round a hub overlap in it. A traversal that looked at each pair would take the square of
//! their number, only to find that the two share a vertex. So they stand side by side in the order of the tree, and a
//! node knows the hub that all its faces share. Faces of bodies stand side by side for the same reason: pairs of nodes
//! that hold nothing else are passed over.

use std::ops::Range;

use super::{MAX_ADJACENT_FACES, aabb::WIDTH};
use crate::mesh::{FaceId, Mesh, VertexId};

/// The hub of a node whose faces share none.
const NONE: u32 = u32::MAX;
/// What stands in the place of a hub for faces of bodies: no pair of them is searched for either.
const BODY: u32 = u32::MAX - 1;

/// For each node the hub that all its faces share.
#[derive(Debug, Default)]
pub(super) struct Hubs {
    /// From the leaves up.
    levels: Vec<Vec<u32>>,
}

/// The first corner of a face that is a hub; [`BODY`] for all faces of bodies.
fn hub_of(mesh: &Mesh, face: FaceId) -> u32 {
    if mesh.is_body_face(face) {
        return BODY;
    }
    let is_hub = |vertex: &VertexId| mesh.vertex_faces(*vertex).len() > MAX_ADJACENT_FACES;
    mesh.face(face).into_iter().filter(is_hub).min().map_or(NONE, |hub| hub.0)
}

/// Puts faces of one hub side by side, then those of bodies, those of none at the end; the ranges of those that
/// belong together.
pub(super) fn group_by_hub(mesh: &Mesh, faces: &mut [FaceId]) -> Vec<Range<usize>> {
    if faces.iter().any(|&face| hub_of(mesh, face) != NONE) {
        faces.sort_by_cached_key(|&face| (hub_of(mesh, face), face));
    }
    let mut start = 0;
    let groups = faces.chunk_by(|&a, &b| hub_of(mesh, a) == hub_of(mesh, b));
    let ranges = groups.map(|group| {
        start += group.len();
        start - group.len()..start
    });
    ranges.collect()
}

impl Hubs {
    /// For faces in the order of the tree. Cost: linear in the faces.
    pub(super) fn new(mesh: &Mesh, order: &[FaceId]) -> Self {
        let of_faces: Vec<u32> = order.iter().map(|&face| hub_of(mesh, face)).collect();
        if of_faces.iter().all(|&hub| hub == NONE) {
            return Self::default();
        }
        let mut levels = vec![common(&of_faces)];
        while let Some(below) = levels.last().filter(|below| below.len() > 1) {
            levels.push(common(below));
        }
        Self { levels }
    }

    /// Whether all faces of two nodes of a level share one hub, or are faces of bodies.
    #[inline(always)]
    pub(super) fn is_common(&self, level: usize, a: u32, b: u32) -> bool {
        let hubs = &self.levels[level];
        hubs[a as usize] != NONE && hubs[a as usize] == hubs[b as usize]
    }

    /// Whether all faces of two nodes of a level are faces of bodies.
    #[inline(always)]
    pub(super) fn are_bodies(&self, level: usize, a: u32, b: u32) -> bool {
        self.levels.get(level).is_some_and(|hubs| hubs[a as usize] == BODY && hubs[b as usize] == BODY)
    }

    /// The nodes of a level all of whose faces are faces of bodies: they stand side by side.
    pub(super) fn bodies(&self, level: usize) -> Range<usize> {
        let hubs = self.levels.get(level).map_or(&[][..], Vec::as_slice);
        let first = hubs.iter().position(|&hub| hub == BODY).unwrap_or_default();
        first..first + hubs[first..].iter().take_while(|&&hub| hub == BODY).count()
    }
}

/// For each eight in a row what they have in common.
fn common(hubs: &[u32]) -> Vec<u32> {
    hubs.chunks(WIDTH).map(|row| if row.iter().all(|hub| *hub == row[0]) { row[0] } else { NONE }).collect()
}
