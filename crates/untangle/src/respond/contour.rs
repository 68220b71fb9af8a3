//! Contour minimisation: forces down the gradient of the length of a path, after Volino and Magnenat-Thalmann (2006),
//! here with the exact gradient.
//!
//! At an edge-face intersection `P = (1-t) x0 + t x1 = sum beta_k y_k`, with the unit direction `E` of the edge, the
//! normal `N` of the face, the sum `R` of the unit directions in which the path leaves `P`, and `c = (E.R) / (E.N)`,
//! the length changes by `-(1-t)(R - cN)` for `x0`, `-t(R - cN)` for `x1`, `-beta_k c N` for `y_k`; in a loop vertex by
//! `-R`. All forces at `P` sum up to `-R` for any `c`, so that momenta are kept also where `c` is regularised.

use nalgebra::Vector3;

use crate::{
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{PathPoint, SurfacePoint},
};

/// Regularises `c` where an edge is nearly parallel to the face that it pierces: `c = (E.R)(E.N) / ((E.N)^2 + GUARD)`.
pub(crate) const GUARD: f64 = 0.04;

/// Calls `add` with vertices and the gradient, with respect to their positions, of the world length of a path:
/// dimensionless, and several times for one vertex.
pub(crate) fn length_gradient(
    mesh: &Mesh,
    frame: &Frame,
    points: &[PathPoint],
    closed: bool,
    guard: f64,
    mut add: impl FnMut(VertexId, Vector3<f64>),
) {
    let count = if closed { points.len() - 1 } else { points.len() };
    for (index, point) in points.iter().enumerate().take(count) {
        let leaving = leaving_directions(points, index, closed);
        let pierced = match (point.own, point.partner) {
            (SurfacePoint::Edge { edge, parameter }, SurfacePoint::Face { face, barycentric })
            | (SurfacePoint::Face { face, barycentric }, SurfacePoint::Edge { edge, parameter }) => {
                directions(mesh, frame, edge, face).map(|directions| (edge, parameter, face, barycentric, directions))
            }
            _ => None,
        };
        let Some((edge, parameter, face, barycentric, (along, normal))) = pierced else {
            // A loop vertex, or two boundaries in exact contact: each sheet takes its half.
            for place in [&point.own, &point.partner] {
                spread(mesh, place, leaving * -0.5, &mut add);
            }
            continue;
        };
        let incidence = along.dot(&normal);
        let squared = incidence * incidence + guard;
        let c = if squared > 0.0 { along.dot(&leaving) * incidence / squared } else { 0.0 };
        let slide = leaving - normal * c;
        let [start, end] = mesh.edge(edge);
        add(start, slide * (parameter - 1.0));
        add(end, slide * -parameter);
        for (vertex, weight) in mesh.face(face).into_iter().zip(barycentric) {
            add(vertex, normal * (-weight * c));
        }
    }
}

/// The sum of the unit directions in which a path leaves one of its points.
fn leaving_directions(points: &[PathPoint], index: usize, closed: bool) -> Vector3<f64> {
    let last = points.len() - 1;
    let direction = |from: usize, to: usize| {
        (points[to].position - points[from].position).try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    };
    let mut leaving = Vector3::zeros();
    if index < last {
        leaving += direction(index, index + 1);
    }
    if index > 0 {
        leaving += direction(index, index - 1);
    } else if closed {
        leaving += direction(0, last - 1);
    }
    leaving
}

/// Spreads a vector over the vertices of a place.
fn spread(mesh: &Mesh, place: &SurfacePoint, vector: Vector3<f64>, add: &mut impl FnMut(VertexId, Vector3<f64>)) {
    match *place {
        SurfacePoint::Vertex(vertex) => add(vertex, vector),
        SurfacePoint::Edge { edge, parameter } => {
            for (vertex, weight) in mesh.edge(edge).into_iter().zip([1.0 - parameter, parameter]) {
                add(vertex, vector * weight);
            }
        }
        SurfacePoint::Face { face, barycentric } => {
            for (vertex, weight) in mesh.face(face).into_iter().zip(barycentric) {
                add(vertex, vector * weight);
            }
        }
    }
}

/// Unit direction of an edge and unit normal of a face; nothing where one of them has none.
fn directions(mesh: &Mesh, frame: &Frame, edge: EdgeId, face: FaceId) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let [start, end] = mesh.edge(edge).map(|vertex| frame.position(vertex));
    let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex));
    Some(((end - start).try_normalize(0.0)?, (b - a).cross(&(c - a)).try_normalize(0.0)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{analysis::analyse, mesh::MeshDescription};

    /// A strip that passes through a sheet at an angle: a BB/II pair of many segments.
    fn scene() -> (Mesh, Vec<[f64; 3]>) {
        let mut positions = Vec::new();
        let mut faces = Vec::new();
        for row in 0..6u32 {
            for column in 0..6u32 {
                let (x, y) = (f64::from(column) * 0.2 - 0.5, f64::from(row) * 0.21 - 0.5);
                positions.push([x, y, 0.03 * (7.0 * x + 3.0 * y).sin()]);
                if row < 5 && column < 5 {
                    let a = row * 6 + column;
                    faces.push([a, a + 1, a + 6]);
                    faces.push([a + 6, a + 1, a + 7]);
                }
            }
        }
        for row in 0..5u32 {
            for column in 0..3u32 {
                let (x, z) = (f64::from(column) * 0.17 - 0.19, f64::from(row) * 0.19 - 0.31);
                positions.push([x + 0.1 * z, 0.02 + 0.4 * z + 0.3 * x, z]);
                if row < 4 && column < 2 {
                    let a = 36 + row * 3 + column;
                    faces.push([a, a + 1, a + 3]);
                    faces.push([a + 3, a + 1, a + 4]);
                }
            }
        }
        let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }).unwrap();
        (mesh, positions)
    }

    fn length(mesh: &Mesh, positions: &[[f64; 3]]) -> f64 {
        let analysis = analyse(mesh, &Frame::new(mesh, positions).unwrap());
        assert_eq!(analysis.paths.pairs.len(), 1);
        analysis.paths.pairs[0].length_m
    }

    #[test]
    fn length_gradient_agrees_with_finite_differences() {
        let (mesh, mut positions) = scene();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let analysis = analyse(&mesh, &frame);
        let path = &analysis.paths.copies[0];
        let mut gradient = vec![Vector3::zeros(); mesh.num_vertices()];
        let points = &analysis.paths.points[path.points.clone()];
        assert!(points.len() > 5);
        length_gradient(&mesh, &frame, points, path.closed, 0.0, |vertex, part| gradient[vertex.index()] += part);
        let step = 1e-6;
        let mut largest: f64 = 0.0;
        for vertex in 0..mesh.num_vertices() {
            for axis in 0..3 {
                let kept = positions[vertex][axis];
                positions[vertex][axis] = kept + step;
                let ahead = length(&mesh, &positions);
                positions[vertex][axis] = kept - step;
                let behind = length(&mesh, &positions);
                positions[vertex][axis] = kept;
                let expected = (ahead - behind) / (2.0 * step);
                assert!((gradient[vertex][axis] - expected).abs() < 1e-8, "vertex {vertex}, axis {axis}");
                largest = largest.max(expected.abs());
            }
        }
        assert!(largest > 0.1);
        assert!(gradient.iter().sum::<Vector3<f64>>().norm() < 1e-12);
    }
}
