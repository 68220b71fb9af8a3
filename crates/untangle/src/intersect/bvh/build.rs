//! Order of the faces: top-down median splits along the longest axis.

use super::aabb::WIDTH;
use crate::mesh::FaceId;

/// Sorts faces so that neighbours in space are neighbours in the array.
///
/// Each split leaves a power of two on its left side, so that the implicit nodes of every level are unions of splits.
pub(super) fn sort_by_median_splits(faces: &mut [FaceId], centroid: &dyn Fn(FaceId) -> [f64; 3]) {
    if faces.len() <= WIDTH {
        return;
    }
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for &face in faces.iter() {
        for (axis, value) in centroid(face).into_iter().enumerate() {
            low[axis] = low[axis].min(value);
            high[axis] = high[axis].max(value);
        }
    }
    let extent = |axis: usize| high[axis] - low[axis];
    let axis = (1..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best });
    let half = faces.len().div_ceil(2).next_power_of_two().min(faces.len() - 1);
    faces.select_nth_unstable_by(half, |&a, &b| centroid(a)[axis].total_cmp(&centroid(b)[axis]).then(a.cmp(&b)));
    let (left, right) = faces.split_at_mut(half);
    sort_by_median_splits(left, centroid);
    sort_by_median_splits(right, centroid);
}
