//! Facets in files, and as they are read: corners in one place become one vertex.

use std::collections::{HashMap, hash_map::Entry};

use crate::formats::polygon::{NO_UV, Polygons};

/// Bytes before the first facet.
pub(super) const HEADER: usize = 84;
/// Bytes of a facet: normal, three corners, and two bytes that some programs use for a colour.
pub(super) const FACET: usize = 50;

/// Where the numbers of a facet stand.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FacetOffsets {
    /// Byte offsets of the normal.
    pub(super) normal: [usize; 3],
    /// Byte offsets of each corner.
    pub(super) corners: [[usize; 3]; 3],
}

/// Vertices and faces of the facets read so far.
#[derive(Debug, Default)]
pub(super) struct Facets {
    /// One for each place, `num_vertices x 3`.
    pub(super) positions: Vec<[f64; 3]>,
    /// The facets whose corners are in three places.
    pub(super) polygons: Polygons,
    /// The vertex of each corner of each facet, `num_facets x 3`.
    pub(super) corners: Vec<[u32; 3]>,
    by_place: HashMap<[u64; 3], u32>,
}

/// The bits of a place; zeros of both signs are one.
pub(super) fn place_key(place: [f64; 3]) -> [u64; 3] {
    place.map(|coordinate| (coordinate + 0.0).to_bits())
}

impl Facets {
    pub(super) fn push(&mut self, places: [[f64; 3]; 3]) {
        let corners = places.map(|place| self.vertex(place));
        let [a, b, c] = corners;
        if a != b && b != c && c != a {
            corners.iter().for_each(|&corner| self.polygons.push_corner(corner, NO_UV));
            self.polygons.finish_polygon();
        }
        self.corners.push(corners);
    }

    fn vertex(&mut self, place: [f64; 3]) -> u32 {
        let key = place_key(place);
        let next = u32::try_from(self.positions.len()).unwrap_or(u32::MAX);
        match self.by_place.entry(key) {
            Entry::Occupied(entry) => *entry.get(),
            Entry::Vacant(entry) => {
                self.positions.push(place);
                *entry.insert(next)
            }
        }
    }
}

/// Three singles at a place of a facet.
pub(super) fn position(facet: &[u8], at: usize) -> [f64; 3] {
    [0, 4, 8].map(|offset| {
        let bytes = &facet[at + offset..at + offset + 4];
        f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    })
}
