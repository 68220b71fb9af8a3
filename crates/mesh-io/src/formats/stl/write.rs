//! Writing STL back with other positions.

use std::{collections::HashSet, io::Write};

use crate::{
    error::WriteError,
    formats::{
        mesh_data::MeshData,
        stl::facet::{FACET, FacetOffsets, Facets, HEADER, place_key, position},
        text::{self, Edit, Tokens},
    },
};

/// An STL file as it was read.
#[derive(Clone, Debug)]
pub(crate) struct StlDocument {
    source: Vec<u8>,
    /// Where the numbers of each facet stand, in a text.
    offsets: Option<Vec<FacetOffsets>>,
    /// The vertex of each corner of each facet.
    corners: Vec<[u32; 3]>,
}

impl StlDocument {
    pub(super) fn new(source: Vec<u8>, offsets: Option<Vec<FacetOffsets>>, facets: Facets) -> (MeshData, Self) {
        let Facets { positions, polygons, corners, .. } = facets;
        (MeshData { positions, polygons, ..MeshData::default() }, Self { source, offsets, corners })
    }

    /// Whether the file is binary, which holds single precision.
    pub(crate) fn is_single_precision(&self) -> bool {
        self.offsets.is_none()
    }

    /// The line of a vertex, counted from 1, in a text: that of its first corner.
    pub(crate) fn line_of_vertex(&self, vertex: usize) -> Option<usize> {
        let offsets = self.offsets.as_ref()?;
        let corner = self.corners.as_flattened().iter().position(|&corner| corner as usize == vertex)?;
        Some(text::line_of(&self.source, offsets[corner / 3].corners[corner % 3][0]))
    }

    /// The positions that reading gives after [`write`](Self::write). What is beyond single precision, and a vertex in
    /// the place of another one, can't be stored.
    pub(crate) fn stored(&self, before: &[[f64; 3]], after: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, WriteError> {
        let refused = |vertex, reason: &str| WriteError::FixedCoordinates { vertex, reason: reason.to_owned() };
        let mut places = HashSet::new();
        let mut stored = after.to_vec();
        for (vertex, (before, stored)) in before.iter().zip(&mut stored).enumerate() {
            if self.is_single_precision() && has_moved(before, stored) {
                *stored = stored.map(|coordinate| f64::from(single(coordinate)));
                if stored.iter().any(|coordinate| !coordinate.is_finite()) {
                    return Err(refused(vertex, "it is beyond single precision"));
                }
            }
            if !places.insert(place_key(*stored)) {
                return Err(refused(vertex, "another vertex is in its place, and STL would make one of them"));
            }
        }
        Ok(stored)
    }

    /// Writes the file with other positions: only coordinates that changed, and the normals of facets that moved, are
    /// other bytes. A normal of three zeros, which leaves it to the reader, stays.
    pub(crate) fn write(&self, before: &[[f64; 3]], after: &[[f64; 3]], out: &mut dyn Write) -> Result<(), WriteError> {
        let after = &self.stored(before, after)?;
        let moved = |corners: &[u32; 3]| {
            corners.map(|vertex| {
                let vertex = vertex as usize;
                has_moved(&before[vertex], &after[vertex]).then_some(after[vertex])
            })
        };
        let normal = |corners: &[u32; 3]| normal(corners.map(|vertex| after[vertex as usize]));
        match &self.offsets {
            Some(offsets) => {
                let facets = self.corners.iter().zip(offsets);
                let edits =
                    facets.flat_map(|(corners, offsets)| self.text_edits(offsets, moved(corners), &|| normal(corners)));
                Ok(text::write_edited(&self.source, 0, edits, out)?)
            }
            None => {
                let mut bytes = self.source.clone();
                for (facet, corners) in bytes[HEADER..].chunks_exact_mut(FACET).zip(&self.corners) {
                    write_facet(facet, moved(corners), &|| normal(corners));
                }
                Ok(out.write_all(&bytes)?)
            }
        }
    }

    /// The edits of one facet of a text, in its order.
    fn text_edits(
        &self,
        offsets: &FacetOffsets,
        moved: [Option<[f64; 3]>; 3],
        normal: &dyn Fn() -> Option<[f64; 3]>,
    ) -> Vec<Edit> {
        let token =
            |start: usize| Tokens::new(&self.source, start, self.source.len()).next().map_or(&[][..], |at| at.1);
        let replaced = |starts: [usize; 3], values: [f64; 3]| {
            starts.into_iter().zip(values).map(move |(start, value)| {
                let mut text = Vec::new();
                text::write_number(value, &mut text).unwrap_or_else(|error| unreachable!("into memory: {error}"));
                Edit { start, length: token(start).len(), text }
            })
        };
        let mut edits = Vec::new();
        let has_normal = offsets.normal.iter().any(|&start| text::number(token(start)).is_some_and(is_nonzero));
        if moved.iter().any(Option::is_some)
            && has_normal
            && let Some(normal) = normal()
        {
            edits.extend(replaced(offsets.normal, normal));
        }
        for (starts, corner) in offsets.corners.into_iter().zip(moved) {
            edits.extend(corner.into_iter().flat_map(|corner| replaced(starts, corner)));
        }
        edits
    }
}

fn write_facet(facet: &mut [u8], moved: [Option<[f64; 3]>; 3], normal: &dyn Fn() -> Option<[f64; 3]>) {
    let mut write = |at: usize, values: [f64; 3]| {
        for (slot, value) in facet[at..at + 12].chunks_exact_mut(4).zip(values) {
            slot.copy_from_slice(&single(value).to_le_bytes());
        }
    };
    for (at, corner) in [12, 24, 36].into_iter().zip(moved) {
        if let Some(corner) = corner {
            write(at, corner);
        }
    }
    if moved.iter().any(Option::is_some)
        && position(facet, 0).into_iter().any(is_nonzero)
        && let Some(normal) = normal()
    {
        for (slot, value) in facet[..12].chunks_exact_mut(4).zip(normal) {
            slot.copy_from_slice(&single(value).to_le_bytes());
        }
    }
}

fn has_moved(before: &[f64; 3], after: &[f64; 3]) -> bool {
    before.map(f64::to_bits) != after.map(f64::to_bits)
}

fn is_nonzero(value: f64) -> bool {
    value.abs() > 0.0
}

/// The single nearest to a double.
#[expect(clippy::cast_possible_truncation, reason = "the file holds singles")]
fn single(value: f64) -> f32 {
    value as f32
}

/// The unit normal of a facet; nothing where it has no area.
fn normal([a, b, c]: [[f64; 3]; 3]) -> Option<[f64; 3]> {
    let [u, v] = [b, c].map(|end| [0, 1, 2].map(|axis| end[axis] - a[axis]));
    let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = cross.iter().map(|value| value * value).sum::<f64>().sqrt();
    let unit = cross.map(|value| value / length);
    unit.iter().all(|value| value.is_finite()).then_some(unit)
}
