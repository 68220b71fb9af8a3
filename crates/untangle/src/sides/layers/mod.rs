//! Layers of cloth in order: which vertices are behind a layer that lies further in.
//!
//! A vertex is behind an inner layer if the closest point of that layer lies within reach and in its interior, and the
//! vertex on its inner side. Where the closest point is on the boundary the vertex lies beyond the layer, not over it:
//! a collar above a collar, a trouser leg below a hem. Outwards is away from the bodies, where there are any; else it
//! is where a piece winds less round a point: a shirt that is open at its hems still winds round what is in it. A flat
//! sheet says by its faces what is outwards: a dent in it winds round something too, on whichever side it is.
//!
//! What is outwards is decided once, from the input or from rest positions, and goes on with the mesh
//! ([`Layers::decide`]): a repair bends sheets, and a state of it must not turn round what the input said.
//!
//! | file | purpose |
//! |---|---|
//! | `outwards` | what is outwards of a piece |
//! | `normals` | outward normals at points of a surface |
//! | `order` | the order of pieces of which nobody says it: as most of each lies |

mod normals;
mod order;
mod outwards;

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::{Sides, Way, WrongSide, body::cloth_vertices, direction, surface::Surface};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
};
use normals::OutwardNormals;
pub use order::ImpliedLayers;
use outwards::outwards;

/// Layers lie over each other within this part of the diagonal of the box round the inner one.
const REACH: f64 = 0.1;
/// Cloth that is no thicker than this part of its extent lies in one plane.
const PLANE: f64 = 1e-6;
/// Coinciding points, as a part of the diagonal.
const TINY: f64 = 1e-10;

/// Layers of cloth, and which way is outwards.
#[derive(Debug)]
pub struct Layers {
    /// By number, ascending.
    layers: Vec<Layer>,
    /// For each face whether its normal points outwards.
    outwards: Vec<bool>,
}

#[derive(Debug)]
struct Layer {
    number: u32,
    faces: Vec<FaceId>,
    reach_m: f64,
}

impl Layers {
    /// The layers of a mesh; nothing where there are less than two. `frame` is the state by which outwards is told, if
    /// the mesh does not say it ([`Mesh::outwards`]).
    ///
    /// Cost: linear in the faces, and for each piece of which it is not known what is outwards 256 winding numbers or
    /// closest points of bodies.
    #[must_use]
    pub fn of(mesh: &Mesh, frame: &Frame, bodies: Option<&Sides>) -> Option<Self> {
        let numbers = mesh.layers()?;
        let mut faces: BTreeMap<u32, Vec<FaceId>> = BTreeMap::new();
        let is_cloth = |face: &FaceId| mesh.piece(*face).is_some() && !mesh.is_body_face(*face);
        for face in mesh.face_ids().filter(is_cloth) {
            faces.entry(numbers[mesh.face(face)[0].index()]).or_default().push(face);
        }
        if faces.len() < 2 {
            return None;
        }
        let layer = |(number, faces): (u32, Vec<FaceId>)| {
            let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
            for place in faces.iter().flat_map(|&face| mesh.face(face)).map(|vertex| frame.position(vertex).coords) {
                (low, high) = (low.inf(&place), high.sup(&place));
            }
            Layer { number, faces, reach_m: REACH * (high - low).norm() }
        };
        let layers = faces.into_iter().map(layer).collect();
        let outwards = mesh.outwards().map_or_else(|| outwards(mesh, frame, bodies), <[bool]>::to_vec);
        Some(Self { layers, outwards })
    }

    /// The mesh, with what is outwards decided by a state, for all states that follow from it: rounds of a repair, what
    /// is read back, frames of a shot. A mesh without layers, and one of which it is decided, stays as it is.
    ///
    /// Cost: that of [`Layers::of`], and one of the sides of bodies.
    #[must_use]
    pub fn decide(mesh: Mesh, frame: &Frame) -> Mesh {
        if mesh.layers().is_none() || mesh.outwards().is_some() {
            return mesh;
        }
        let layers = Self::of(&mesh, frame, Sides::of(&mesh, frame).as_ref());
        let outwards = layers.map(|layers| layers.outwards);
        mesh.with_outwards(outwards.as_deref())
    }

    /// The mesh, with what is outwards decided by its rest positions, for all frames of a session. A mesh without them
    /// stays as it is, and so does one whose cloth they lay out in one plane: a pattern does not say how it is worn.
    ///
    /// Cost: that of [`Layers::decide`].
    #[must_use]
    pub fn decide_at_rest(mesh: Mesh) -> Mesh {
        let rest = mesh.rest_positions().filter(|_| mesh.layers().is_some());
        match rest.and_then(|rest| Frame::new(&mesh, rest).ok()).filter(|rest| !is_laid_out(&mesh, rest)) {
            Some(rest) => Self::decide(mesh, &rest),
            None => mesh,
        }
    }

    /// The vertices of cloth that are behind an inner layer, ascending, each once: behind the layer that it is deepest
    /// behind. The way leads to the closest point of that layer.
    ///
    /// Cost: O(n log n) in the faces, in parallel.
    #[must_use]
    pub fn behind(&self, mesh: &Mesh, positions: &[Point3<f64>]) -> Vec<WrongSide> {
        let state = LayerState::of(self, mesh, positions);
        let vertices: Vec<VertexId> = cloth_vertices(mesh).collect();
        let behind = |&vertex: &VertexId| {
            state.behind(positions[vertex.index()], state.number_of(vertex)).map(|way| WrongSide { vertex, way })
        };
        vertices.par_iter().filter_map(behind).collect()
    }
}

/// Layers at one instant.
#[derive(Debug)]
pub(crate) struct LayerState<'a> {
    layers: &'a Layers,
    mesh: &'a Mesh,
    positions: &'a [Point3<f64>],
    /// Of all layers but the outermost.
    surfaces: Vec<Option<Surface>>,
}

impl<'a> LayerState<'a> {
    pub(crate) fn of(layers: &'a Layers, mesh: &'a Mesh, positions: &'a [Point3<f64>]) -> Self {
        let place = |&face: &FaceId| mesh.face(face).map(|vertex| positions[vertex.index()]);
        let inner = &layers.layers[..layers.layers.len() - 1];
        let surface = |layer: &Layer| Surface::new(&layer.faces.iter().map(place).collect::<Vec<_>>());
        Self { layers, mesh, positions, surfaces: inner.par_iter().map(surface).collect() }
    }

    /// The number of a vertex' layer.
    pub(crate) fn number_of(&self, vertex: VertexId) -> u32 {
        self.mesh.layers().map_or(0, |numbers| numbers[vertex.index()])
    }

    /// The way to the layer further in that a point of a layer is deepest behind, if there is one.
    pub(crate) fn behind(&self, at: Point3<f64>, number: u32) -> Option<Way> {
        let ways = self.over(at, number).filter(|(_, is_behind)| *is_behind).map(|(way, _)| way);
        ways.max_by(|a, b| a.depth_m.total_cmp(&b.depth_m))
    }

    /// The ways to all layers further in that a point of a layer lies over, and whether it is behind them.
    pub(crate) fn over(&self, at: Point3<f64>, number: u32) -> impl Iterator<Item = (Way, bool)> + '_ {
        let normals = OutwardNormals { mesh: self.mesh, positions: self.positions, outwards: &self.layers.outwards };
        let inner = self.layers.layers.iter().zip(&self.surfaces).take_while(move |(layer, _)| layer.number < number);
        inner.filter_map(move |(layer, surface)| {
            let place = surface.as_ref()?.closest(at, |_| true)?;
            let to_surface = place.point - at;
            let depth_m = to_surface.norm();
            let face = layer.faces[place.triangle];
            let normal = (depth_m <= layer.reach_m).then(|| normals.normal(face, place.barycentric)).flatten()?;
            let is_behind = to_surface.dot(&normal) > 0.0;
            let outwards = if is_behind { to_surface } else { -to_surface };
            let direction = direction(outwards, TINY * layer.reach_m / REACH, normal);
            Some((Way { face, barycentric: place.barycentric, depth_m, direction }, is_behind))
        })
    }
}

/// Whether all cloth lies in one plane.
fn is_laid_out(mesh: &Mesh, frame: &Frame) -> bool {
    let place = |vertex: VertexId| frame.position(vertex).coords;
    let cloth = mesh.face_ids().filter(|&face| !mesh.is_body_face(face)).map(|face| mesh.face(face).map(place));
    let areas = cloth.clone().map(|[a, b, c]| (a, (b - a).cross(&(c - a))));
    let Some((origin, area)) = areas.max_by(|a, b| a.1.norm().total_cmp(&b.1.norm())) else { return true };
    let Some(normal) = area.try_normalize(0.0) else { return true };
    let (mut thickness, mut extent) = (0.0_f64, 0.0_f64);
    for from_origin in cloth.flatten().map(|at| at - origin) {
        thickness = thickness.max(from_origin.dot(&normal).abs());
        extent = extent.max(from_origin.norm());
    }
    thickness <= PLANE * extent
}
