//! Charts of rolled sheets and of tubes, whose flat coordinates are known.

use nalgebra::Point2;

use super::{Chart, ChartKind, ShapeSource};
use crate::{
    correspond::{
        material_point::MaterialPoint,
        samples::{sheet, sheet_faces, tube},
    },
    frame::Frame,
    mesh::{EdgeId, FaceId, Mesh, MeshDescription, Uvs, VertexId},
    paths::SurfacePoint,
};

/// A 6 x 6 sheet rolled into a quarter of a cylinder.
fn rolled(rest: bool, uvs: Option<Uvs>) -> (Mesh, Frame, Vec<Point2<f64>>) {
    let (_, flat) = sheet(6, 6, 0.1);
    let rest_positions = rest.then(|| flat.iter().map(|p| [p.x, p.y, 0.0]).collect());
    let mesh = Mesh::new(MeshDescription {
        num_vertices: flat.len(),
        faces: sheet_faces(6, 6),
        rest_positions,
        uvs,
        ..Default::default()
    })
    .unwrap();
    let positions: Vec<_> = flat.iter().map(|p| [(p.x * 2.0).sin() * 0.5, p.y, (p.x * 2.0).cos() * 0.5]).collect();
    let frame = Frame::new(&mesh, &positions).unwrap();
    (mesh, frame, flat)
}

/// Asserts that the chart round a face has the distances of the flat sheet, and finds its vertices again.
fn check(mesh: &Mesh, frame: &Frame, flat: &[Point2<f64>], source: ShapeSource, tolerance: f64) {
    let mut chart = Chart::default();
    chart.patch_mut().start(mesh, [FaceId(30)].into_iter());
    chart.patch_mut().grow(mesh, 2, usize::MAX);
    assert_eq!(chart.build(mesh, frame), Some(ChartKind { source, relaxed: false, cut: false }));
    let seed = mesh.face(FaceId(30))[0];
    for vertex in mesh.vertex_ids() {
        let Some(point) = chart.vertex(vertex) else { continue };
        let distance = (point - chart.vertex(seed).unwrap()).norm();
        let expected = (flat[vertex.index()] - flat[seed.index()]).norm();
        assert!((distance - expected).abs() < tolerance, "{vertex:?}: {distance} {expected}");
        let found = chart.locate(mesh, point).unwrap();
        let back = found.vertices.iter().position(|&v| v == vertex).unwrap();
        assert!(found.weights[back] > 1.0 - 1e-9);
    }
}

#[test]
fn chart_takes_uvs_before_rest_lengths_before_current_ones() {
    let (mesh, frame, flat) = rolled(false, None);
    check(&mesh, &frame, &flat, ShapeSource::Current, 2e-3);
    let (mesh, frame, flat) = rolled(true, None);
    check(&mesh, &frame, &flat, ShapeSource::Rest, 1e-3);
    let coordinates: Vec<_> = flat.iter().map(|p| [p.x * 8.0, p.y * 8.0]).collect();
    let uvs = Uvs { coordinates, corners: sheet_faces(6, 6) };
    let (mesh, frame, flat) = rolled(false, Some(uvs));
    check(&mesh, &frame, &flat, ShapeSource::Uvs, 1e-3);
    let uvs = Uvs { coordinates: vec![[0.5, 0.5]; flat.len()], corners: sheet_faces(6, 6) };
    let (mesh, frame, flat) = rolled(false, Some(uvs));
    check(&mesh, &frame, &flat, ShapeSource::Current, 2e-3);
}

#[test]
fn chart_has_coordinates_for_places_of_its_faces_only() {
    let (mesh, frame, _) = rolled(false, None);
    let mut chart = Chart::default();
    chart.patch_mut().start(&mesh, [FaceId(0)].into_iter());
    chart.build(&mesh, &frame).unwrap();
    let [a, b] = mesh.edge(EdgeId(0));
    let place = SurfacePoint::Edge { edge: EdgeId(0), parameter: 0.5 };
    let middle = chart.point_in(&mesh, FaceId(0), &place).unwrap();
    let expected = nalgebra::center(&chart.vertex(a).unwrap(), &chart.vertex(b).unwrap());
    assert!((middle - expected).norm() < 1e-15);
    let place = SurfacePoint::Face { face: FaceId(0), barycentric: [0.0, 1.0, 0.0] };
    assert_eq!(chart.point_in(&mesh, FaceId(0), &place), chart.vertex(mesh.face(FaceId(0))[1]));
    assert_eq!(chart.point_in(&mesh, FaceId(1), &place), None);
    assert_eq!(chart.material_point(&mesh, &MaterialPoint::vertex(VertexId(48))), None);
}

#[test]
fn chart_of_tube_is_cut_open_with_the_girth_as_period() {
    let (columns, rows) = (24, 10);
    let mut positions = Vec::new();
    for row in 0..=rows {
        for column in 0..columns {
            let angle = f64::from(column) / f64::from(columns) * std::f64::consts::TAU;
            positions.push([angle.cos(), angle.sin(), 0.2 * f64::from(row)]);
        }
    }
    let mesh = tube(columns, rows);
    let frame = Frame::new(&mesh, &positions).unwrap();
    let mut chart = Chart::default();
    chart.patch_mut().start(&mesh, [FaceId(200)].into_iter());
    chart.patch_mut().grow(&mesh, 40, usize::MAX);
    let kind = chart.build(&mesh, &frame).unwrap();
    assert_eq!(kind, ChartKind { source: ShapeSource::Current, relaxed: false, cut: true });
    let girth = f64::from(columns) * 2.0 * (std::f64::consts::PI / f64::from(columns)).sin();
    let period = chart.period().unwrap();
    for vertex in mesh.vertex_ids() {
        let point = chart.vertex(vertex).unwrap();
        let next = period.apply(point);
        assert!(((next - point).norm() - girth).abs() < 1e-9);
        for point in [point, next, period.power(-1).apply(point)] {
            let found = chart.locate(&mesh, point).unwrap();
            assert!((found.position(&frame) - frame.position(vertex)).norm() < 1e-9);
        }
    }
}
