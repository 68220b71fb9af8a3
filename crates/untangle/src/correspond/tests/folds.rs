//! Targets on folded sheets, where the true one is known: the layers `u` and `-u` meet, so that (u, v) belongs to (-u,
//! v).

use nalgebra::Point2;

use super::samples::sheet_faces;
use crate::{
    analysis::analyse,
    correspond::{Correspondent, MaterialPoint, ShapeSource},
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
    paths::PathType,
    settings::Settings,
};

/// A sheet of `count x count` squares over [-1, 1]^2, a little askew, mapped by
/// `(u, v) -> (|u| smoothed, v, tanh(u / 0.3) g(u, v) / 2)`: it intersects itself where `g`, even in `u`, is zero.
/// With `narrow` the half `u < 0` is cut to `|v| < 0.7`.
fn folded(
    count: u32,
    with_uvs: bool,
    narrow: bool,
    level: impl Fn(f64, f64) -> f64,
) -> (Mesh, Frame, Vec<Point2<f64>>) {
    let mut flat = Vec::new();
    for row in 0..=count {
        for column in 0..=count {
            let (x, y) = (f64::from(column) / f64::from(count), f64::from(row) / f64::from(count));
            let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
            // Askew, so that no vertex lies on the line of the fold.
            flat.push(Point2::new(u + 0.03 * (5.0 * v).sin() + 0.011, v + 0.02 * (4.0 * u).sin()));
        }
    }
    let mut faces = sheet_faces(count, count);
    if narrow {
        faces.retain(|face| {
            face.iter().all(|&corner| flat[corner as usize].x > -0.2 || flat[corner as usize].y.abs() < 0.7)
        });
    }
    let uvs = with_uvs.then(|| Uvs { coordinates: flat.iter().map(|p| [p.x, p.y]).collect(), corners: faces.clone() });
    let mesh = Mesh::new(MeshDescription { num_vertices: flat.len(), faces, uvs, ..Default::default() }).unwrap();
    let fold = |p: &Point2<f64>| {
        let x = (p.x * p.x + 0.04).sqrt();
        [x, p.y, 0.5 * (p.x / 0.3).tanh() * level(p.x, p.y)]
    };
    let positions: Vec<_> = flat.iter().map(fold).collect();
    let frame = Frame::new(&mesh, &positions).unwrap();
    (mesh, frame, flat)
}

fn ellipse(u: f64, v: f64) -> f64 {
    (u / 0.6).powi(2) + (v / 0.5).powi(2) - 1.0
}

/// Mean distance of the targets from the true ones, in edge lengths, and the number of targets.
fn error(
    mesh: &Mesh,
    frame: &Frame,
    flat: &[Point2<f64>],
    edge: f64,
    expected: PathType,
    source: ShapeSource,
) -> (f64, usize) {
    let analysis = analyse(mesh, frame);
    let mut correspondent = Correspondent::default();
    let found = correspondent.find(mesh, frame, &analysis, &Settings::default(), &mut ());
    let at = |point: &MaterialPoint| {
        let places = point.vertices.iter().zip(point.weights);
        places.fold(Point2::origin(), |sum, (vertex, weight)| sum + flat[vertex.index()].coords * weight)
    };
    let path = found.paths.iter().find(|path| analysis.paths.copies[path.copy].path_type == expected).unwrap();
    assert_eq!(path.own_chart.source, source);
    assert_eq!(path.rank_deficiency, 0);
    let attractions = &found.attractions[path.attractions.clone()];
    let mut sum = 0.0;
    for attraction in attractions {
        let (from, to) = (at(&attraction.source), at(&attraction.target));
        sum += (to - Point2::new(-from.x, from.y)).norm();
    }
    let mean = sum / attractions.len() as f64 / edge;
    println!(
        "{expected:?} from {source:?}: {mean:.3} edges over {} targets, {} centres",
        attractions.len(),
        path.num_centres
    );
    (mean, attractions.len())
}

#[test]
fn targets_of_loop_with_uvs_are_mirror_images() {
    for (count, bound) in [(20, 0.12), (40, 0.12)] {
        let (mesh, frame, flat) = folded(count, true, false, ellipse);
        let edge = 2.0 / f64::from(count);
        let (error, targets) = error(&mesh, &frame, &flat, edge, PathType::LoopLoop, ShapeSource::Uvs);
        assert!(targets > 50 && error < bound, "{count}: {error} edges over {targets} targets");
    }
}

#[test]
fn targets_of_flap_with_straight_paths_are_mirror_images() {
    // Both paths are straight, so that only the centres beside them determine the map across.
    for with_uvs in [true, false] {
        let (mesh, frame, flat) = folded(30, with_uvs, true, |u, _| u * u - 0.25);
        let source = if with_uvs { ShapeSource::Uvs } else { ShapeSource::Current };
        let (error, targets) = error(&mesh, &frame, &flat, 2.0 / 30.0, PathType::BoundaryBoundary, source);
        let bound = if with_uvs { 0.05 } else { 0.1 };
        assert!(targets > 50 && error < bound, "{error} edges over {targets} targets");
    }
}

#[test]
fn targets_of_loop_without_uvs_are_near_mirror_images() {
    let (mesh, frame, flat) = folded(30, false, false, ellipse);
    let (error, targets) = error(&mesh, &frame, &flat, 2.0 / 30.0, PathType::LoopLoop, ShapeSource::Current);
    assert!(targets > 50 && error < 0.6, "{error} edges over {targets} targets");
}

#[test]
fn separations_of_pair_with_two_regions_count_each_length_once() {
    let (mesh, frame, _) = folded(24, true, false, ellipse);
    let analysis = analyse(&mesh, &frame);
    let mut correspondent = Correspondent::default();
    let found = correspondent.find(&mesh, &frame, &analysis, &Settings::default(), &mut ());
    let separated: f64 = found.separations.iter().map(|separation| separation.length_m).sum();
    let length: f64 = analysis.paths.pairs.iter().map(|pair| pair.length_m).sum();
    assert!((separated - length).abs() < 1e-9 * length, "{separated} of {length}");
    for separation in &found.separations {
        for point in [&separation.own, &separation.partner] {
            assert!((point.position(&frame) - separation.position).norm() < 1e-12);
        }
        assert!((separation.direction.norm() - 1.0).abs() < 1e-12);
    }
}
