//! How much two states of a mesh differ.

use nalgebra::Point3;
use untangle::mesh::Mesh;

/// Displacements in percent of the diagonal of the bounding box, and ratios to the state before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Change {
    pub(crate) mean_percent: f64,
    pub(crate) most_percent: f64,
    /// Least and greatest ratio of an edge's length.
    pub(crate) shortest: f64,
    pub(crate) longest: f64,
    /// Least ratio of a face's area.
    pub(crate) smallest: f64,
    /// Vertices whose bits are others, in percent.
    pub(crate) moved_percent: f64,
}

impl Change {
    pub(crate) fn between(mesh: &Mesh, before: &[[f64; 3]], after: &[[f64; 3]]) -> Self {
        let [mean_percent, most_percent, moved_percent] = displacements(before, after);
        let (shortest, longest) = edge_ratios(mesh, before, after);
        let smallest = least_area_ratio(mesh, before, after);
        Self { mean_percent, most_percent, shortest, longest, smallest, moved_percent }
    }

    /// The edge ratio that is farthest from 1.
    pub(crate) fn worst_edge(&self) -> f64 {
        if self.longest.ln() > -self.shortest.ln() { self.longest } else { self.shortest }
    }
}

fn point(positions: &[[f64; 3]], vertex: u32) -> Point3<f64> {
    Point3::from(positions[vertex as usize])
}

/// Mean and largest displacement, and how many vertices moved, all in percent.
fn displacements(before: &[[f64; 3]], after: &[[f64; 3]]) -> [f64; 3] {
    let low = before.iter().fold([f64::INFINITY; 3], |low, p| std::array::from_fn(|k| low[k].min(p[k])));
    let high = before.iter().fold([f64::NEG_INFINITY; 3], |high, p| std::array::from_fn(|k| high[k].max(p[k])));
    let diagonal = (Point3::from(high) - Point3::from(low)).norm();
    let (mut sum, mut most, mut moved, mut count) = (0.0, 0.0f64, 0.0, 0.0);
    for (a, b) in before.iter().zip(after) {
        let length = (Point3::from(*b) - Point3::from(*a)).norm();
        sum += length;
        most = most.max(length);
        moved += if a.map(f64::to_bits) == b.map(f64::to_bits) { 0.0 } else { 1.0 };
        count += 1.0;
    }
    [sum / count / diagonal, most / diagonal, moved / count].map(|part| 100.0 * part)
}

fn edge_ratios(mesh: &Mesh, before: &[[f64; 3]], after: &[[f64; 3]]) -> (f64, f64) {
    let ratios = mesh.edge_ids().map(|edge| {
        let [a, b] = mesh.edge(edge).map(|vertex| vertex.0);
        let length = |positions: &[[f64; 3]]| (point(positions, b) - point(positions, a)).norm();
        length(after) / length(before)
    });
    ratios
        .filter(|ratio| ratio.is_finite())
        .fold((1.0, 1.0), |(least, most), ratio| (least.min(ratio), most.max(ratio)))
}

fn least_area_ratio(mesh: &Mesh, before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
    let ratios = mesh.face_ids().map(|face| {
        let area = |positions: &[[f64; 3]]| {
            let [a, b, c] = mesh.face(face).map(|vertex| point(positions, vertex.0));
            (b - a).cross(&(c - a)).norm()
        };
        area(after) / area(before)
    });
    ratios.filter(|ratio| ratio.is_finite()).fold(1.0, f64::min)
}
