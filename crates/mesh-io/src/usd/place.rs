//! Where the vertices of a mesh are: from the singles that its points are stored in to metres in the world, and back.

use std::ops::Range;

use nalgebra::{Matrix4, RowVector4, Vector4};

/// Bits of a coordinate in the world that a grid of local coordinates leaves for the error of its transform.
const SPARE_BITS: i32 = 7;

/// The place of one mesh at one time.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub(crate) vertices: Range<usize>,
    to_world: Matrix4<f64>,
    from_world: Matrix4<f64>,
    /// Whether local coordinates are those of the world.
    pub(crate) is_identity: bool,
}

impl Place {
    /// Nothing for a transform that can't be inverted, or that is none of points.
    pub(crate) fn new(vertices: Range<usize>, to_world: Matrix4<f64>) -> Option<Self> {
        let from_world = to_world.try_inverse().filter(|inverse| inverse.iter().all(|value| value.is_finite()))?;
        let is_affine = to_world.row(3) == RowVector4::new(0.0, 0.0, 0.0, 1.0);
        let is_identity = to_world == Matrix4::identity();
        is_affine.then_some(Self { vertices, to_world, from_world, is_identity })
    }

    /// A stored point in the world.
    pub(crate) fn to_world(&self, local: [f32; 3]) -> [f64; 3] {
        let local = local.map(f64::from);
        if self.is_identity { local } else { apply(&self.to_world, local) }
    }

    /// A point of the world as it is stored; nothing if it is beyond single precision.
    ///
    /// Local coordinates are rounded to a grid that is coarser than the error of going there and back, so that a point
    /// that was stored and read is stored as what it was. The grid is some 10^-13 of the largest coordinate.
    pub(crate) fn stored(&self, world: [f64; 3], largest: f64) -> Option<[f32; 3]> {
        let local = if self.is_identity {
            world
        } else {
            apply(&self.from_world, world).map(|value| self.snap(value, largest))
        };
        #[expect(clippy::cast_possible_truncation, reason = "the file holds single precision")]
        let stored = local.map(|value| value as f32);
        stored.iter().all(|value| value.is_finite()).then_some(stored)
    }

    fn snap(&self, value: f64, largest: f64) -> f64 {
        let norm = |matrix: &Matrix4<f64>| matrix.fixed_view::<3, 3>(0, 0).abs().row_sum().max();
        let reach = norm(&self.from_world) * (largest + self.to_world.fixed_view::<3, 1>(0, 3).amax());
        let error = 16.0 * f64::EPSILON * reach.max(f64::MIN_POSITIVE);
        let grid = libm::exp2(libm::ceil(libm::log2(error)) + f64::from(SPARE_BITS - 4));
        if grid.is_normal() { (value / grid).round() * grid } else { value }
    }
}

fn apply(matrix: &Matrix4<f64>, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let world = matrix * Vector4::new(x, y, z, 1.0);
    [world.x, world.y, world.z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::float_cmp, reason = "what is stored and read is the same number")]
    fn point_that_was_stored_and_read_is_stored_as_what_it_was() {
        let mut matrix = Matrix4::new_rotation(nalgebra::Vector3::new(0.3, 1.1, -0.7)) * 0.01;
        matrix[(3, 3)] = 1.0;
        matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&nalgebra::Vector3::new(120.0, -3.0, 4000.0));
        let place = Place::new(0..1, matrix).unwrap();
        for number in 0..10_000 {
            let number = f64::from(number);
            let world = [120.0 + number.sin() / (1.0 + number), -3.0 + 1e-9 * number, 4000.0 + number.cos()];
            let stored = place.stored(world, 4001.0).unwrap();
            let read = place.to_world(stored);
            assert!(world.iter().zip(read).all(|(a, b)| (a - b).abs() < 1e-7), "{world:?} {read:?}");
            assert_eq!(place.stored(read, 4001.0).unwrap(), stored);
        }
    }
}
