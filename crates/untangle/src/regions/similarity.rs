//! Similarities of the plane: what places one triangle of an unfolding beside another.

use nalgebra::Vector2;

/// The map `z -> shift + turn * z` in complex numbers, or of the conjugate of `z` if mirrored.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Similarity {
    turn: Vector2<f64>,
    mirrored: bool,
    shift: Vector2<f64>,
}

impl Default for Similarity {
    fn default() -> Self {
        Self { turn: Vector2::new(1.0, 0.0), mirrored: false, shift: Vector2::zeros() }
    }
}

impl Similarity {
    /// A translation.
    pub(crate) fn translation(shift: Vector2<f64>) -> Self {
        Self { shift, ..Self::default() }
    }

    /// The image of a point.
    pub(crate) fn apply(&self, z: Vector2<f64>) -> Vector2<f64> {
        self.shift + complex_product(self.turn, conjugate_if(self.mirrored, z))
    }

    /// The map of a neighbouring triangle: `before` and `after` are the ends of the common edge and the third corner,
    /// in the plane of the triangle that this map places and in that of the neighbour. The neighbour comes to lie on
    /// the other side of the edge.
    pub(crate) fn continued(&self, before: [Vector2<f64>; 3], after: [Vector2<f64>; 3]) -> Self {
        let is_left = |[a, b, c]: [Vector2<f64>; 3]| (b - a).perp(&(c - a)) > 0.0;
        let flip = is_left(before) == is_left(after);
        let along = conjugate_if(flip, after[1] - after[0]);
        let squared = along.norm_squared();
        let relative = if squared > 0.0 {
            complex_product(before[1] - before[0], conjugate_if(true, along)) / squared
        } else {
            Vector2::new(1.0, 0.0)
        };
        let turn = complex_product(self.turn, conjugate_if(self.mirrored, relative));
        let mirrored = self.mirrored != flip;
        Self { turn, mirrored, shift: self.apply(before[0]) - complex_product(turn, conjugate_if(mirrored, after[0])) }
    }
}

/// The product of two complex numbers.
fn complex_product(a: Vector2<f64>, b: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

/// The conjugate of a complex number, or the number itself.
fn conjugate_if(conjugate: bool, z: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(z.x, if conjugate { -z.y } else { z.y })
}
