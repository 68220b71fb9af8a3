//! Unfolding: faces laid one against the other in the plane, along the path first, then outwards.
//!
//! Each face is put against a face that lies already, by the similarity of the plane that makes their common edge agree and leaves
//! them on different sides of it. One rule covers every source of shapes: texture coordinates without a seam come out as they are,
//! those with a seam or a period go on beyond it (also with a mirrored or scaled panel), and lengths give the isometric unfolding.

use std::collections::VecDeque;

use nalgebra::{Point2, Vector2};

use super::{
    patch::{Beyond, Patch},
    shapes::Shape,
};
use crate::mesh::Mesh;

/// Where the vertices and faces of a patch come to lie.
#[derive(Debug, Default)]
pub(crate) struct Unfolding {
    /// Place of each vertex of the patch; meaningless where no face of it was reached.
    pub(crate) points: Vec<Point2<f64>>,
    /// For each face of the patch, whether it was reached and lies as its shape does, or mirrored.
    pub(crate) facing: Vec<Facing>,
    /// Largest disagreement of a face with its shape, as a part of its longest side.
    pub(crate) misfit: f64,
    /// For each face, across which of its sides it was placed or placed another.
    pub(crate) tree: Vec<[bool; 3]>,
    /// For each face that was reached, which of its sides have no other face of the patch beyond them.
    pub(crate) rims: Vec<[bool; 3]>,
    /// Sum of all sides of the faces that were reached, as they lie.
    pub(crate) length: f64,
    /// For each face, which of its sides were looked at from beyond.
    seen: Vec<[bool; 3]>,
    /// The faces after the first in the order in which they were reached: from which one, across which side.
    reached_from: Vec<(usize, usize, usize)>,
    placed: Vec<bool>,
    path_queue: VecDeque<usize>,
    queue: VecDeque<usize>,
}

/// How a face came to lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Facing {
    /// Not connected to the first face by edges of the patch.
    Unreached,
    /// As its shape.
    Straight,
    /// As the mirror image of its shape.
    Mirrored,
}

impl Unfolding {
    /// Unfolds a patch from its first face. False where the patch is one-sided: no orientation fits, and no chart exists.
    pub(crate) fn unfold(&mut self, mesh: &Mesh, patch: &Patch, shapes: &[Shape]) -> bool {
        let num_faces = patch.faces().len();
        self.points.clear();
        self.points.resize(patch.vertices().len(), Point2::origin());
        self.placed.clear();
        self.placed.resize(patch.vertices().len(), false);
        self.tree.clear();
        self.tree.resize(num_faces, [false; 3]);
        self.rims.clear();
        self.rims.resize(num_faces, [false; 3]);
        self.seen.clear();
        self.seen.resize(num_faces, [false; 3]);
        self.facing.clear();
        self.facing.resize(num_faces, Facing::Unreached);
        self.reached_from.clear();
        self.misfit = 0.0;
        self.path_queue.clear();
        self.queue.clear();
        if num_faces == 0 {
            return false;
        }
        for (&vertex, &point) in patch.corners()[0].iter().zip(&shapes[0]) {
            self.points[vertex as usize] = point;
            self.placed[vertex as usize] = true;
        }
        self.facing[0] = Facing::Straight;
        self.path_queue.push_back(0);
        let mut orientable = true;
        while let Some(face) = self.path_queue.pop_front().or_else(|| self.queue.pop_front()) {
            for side in 0..3 {
                if self.seen[face][side] {
                    continue;
                }
                let Some(beyond) = patch.beyond(mesh, face, side) else {
                    self.rims[face][side] = true;
                    continue;
                };
                let Beyond { face: next, side: there, is_same_way } = beyond;
                self.seen[next][there] = true;
                let facing = turned(self.facing[face], is_same_way, shapes, face, next);
                match self.facing[next] {
                    Facing::Unreached => {
                        self.facing[next] = facing;
                        self.tree[face][side] = true;
                        self.tree[next][there] = true;
                        self.place(patch, shapes, [face, side], beyond);
                        self.reached_from.push((next, face, side));
                        if next < patch.num_seeds() {
                            self.path_queue.push_back(next);
                        } else {
                            self.queue.push_back(next);
                        }
                    }
                    known => orientable &= known == facing,
                }
            }
        }
        self.measure_misfit(patch, shapes);
        orientable && self.points.iter().all(|point| point.x.is_finite() && point.y.is_finite())
    }

    /// Writes for each face the scale of its shape in the chart: 1 for the first, equal lengths along common edges.
    pub(crate) fn scales(&self, patch: &Patch, shapes: &[Shape], scales: &mut Vec<f64>) {
        scales.clear();
        scales.resize(shapes.len(), 1.0);
        for &(next, face, side) in &self.reached_from {
            scales[next] = scales[face] * ratio_of_sides(patch, shapes, face, side, next);
        }
    }

    /// Adds up the sides anew, after points were moved.
    pub(crate) fn measure_length(&mut self, patch: &Patch) {
        let reached = patch.corners().iter().enumerate().filter(|&(face, _)| self.is_reached(face));
        self.length = reached.fold(0.0, |length, (_, &[a, b, c])| {
            let (a, b, c) = (self.points[a as usize], self.points[b as usize], self.points[c as usize]);
            length + ((b - a).norm() + (c - b).norm() + (a - c).norm())
        });
    }

    /// Whether a face has a place.
    pub(crate) fn is_reached(&self, face: usize) -> bool {
        self.facing[face] != Facing::Unreached
    }

    /// Places the third vertex of what lies beyond a side of a face, unless it lies already.
    fn place(&mut self, patch: &Patch, shapes: &[Shape], [face, side]: [usize; 2], beyond: Beyond) {
        let corners = patch.corners()[face];
        let (a, b) = (corners[side], corners[(side + 1) % 3]);
        let Beyond { face: next, side: there, is_same_way } = beyond;
        let ends = [there, (there + 1) % 3];
        let [at_a, at_b] = if is_same_way { ends } else { [ends[1], ends[0]] };
        let at_c = (there + 2) % 3;
        let c = patch.corners()[next][at_c] as usize;
        if self.placed[c] {
            return;
        }
        self.placed[c] = true;
        let shape = &shapes[next];
        let ratio = complex_ratio(shape[at_c] - shape[at_a], shape[at_b] - shape[at_a]);
        let (from, to) = (self.points[a as usize], self.points[b as usize]);
        let edge = to - from;
        let behind = edge.perp(&(self.points[corners[(side + 2) % 3] as usize] - from));
        let height = if behind > 0.0 { -ratio.y.abs() } else { ratio.y.abs() };
        self.points[c] = from + edge * ratio.x + Vector2::new(-edge.y, edge.x) * height;
    }

    /// Compares the sides of every face with those of its shape at the best common scale.
    fn measure_misfit(&mut self, patch: &Patch, shapes: &[Shape]) {
        let (mut length, mut misfit) = (0.0, 0.0f64);
        for ((corners, shape), &facing) in patch.corners().iter().zip(shapes).zip(&self.facing) {
            if facing == Facing::Unreached {
                continue;
            }
            let [a, b, c] = *corners;
            let lies = [self.points[a as usize], self.points[b as usize], self.points[c as usize]];
            let sides = |at: &Shape| ((at[1] - at[0]).norm(), (at[2] - at[1]).norm(), (at[0] - at[2]).norm());
            let ((p, q, r), (a, b, c)) = (sides(&lies), sides(shape));
            length += p + q + r;
            let scale = (p + q + r) / (a + b + c).max(f64::MIN_POSITIVE);
            let most = (p - a * scale).abs().max((q - b * scale).abs()).max((r - c * scale).abs());
            misfit = misfit.max(most / p.max(q).max(r).max(f64::MIN_POSITIVE));
        }
        (self.length, self.misfit) = (length, misfit);
    }
}

/// `a / b` as complex numbers; zero for a zero divisor.
fn complex_ratio(a: Vector2<f64>, b: Vector2<f64>) -> Vector2<f64> {
    let squared = b.norm_squared();
    if squared > 0.0 { Vector2::new(a.dot(&b), b.perp(&a)) / squared } else { Vector2::zeros() }
}

/// Length of a common edge in the shape of `face` over that in the shape of `next`; 1 where it has none.
fn ratio_of_sides(patch: &Patch, shapes: &[Shape], face: usize, side: usize, next: usize) -> f64 {
    let ends = [patch.corners()[face][side], patch.corners()[face][(side + 1) % 3]];
    let mut there = [Point2::origin(); 2];
    for (&vertex, &point) in patch.corners()[next].iter().zip(&shapes[next]) {
        for (end, slot) in ends.iter().zip(&mut there) {
            if *end == vertex {
                *slot = point;
            }
        }
    }
    let ratio = (shapes[face][(side + 1) % 3] - shapes[face][side]).norm() / (there[1] - there[0]).norm();
    if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
}

/// How a face must lie beside a neighbour that lies as `known`, so that they don't overlap.
fn turned(known: Facing, is_same_way: bool, shapes: &[Shape], face: usize, next: usize) -> Facing {
    let winding = |at: usize| {
        let [a, b, c] = shapes[at];
        (b - a).perp(&(c - a)) >= 0.0
    };
    // The winding in the plane is that of the shape, mirrored or not; neighbours of one direction of travel need opposite ones.
    let lies = winding(face) == (known == Facing::Straight);
    let must = lies != is_same_way;
    if winding(next) == must { Facing::Straight } else { Facing::Mirrored }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        correspond::samples::{all_faces, sheet, sheet_faces},
        mesh::{Mesh, MeshDescription},
    };

    fn whole(mesh: &Mesh) -> Patch {
        let mut patch = Patch::default();
        patch.start(mesh, all_faces(mesh).into_iter());
        patch
    }

    fn shapes_of(patch: &Patch, points: &[Point2<f64>]) -> Vec<Shape> {
        patch.corners().iter().map(|c| c.map(|v| points[patch.vertices()[v as usize].index()])).collect()
    }

    fn distance_error(patch: &Patch, unfolding: &Unfolding, flat: &[Point2<f64>], scale: f64) -> f64 {
        let first = flat[patch.vertices()[0].index()];
        let mut worst: f64 = 0.0;
        for (vertex, point) in patch.vertices().iter().zip(&unfolding.points) {
            let expected = (flat[vertex.index()] - first).norm() * scale;
            worst = worst.max(((point - unfolding.points[0]).norm() - expected).abs());
        }
        worst
    }

    #[test]
    fn a_flat_sheet_unfolds_to_itself_whatever_the_winding() {
        let (_, flat) = sheet(6, 5, 0.1);
        let mut faces = sheet_faces(6, 5);
        for face in faces.iter_mut().step_by(3) {
            face.swap(1, 2);
        }
        let mesh = Mesh::new(MeshDescription { num_vertices: flat.len(), faces, ..Default::default() }).unwrap();
        let patch = whole(&mesh);
        let shapes = shapes_of(&patch, &flat);
        let mut unfolding = Unfolding::default();
        assert!(unfolding.unfold(&mesh, &patch, &shapes));
        assert!(unfolding.misfit < 1e-12);
        assert!(distance_error(&patch, &unfolding, &flat, 1.0) < 1e-12);
    }

    #[test]
    fn panels_of_an_atlas_are_joined_across_their_seam() {
        let (mesh, flat) = sheet(6, 5, 0.1);
        let patch = whole(&mesh);
        let mut shapes = shapes_of(&patch, &flat);
        // The right half is another panel: mirrored, turned, half as large, elsewhere.
        for shape in &mut shapes {
            if shape.iter().map(|p| p.x).sum::<f64>() > 0.9 {
                *shape = shape.map(|p| Point2::new(7.0 + 0.5 * p.y, 3.0 + 0.5 * p.x));
            }
        }
        let mut unfolding = Unfolding::default();
        assert!(unfolding.unfold(&mesh, &patch, &shapes));
        assert!(unfolding.misfit < 1e-12);
        assert!(distance_error(&patch, &unfolding, &flat, 1.0) < 1e-12);
    }

    #[test]
    fn a_cone_does_not_close_and_a_moebius_band_has_no_side() {
        // Five equilateral triangles round a vertex.
        let faces = (0..5).map(|k| [5, k, (k + 1) % 5]).collect();
        let mesh = Mesh::new(MeshDescription { num_vertices: 6, faces, ..Default::default() }).unwrap();
        let patch = whole(&mesh);
        let shape = [Point2::new(0.0, 0.0), Point2::new(1.0, 0.0), Point2::new(0.5, 0.75f64.sqrt())];
        let mut unfolding = Unfolding::default();
        assert!(unfolding.unfold(&mesh, &patch, &[shape; 5]));
        assert!(unfolding.misfit > 0.2, "{}", unfolding.misfit);
        let faces = vec![[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]];
        let mesh = Mesh::new(MeshDescription { num_vertices: 5, faces, ..Default::default() }).unwrap();
        assert!(!unfolding.unfold(&mesh, &whole(&mesh), &[shape; 5]));
    }
}
