//! The faces of a patch in the plane, with the weights that both systems take from their shapes.

use nalgebra::{Point2, Vector2};

use crate::correspond::charts::{
    patch::Patch,
    shapes::{Shape, sides_of},
    unfolding::{Facing, Unfolding},
};

/// Smallest weight of a side, the largest being its inverse.
const SMALLEST_WEIGHT: f64 = 0.05;
/// Smallest area of a face as a part of its longest side squared.
const SMALLEST_AREA: f64 = 1e-3;

/// The faces to be parameterised, and where the unfolding puts their vertices.
#[derive(Debug, Default)]
pub(super) struct FlatFaces {
    pub(super) faces: Vec<FlatFace>,
    /// For each vertex of the patch its place in the unfolding.
    pub(super) start: Vec<Point2<f64>>,
    /// For each vertex whether it belongs to one of the faces.
    pub(super) is_used: Vec<bool>,
}

/// A reached face with its shape as it lies in the chart, at the scale of the unfolding.
#[derive(Debug)]
pub(super) struct FlatFace {
    pub(super) corners: [usize; 3],
    /// From corner `k` to the next.
    pub(super) sides: [Vector2<f64>; 3],
    pub(super) area: f64,
    /// Half the cotangent of the angle opposite each side.
    pub(super) weights: [f64; 3],
}

impl FlatFaces {
    /// Takes all faces that an unfolding reached, each at its scale.
    pub(super) fn take(&mut self, patch: &Patch, shapes: &[Shape], unfolding: &Unfolding, scales: &[f64]) {
        self.start.clear();
        self.start.extend_from_slice(&unfolding.points);
        self.faces.clear();
        let placed = unfolding.facing.iter().zip(scales);
        for ((corners, shape), (&facing, &scale)) in patch.corners().iter().zip(shapes).zip(placed) {
            if facing != Facing::Unreached {
                let is_mirrored = facing == Facing::Mirrored;
                self.faces.push(FlatFace::new(corners.map(|vertex| vertex as usize), *shape, is_mirrored, scale));
            }
        }
        self.is_used.clear();
        self.is_used.resize(self.start.len(), false);
        for corner in self.faces.iter().flat_map(|face| face.corners) {
            self.is_used[corner] = true;
        }
    }
}

impl FlatFace {
    fn new(corners: [usize; 3], mut shape: Shape, is_mirrored: bool, scale: f64) -> Self {
        if is_mirrored {
            for point in &mut shape {
                point.y = -point.y;
            }
        }
        let sides = sides_of(&shape).map(|side| side * scale);
        let longest = sides.iter().map(Vector2::norm).fold(0.0, f64::max);
        let area = (0.5 * sides[0].perp(&sides[2])).abs().max(SMALLEST_AREA * longest.powi(2));
        // The cotangent at the corner opposite side k, between the two other sides.
        let weights = [0, 1, 2].map(|k| {
            let cotangent = -sides[(k + 1) % 3].dot(&sides[(k + 2) % 3]) / (2.0 * area);
            (0.5 * cotangent).clamp(SMALLEST_WEIGHT, 1.0 / SMALLEST_WEIGHT)
        });
        Self { corners, sides, area, weights }
    }
}
