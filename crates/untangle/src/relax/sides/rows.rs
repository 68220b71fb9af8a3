//! Constraints along the distance field of the bodies: out of them, and not into them.

use std::collections::BTreeSet;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::tracker::SideTracker;
use crate::{
    correspond::MaterialPoint,
    frame::Frame,
    intersect::{EdgeFaceIntersection, Intersections},
    mesh::{FaceId, Mesh, VertexId},
    relax::{constraints::Constraints, energy::Domain},
};

/// Depths up to this many edge lengths are left in one step, and of larger ones a part.
const SHORT: f64 = 2.0;
const PART: f64 = 0.5;
/// Vertices nearer to a body than this many edge lengths are kept from entering it.
const NEAR: f64 = 2.0;
/// Places in a face that crosses a body, beside its corners, as weights.
const SAMPLES: [[f64; 3]; 7] = [
    [1.0 / 3.0; 3],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.5],
    [0.5, 0.0, 0.5],
    [0.7, 0.15, 0.15],
    [0.15, 0.7, 0.15],
    [0.15, 0.15, 0.7],
];

/// A point of the cloth that has to leave a body, or must not enter it.
#[derive(Clone, Copy, Debug)]
struct SidePoint {
    own: MaterialPoint,
    /// Unit vector outwards.
    direction: Vector3<f64>,
    /// How deep it is inside, in metres; negative outside.
    depth_m: f64,
    edge_m: f64,
}

/// The points of one state.
#[derive(Debug, Default)]
pub(crate) struct SideRows {
    /// Those that have to leave a body.
    out: Vec<SidePoint>,
    /// Those that are near one, on the right side.
    near: Vec<SidePoint>,
}

impl SideRows {
    /// Finds the points that have to leave a body: vertices and places in faces that are inside, and where edges and
    /// faces of bodies and of the cloth intersect.
    pub(crate) fn find(&mut self, tracker: &SideTracker, mesh: &Mesh, frame: &Frame, found: &Intersections) {
        self.out.clear();
        self.near.clear();
        let out = tracker.wrong(frame.positions()).into_iter().map(|(vertex, way, edge_m)| SidePoint {
            own: MaterialPoint::vertex(vertex),
            direction: way.direction,
            depth_m: way.depth_m,
            edge_m,
        });
        self.out.extend(out);
        let faces: BTreeSet<FaceId> = found
            .segments
            .iter()
            .filter_map(|segment| match segment.faces.map(|face| mesh.is_body_face(face)) {
                [true, false] => Some(segment.faces[1]),
                [false, true] => Some(segment.faces[0]),
                _ => None,
            })
            .collect();
        let faces: Vec<FaceId> = faces.into_iter().collect();
        let samples: Vec<SidePoint> = faces
            .par_iter()
            .flat_map_iter(|&face| {
                SAMPLES.iter().filter_map(move |&weights| sample(tracker, mesh, frame, face, weights))
            })
            .collect();
        self.out.extend(samples);
        self.out.extend(found.edge_face.iter().filter_map(|found| on_surface(tracker, mesh, frame, found)));
    }

    /// Finds the vertices of a domain that are near a body, on the right side.
    pub(crate) fn find_near(&mut self, tracker: &SideTracker, frame: &Frame, domain: &Domain) {
        let near = tracker.tracked.par_iter().filter_map(|known| {
            let at = frame.position(known.vertex);
            let reach_m = NEAR * known.edge_m;
            if domain.local(known.vertex).is_none()
                || known.distance_m(at) > reach_m
                || known.is_inside_at(&tracker.sides, at)
            {
                return None;
            }
            let way = tracker.sides.closest(at, false);
            (way.depth_m < reach_m).then(|| SidePoint {
                own: MaterialPoint::vertex(known.vertex),
                direction: way.direction,
                depth_m: -way.depth_m,
                edge_m: known.edge_m,
            })
        });
        self.near = near.collect();
    }

    /// The vertices of all points that have to leave a body, some of them several times.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        self.out.iter().flat_map(|point| point.own.vertices)
    }

    /// How deep the deepest of them is, in edge lengths.
    pub(crate) fn depth_edges(&self) -> f64 {
        self.out.iter().map(|point| point.depth_m / point.edge_m).fold(0.0, f64::max)
    }

    /// Adds constraints for a gap, in edge lengths: what is inside leaves, in parts of its depth, and what is near
    /// keeps the gap, or its distance where that is less.
    pub(crate) fn add(&self, gap: f64, constraints: &mut Constraints) {
        for point in &self.out {
            let whole_m = point.depth_m + gap * point.edge_m;
            let wanted_m = whole_m.min((SHORT * point.edge_m).max(PART * whole_m));
            constraints.push(&point.own, point.direction, wanted_m);
        }
        for point in &self.near {
            let apart_m = -point.depth_m;
            constraints.push(&point.own, point.direction, apart_m.min(gap * point.edge_m) - apart_m);
        }
    }
}

/// A place in a face that crosses a body, if it is inside.
fn sample(tracker: &SideTracker, mesh: &Mesh, frame: &Frame, face: FaceId, weights: [f64; 3]) -> Option<SidePoint> {
    let own = MaterialPoint { vertices: mesh.face(face), weights };
    let at = own.position(frame);
    tracker.sides.is_inside(at).then(|| {
        let way = tracker.sides.way_out(at);
        SidePoint { own, direction: way.direction, depth_m: way.depth_m, edge_m: tracker.edge_m(&own) }
    })
}

/// Where an edge and a face of a body and of the cloth intersect.
fn on_surface(tracker: &SideTracker, mesh: &Mesh, frame: &Frame, found: &EdgeFaceIntersection) -> Option<SidePoint> {
    let ends = mesh.edge(found.edge);
    let own = match (mesh.is_body(ends[0]), mesh.is_body_face(found.face)) {
        (false, true) => MaterialPoint {
            vertices: [ends[0], ends[1], ends[1]],
            weights: [1.0 - found.edge_parameter, found.edge_parameter, 0.0],
        },
        (true, false) => MaterialPoint { vertices: mesh.face(found.face), weights: found.barycentric },
        _ => return None,
    };
    let at: Point3<f64> = own.position(frame);
    // Inside of another body it is no part of what bounds the inside.
    let way = tracker.sides.closest(at, true);
    Some(SidePoint { own, direction: way.direction, depth_m: 0.0, edge_m: tracker.edge_m(&own) })
}
