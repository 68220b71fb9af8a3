//! How much a repair changes the cloth.

use nalgebra::{Point3, distance};
use untangle::mesh::Mesh;
use untangled_proto::RepairHeader;

/// Fills in how far vertices move, and how edges and faces change. Edges without length and faces without area before
/// are left out.
#[expect(clippy::float_cmp, reason = "what did not move has the same bits")]
pub(super) fn measure(header: &mut RepairHeader, mesh: &Mesh, before: &[[f64; 3]], after: &[[f64; 3]]) {
    let points = |positions: &[[f64; 3]], index: usize| Point3::from(positions[index]);
    let (mut sum, mut largest, mut num_moved) = (0.0, 0.0f64, 0u32);
    for (before, after) in before.iter().zip(after) {
        if before != after {
            let length = distance(&Point3::from(*before), &Point3::from(*after));
            (sum, largest, num_moved) = (sum + length, largest.max(length), num_moved + 1);
        }
    }
    header.num_moved = num_moved;
    header.max_displacement_m = largest;
    header.mean_displacement_m = sum / f64::from(num_moved.max(1));
    let edges = mesh.edge_ids().map(|edge| {
        let ends = mesh.edge(edge);
        [before, after].map(|positions| {
            let [a, b] = ends.map(|vertex| points(positions, vertex.index()));
            distance(&a, &b)
        })
    });
    [header.min_edge_ratio, header.max_edge_ratio] = extremes(edges);
    let faces = mesh.face_ids().map(|face| {
        let corners = mesh.face(face);
        [before, after].map(|positions| {
            let [a, b, c] = corners.map(|vertex| points(positions, vertex.index()));
            (b - a).cross(&(c - a)).norm()
        })
    });
    header.min_area_ratio = extremes(faces)[0];
}

/// The least and the largest ratio of a measure after to the same before; 1 where there is none.
fn extremes(pairs: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    let ratios = pairs.filter(|[before, _]| *before > 0.0).map(|[before, after]| after / before);
    let extremes = ratios.fold([f64::INFINITY, 0.0], |[least, most], ratio| [ratio.min(least), ratio.max(most)]);
    if extremes[0].is_finite() { extremes } else { [1.0; 2] }
}
