//! The disc round a loop vertex: the surroundings of a BLI path unfolded into the plane.
//!
//! Faces are laid out one after the other, nearest first, each along an edge that is already there: with their texture coordinates where
//! the mesh has them, otherwise with their rest lengths. Across a seam the layout simply goes on. Where the coordinates are
//! smooth, the result is these coordinates themselves, moved so that the loop vertex is the origin.
//!
//! Each face keeps the motion that placed it, and hands it on to its neighbours: so errors add up from face to face. Placing each corner
//! by the two that are there would multiply them.

use std::{cmp::Ordering, collections::BinaryHeap};

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
    /// The face and the edge that it is reached from.
    from: Option<(FaceId, EdgeId)>,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // Reversed: the heap's greatest is the nearest, then the lowest face.
        other.distance.total_cmp(&self.distance).then(other.face.cmp(&self.face)).then(other.from.cmp(&self.from))
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
    layouts: Vec<(u32, Layout)>,
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
        self.layouts.resize(mesh.num_faces(), (0, Layout::default()));
        self.epoch = self.epoch.checked_add(1).unwrap_or_else(|| {
            self.places.fill((0, Vector2::zeros()));
            self.layouts.fill((0, Layout::default()));
            1
        });
        self.queue.clear();
        self.place(centre, Vector2::zeros());
        let first = *mesh.vertex_faces(centre).first()?;
        self.queue.push(Candidate { distance: 0.0, face: first, from: None });
        let mut radius: Option<f64> = None;
        while let Some(Candidate { distance, face, from }) = self.queue.pop() {
            let found = ends.map(|end| self.distance_to(mesh, end));
            radius = found.into_iter().flatten().reduce(f64::min);
            // All that is nearer than the nearer end is laid out; an end that is not is farther away.
            if radius.is_some_and(|radius| distance > radius) {
                break;
            }
            self.lay_out(mesh, frame, face, from, centre);
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
    fn lay_out(&mut self, mesh: &Mesh, frame: &Frame, face: FaceId, from: Option<(FaceId, EdgeId)>, centre: VertexId) {
        if self.layouts[face.index()].0 == self.epoch {
            return;
        }
        let corners = mesh.face(face);
        let local = local_coordinates(mesh, frame, face);
        let layout = match from {
            Some((previous, edge)) => {
                let at = |face: FaceId, local: [Vector2<f64>; 3]| {
                    // The ends of the edge, then the third corner.
                    let ends = mesh.edge(edge);
                    let apex = mesh.face(face).into_iter().find(|corner| !ends.contains(corner)).unwrap_or(ends[0]);
                    [ends[0], ends[1], apex].map(|vertex| {
                        let corner = mesh.face(face).into_iter().position(|corner| corner == vertex);
                        local[corner.unwrap_or_default()]
                    })
                };
                let before = at(previous, local_coordinates(mesh, frame, previous));
                self.layouts[previous.index()].1.continued(before, at(face, local))
            }
            None => {
                let origin = corners.into_iter().position(|corner| corner == centre).unwrap_or_default();
                Layout { shift: -local[origin], ..Layout::default() }
            }
        };
        self.layouts[face.index()] = (self.epoch, layout);
        for (corner, place) in corners.into_iter().zip(local) {
            if self.place_of(corner).is_none() {
                self.place(corner, layout.apply(place));
            }
        }
        for edge in mesh.face_edges(face).into_iter().flatten() {
            let distance = mesh.edge(edge).into_iter().filter_map(|end| self.place_of(end)).map(|place| place.norm());
            let distance = distance.reduce(f64::min).unwrap_or(f64::INFINITY);
            for &neighbour in mesh.edge_faces(edge) {
                if self.layouts[neighbour.index()].0 != self.epoch {
                    self.queue.push(Candidate { distance, face: neighbour, from: Some((face, edge)) });
                }
            }
        }
    }
}

/// A motion of the plane, with a scale: `z -> shift + turn * z` in complex numbers, or of the conjugate of `z` if mirrored.
#[derive(Clone, Copy, Debug)]
struct Layout {
    turn: Vector2<f64>,
    mirrored: bool,
    shift: Vector2<f64>,
}

impl Default for Layout {
    fn default() -> Self {
        Self { turn: Vector2::new(1.0, 0.0), mirrored: false, shift: Vector2::zeros() }
    }
}

impl Layout {
    fn apply(&self, z: Vector2<f64>) -> Vector2<f64> {
        self.shift + times(self.turn, conjugate_if(self.mirrored, z))
    }

    /// The layout of a neighbour: `before` and `after` are the ends of the common edge and the third corner, in the plane of
    /// the face that has this layout and in that of the neighbour. The neighbour goes to the other side of the edge.
    fn continued(&self, before: [Vector2<f64>; 3], after: [Vector2<f64>; 3]) -> Self {
        let is_left = |[a, b, c]: [Vector2<f64>; 3]| (b - a).perp(&(c - a)) > 0.0;
        let flip = is_left(before) == is_left(after);
        let along = conjugate_if(flip, after[1] - after[0]);
        let squared = along.norm_squared();
        let relative = if squared > 0.0 {
            times(before[1] - before[0], conjugate_if(true, along)) / squared
        } else {
            Vector2::new(1.0, 0.0)
        };
        let turn = times(self.turn, conjugate_if(self.mirrored, relative));
        let mirrored = self.mirrored != flip;
        Self { turn, mirrored, shift: self.apply(before[0]) - times(turn, conjugate_if(mirrored, after[0])) }
    }
}

fn times(a: Vector2<f64>, b: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

fn conjugate_if(conjugate: bool, z: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(z.x, if conjugate { -z.y } else { z.y })
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
