//! A mesh prim: its points, polygons and texture coordinates.

use std::collections::BTreeSet;

use super::{
    compose::{Attribute, ComposedPrim, Stage},
    fault::UsdError,
    layers::value::Value,
};
use crate::formats::{
    mesh_data::MeshData,
    polygon::{NO_UV, Polygons},
};

/// What a mesh prim says, the same at all times but for its points.
#[derive(Clone, Debug)]
pub(super) struct MeshPrim {
    pub(super) points: Attribute,
    pub(super) num_vertices: usize,
    counts: Vec<i64>,
    corners: Vec<i64>,
    /// Faces that are no part of the surface.
    holes: BTreeSet<i64>,
    is_left_handed: bool,
    uvs: Option<Uvs>,
}

#[derive(Clone, Debug)]
struct Uvs {
    coordinates: Vec<[f64; 2]>,
    /// For each corner, or for each point; without, corner or point `k` has coordinate `k`.
    indices: Option<Vec<i64>>,
    is_of_corners: bool,
}

impl MeshPrim {
    pub(super) fn read(stage: &Stage, prim: &ComposedPrim) -> Result<Self, UsdError> {
        let error = |reason: String| stage.error(&prim.path, reason);
        let points = prim.attribute("points").ok_or_else(|| error("has no points".into()))?;
        if points.has_spline || !matches!(points.type_name.as_str(), "point3f[]" | "float3[]" | "vector3f[]") {
            return Err(error(format!(
                "has points of the type {}; point3f[], float3[] and vector3f[] are read",
                points.type_name
            )));
        }
        let first = match points.samples.first() {
            Some((_, slot)) => Some(stage.value(&points, slot)?),
            None => stage.default(&points)?,
        };
        let Some(Value::Singles(coordinates)) = first else { return Err(error("has no points".into())) };
        let needed = |name: &str| integers(stage, prim, name)?.ok_or_else(|| error(format!("has no {name}")));
        let orientation = prim.attribute("orientation").map(|attribute| stage.default(&attribute)).transpose()?;
        Ok(Self {
            points,
            num_vertices: coordinates.len() / 3,
            counts: needed("faceVertexCounts")?,
            corners: needed("faceVertexIndices")?,
            holes: integers(stage, prim, "holeIndices")?.unwrap_or_default().into_iter().collect(),
            is_left_handed: orientation.flatten().is_some_and(|value| value.as_text() == Some("leftHanded")),
            uvs: Uvs::read(stage, prim)?,
        })
    }

    /// Bytes that it takes at most.
    pub(super) fn num_bytes(&self) -> u64 {
        let num_uvs =
            self.uvs.as_ref().map_or(0, |uvs| uvs.coordinates.len() + uvs.indices.as_ref().map_or(0, Vec::len));
        (24 * self.num_vertices
            + 32 * self.points.samples.len()
            + 16 * (self.counts.len() + self.corners.len() + num_uvs)) as u64
    }

    /// Adds its polygons to those of other meshes, of whose vertices there are `first`.
    ///
    /// # Errors
    /// In words, with the face at fault.
    pub(super) fn append(&self, first: usize, data: &mut MeshData) -> Result<(), String> {
        let first_uv = data.uv_coordinates.len();
        let uvs = self.uvs.as_ref().filter(|uvs| uvs.fit(self.num_vertices, self.corners.len()));
        data.uv_coordinates.extend(uvs.into_iter().flat_map(|uvs| &uvs.coordinates));
        let mut start = 0usize;
        for (face, &count) in (0i64..).zip(&self.counts) {
            let end = usize::try_from(count).ok().and_then(|count| start.checked_add(count));
            let own = end.and_then(|end| self.corners.get(start..end));
            let own = own.ok_or_else(|| match count {
                ..0 => format!("face {face} (from 0) has {count} corners, at least 3 are needed"),
                _ => format!("has fewer corners than face {face} (from 0) needs"),
            })?;
            if !self.holes.contains(&face) {
                if own.len() < 3 {
                    return Err(format!("face {face} (from 0) has {count} corners, at least 3 are needed"));
                }
                let corner = |(index, vertex): (usize, &i64)| {
                    let vertex = usize::try_from(*vertex).ok().filter(|vertex| *vertex < self.num_vertices);
                    let uv = |vertex| uvs.and_then(|uvs| uvs.of(start + index, vertex)).map(|uv| first_uv + uv);
                    Some((index_of(first + vertex?)?, uv(vertex?).and_then(index_of).unwrap_or(NO_UV)))
                };
                let corners: Option<Vec<_>> = own.iter().enumerate().map(corner).collect();
                let corners = corners.ok_or_else(|| {
                    format!("face {face} (from 0) refers to points that are none: there are {}", self.num_vertices)
                })?;
                self.push(&corners, &mut data.polygons);
            }
            start += own.len();
        }
        let left = self.corners.len() - start;
        if left == 0 { Ok(()) } else { Err(format!("has {left} corners beyond its faces")) }
    }

    fn push(&self, corners: &[(u32, u32)], polygons: &mut Polygons) {
        let push = |&(vertex, uv): &(u32, u32)| polygons.push_corner(vertex, uv);
        if self.is_left_handed {
            corners.iter().rev().for_each(push);
        } else {
            corners.iter().for_each(push);
        }
        polygons.finish_polygon();
    }
}

fn index_of(index: usize) -> Option<u32> {
    u32::try_from(index).ok().filter(|index| *index != NO_UV)
}

/// An array of integers that is the same at all times.
fn integers(stage: &Stage, prim: &ComposedPrim, name: &str) -> Result<Option<Vec<i64>>, UsdError> {
    let Some(attribute) = prim.attribute(name) else { return Ok(None) };
    let mut first: Option<Value> = None;
    for (_, slot) in &attribute.samples {
        let value = stage.value(&attribute, slot)?;
        if first.get_or_insert_with(|| value.clone()) != &value {
            let reason = format!("has other {name} in other frames; the mesh must stay the same");
            return Err(stage.error(&prim.path, reason));
        }
    }
    match first.map_or_else(|| stage.default(&attribute), |value| Ok(Some(value)))? {
        Some(Value::Integers(values)) => Ok(Some(values)),
        _ => Ok(None),
    }
}

impl Uvs {
    /// The primvar `st`, if there is one that is understood.
    fn read(stage: &Stage, prim: &ComposedPrim) -> Result<Option<Self>, UsdError> {
        let Some(attribute) = prim.attribute("primvars:st") else { return Ok(None) };
        let is_of_corners = match attribute.interpolation.as_deref() {
            Some("faceVarying") => true,
            Some("vertex" | "varying") => false,
            _ => return Ok(None),
        };
        let value = match attribute.samples.first() {
            Some((_, slot)) => Some(stage.value(&attribute, slot)?),
            None => stage.default(&attribute)?,
        };
        let is_pairs = attribute.type_name.starts_with("texCoord2f") || attribute.type_name.starts_with("float2");
        let Some(Value::Singles(numbers)) = value.filter(|_| is_pairs) else { return Ok(None) };
        let indices = prim.attribute("primvars:st:indices").map(|_| integers(stage, prim, "primvars:st:indices"));
        let coordinates = numbers.as_chunks::<2>().0.iter().map(|pair| pair.map(f64::from)).collect();
        Ok(Some(Self { coordinates, indices: indices.transpose()?.flatten(), is_of_corners }))
    }

    /// Whether there is one for each point or corner, and all are finite.
    fn fit(&self, num_vertices: usize, num_corners: usize) -> bool {
        let count = self.indices.as_ref().map_or(self.coordinates.len(), Vec::len);
        let is_finite = self.coordinates.as_flattened().iter().all(|value| value.is_finite());
        is_finite && count == if self.is_of_corners { num_corners } else { num_vertices }
    }

    /// The coordinate of a corner at a vertex.
    fn of(&self, corner: usize, vertex: usize) -> Option<usize> {
        let at = if self.is_of_corners { corner } else { vertex };
        let index = self.indices.as_ref().map_or(Some(at), |indices| usize::try_from(*indices.get(at)?).ok());
        index.filter(|index| *index < self.coordinates.len())
    }
}
