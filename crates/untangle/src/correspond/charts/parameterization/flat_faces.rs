//! The faces of a patch in the plane, with the weights that both systems take from their shapes.

use nalgebra::{Complex, Vector2};

use crate::correspond::{
    charts::{
        patch::Patch,
        shapes::{Shape, sides_of},
        unfolding::{Facing, Unfolding},
    },
    linalg::Band,
};

/// Smallest weight of a side, the largest being its inverse.
const SMALLEST_WEIGHT: f64 = 0.05;
/// Smallest area of a face as a part of its longest side squared.
const SMALLEST_AREA: f64 = 1e-3;

/// The faces to be parameterised, and where the unfolding puts their vertices.
///
/// The vertices of a narrow patch are numbered anew, in the order of its [`Band`].
#[derive(Debug, Default)]
pub(super) struct FlatFaces {
    pub(super) faces: Vec<FlatFace>,
    /// For each vertex its place in the unfolding, as a complex number.
    pub(super) start: Vec<Complex<f64>>,
    /// For each vertex whether it belongs to one of the faces.
    pub(super) is_used: Vec<bool>,
    /// The first corner of the first face, and the vertex farthest from it.
    pub(super) held: [usize; 2],
    band: Band,
    is_narrow: bool,
}

/// A reached face with its shape as it lies in the chart, at the scale of the unfolding.
#[derive(Debug)]
pub(super) struct FlatFace {
    pub(super) corners: [u32; 3],
    /// From corner `k` to the next.
    pub(super) sides: [Complex<f64>; 3],
    pub(super) area: f64,
    /// Half the cotangent of the angle opposite each side.
    pub(super) weights: [f64; 3],
}

impl FlatFaces {
    /// Takes all faces that an unfolding reached, each at its scale. False where there are none.
    pub(super) fn take(&mut self, patch: &Patch, shapes: &[Shape], unfolding: &Unfolding, scales: &[f64]) -> bool {
        self.faces.clear();
        let placed = unfolding.facing.iter().zip(scales);
        for ((corners, shape), (&facing, &scale)) in patch.corners().iter().zip(shapes).zip(placed) {
            if facing != Facing::Unreached {
                self.faces.push(FlatFace::new(*corners, *shape, facing == Facing::Mirrored, scale));
            }
        }
        if self.faces.is_empty() {
            return false;
        }
        self.start.clear();
        self.start.extend(unfolding.points.iter().map(|point| Complex::new(point.x, point.y)));
        self.is_used.clear();
        self.is_used.resize(self.start.len(), false);
        for corner in self.faces.iter().flat_map(|face| face.corners) {
            self.is_used[corner as usize] = true;
        }
        self.choose_held();
        self.number(unfolding);
        true
    }

    fn choose_held(&mut self) {
        let first = self.faces[0].corners[0] as usize;
        let mut second = (first, 0.0);
        for (vertex, place) in self.start.iter().enumerate() {
            let squared = (place - self.start[first]).norm_sqr();
            if self.is_used[vertex] && squared > second.1 {
                second = (vertex, squared);
            }
        }
        self.held = [first, second.0];
    }

    /// Numbers the vertices of a narrow patch along its band.
    fn number(&mut self, unfolding: &Unfolding) {
        self.is_narrow = self.band.find(self.start.len(), self.held[1], self.faces.iter().map(|face| face.corners));
        if !self.is_narrow {
            return;
        }
        let places = self.band.places();
        for corner in self.faces.iter_mut().flat_map(|face| &mut face.corners) {
            #[expect(clippy::cast_possible_truncation, reason = "a row is the number of a vertex, which fits")]
            let place = places[*corner as usize] as u32;
            *corner = place;
        }
        self.held = self.held.map(|vertex| places[vertex]);
        self.is_used.fill(false);
        for corner in self.faces.iter().flat_map(|face| face.corners) {
            self.is_used[corner as usize] = true;
        }
        for (&place, point) in places.iter().zip(&unfolding.points) {
            self.start[place] = Complex::new(point.x, point.y);
        }
    }

    /// The band of the patch, where it is narrow.
    pub(super) fn band(&self) -> Option<&Band> {
        self.is_narrow.then_some(&self.band)
    }

    /// Writes places back into an unfolding.
    pub(super) fn give_back(&self, places: &[Complex<f64>], unfolding: &mut Unfolding) {
        let slots = self.band.places();
        for (vertex, point) in unfolding.points.iter_mut().enumerate() {
            let place = places[if self.is_narrow { slots[vertex] } else { vertex }];
            (point.x, point.y) = (place.re, place.im);
        }
    }
}

impl FlatFace {
    fn new(corners: [u32; 3], mut shape: Shape, is_mirrored: bool, scale: f64) -> Self {
        if is_mirrored {
            for point in &mut shape {
                point.y = -point.y;
            }
        }
        let sides = sides_of(&shape).map(|side| side * scale);
        let longest = sides.iter().map(Vector2::norm_squared).fold(0.0, f64::max);
        let area = (0.5 * sides[0].perp(&sides[2])).abs().max(SMALLEST_AREA * longest);
        // The cotangent at the corner opposite side k, between the two other sides.
        let weights = [0, 1, 2].map(|k| {
            let cotangent = -sides[(k + 1) % 3].dot(&sides[(k + 2) % 3]) / (2.0 * area);
            (0.5 * cotangent).clamp(SMALLEST_WEIGHT, 1.0 / SMALLEST_WEIGHT)
        });
        Self { corners, sides: sides.map(|side| Complex::new(side.x, side.y)), area, weights }
    }

    /// The numbers of the corners.
    pub(super) fn vertices(&self) -> [usize; 3] {
        self.corners.map(|corner| corner as usize)
    }
}
