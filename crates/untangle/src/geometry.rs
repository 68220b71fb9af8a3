//! Plane and space geometry that several modules need in the same arithmetic, operation by operation: numbers, never
//! decisions.

use nalgebra::{Point, Point2, Point3, Vector2, Vector3};

use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
};

/// The product of two vectors as complex numbers: rotates and scales one by the other.
#[inline]
pub(crate) fn complex_product(a: Vector2<f64>, b: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x)
}

/// `a / b` as complex numbers: the rotation and scale that takes `b` to `a`. Zero for a zero divisor.
#[inline]
pub(crate) fn complex_quotient(a: Vector2<f64>, b: Vector2<f64>) -> Vector2<f64> {
    let squared = b.norm_squared();
    if squared > 0.0 { conjugate_product(b, a) / squared } else { Vector2::zeros() }
}

/// The conjugate of `a` times `b` as complex numbers: their scalar product and their cross product.
#[inline]
pub(crate) fn conjugate_product(a: Vector2<f64>, b: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(a.dot(&b), a.perp(&b))
}

/// A vector turned by a quarter to the left.
#[inline]
pub(crate) fn left_normal(direction: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}

/// A triangle of space in a plane of its own, its lengths kept: first corner at the origin, first side along the first
/// axis, the third corner not below it.
///
/// The disc of BLI paths and the flattening flow take flat triangles of their own: the same shape, rounded in another
/// way.
#[inline]
pub(crate) fn flat_triangle([a, b, c]: [Point3<f64>; 3]) -> [Point2<f64>; 3] {
    let side = b - a;
    let length = side.norm();
    let other = c - a;
    let along = if length > 0.0 { side / length } else { Vector3::x() };
    let x = other.dot(&along);
    let height = (other - along * x).norm();
    [Point2::origin(), Point2::new(length, 0.0), Point2::new(x, height)]
}

/// The sum of the sides of a triangle, in the plane or in space.
#[inline]
pub(crate) fn perimeter<const D: usize>([a, b, c]: [Point<f64, D>; 3]) -> f64 {
    (b - a).norm() + (c - b).norm() + (a - c).norm()
}

/// Mean length of the sides of some faces, in metres, a face that is named twice counted twice. Nothing where it is
/// zero, not finite, or there are no faces.
pub(crate) fn mean_edge_length(mesh: &Mesh, frame: &Frame, faces: impl Iterator<Item = FaceId>) -> Option<f64> {
    let (mut sum, mut num_edges) = (0.0, 0.0);
    for face in faces {
        sum += perimeter(mesh.face(face).map(|vertex| frame.position(vertex)));
        num_edges += 3.0;
    }
    let mean = sum / num_edges;
    (mean.is_finite() && mean > 0.0).then_some(mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshDescription;

    #[test]
    fn complex_quotient_of_product_is_first_factor() {
        let (a, b) = (Vector2::new(1.0, 2.0), Vector2::new(-0.5, 0.25));
        assert!((complex_quotient(complex_product(a, b), b) - a).norm() < 1e-15);
        assert_eq!(complex_product(Vector2::y(), a), left_normal(a));
        assert_eq!(complex_quotient(a, Vector2::zeros()), Vector2::zeros());
    }

    #[test]
    fn flat_triangle_keeps_lengths_and_takes_points_and_segments() {
        let corners = [Point3::new(1.0, 2.0, 3.0), Point3::new(2.0, 0.0, 3.5), Point3::new(0.0, 1.0, 5.0)];
        let [a, b, c] = flat_triangle(corners);
        assert!((perimeter([a, b, c]) - perimeter(corners)).abs() < 1e-12);
        assert!(((c - a).norm() - (corners[2] - corners[0]).norm()).abs() < 1e-12 && c.y > 0.0);
        let point = flat_triangle([corners[0], corners[0], corners[2]]);
        assert_eq!(point[1], Point2::origin());
        assert!((point[2].coords.norm() - (corners[2] - corners[0]).norm()).abs() < 1e-12);
    }

    #[test]
    fn mean_edge_length_of_no_face_or_a_point_is_none() {
        let description =
            MeshDescription { num_vertices: 6, faces: vec![[0, 1, 2], [3, 4, 5]], ..MeshDescription::default() };
        let mesh = Mesh::new(description).unwrap();
        let positions = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0; 3], [1.0; 3], [1.0; 3]];
        let frame = Frame::new(&mesh, &positions).unwrap();
        let mean = |faces: &[u32]| mean_edge_length(&mesh, &frame, faces.iter().map(|&face| FaceId(face)));
        assert_eq!((mean(&[0, 0]), mean(&[]), mean(&[1])), (Some(4.0), None, None));
    }
}
