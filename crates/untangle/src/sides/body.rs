//! The sides of all bodies of a mesh at one instant.

use std::sync::OnceLock;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::{
    INSIDE, Numbered, WrongSide, direction,
    outwards::Outwards,
    surface::{Surface, SurfacePlace},
    winding::WindingTree,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
};

/// "Just beyond" the surface, as a part of the diagonal of the box round all bodies.
const BEYOND: f64 = 1e-7;
/// Surfaces that a ray on its way out passes at most.
const MAX_PASSED: usize = 64;
/// Where in a face it is looked at whether the face lies inside of another body, as weights of its corners.
const SAMPLES: [[f64; 3]; 4] = [[1.0 / 3.0; 3], [0.9, 0.05, 0.05], [0.05, 0.9, 0.05], [0.05, 0.05, 0.9]];

/// The way between a point and the surface of a body or of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// The face of the body, or of the inner layer.
    pub face: FaceId,
    /// The point on it, as weights of its corners.
    pub barycentric: [f64; 3],
    /// The distance to it in metres: how deep a point inside is.
    pub depth_m: f64,
    /// Unit vector outwards: for a point inside the direction of the way, for one outside its opposite.
    pub direction: Vector3<f64>,
}

/// All bodies of a mesh, at one instant: what is inside, and which way leads out.
#[derive(Debug)]
pub struct Sides {
    faces: Vec<Numbered>,
    triangles: Vec<[Point3<f64>; 3]>,
    winding: WindingTree,
    surface: Surface,
    low: Vector3<f64>,
    high: Vector3<f64>,
    beyond_m: f64,
    are_closed: bool,
    /// For each face whether a part of it bounds the inside; looked at where bodies overlap.
    bounds: OnceLock<Vec<bool>>,
}

impl Sides {
    /// The bodies of a mesh; nothing where there are none.
    ///
    /// Cost: O(n log n) in the faces of bodies, linear in the others.
    #[must_use]
    pub fn of(mesh: &Mesh, frame: &Frame) -> Option<Self> {
        if !mesh.has_body() {
            return None;
        }
        let Outwards { faces, triangles, are_closed } = Outwards::of(mesh, frame);
        let surface = Surface::new(&triangles)?;
        let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for corner in triangles.iter().flatten() {
            (low, high) = (low.inf(&corner.coords), high.sup(&corner.coords));
        }
        let winding = WindingTree::new(&triangles);
        let beyond_m = BEYOND * (high - low).norm();
        let bounds = OnceLock::new();
        Some(Self { faces, triangles, winding, surface, low, high, beyond_m, are_closed, bounds })
    }

    /// Whether all pieces of bodies are closed, so that only what passes their surface changes sides.
    #[must_use]
    pub fn are_closed(&self) -> bool {
        self.are_closed
    }

    /// Whether a point is inside of a body. On the surface it is outside.
    ///
    /// Cost: O(log n) in the faces of bodies; O(1) outside of the box round them.
    #[must_use]
    pub fn is_inside(&self, at: Point3<f64>) -> bool {
        let is_in_box = (0..3).all(|axis| at[axis] >= self.low[axis] && at[axis] <= self.high[axis]);
        is_in_box && self.winding.number(at) > INSIDE
    }

    /// The vertices of cloth that are inside of a body, ascending.
    ///
    /// Cost: that of [`is_inside`](Self::is_inside) for each vertex that a face uses, and a search of the closest point
    /// for each that is inside; in parallel.
    #[must_use]
    pub fn wrong_vertices(&self, mesh: &Mesh, frame: &Frame) -> Vec<WrongSide> {
        let cloth: Vec<VertexId> = cloth_vertices(mesh).collect();
        let wrong = cloth.par_iter().filter(|&&vertex| self.is_inside(frame.position(vertex)));
        wrong.map(|&vertex| WrongSide { vertex, way: self.way_out(frame.position(vertex)) }).collect()
    }

    /// The way to the closest point of the surface, from outside or inside.
    #[must_use]
    pub fn closest(&self, at: Point3<f64>, is_inside: bool) -> Way {
        let place = self.surface.closest(at, |_| true).expect("there is a face, and places are finite");
        self.way(at, &place, is_inside)
    }

    /// The way out for a point inside: to the closest point of the surface just beyond which it is outside.
    #[must_use]
    pub fn way_out(&self, at: Point3<f64>) -> Way {
        let nearest = self.closest(at, true);
        if self.leads_out(&nearest) {
            return nearest;
        }
        // Here bodies overlap.
        let bounds = self.bounds.get_or_init(|| self.find_bounds());
        let Some(place) = self.surface.closest(at, |triangle| bounds[triangle]) else { return nearest };
        let way = self.way(at, &place, true);
        if self.leads_out(&way) {
            return way;
        }
        // A face that lies inside in part: its ray goes on to where that ends.
        let mut from = place.point;
        for _ in 0..MAX_PASSED {
            from += way.direction * self.beyond_m;
            let Some(place) = self.surface.along(from, way.direction) else { break };
            let found = Way { direction: way.direction, ..self.way(at, &place, true) };
            if self.leads_out(&found) {
                return found;
            }
            from = place.point;
        }
        way
    }

    /// Whether it is outside just beyond the end of a way.
    fn leads_out(&self, way: &Way) -> bool {
        let number = self.faces.binary_search_by_key(&way.face, |numbered| numbered.face);
        let Ok(number) = number else { return false };
        let Numbered { is_turned, .. } = self.faces[number];
        let [a, b, c] = self.triangles[number];
        let corners = if is_turned { [a, c, b] } else { [a, b, c] };
        let end = point_of(&corners, way.barycentric);
        !self.is_inside(end + way.direction * self.beyond_m)
    }

    fn way(&self, at: Point3<f64>, place: &SurfacePlace, is_inside: bool) -> Way {
        let Numbered { face, is_turned } = self.faces[place.triangle];
        let [a, b, c] = self.triangles[place.triangle];
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        let to_surface = place.point - at;
        let [u, v, w] = place.barycentric;
        Way {
            face,
            barycentric: if is_turned { [u, w, v] } else { [u, v, w] },
            depth_m: to_surface.norm(),
            direction: direction(if is_inside { to_surface } else { -to_surface }, self.beyond_m, normal),
        }
    }

    /// For each face whether it is outside just beyond some point of it.
    fn find_bounds(&self) -> Vec<bool> {
        let is_bound = |[a, b, c]: &[Point3<f64>; 3]| {
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            SAMPLES.iter().any(|&weights| !self.is_inside(point_of(&[*a, *b, *c], weights) + normal * self.beyond_m))
        };
        self.triangles.par_iter().map(is_bound).collect()
    }
}

/// Vertices of faces that belong to no body, ascending.
pub(crate) fn cloth_vertices(mesh: &Mesh) -> impl Iterator<Item = VertexId> + '_ {
    mesh.vertex_ids().filter(|&vertex| !mesh.is_body(vertex) && !mesh.vertex_faces(vertex).is_empty())
}

fn point_of([a, b, c]: &[Point3<f64>; 3], [u, v, w]: [f64; 3]) -> Point3<f64> {
    Point3::from(a.coords * u + b.coords * v + c.coords * w)
}
