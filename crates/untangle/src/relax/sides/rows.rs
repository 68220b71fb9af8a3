//! Constraints along the distance fields of bodies and inner layers: to the right side of them, and not to the wrong
//! one.

use std::collections::BTreeSet;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::tracker::{SideTracker, Wrong};
use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    intersect::{EdgeFaceIntersection, Intersections},
    mesh::{FaceId, Mesh, VertexId},
    relax::{constraints::Constraints, energy::Domain},
    sides::{LayerState, Way},
};

/// Depths up to this many edge lengths are left in one step, and of larger ones a part.
const SHORT: f64 = 2.0;
const PART: f64 = 0.5;
/// Vertices nearer than this many edge lengths are kept on their side.
const NEAR: f64 = 2.0;
/// Places in a face that crosses a body or an inner layer, beside its corners, as weights.
const SAMPLES: [[f64; 3]; 7] = [
    [1.0 / 3.0; 3],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
    [0.7, 0.15, 0.15],
    [0.15, 0.7, 0.15],
    [0.15, 0.15, 0.7],
];

/// A point of the cloth that has to get to the right side of a body or layer, or to stay there.
#[derive(Clone, Copy, Debug)]
struct SidePoint {
    own: MaterialPoint,
    /// The point of a layer, which moves as well.
    partner: Option<MaterialPoint>,
    /// Unit vector outwards.
    direction: Vector3<f64>,
    /// How far it is on the wrong side, in metres; negative on the right one.
    depth_m: f64,
    edge_m: f64,
}

impl SidePoint {
    /// A point with its way to the right side, or with the way from the surface, `sign` -1, where it is there.
    fn new(mesh: &Mesh, own: MaterialPoint, way: &Way, sign: f64, edge_m: f64) -> Self {
        let partner = MaterialPoint { vertices: mesh.face(way.face), weights: way.barycentric };
        let partner = (!mesh.is_body_face(way.face)).then_some(partner);
        Self { own, partner, direction: way.direction, depth_m: sign * way.depth_m, edge_m }
    }
}

/// The points of one state.
#[derive(Debug, Default)]
pub(crate) struct SideRows {
    /// Those on the wrong side.
    out: Vec<SidePoint>,
    /// Those on the right side that are near.
    near: Vec<SidePoint>,
}

impl SideRows {
    /// Finds the points on the wrong side: vertices, places in faces that cross a body or an inner layer, and where
    /// these intersect.
    pub(crate) fn find(&mut self, tracker: &SideTracker, mesh: &Mesh, frame: &Frame, found: &Intersections) {
        self.near.clear();
        self.out.clear();
        let wrong = tracker.wrong(mesh, frame.positions()).into_iter();
        self.out.extend(wrong.map(|Wrong { vertex, way, edge_m }| {
            SidePoint::new(mesh, MaterialPoint::vertex(vertex), &way, 1.0, edge_m)
        }));
        let view = View { tracker, mesh, frame, layers: tracker.layer_state(mesh, frame.positions()) };
        let outer = found.segments.iter().filter_map(|segment| view.outer(segment.faces));
        let faces: Vec<FaceId> = outer.collect::<BTreeSet<FaceId>>().into_iter().collect();
        let sample =
            |&face: &FaceId| SAMPLES.iter().filter_map(|&weights| view.sample(face, weights)).collect::<Vec<_>>();
        let samples: Vec<Vec<SidePoint>> = faces.par_iter().map(sample).collect();
        self.out.extend(samples.into_iter().flatten());
        self.out.extend(found.edge_face.iter().filter_map(|found| view.on_surface(found)));
    }

    /// Finds the vertices of a domain that are near a body or over an inner layer, on the right side.
    pub(crate) fn find_near(&mut self, tracker: &SideTracker, mesh: &Mesh, frame: &Frame, domain: &Domain) {
        let layers = tracker.layer_state(mesh, frame.positions());
        let near = tracker.tracked.par_iter().filter(|known| domain.local(known.vertex).is_some()).map(|known| {
            let at = frame.position(known.vertex);
            let own = MaterialPoint::vertex(known.vertex);
            let reach_m = NEAR * known.edge_m;
            let mut points = Vec::new();
            if let Some(bodies) = &tracker.bodies
                && known.distance_m(at) <= reach_m
                && !known.is_inside_at(bodies, at)
            {
                points.push(SidePoint::new(mesh, own, &bodies.closest(at, false), -1.0, known.edge_m));
            }
            if let Some(layers) = &layers {
                let over = layers.over(at, layers.number_of(known.vertex)).filter(|(_, is_behind)| !is_behind);
                points.extend(over.map(|(way, _)| SidePoint::new(mesh, own, &way, -1.0, known.edge_m)));
            }
            points.retain(|point| -point.depth_m < reach_m);
            points
        });
        self.near = near.collect::<Vec<_>>().into_iter().flatten().collect();
    }

    /// The vertices of all points on the wrong side, some of them several times.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        let points = self.out.iter().flat_map(|point| std::iter::once(point.own).chain(point.partner));
        points.flat_map(|point| point.vertices)
    }

    /// How far the farthest of them is on the wrong side, in edge lengths.
    pub(crate) fn depth_edges(&self) -> f64 {
        self.out.iter().map(|point| point.depth_m / point.edge_m).fold(0.0, f64::max)
    }

    /// Adds constraints for a gap, in edge lengths: what is on the wrong side gets to the other, in parts of its depth,
    /// and what is near keeps the gap, or its distance where that is less.
    pub(crate) fn add(&self, gap: f64, constraints: &mut Constraints) {
        for point in &self.out {
            let whole_m = point.depth_m + gap * point.edge_m;
            let wanted_m = whole_m.min((SHORT * point.edge_m).max(PART * whole_m));
            constraints.push(&point.own, point.partner.as_ref(), point.direction, wanted_m);
        }
        for point in &self.near {
            let apart_m = -point.depth_m;
            let wanted_m = apart_m.min(gap * point.edge_m) - apart_m;
            constraints.push(&point.own, point.partner.as_ref(), point.direction, wanted_m);
        }
    }
}

/// A state with its bodies and layers.
struct View<'a> {
    tracker: &'a SideTracker,
    mesh: &'a Mesh,
    frame: &'a Frame,
    layers: Option<LayerState<'a>>,
}

impl View<'_> {
    /// Of two faces that intersect the one that belongs outside of the other.
    fn outer(&self, faces: [FaceId; 2]) -> Option<FaceId> {
        let Self { tracker, mesh, .. } = self;
        if !tracker.decides(mesh, faces) {
            return None;
        }
        let rank = |face: FaceId| (!mesh.is_body_face(face)).then(|| self.number(mesh.face(face)[0]));
        Some(if rank(faces[0]) > rank(faces[1]) { faces[0] } else { faces[1] })
    }

    fn number(&self, vertex: VertexId) -> u32 {
        self.layers.as_ref().map_or(0, |layers| layers.number_of(vertex))
    }

    /// A place in a face that crosses a body or an inner layer, if it is on the wrong side.
    fn sample(&self, face: FaceId, weights: [f64; 3]) -> Option<SidePoint> {
        let Self { tracker, mesh, frame, layers } = self;
        let own = MaterialPoint { vertices: mesh.face(face), weights };
        let at = own.position(frame);
        let way = match &tracker.bodies {
            Some(bodies) if bodies.is_inside(at) => bodies.way_out(at),
            _ => layers.as_ref()?.behind(at, self.number(own.vertices[0]))?,
        };
        Some(SidePoint::new(mesh, own, &way, 1.0, tracker.edge_m(&own)))
    }

    /// Where an edge and a face intersect that belong on certain sides of each other.
    fn on_surface(&self, found: &EdgeFaceIntersection) -> Option<SidePoint> {
        let Self { tracker, mesh, frame, layers } = self;
        let ends = mesh.edge(found.edge);
        let &of_edge = mesh.edge_faces(found.edge).first()?;
        let outer = self.outer([of_edge, found.face])?;
        let on_edge = MaterialPoint {
            vertices: [ends[0], ends[1], ends[1]],
            weights: [1.0 - found.edge_parameter, found.edge_parameter, 0.0],
        };
        let in_face = MaterialPoint { vertices: mesh.face(found.face), weights: found.barycentric };
        let (own, inner) = if outer == of_edge { (on_edge, found.face) } else { (in_face, of_edge) };
        let at: Point3<f64> = own.position(frame);
        let way = if mesh.is_body_face(inner) {
            tracker.bodies.as_ref()?.closest(at, true)
        } else {
            let layers = layers.as_ref()?;
            let mut over = layers.over(at, self.number(own.vertices[0]));
            over.find(|(way, _)| self.number(mesh.face(way.face)[0]) == self.number(mesh.face(inner)[0]))?.0
        };
        let point = SidePoint::new(mesh, own, &way, 1.0, tracker.edge_m(&own));
        Some(SidePoint { depth_m: 0.0, ..point })
    }
}
