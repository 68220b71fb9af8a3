//! Polygons of a file, in one flat list of corners.

use super::triangulate::clip_ears;

/// The index of a corner without texture coordinates.
pub(crate) const NO_UV: u32 = u32::MAX;

/// The faces of a file in its order, each with three or more corners.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polygons {
    ends: Vec<usize>,
    corners: Vec<u32>,
    /// For each corner its texture coordinate or [`NO_UV`].
    uv_corners: Vec<u32>,
    /// Corners without texture coordinates; counted, since each polygon asks.
    num_without_uv: usize,
}

impl Polygons {
    /// Number of polygons.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The vertices of one polygon, in order.
    #[must_use]
    pub fn corners(&self, polygon: usize) -> &[u32] {
        &self.corners[self.range(polygon)]
    }

    /// The texture coordinates of one polygon, one for each corner; `None` unless all corners of all polygons have
    /// them.
    #[must_use]
    pub fn uv_corners(&self, polygon: usize) -> Option<&[u32]> {
        self.has_uvs().then(|| &self.uv_corners[self.range(polygon)])
    }

    /// The texture coordinates of one polygon, [`NO_UV`] where a corner has none.
    pub(crate) fn raw_uv_corners(&self, polygon: usize) -> &[u32] {
        &self.uv_corners[self.range(polygon)]
    }

    fn has_uvs(&self) -> bool {
        !self.uv_corners.is_empty() && self.num_without_uv == 0
    }

    fn range(&self, polygon: usize) -> std::ops::Range<usize> {
        let start = if polygon == 0 { 0 } else { self.ends[polygon - 1] };
        start..self.ends[polygon]
    }

    /// Number of triangles before those of a polygon; of all triangles for the number of polygons.
    pub(crate) fn first_triangle(&self, polygon: usize) -> usize {
        let num_corners = polygon.checked_sub(1).map_or(0, |last| self.ends[last]);
        num_corners - 2 * polygon
    }

    /// Adds a corner to the polygon that is being built; `uv` is [`NO_UV`] for a corner without texture coordinates.
    pub(crate) fn push_corner(&mut self, vertex: u32, uv: u32) {
        self.corners.push(vertex);
        self.uv_corners.push(uv);
        self.num_without_uv += usize::from(uv == NO_UV);
    }

    /// Gives every corner the texture coordinate with the index of its vertex.
    pub(crate) fn use_vertices_as_uvs(&mut self) {
        self.uv_corners.clone_from(&self.corners);
        self.num_without_uv = 0;
    }

    /// Ends the polygon that is being built and returns its number of corners.
    pub(crate) fn finish_polygon(&mut self) -> usize {
        let start = self.ends.last().copied().unwrap_or(0);
        self.ends.push(self.corners.len());
        self.corners.len() - start
    }

    /// All triangles, polygon by polygon, as vertex indices and, where all corners have them, texture coordinate
    /// indices, both `num_faces x 3`.
    ///
    /// A polygon of `n` corners gives `n - 2` triangles of its orientation; [`clip_ears`] says which.
    pub(crate) fn triangulate(&self, positions: &[[f64; 3]]) -> (Vec<[u32; 3]>, Option<Vec<[u32; 3]>>) {
        let mut slots = Vec::with_capacity(self.corners.len());
        for polygon in 0..self.len() {
            let range = self.range(polygon);
            let corners = &self.corners[range.clone()];
            if corners.len() == 3 {
                slots.push([range.start, range.start + 1, range.start + 2]);
            } else {
                let points: Vec<[f64; 3]> = corners.iter().map(|&corner| positions[corner as usize]).collect();
                clip_ears(&points, |triangle| slots.push(triangle.map(|corner| range.start + corner)));
            }
        }
        let faces = slots.iter().map(|slots| slots.map(|slot| self.corners[slot])).collect();
        let uvs = self.has_uvs().then(|| slots.iter().map(|slots| slots.map(|slot| self.uv_corners[slot])).collect());
        (faces, uvs)
    }
}
