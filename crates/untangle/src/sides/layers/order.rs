//! The order of pieces that lie over each other, where nobody says it: each pair as most of it lies.
//!
//! Two garments half an edge apart intersect in many places, and each path by itself does not show which of them lies
//! outside. Their areas do: where one is over the other along a good part of its area, and most of that is on the outer
//! side, it is the outer one. Pieces that have no such order go with the one that they are nearest to.

use std::collections::BTreeMap;

use nalgebra::Point3;
use rayon::prelude::*;

use super::{REACH, normals::OutwardNormals, outwards::outwards};
use crate::{
    frame::Frame,
    intersect::Intersections,
    mesh::{FaceId, Mesh, PieceId},
    sides::{Sides, surface::Surface},
};

/// Two surfaces lie over each other where their normals differ by less than 45 degrees, or more than 135.
const LEAST_COSINE: f64 = 0.7;
/// Of a pair that has an order at least this part of one piece's area lies over the other one.
const LEAST_COVER: f64 = 1.0 / 3.0;
/// And less than this part of it is on the wrong side.
const CLEAR: f64 = 0.45;
/// Corners of a piece at which it is asked what it is nearest to, at most.
const SAMPLES: usize = 32;

/// Pieces that intersect and lie over each other, in the order in which most of each lies.
#[derive(Clone, Debug)]
pub struct ImpliedLayers {
    /// The mesh with these layers, and with what is outwards decided.
    pub mesh: Mesh,
    /// For each pair of pieces that intersect a face of the inner one and a face of the outer one.
    pub orders: Vec<[FaceId; 2]>,
}

impl ImpliedLayers {
    /// What a state shows in which something intersects. Pieces without a boundary, and bodies, have no order. Nothing
    /// where no others intersect, one pair of them has no clear order, the orders form a circle, or layers are given.
    ///
    /// Cost: O(n log n) in the faces for each pair, in parallel.
    #[must_use]
    pub fn of(mesh: &Mesh, frame: &Frame, found: &Intersections) -> Option<Self> {
        let meetings = if mesh.layers().is_none() { meetings(mesh, found) } else { Vec::new() };
        if meetings.is_empty() {
            return None;
        }
        let pieces = Pieces::of(mesh, frame);
        let surface = |piece: PieceId| Some((piece, Surface::new(&pieces.triangles(piece))?));
        let surfaces: BTreeMap<PieceId, Surface> =
            meetings.iter().flatten().filter_map(|&piece| surface(piece)).collect();
        let orders: Option<Vec<[PieceId; 2]>> =
            meetings.iter().map(|&meeting| pieces.inner_first(&surfaces, meeting)).collect();
        let orders = orders?;
        let mut numbers = numbers(&orders)?;
        for index in 0..mesh.num_pieces() {
            let piece = PieceId(u32::try_from(index).ok()?);
            let is_cloth = !pieces.faces[index].iter().any(|&face| mesh.is_body_face(face));
            if is_cloth && !numbers.contains_key(&piece) {
                let nearest = pieces.nearest(&surfaces, piece)?;
                numbers.insert(piece, numbers[&nearest]);
            }
        }
        let mut layers = vec![0; mesh.num_vertices()];
        for face in mesh.face_ids() {
            if let Some(piece) = mesh.piece(face) {
                let number = numbers.get(&piece).copied().unwrap_or(0);
                mesh.face(face).iter().for_each(|vertex| layers[vertex.index()] = number);
            }
        }
        let orders = orders.iter().map(|order| order.map(|piece| pieces.faces[piece.index()][0])).collect();
        Some(Self { mesh: mesh.with_layers(layers).with_outwards(Some(&pieces.outwards)), orders })
    }
}

/// The pairs of pieces with a boundary that intersect each other, in order; no bodies.
fn meetings(mesh: &Mesh, found: &Intersections) -> Vec<[PieceId; 2]> {
    let closed = mesh.closed_pieces();
    let of_cloth = found.segments.iter().filter(|segment| !segment.faces.iter().any(|&face| mesh.is_body_face(face)));
    let pieces = of_cloth.filter_map(|segment| match segment.faces.map(|face| mesh.piece(face)) {
        [Some(a), Some(b)] if a != b && !closed[a.index()] && !closed[b.index()] => Some([a.min(b), a.max(b)]),
        _ => None,
    });
    let mut meetings: Vec<[PieceId; 2]> = pieces.collect();
    meetings.sort_unstable();
    meetings.dedup();
    meetings
}

/// The pieces of a mesh in a state.
struct Pieces<'a> {
    mesh: &'a Mesh,
    positions: &'a [Point3<f64>],
    outwards: Vec<bool>,
    /// Of each piece.
    faces: Vec<Vec<FaceId>>,
}

impl<'a> Pieces<'a> {
    fn of(mesh: &'a Mesh, frame: &'a Frame) -> Self {
        let mut faces = vec![Vec::new(); mesh.num_pieces()];
        for face in mesh.face_ids() {
            if let Some(piece) = mesh.piece(face) {
                faces[piece.index()].push(face);
            }
        }
        Self {
            mesh,
            positions: frame.positions(),
            outwards: outwards(mesh, frame, Sides::of(mesh, frame).as_ref()),
            faces,
        }
    }

    fn triangle(&self, face: FaceId) -> [Point3<f64>; 3] {
        self.mesh.face(face).map(|vertex| self.positions[vertex.index()])
    }

    fn triangles(&self, piece: PieceId) -> Vec<[Point3<f64>; 3]> {
        self.faces[piece.index()].iter().map(|&face| self.triangle(face)).collect()
    }

    /// Two pieces, the inner one first; nothing where that is not clear.
    fn inner_first(&self, surfaces: &BTreeMap<PieceId, Surface>, [a, b]: [PieceId; 2]) -> Option<[PieceId; 2]> {
        let shares = [[a, b], [b, a]].map(|[inner, outer]| self.cover(surfaces, inner, outer));
        let covered = shares.iter().map(|cover| cover.part).fold(0.0, f64::max);
        let [b_outside, a_outside] = shares.map(|cover| cover.behind);
        if covered < LEAST_COVER || b_outside.min(a_outside) >= CLEAR {
            return None;
        }
        Some(if b_outside <= a_outside { [a, b] } else { [b, a] })
    }

    /// How much of one piece lies over another one.
    fn cover(&self, surfaces: &BTreeMap<PieceId, Surface>, inner: PieceId, outer: PieceId) -> Cover {
        let Some(surface) = surfaces.get(&inner) else { return Cover { part: 0.0, behind: 1.0 } };
        let Self { mesh, positions, ref outwards, ref faces } = *self;
        let normals = OutwardNormals { mesh, positions, outwards };
        let reach_m = REACH * diagonal_m(&self.triangles(inner));
        let look = |&face: &FaceId| {
            let [a, b, c] = self.triangle(face);
            let area_m2 = 0.5 * (b - a).cross(&(c - a)).norm();
            let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
            let over = surface.closest(middle, |_| true).and_then(|place| {
                let to_surface = place.point - middle;
                let normal = normals.normal(faces[inner.index()][place.triangle], place.barycentric)?;
                let is_over = to_surface.norm() <= reach_m && normal.dot(&normals.unit(face)).abs() > LEAST_COSINE;
                is_over.then(|| to_surface.dot(&normal) > 0.0)
            });
            (area_m2, over)
        };
        let looks: Vec<(f64, Option<bool>)> = faces[outer.index()].par_iter().map(look).collect();
        let area_m2 = |is_counted: &dyn Fn(Option<bool>) -> bool| -> f64 {
            looks.iter().filter(|look| is_counted(look.1)).map(|look| look.0).sum()
        };
        let (all_m2, over_m2) = (area_m2(&|_| true), area_m2(&|over| over.is_some()));
        let behind_m2 = area_m2(&|over| over == Some(true));
        let part = |of: f64, whole: f64, without: f64| if whole > 0.0 { of / whole } else { without };
        Cover { part: part(over_m2, all_m2, 0.0), behind: part(behind_m2, over_m2, 1.0) }
    }

    /// The one of some pieces that the corners of another one are nearest to, on the average.
    fn nearest(&self, surfaces: &BTreeMap<PieceId, Surface>, piece: PieceId) -> Option<PieceId> {
        let corners: Vec<Point3<f64>> = self.triangles(piece).concat();
        let corners: Vec<Point3<f64>> = corners.iter().copied().step_by(corners.len() / SAMPLES + 1).collect();
        let sum_m = |surface: &Surface| -> f64 {
            let distance_m =
                |&at: &Point3<f64>| surface.closest(at, |_| true).map_or(0.0, |place| (place.point - at).norm());
            let distances: Vec<f64> = corners.par_iter().map(distance_m).collect();
            distances.iter().sum()
        };
        let sums = surfaces.iter().map(|(&piece, surface)| (piece, sum_m(surface)));
        sums.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(piece, _)| piece)
    }
}

/// How one piece lies over another one.
#[derive(Clone, Copy, Debug)]
struct Cover {
    /// The part of its area that does.
    part: f64,
    /// The part of this that is behind the other one.
    behind: f64,
}

/// The number of each piece: greater than those of all that lie inside of it. Nothing where the orders form a circle.
fn numbers(orders: &[[PieceId; 2]]) -> Option<BTreeMap<PieceId, u32>> {
    let mut numbers: BTreeMap<PieceId, u32> = orders.iter().flatten().map(|&piece| (piece, 0)).collect();
    for _ in 0..=numbers.len() {
        let mut is_done = true;
        for [inner, outer] in orders {
            if numbers[outer] <= numbers[inner] {
                numbers.insert(*outer, numbers[inner] + 1);
                is_done = false;
            }
        }
        if is_done {
            return Some(numbers);
        }
    }
    None
}

fn diagonal_m(triangles: &[[Point3<f64>; 3]]) -> f64 {
    let corners = || triangles.iter().flatten();
    let Some(first) = corners().next() else { return 0.0 };
    let (low, high) = corners().fold((*first, *first), |(low, high), at| (low.inf(at), high.sup(at)));
    (high - low).norm()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::{intersect::Intersector, mesh::MeshDescription};

    /// Tubes along an axis, each of a radius with waves, a place along the axis, and a sense of its faces.
    fn tubes(tubes: &[(f64, f64, [f64; 3], bool)]) -> (Mesh, Frame) {
        const STEPS: u32 = 24;
        let (mut positions, mut faces) = (Vec::new(), Vec::new());
        for &(radius_m, wave_m, [x, y, z], is_turned) in tubes {
            let first = u32::try_from(positions.len()).unwrap();
            for k in 0..STEPS * STEPS {
                let [u, v] = [k % STEPS, k / STEPS].map(f64::from);
                let angle = TAU * u / f64::from(STEPS);
                let radius_m = radius_m + wave_m * (3.0 * angle + 0.5 * v).sin();
                positions.push([x + 0.1 * v, y + radius_m * angle.cos(), z + radius_m * angle.sin()]);
            }
            for k in (0..STEPS * (STEPS - 1)).map(|k| (k / STEPS, k % STEPS)) {
                let at = |i: u32, j: u32| first + (k.0 + j) * STEPS + (k.1 + i) % STEPS;
                for [a, b, c] in [[at(0, 0), at(1, 0), at(1, 1)], [at(0, 0), at(1, 1), at(0, 1)]] {
                    faces.push(if is_turned { [a, c, b] } else { [a, b, c] });
                }
            }
        }
        let num_vertices = positions.len();
        let mesh = Mesh::new(MeshDescription { num_vertices, faces, ..Default::default() }).unwrap();
        let frame = Frame::new(&mesh, &positions).unwrap();
        (mesh, frame)
    }

    /// The layer of each piece, where there are any.
    fn layers(given: &[(f64, f64, [f64; 3], bool)]) -> Option<Vec<u32>> {
        let (mesh, frame) = tubes(given);
        let mut found = Intersections::default();
        Intersector::default().intersect(&mesh, &frame, &mut found);
        let ImpliedLayers { mesh, orders } = ImpliedLayers::of(&mesh, &frame, &found)?;
        let numbers = mesh.layers().unwrap();
        let number = |face: FaceId| numbers[mesh.face(face)[0].index()];
        assert!(orders.iter().all(|&[inner, outer]| number(inner) < number(outer)));
        Some(numbers.iter().step_by(24 * 24).copied().collect())
    }

    #[test]
    fn tube_that_is_wider_for_the_most_part_is_the_outer_one_however_faces_run() {
        for turned in [false, true] {
            let inner = (1.0, 0.0, [0.0; 3], false);
            let outer = (1.03, 0.1, [0.0; 3], turned);
            assert_eq!(layers(&[inner, outer]), Some(vec![0, 1]));
            assert_eq!(layers(&[outer, inner]), Some(vec![1, 0]));
        }
    }

    #[test]
    fn tubes_that_lie_half_outside_of_each_other_or_beside_each_other_have_no_order() {
        let tube = |radius_m: f64, wave_m: f64, y: f64| (radius_m, wave_m, [0.0, y, 0.0], false);
        assert_eq!(layers(&[tube(1.0, 0.0, 0.0), tube(1.0, 0.1, 0.0)]), None);
        assert_eq!(layers(&[tube(1.0, 0.0, 0.0), tube(1.0, 0.0, 1.9)]), None);
        assert_eq!(layers(&[tube(1.0, 0.0, 0.0), tube(1.1, 0.0, 0.0)]), None);
    }

    #[test]
    fn pieces_without_an_order_go_with_the_one_that_is_nearest() {
        let tube = |radius_m: f64, wave_m: f64, x: f64| (radius_m, wave_m, [x, 0.0, 0.0], false);
        let outfit = [tube(1.05, 0.0, 0.0), tube(1.0, 0.1, 0.0), tube(1.4, 0.0, 0.5), tube(0.8, 0.0, 0.2)];
        assert_eq!(layers(&outfit), Some(vec![1, 0, 1, 0]));
    }

    #[test]
    fn orders_in_a_circle_are_none() {
        let [a, b, c] = [0, 1, 2].map(PieceId);
        assert_eq!(numbers(&[[a, b], [b, c], [c, a]]), None);
        let numbers = numbers(&[[b, c], [a, b]]).unwrap();
        assert_eq!([a, b, c].map(|piece| numbers[&piece]), [0, 1, 2]);
    }
}
