//! BI paths: push the intersection over the nearest boundary.
//!
//! Equations 5 to 7 of Wicke, Lanker and Gross (2006), with these differences: the distance to the boundary is measured along the surface in
//! its present lengths, so that its gradient is a direction of the world at once; the magnitude is the `min` law with the offset; and
//! the force acts on the path itself, spread over the corners of its faces, against its opposite in the same place of the other
//! sheet, so that angular momentum is kept too.

use std::{cmp::Ordering, collections::BinaryHeap};

use nalgebra::{Vector2, Vector3};

use super::forces::ForceLaw;
use crate::{
    correspond::{Chart, MaterialPoint, Patch},
    frame::Frame,
    mesh::{FaceId, Mesh},
    paths::{PathPoint, PathSegment},
};

/// A mean below this part of the mean magnitude counts as cancelled: the path straddles the line from which two boundaries are
/// equally far.
const CANCELLED: f64 = 0.3;

/// Which of the two sheets along a path is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Over {
    /// The sheet of the path.
    Own,
    /// The sheet of the corresponding path.
    Partner,
}

/// Distances to the boundary over a patch of the cloth.
#[derive(Debug, Default)]
pub(crate) struct BoundaryPush {
    chart: Chart,
    patch: Patch,
    distances: Vec<f64>,
    done: Vec<bool>,
    is_wanted: Vec<bool>,
    heap: BinaryHeap<Candidate>,
}

/// A path to be pushed, and the law that says how far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PushedPath<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) points: &'a [PathPoint],
    pub(crate) segments: &'a [PathSegment],
    pub(crate) law: ForceLaw,
    pub(crate) edge_length_m: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Candidate {
    distance: f64,
    vertex: usize,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        // The heap gives the largest first.
        other.distance.total_cmp(&self.distance).then(other.vertex.cmp(&self.vertex))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl BoundaryPush {
    /// Writes for each segment the displacement of one step, in metres, towards the boundary of the sheet `over`: the mean over the path,
    /// taken in a chart, so that it follows a sheet that bends. Returns the mean distance to the boundary in metres; nothing, and zeros,
    /// where no boundary is near or the directions cancel.
    ///
    /// Cost: linear in the faces within one and a half path lengths of the path, and O(n log n) in those of them that are no farther from
    /// a boundary than the path.
    pub(crate) fn steps(&mut self, path: &PushedPath<'_>, over: Over, steps: &mut Vec<Vector3<f64>>) -> Option<f64> {
        let PushedPath { mesh, frame, points, segments, law, edge_length_m } = *path;
        steps.clear();
        steps.resize(segments.len(), Vector3::zeros());
        let length: f64 = points.windows(2).map(|pair| (pair[1].position - pair[0].position).norm()).sum();
        let face_of = |segment: &PathSegment| if over == Over::Own { segment.own } else { segment.partner };
        self.chart.patch_mut().start(mesh, segments.iter().map(face_of));
        self.chart.patch_mut().grow(mesh, 1, usize::MAX);
        self.chart.build(mesh, frame)?;
        // The path itself ends on a boundary, so none that counts is farther than its length.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates, which is what is wanted"
        )]
        let rings = ((1.5 * length / edge_length_m).ceil() as usize).saturating_add(3);
        self.patch.start(mesh, segments.iter().map(face_of));
        self.patch.grow(mesh, rings, usize::MAX);
        if !self.march(mesh, frame, segments.iter().map(face_of)) {
            return None;
        }
        let (mut mean, mut magnitude, mut depth) = (Vector2::zeros(), 0.0, 0.0);
        for (index, segment) in segments.iter().enumerate() {
            let (start, end) = (&points[index], &points[index + 1]);
            let places = if over == Over::Own { [&start.own, &end.own] } else { [&start.partner, &end.partner] };
            let face = face_of(segment);
            let slope = MaterialPoint::middle(mesh, face, places).and_then(|at| self.slope(mesh, frame, face, &at));
            let Some((distance, downhill)) = slope else { continue };
            let Some(downhill) = self.chart.to_chart(mesh, frame, face, downhill) else { continue };
            let part = (end.position - start.position).norm() / length;
            let step = law.step(distance) * part;
            depth += distance * part;
            mean += downhill * step;
            magnitude += step;
        }
        if mean.norm() <= CANCELLED * magnitude {
            return None;
        }
        for (step, segment) in steps.iter_mut().zip(segments) {
            if let Some(direction) = self.chart.to_world(mesh, frame, face_of(segment), mean) {
                *step = direction * mean.norm();
            }
        }
        Some(depth)
    }

    /// Distance to the boundary at a point of a face and the unit direction in which it shrinks fastest.
    fn slope(&self, mesh: &Mesh, frame: &Frame, face: FaceId, at: &MaterialPoint) -> Option<(f64, Vector3<f64>)> {
        let mut values = [0.0; 3];
        for (value, vertex) in values.iter_mut().zip(mesh.face(face)) {
            *value = self.distances[self.patch.local_vertex(vertex)?];
        }
        let distance = values.iter().zip(at.weights).map(|(value, weight)| value * weight).sum::<f64>();
        let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex));
        let normal = (b - a).cross(&(c - a));
        // Gradient of the linear function: each value times the height direction of its corner.
        let gradient = normal.cross(&(c - b)) * values[0]
            + normal.cross(&(a - c)) * values[1]
            + normal.cross(&(b - a)) * values[2];
        let downhill = (-gradient).try_normalize(0.0)?;
        (distance.is_finite() && downhill.iter().all(|value| value.is_finite())).then_some((distance, downhill))
    }

    /// Fast marching from the boundary over the patch (Kimmel and Sethian 1998), until the distances of the corners of `faces` are known.
    /// False where the patch has no boundary.
    fn march(&mut self, mesh: &Mesh, frame: &Frame, faces: impl Iterator<Item = FaceId>) -> bool {
        let count = self.patch.vertices().len();
        self.is_wanted.clear();
        self.is_wanted.resize(count, false);
        let mut num_wanted = 0usize;
        for vertex in faces.flat_map(|face| mesh.face(face)) {
            if let Some(vertex) = self.patch.local_vertex(vertex)
                && !std::mem::replace(&mut self.is_wanted[vertex], true)
            {
                num_wanted += 1;
            }
        }
        self.distances.clear();
        self.distances.resize(count, f64::INFINITY);
        self.done.clear();
        self.done.resize(count, false);
        self.heap.clear();
        for vertex in 0..count {
            if mesh.is_boundary_vertex(self.patch.vertices()[vertex]) {
                self.distances[vertex] = 0.0;
                self.heap.push(Candidate { distance: 0.0, vertex });
            }
        }
        let found = !self.heap.is_empty();
        while let Some(Candidate { vertex, .. }) = self.heap.pop() {
            if std::mem::replace(&mut self.done[vertex], true) {
                continue;
            }
            num_wanted -= usize::from(self.is_wanted[vertex]);
            if num_wanted == 0 {
                break;
            }
            for &face in mesh.vertex_faces(self.patch.vertices()[vertex]) {
                let Some(local) = self.patch.local_face(face) else { continue };
                let corners = self.patch.corners()[local].map(|corner| corner as usize);
                for k in 0..3 {
                    let (target, others) = (corners[k], [corners[(k + 1) % 3], corners[(k + 2) % 3]]);
                    if self.done[target] {
                        continue;
                    }
                    let distance = self.update(mesh, frame, target, others);
                    if distance < self.distances[target] {
                        self.distances[target] = distance;
                        self.heap.push(Candidate { distance, vertex: target });
                    }
                }
            }
        }
        found
    }

    fn is_boundary_edge(&self, mesh: &Mesh, [a, b]: [usize; 2]) -> bool {
        let [a, b] = [a, b].map(|vertex| self.patch.vertices()[vertex]);
        mesh.edge_between(a, b).is_some_and(|edge| mesh.is_boundary_edge(edge))
    }

    /// The distance of a vertex through the triangle with two others: by a straight front where it enters between them, else along a side.
    fn update(&self, mesh: &Mesh, frame: &Frame, target: usize, others: [usize; 2]) -> f64 {
        let at = |vertex: usize| frame.position(self.patch.vertices()[vertex]);
        let known = others.map(|vertex| if self.done[vertex] { self.distances[vertex] } else { f64::INFINITY });
        let sides = others.map(|vertex| at(vertex) - at(target));
        let along_sides = (known[0] + sides[0].norm()).min(known[1] + sides[1].norm());
        if !(known[0].is_finite() && known[1].is_finite()) {
            return along_sides;
        }
        // An inner edge from boundary to boundary cuts a corner: the front does not start all along it.
        if known.iter().all(|&distance| distance <= 0.0) && !self.is_boundary_edge(mesh, others) {
            return along_sides;
        }
        // The front is the plane wave with slope 1 through both values: |Q^-1 (values - d)| = 1 in the frame of the two sides.
        let (aa, ab, bb) = (sides[0].norm_squared(), sides[0].dot(&sides[1]), sides[1].norm_squared());
        let determinant = aa * bb - ab * ab;
        if determinant <= 1e-12 * aa * bb {
            return along_sides;
        }
        let inverse = |x: [f64; 2], y: [f64; 2]| {
            (bb * x[0] * y[0] - ab * (x[0] * y[1] + x[1] * y[0]) + aa * x[1] * y[1]) / determinant
        };
        let (ones, values) = ([1.0; 2], known);
        let (p, q, r) = (inverse(ones, ones), inverse(ones, values), inverse(values, values) - 1.0);
        let root = q * q - p * r;
        if root < 0.0 || p <= 0.0 {
            return along_sides;
        }
        let distance = (q + root.sqrt()) / p;
        let slack = [distance - known[0], distance - known[1]];
        // The direction against the front, in the frame of the sides, must point between them.
        let enters = [bb * slack[0] - ab * slack[1], aa * slack[1] - ab * slack[0]];
        if enters.iter().all(|&part| part >= 0.0) { distance.min(along_sides) } else { along_sides }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MeshDescription, VertexId};

    #[test]
    fn distances_to_the_boundary_of_a_sheet() {
        let mut positions = Vec::new();
        let mut faces = Vec::new();
        for row in 0..13u32 {
            for column in 0..11u32 {
                positions.push([f64::from(column) * 0.1, f64::from(row) * 0.1, 0.0]);
                if row < 12 && column < 10 {
                    let a = row * 11 + column;
                    faces.push([a, a + 1, a + 11]);
                    faces.push([a + 11, a + 1, a + 12]);
                }
            }
        }
        let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }).unwrap();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let mut push = BoundaryPush::default();
        push.patch.start(&mesh, mesh.face_ids());
        assert!(push.march(&mesh, &frame, mesh.face_ids()));
        for (vertex, [x, y, _]) in (0u32..).zip(positions) {
            let expected = x.min(1.0 - x).min(y).min(1.2 - y);
            let found = push.distances[push.patch.local_vertex(VertexId(vertex)).unwrap()];
            // Where two fronts meet, the last edge is cut short; nowhere is the way longer than it is.
            assert!(found < expected + 1e-9 && found > expected - 0.05, "vertex {vertex}: {found} {expected}");
        }
        // Stopping where the corners of a face are known changes nothing there.
        let all = push.distances.clone();
        let face = FaceId(2 * (5 * 10 + 2));
        assert!(push.march(&mesh, &frame, [face].into_iter()));
        for vertex in mesh.face(face).map(|vertex| push.patch.local_vertex(vertex).unwrap()) {
            assert!(push.done[vertex] && push.distances[vertex].to_bits() == all[vertex].to_bits());
        }
        assert!(push.done.iter().any(|done| !done));
        // Left of the middle it shrinks to the left.
        let at = MaterialPoint { vertices: mesh.face(face), weights: [0.4, 0.3, 0.3] };
        let (distance, downhill) = push.slope(&mesh, &frame, face, &at).unwrap();
        assert!((distance - at.position(&frame).x).abs() < 0.03);
        assert!((downhill + Vector3::x()).norm() < 0.1);
    }
}
