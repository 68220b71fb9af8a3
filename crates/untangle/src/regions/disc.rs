//! The disc round a loop vertex: the surroundings of a BLI path unfolded into the plane.
//!
//! Where the texture coordinates of a piece are one smooth chart, they are the unfolding: a vertex is in the disc or not by its own
//! coordinates, and nothing is laid out at all. The fill then visits what it needs.
//!
//! Otherwise faces are laid out one after the other, nearest first, each along an edge that is already there: with their texture
//! coordinates where the mesh has them, or else with their rest lengths. Across a seam the layout simply goes on. The radius is known
//! only when the nearer end of the path is reached, so that the whole disc has to be laid out.
//!
//! The ends of the path lie on the rim of the disc, or beyond it. The disc is convex, so that no way inside of it leads round an end: a
//! free end needs no extension to the rim to keep the sides apart.
//!
//! Each face keeps the motion that placed it, and hands it on to its neighbours: so errors add up from face to face. Placing each corner
//! by the two that are there would multiply them. What comes first is told by lengths, so that no numbering changes the disc.

use std::{cmp::Ordering, collections::BinaryHeap};

use nalgebra::{Point3, Vector2};

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::SurfacePoint,
};

/// A face to be laid out, the nearest first.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    /// From the centre to the nearer and the farther end of the edge that it is reached over.
    distances: [f64; 2],
    /// Its corner that is not on this edge.
    apex: VertexId,
    face: FaceId,
    /// The face and the edge that it is reached from, and how many faces were laid out before that one.
    from: Option<(u32, FaceId, EdgeId)>,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // Reversed: the heap's greatest is the nearest. Lengths tell edges apart, and an edge has one open face; the rest is for edges of
        // many faces and exact symmetry.
        let [near, far] = [0, 1].map(|end: usize| other.distances[end].total_cmp(&self.distances[end]));
        let (this, that) = (&self, other);
        near.then(far).then(that.from.cmp(&this.from)).then(that.apex.cmp(&this.apex)).then(that.face.cmp(&this.face))
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
    /// The texture coordinates of the centre, where they need no unfolding.
    chart: Option<Vector2<f64>>,
    epoch: u32,
    places: Vec<(u32, Vector2<f64>)>,
    layouts: Vec<(u32, Layout)>,
    queue: BinaryHeap<Candidate>,
    num_laid_out: u32,
    radius: f64,
}

impl Disc {
    /// Makes the disc round `centre` that reaches to the nearer one of two path ends; `around` are the faces in which the path passes through
    /// the centre.
    ///
    /// Returns the radius; nothing if neither end can be reached over edges. Cost: constant in a smooth chart, otherwise O(n log n) in
    /// the faces of the disc.
    pub(crate) fn reach(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        centre: VertexId,
        around: [FaceId; 2],
        ends: [SurfacePoint; 2],
    ) -> Option<f64> {
        self.chart = mesh.chart_place(centre).map(Vector2::from);
        if self.chart.is_none() {
            return self.unfold(mesh, frame, centre, around, ends);
        }
        let radius = ends.into_iter().filter_map(|end| self.distance_to(mesh, end)).reduce(f64::min);
        self.radius = radius?;
        radius
    }

    /// Lays out the surroundings of `centre` until they hold the nearer one of two path ends.
    fn unfold(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        centre: VertexId,
        around: [FaceId; 2],
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
        self.num_laid_out = 0;
        self.place(centre, Vector2::zeros());
        let face = first_face(mesh, frame, centre)?;
        self.queue.push(Candidate { distances: [0.0; 2], apex: centre, face, from: None });
        // Where the faces round the centre are not one fan, those of the path belong to the disc too; where they are, all its faces
        // come earlier.
        let later = [0.0, f64::INFINITY];
        self.queue.extend(around.map(|face| Candidate { distances: later, apex: centre, face, from: None }));
        let mut radius: Option<f64> = None;
        while let Some(Candidate { distances: [distance, _], face, from, .. }) = self.queue.pop() {
            let found = ends.map(|end| self.distance_to(mesh, end));
            radius = found.into_iter().flatten().reduce(f64::min);
            // All that is nearer than the nearer end is laid out; an end that is not is farther away.
            if radius.is_some_and(|radius| distance > radius) {
                break;
            }
            self.lay_out(mesh, frame, face, from.map(|(_, face, edge)| (face, edge)), centre);
        }
        self.radius = radius?;
        radius
    }

    /// Whether a vertex lies in the disc.
    pub(crate) fn contains(&self, mesh: &Mesh, vertex: VertexId) -> bool {
        self.place_of(mesh, vertex).is_some_and(|place| place.norm() <= self.radius)
    }

    fn place(&mut self, vertex: VertexId, place: Vector2<f64>) {
        self.places[vertex.index()] = (self.epoch, place);
    }

    fn place_of(&self, mesh: &Mesh, vertex: VertexId) -> Option<Vector2<f64>> {
        if let Some(centre) = self.chart {
            return Some(Vector2::from(mesh.chart_place(vertex)?) - centre);
        }
        let (epoch, place) = self.places[vertex.index()];
        (epoch == self.epoch).then_some(place)
    }

    fn distance_to(&self, mesh: &Mesh, point: SurfacePoint) -> Option<f64> {
        self.place_of_point(mesh, point).map(|place| place.norm())
    }

    fn place_of_point(&self, mesh: &Mesh, point: SurfacePoint) -> Option<Vector2<f64>> {
        Some(match point {
            SurfacePoint::Vertex(vertex) => self.place_of(mesh, vertex)?,
            SurfacePoint::Edge { edge, parameter } => {
                let [a, b] = mesh.edge(edge);
                self.place_of(mesh, a)?.lerp(&self.place_of(mesh, b)?, parameter)
            }
            SurfacePoint::Face { face, barycentric } => {
                let mut sum = Vector2::zeros();
                for (corner, weight) in mesh.face(face).into_iter().zip(barycentric) {
                    sum += self.place_of(mesh, corner)? * weight;
                }
                sum
            }
        })
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
        self.num_laid_out += 1;
        for (corner, place) in corners.into_iter().zip(local) {
            if self.place_of(mesh, corner).is_none() {
                self.place(corner, layout.apply(place));
            }
        }
        for edge in mesh.face_edges(face).into_iter().flatten() {
            let ends = mesh.edge(edge);
            let [a, b] = ends.map(|end| self.place_of(mesh, end).map_or(f64::INFINITY, |place| place.norm()));
            for &neighbour in mesh.edge_faces(edge) {
                if self.layouts[neighbour.index()].0 != self.epoch {
                    let apex = mesh.face(neighbour).into_iter().find(|corner| !ends.contains(corner));
                    self.queue.push(Candidate {
                        distances: [a.min(b), a.max(b)],
                        apex: apex.unwrap_or_default(),
                        face: neighbour,
                        from: Some((self.num_laid_out, face, edge)),
                    });
                }
            }
        }
    }
}

/// The face round a vertex with the shortest sides at the vertex.
fn first_face(mesh: &Mesh, frame: &Frame, centre: VertexId) -> Option<FaceId> {
    let key = |face: FaceId| {
        let (corners, local) = (mesh.face(face), local_coordinates(mesh, frame, face));
        let at = corners.into_iter().position(|corner| corner == centre).unwrap_or_default();
        let [a, b] = [1, 2].map(|step| (local[(at + step) % 3] - local[at]).norm());
        let mut names = corners;
        names.sort_unstable();
        (a.min(b), a.max(b), names)
    };
    let shorter = |a: &FaceId, b: &FaceId| {
        let (a, b) = (key(*a), key(*b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2))
    };
    mesh.vertex_faces(centre).iter().copied().min_by(shorter)
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

/// A face in a plane of its own: its texture coordinates where they have an area, or a triangle of its rest lengths.
fn local_coordinates(mesh: &Mesh, frame: &Frame, face: FaceId) -> [Vector2<f64>; 3] {
    if let Some(uvs) = mesh.uvs() {
        let [a, b, c] = uvs.corners[face.index()].map(|corner| Vector2::from(uvs.coordinates[corner as usize]));
        if (b - a).perp(&(c - a)).abs() > 0.0 {
            return [a, b, c];
        }
    }
    // From the corners in the order of their vertices: no rounding depends on how the face is written down.
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&corner| mesh.face(face)[corner]);
    let [a, b, c] = order.map(|corner| mesh.face(face)[corner]).map(|vertex| match mesh.rest_positions() {
        Some(rest) => Point3::from(rest[vertex.index()]),
        None => frame.position(vertex),
    });
    let (along, to_c) = (b - a, c - a);
    let length = along.norm();
    let flat = if length > 0.0 {
        let x = to_c.dot(&along) / length;
        let y = (to_c - along * (x / length)).norm();
        [Vector2::zeros(), Vector2::new(length, 0.0), Vector2::new(x, y)]
    } else {
        [Vector2::zeros(), Vector2::zeros(), Vector2::new(0.0, to_c.norm())]
    };
    let mut local = [Vector2::zeros(); 3];
    for (corner, place) in order.into_iter().zip(flat) {
        local[corner] = place;
    }
    local
}
