//! The disc round a loop vertex: the surroundings of a BLI path unfolded (developed) into the plane.
//!
//! Where the texture coordinates of a piece are one smooth chart, they are the unfolding: the coordinates of a vertex
//! tell whether it is in the disc, no face is unfolded, and the flood fill visits only the vertices that it needs.
//!
//! Otherwise faces are unfolded one by one, the nearest first, each beside a neighbour that is in the plane already,
//! over their common edge: by their texture coordinates where the mesh has them, or else by their rest lengths. The
//! unfolding continues across seams of the texture. The radius is known only when the unfolding reaches the nearer end
//! of the path, so the whole disc is unfolded.
//!
//! The ends of the path lie on the rim of the disc, or beyond it. The disc is convex, so that no walk inside it leads
//! round an end: a free end needs no extension to the rim to keep the sides apart.
//!
//! Each face keeps the similarity that placed it, and its neighbours continue from that: so errors add up from face to
//! face. To place each corner by the two that are already there would multiply them. Lengths decide which face comes
//! first, so that no numbering changes the disc.

use std::{cmp::Ordering, collections::BinaryHeap};

use nalgebra::{Point3, Vector2};

use super::similarity::Similarity;
use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::SurfacePoint,
    sparse_map::SparseMap,
};

/// A face to be unfolded; the nearest comes first.
#[derive(Clone, Copy, Debug)]
struct QueuedFace {
    /// From the centre to the nearer and the farther end of the edge that it is reached over.
    distances: [f64; 2],
    /// Its corner that is not on this edge.
    apex: VertexId,
    face: FaceId,
    /// The number of faces that were unfolded before it was queued, and the face and the edge that it is reached from.
    from: Option<(usize, FaceId, EdgeId)>,
}

impl Ord for QueuedFace {
    fn cmp(&self, other: &Self) -> Ordering {
        // Reversed, since the heap gives the greatest: the nearest first. Lengths tell edges apart, and an edge has one
        // face that is not unfolded; the other keys are for edges of many faces and exact symmetry.
        let [near, far] = [0, 1].map(|end: usize| other.distances[end].total_cmp(&self.distances[end]));
        let (this, that) = (&self, other);
        near.then(far).then(that.from.cmp(&this.from)).then(that.apex.cmp(&this.apex)).then(that.face.cmp(&this.face))
    }
}

impl PartialOrd for QueuedFace {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for QueuedFace {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for QueuedFace {}

/// Unfolded surroundings of one vertex, reusing its memory from path to path.
#[derive(Debug, Default)]
pub(crate) struct Disc {
    /// The texture coordinates of the centre, where those of its piece are the unfolding.
    uv_centre: Option<Vector2<f64>>,
    /// Vertices in the plane, relative to the centre.
    places: SparseMap<VertexId, Vector2<f64>>,
    /// For each unfolded face the map that placed it.
    similarities: SparseMap<FaceId, Similarity>,
    queue: BinaryHeap<QueuedFace>,
    radius: f64,
}

impl Disc {
    /// Makes the disc round `centre` that reaches to the nearer one of two path ends; `around` are the faces in which
    /// the path passes through the centre.
    ///
    /// Returns the radius; nothing if neither end can be reached over edges. Cost: constant in a smooth chart,
    /// otherwise O(n log n) in the faces of the disc.
    pub(crate) fn build(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        centre: VertexId,
        around: [FaceId; 2],
        ends: [SurfacePoint; 2],
    ) -> Option<f64> {
        self.uv_centre = mesh.chart_place(centre).map(Vector2::from);
        let radius = if self.uv_centre.is_some() {
            self.distance_to_nearer(mesh, ends)
        } else {
            self.unfold(mesh, frame, centre, around, ends)
        };
        self.radius = radius?;
        radius
    }

    /// Unfolds the surroundings of `centre` until they hold the nearer one of two path ends; returns the distance to
    /// it.
    fn unfold(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        centre: VertexId,
        around: [FaceId; 2],
        ends: [SurfacePoint; 2],
    ) -> Option<f64> {
        self.places.reset(mesh.num_vertices());
        self.similarities.reset(mesh.num_faces());
        self.queue.clear();
        self.places.set(centre, Vector2::zeros());
        let face = first_face(mesh, frame, centre)?;
        self.queue.push(QueuedFace { distances: [0.0; 2], apex: centre, face, from: None });
        // Where the faces round the centre are not one fan, those of the path belong to the disc too; where they are,
        // all its faces come earlier.
        let later = [0.0, f64::INFINITY];
        self.queue.extend(around.map(|face| QueuedFace { distances: later, apex: centre, face, from: None }));
        let mut radius = None;
        while let Some(QueuedFace { distances: [distance, _], face, from, .. }) = self.queue.pop() {
            radius = self.distance_to_nearer(mesh, ends);
            // All that is nearer than the nearer end is unfolded; an end that is not is farther away.
            if radius.is_some_and(|radius| distance > radius) {
                break;
            }
            self.unfold_face(mesh, frame, face, from.map(|(_, face, edge)| (face, edge)), centre);
        }
        radius
    }

    /// Whether a vertex lies in the disc.
    pub(crate) fn contains(&self, mesh: &Mesh, vertex: VertexId) -> bool {
        self.place_of(mesh, vertex).is_some_and(|place| place.norm() <= self.radius)
    }

    /// The place of a vertex relative to the centre, if it is in the unfolding.
    fn place_of(&self, mesh: &Mesh, vertex: VertexId) -> Option<Vector2<f64>> {
        match self.uv_centre {
            Some(centre) => Some(Vector2::from(mesh.chart_place(vertex)?) - centre),
            None => self.places.get(vertex),
        }
    }

    fn distance_to_nearer(&self, mesh: &Mesh, ends: [SurfacePoint; 2]) -> Option<f64> {
        let distance = |end| self.place_of_point(mesh, end).map(|place| place.norm());
        ends.into_iter().filter_map(distance).reduce(f64::min)
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

    /// Places the corners of a face that are not placed yet, and queues its neighbours. `from` is the neighbour that is
    /// in the plane already and the common edge; without it the face has a corner in the centre.
    fn unfold_face(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        face: FaceId,
        from: Option<(FaceId, EdgeId)>,
        centre: VertexId,
    ) {
        if self.similarities.contains(face) {
            return;
        }
        let corners = mesh.face(face);
        let local = local_coordinates(mesh, frame, face);
        let similarity = match from {
            Some((previous, edge)) => {
                let before = edge_first(mesh, previous, edge, local_coordinates(mesh, frame, previous));
                let after = edge_first(mesh, face, edge, local);
                let placed = self.similarities.get(previous);
                let placed =
                    placed.unwrap_or_else(|| unreachable!("{previous:?} queued {face:?} before it was unfolded"));
                placed.continued(before, after)
            }
            None => {
                let origin = corners.into_iter().position(|corner| corner == centre).unwrap_or_default();
                Similarity::translation(-local[origin])
            }
        };
        self.similarities.set(face, similarity);
        for (corner, place) in corners.into_iter().zip(local) {
            self.places.insert(corner, similarity.apply(place));
        }
        self.queue_neighbours(mesh, face);
    }

    fn queue_neighbours(&mut self, mesh: &Mesh, face: FaceId) {
        let num_unfolded = self.similarities.keys().len();
        for edge in mesh.face_edges(face).into_iter().flatten() {
            let ends = mesh.edge(edge);
            let [a, b] = ends.map(|end| self.place_of(mesh, end).map_or(f64::INFINITY, |place| place.norm()));
            for &neighbour in mesh.edge_faces(edge) {
                if !self.similarities.contains(neighbour) {
                    let apex = mesh.face(neighbour).into_iter().find(|corner| !ends.contains(corner));
                    self.queue.push(QueuedFace {
                        distances: [a.min(b), a.max(b)],
                        apex: apex.unwrap_or_default(),
                        face: neighbour,
                        from: Some((num_unfolded, face, edge)),
                    });
                }
            }
        }
    }
}

/// Values of the corners of a face in the order: ends of an edge, third corner.
fn edge_first(mesh: &Mesh, face: FaceId, edge: EdgeId, values: [Vector2<f64>; 3]) -> [Vector2<f64>; 3] {
    let ends = mesh.edge(edge);
    let apex = mesh.face(face).into_iter().find(|corner| !ends.contains(corner)).unwrap_or(ends[0]);
    [ends[0], ends[1], apex].map(|vertex| {
        let corner = mesh.face(face).into_iter().position(|corner| corner == vertex);
        values[corner.unwrap_or_default()]
    })
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

/// A face in a plane of its own: its texture coordinates where they have an area, or else a triangle of its rest
/// lengths.
fn local_coordinates(mesh: &Mesh, frame: &Frame, face: FaceId) -> [Vector2<f64>; 3] {
    if let Some(uvs) = mesh.uvs() {
        let [a, b, c] = uvs.corners[face.index()].map(|corner| Vector2::from(uvs.coordinates[corner as usize]));
        if (b - a).perp(&(c - a)).abs() > 0.0 {
            return [a, b, c];
        }
    }
    // From the corners in the order of their vertices: no rounding depends on the order in which the face names them.
    let mut order = [0, 1, 2];
    order.sort_unstable_by_key(|&corner| mesh.face(face)[corner]);
    let corners = order.map(|corner| mesh.face(face)[corner]).map(|vertex| match mesh.rest_positions() {
        Some(rest) => Point3::from(rest[vertex.index()]),
        None => frame.position(vertex),
    });
    let mut local = [Vector2::zeros(); 3];
    for (corner, place) in order.into_iter().zip(flat_triangle(corners)) {
        local[corner] = place;
    }
    local
}

/// A triangle in a plane of its own: its first corner in the origin, its second on the axis of x, its third at or above
/// it.
fn flat_triangle([a, b, c]: [Point3<f64>; 3]) -> [Vector2<f64>; 3] {
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
