//! The disc round a loop vertex: the surroundings of a BLI path unfolded into the plane.
//!
//! Faces are laid out one after the other, nearest first, each along an edge that is already there: with their texture coordinates where
//! the mesh has them, otherwise with their rest lengths. Across a seam the layout simply goes on. Where the coordinates are
//! smooth, the result is these coordinates themselves, moved so that the loop vertex is the origin.

use std::{cmp::Ordering, collections::BinaryHeap};

use arrayvec::ArrayVec;
use nalgebra::{Point3, Vector2};

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{PathPoint, SurfacePoint},
};

/// A face to be laid out, the nearest first.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    distance: f64,
    face: FaceId,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // Reversed: the heap's greatest is the nearest, then the lowest face.
        other.distance.total_cmp(&self.distance).then(other.face.cmp(&self.face))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// Unfolded surroundings of one vertex, reusing its memory from path to path.
#[derive(Debug, Default)]
pub(crate) struct Disc {
    epoch: u32,
    places: Vec<(u32, Vector2<f64>)>,
    laid_out: Vec<u32>,
    queue: BinaryHeap<Candidate>,
    radius: f64,
}

impl Disc {
    /// Unfolds the surroundings of `centre` until they hold the nearer one of two path ends, which fixes the radius.
    ///
    /// Returns the radius; nothing if neither end can be reached over edges.
    pub(crate) fn unfold(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        centre: VertexId,
        ends: [SurfacePoint; 2],
    ) -> Option<f64> {
        self.places.resize(mesh.num_vertices(), (0, Vector2::zeros()));
        self.laid_out.resize(mesh.num_faces(), 0);
        self.epoch = self.epoch.checked_add(1).unwrap_or_else(|| {
            self.places.fill((0, Vector2::zeros()));
            self.laid_out.fill(0);
            1
        });
        self.queue.clear();
        self.place(centre, Vector2::zeros());
        let first = *mesh.vertex_faces(centre).first()?;
        self.queue.push(Candidate { distance: 0.0, face: first });
        let mut radius: Option<f64> = None;
        while let Some(Candidate { distance, face }) = self.queue.pop() {
            let found = ends.map(|end| self.distance_to(mesh, end));
            radius = found.into_iter().flatten().reduce(f64::min);
            // All that is nearer than the nearer end is laid out; an end that is not is farther away.
            if radius.is_some_and(|radius| distance > radius) {
                break;
            }
            self.lay_out(mesh, frame, face);
        }
        self.radius = radius?;
        radius
    }

    /// Whether a vertex lies in the disc.
    pub(crate) fn contains(&self, vertex: VertexId) -> bool {
        self.place_of(vertex).is_some_and(|place| place.norm() <= self.radius)
    }

    fn place(&mut self, vertex: VertexId, place: Vector2<f64>) {
        self.places[vertex.index()] = (self.epoch, place);
    }

    fn place_of(&self, vertex: VertexId) -> Option<Vector2<f64>> {
        let (epoch, place) = self.places[vertex.index()];
        (epoch == self.epoch).then_some(place)
    }

    fn distance_to(&self, mesh: &Mesh, point: SurfacePoint) -> Option<f64> {
        self.place_of_point(mesh, point).map(|place| place.norm())
    }

    fn place_of_point(&self, mesh: &Mesh, point: SurfacePoint) -> Option<Vector2<f64>> {
        Some(match point {
            SurfacePoint::Vertex(vertex) => self.place_of(vertex)?,
            SurfacePoint::Edge { edge, parameter } => {
                let [a, b] = mesh.edge(edge);
                self.place_of(a)?.lerp(&self.place_of(b)?, parameter)
            }
            SurfacePoint::Face { face, barycentric } => {
                let mut sum = Vector2::zeros();
                for (corner, weight) in mesh.face(face).into_iter().zip(barycentric) {
                    sum += self.place_of(corner)? * weight;
                }
                sum
            }
        })
    }

    /// The end of an edge to the left of the path where it crosses it first.
    pub(crate) fn left_end(&self, mesh: &Mesh, points: &[PathPoint], edge: EdgeId) -> Option<VertexId> {
        let crosses = |point: &PathPoint| matches!(point.own, SurfacePoint::Edge { edge: here, .. } if here == edge);
        let at = points.iter().position(crosses)?;
        let place = |index: usize| self.place_of_point(mesh, points[index].own);
        let ahead = place((at + 1).min(points.len() - 1))? - place(at.saturating_sub(1))?;
        let [a, b] = mesh.edge(edge);
        let along = self.place_of(b)? - self.place_of(a)?;
        Some(if ahead.perp(&along) > 0.0 { b } else { a })
    }

    /// Places the corners of a face that are not placed yet, and queues its neighbours.
    fn lay_out(&mut self, mesh: &Mesh, frame: &Frame, face: FaceId) {
        if std::mem::replace(&mut self.laid_out[face.index()], self.epoch) == self.epoch {
            return;
        }
        let corners = mesh.face(face);
        let local = local_coordinates(mesh, frame, face);
        let placed = corners.map(|corner| self.place_of(corner));
        match placed {
            [Some(_), Some(_), Some(_)] => {}
            _ => {
                let known: ArrayVec<usize, 3> = (0..3).filter(|&corner| placed[corner].is_some()).collect();
                if let &[a, b] = known.as_slice() {
                    let c = 3 - a - b;
                    let edge = placed[a].zip(placed[b]);
                    if let Some((to_a, to_b)) = edge {
                        let beyond = self.apex_beyond(mesh, face, corners[a], corners[b]);
                        let place = continue_layout([local[a], local[b], local[c]], [to_a, to_b], beyond);
                        self.place(corners[c], place);
                    }
                } else if let &[a] = known.as_slice() {
                    // The first face: as it is.
                    for corner in (0..3).filter(|&corner| corner != a) {
                        self.place(corners[corner], local[corner] - local[a]);
                    }
                }
            }
        }
        for edge in mesh.face_edges(face).into_iter().flatten() {
            let distance = mesh.edge(edge).into_iter().filter_map(|end| self.place_of(end)).map(|place| place.norm());
            let distance = distance.reduce(f64::min).unwrap_or(f64::INFINITY);
            for &neighbour in mesh.edge_faces(edge) {
                if self.laid_out[neighbour.index()] != self.epoch {
                    self.queue.push(Candidate { distance, face: neighbour });
                }
            }
        }
    }

    /// Where the face on the other side of an edge has its third corner: the new face goes to the other side.
    fn apex_beyond(&self, mesh: &Mesh, face: FaceId, a: VertexId, b: VertexId) -> Option<Vector2<f64>> {
        let edge = mesh.edge_between(a, b)?;
        let laid_out = |&&other: &&FaceId| other != face && self.laid_out[other.index()] == self.epoch;
        let other = mesh.edge_faces(edge).iter().find(laid_out)?;
        let apex = mesh.face(*other).into_iter().find(|&corner| corner != a && corner != b)?;
        self.place_of(apex)
    }
}

/// A face in a plane of its own: its texture coordinates, or a triangle of its rest lengths.
fn local_coordinates(mesh: &Mesh, frame: &Frame, face: FaceId) -> [Vector2<f64>; 3] {
    if let Some(uvs) = mesh.uvs() {
        return uvs.corners[face.index()].map(|corner| uvs.coordinates[corner as usize].into());
    }
    let [a, b, c] = mesh.face(face).map(|vertex| match mesh.rest_positions() {
        Some(rest) => Point3::from(rest[vertex.index()]),
        None => frame.position(vertex),
    });
    let (along, to_c) = (b - a, c - a);
    let length = along.norm();
    if length > 0.0 {
        let x = to_c.dot(&along) / length;
        let y = (to_c - along * (x / length)).norm();
        [Vector2::zeros(), Vector2::new(length, 0.0), Vector2::new(x, y)]
    } else {
        [Vector2::zeros(), Vector2::zeros(), Vector2::new(0.0, to_c.norm())]
    }
}

/// Moves the triangle `[a, b, c]` so that its first two corners fall on `to`, and returns the place of the third, on the side of `to`
/// away from `beyond`.
fn continue_layout([a, b, c]: [Vector2<f64>; 3], to: [Vector2<f64>; 2], beyond: Option<Vector2<f64>>) -> Vector2<f64> {
    let (along, target) = (b - a, to[1] - to[0]);
    let squared = along.norm_squared();
    if squared <= 0.0 {
        return to[0];
    }
    let relative = c - a;
    let (x, y) = (relative.dot(&along) / squared, along.perp(&relative) / squared);
    let normal = Vector2::new(-target.y, target.x);
    let place = |y: f64| to[0] + target * x + normal * y;
    let mirrored = beyond.is_some_and(|beyond| (target.perp(&(beyond - to[0])) > 0.0) == (y > 0.0));
    place(if mirrored { -y } else { y })
}
