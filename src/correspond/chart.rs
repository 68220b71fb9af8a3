//! Charts: 2D coordinates of a part of the cloth, roughly in metres.

use nalgebra::{Point2, Vector2, Vector3};

use super::{
    MaterialPoint,
    locate::Locator,
    patch::Patch,
    relax::relax,
    shapes::{self, Shape, ShapeSource},
    unfold::{Facing, Unfolding},
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
    paths::SurfacePoint,
};

/// Unfoldings that close up to this part of an edge are taken as they are.
const LARGEST_MISFIT: f64 = 0.02;

/// How a chart was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChartKind {
    /// What its faces take their shapes from.
    pub source: ShapeSource,
    /// Whether the shapes had to be changed to fit together (a dome, an annulus, a dart); otherwise the faces were only moved.
    pub relaxed: bool,
}

/// A patch with 2D coordinates.
#[derive(Debug, Default)]
pub(crate) struct Chart {
    patch: Patch,
    shapes: Vec<Shape>,
    unfolding: Unfolding,
    locator: Locator,
    has_point: Vec<bool>,
}

/// Two sides of a face, in the chart (`u`, `v`) and in the world (`x`, `y`).
struct Sides {
    u: Vector2<f64>,
    v: Vector2<f64>,
    x: Vector3<f64>,
    y: Vector3<f64>,
}

impl Chart {
    /// The patch, to be filled before [`build`](Self::build).
    pub(crate) fn patch_mut(&mut self) -> &mut Patch {
        &mut self.patch
    }

    /// Gives coordinates to all that is connected to the path's first face. Nothing for one-sided patches.
    ///
    /// Cost: O(n) where the patch unfolds, else that of two sparse factorisations.
    pub(crate) fn build(&mut self, mesh: &Mesh, frame: &Frame) -> Option<ChartKind> {
        let source = shapes::measure(mesh, frame, &self.patch, &mut self.shapes);
        if !self.unfolding.unfold(mesh, &self.patch, &self.shapes) {
            return None;
        }
        let relaxed = self.unfolding.misfit > LARGEST_MISFIT && relax(&self.patch, &self.shapes, &mut self.unfolding);
        self.scale_to_metres(frame)?;
        self.index(mesh);
        Some(ChartKind { source, relaxed })
    }

    /// Texture coordinates have no unit: the sides of the chart get the total length that they have in the world.
    fn scale_to_metres(&mut self, frame: &Frame) -> Option<()> {
        let (mut chart, mut world) = (0.0, 0.0);
        for (corners, _) in self.reached() {
            for k in 0..3 {
                let (a, b) = (corners[k] as usize, corners[(k + 1) % 3] as usize);
                chart += (self.unfolding.points[b] - self.unfolding.points[a]).norm();
                let [a, b] = [a, b].map(|vertex| frame.position(self.patch.vertices()[vertex]));
                world += (b - a).norm();
            }
        }
        let scale = world / chart;
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        for point in &mut self.unfolding.points {
            *point *= scale;
        }
        Some(())
    }

    fn reached(&self) -> impl Iterator<Item = (&[u32; 3], usize)> {
        let facing = self.unfolding.facing.iter();
        self.patch
            .corners()
            .iter()
            .zip(facing)
            .enumerate()
            .filter_map(|(face, (corners, &facing))| (facing != Facing::Unreached).then_some((corners, face)))
    }

    fn index(&mut self, mesh: &Mesh) {
        self.has_point.clear();
        self.has_point.resize(self.patch.vertices().len(), false);
        self.locator.start();
        for (face, corners) in self.patch.corners().iter().enumerate() {
            if self.unfolding.facing[face] == Facing::Unreached {
                continue;
            }
            for &corner in corners {
                self.has_point[corner as usize] = true;
            }
            let Some(edges) = mesh.face_edges(self.patch.faces()[face]) else { continue };
            let rim = edges.map(|edge| {
                let here = |&&other: &&FaceId| {
                    self.patch.local_face(other).is_some_and(|f| self.unfolding.facing[f] != Facing::Unreached)
                };
                mesh.edge_faces(edge).iter().filter(here).count() < 2
            });
            self.locator.add(face, corners.map(|corner| self.unfolding.points[corner as usize]), rim);
        }
        self.locator.finish();
    }

    /// The coordinates of a vertex, if it belongs to the chart.
    pub(crate) fn vertex(&self, vertex: VertexId) -> Option<Point2<f64>> {
        let local = self.patch.local_vertex(vertex)?;
        self.has_point[local].then(|| self.unfolding.points[local])
    }

    /// The coordinates of a place on the cloth, if it belongs to the chart.
    pub(crate) fn point(&self, mesh: &Mesh, place: &SurfacePoint) -> Option<Point2<f64>> {
        match *place {
            SurfacePoint::Vertex(vertex) => self.vertex(vertex),
            SurfacePoint::Edge { edge, parameter } => {
                let [a, b] = mesh.edge(edge);
                let (a, b) = (self.vertex(a)?, self.vertex(b)?);
                Some(a + (b - a) * parameter)
            }
            SurfacePoint::Face { face, barycentric } => {
                let mut sum = Point2::origin();
                for (vertex, weight) in mesh.face(face).into_iter().zip(barycentric) {
                    sum += self.vertex(vertex)?.coords * weight;
                }
                Some(sum)
            }
        }
    }

    /// The coordinates of a point of the cloth, if it belongs to the chart.
    pub(crate) fn material_point(&self, point: &MaterialPoint) -> Option<Point2<f64>> {
        let mut sum = Point2::origin();
        for (&vertex, weight) in point.vertices.iter().zip(point.weights) {
            if weight != 0.0 {
                sum += self.vertex(vertex)?.coords * weight;
            }
        }
        Some(sum)
    }

    /// The unit direction of the world that a direction of the chart has in a face.
    pub(crate) fn to_world(
        &self,
        mesh: &Mesh,
        frame: &Frame,
        face: FaceId,
        direction: Vector2<f64>,
    ) -> Option<Vector3<f64>> {
        let Sides { u, v, x, y } = self.sides(mesh, frame, face)?;
        let along = x * direction.perp(&v) + y * u.perp(&direction);
        (along * u.perp(&v).signum()).try_normalize(0.0)
    }

    /// The unit direction of the chart that a direction of the world, in the plane of a face, has there.
    pub(crate) fn to_chart(
        &self,
        mesh: &Mesh,
        frame: &Frame,
        face: FaceId,
        direction: Vector3<f64>,
    ) -> Option<Vector2<f64>> {
        let Sides { u, v, x, y } = self.sides(mesh, frame, face)?;
        // Coordinates of the direction in the two sides, up to their common positive factor.
        let (xx, xy, yy) = (x.norm_squared(), x.dot(&y), y.norm_squared());
        let (px, py) = (direction.dot(&x), direction.dot(&y));
        (u * (px * yy - py * xy) + v * (py * xx - px * xy)).try_normalize(0.0)
    }

    /// Two sides of a face from its first corner, in the chart and in the world.
    fn sides(&self, mesh: &Mesh, frame: &Frame, face: FaceId) -> Option<Sides> {
        let [a, b, c] = mesh.face(face);
        let (flat, world) = (self.vertex(a)?, frame.position(a));
        let (u, v) = (self.vertex(b)? - flat, self.vertex(c)? - flat);
        Some(Sides { u, v, x: frame.position(b) - world, y: frame.position(c) - world })
    }

    /// The point of the cloth with the given coordinates, or the nearest on the outline of the chart.
    pub(crate) fn locate(&self, mesh: &Mesh, point: Point2<f64>) -> Option<MaterialPoint> {
        let place = self.locator.locate(point)?;
        Some(MaterialPoint { vertices: mesh.face(self.patch.faces()[place.face]), weights: place.barycentric })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        correspond::samples::{sheet, sheet_faces},
        mesh::{EdgeId, MeshDescription, Uvs},
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

    fn check(mesh: &Mesh, frame: &Frame, flat: &[Point2<f64>], source: ShapeSource, tolerance: f64) {
        let mut chart = Chart::default();
        chart.patch_mut().start(mesh, [FaceId(30)].into_iter());
        chart.patch_mut().grow(mesh, 2, usize::MAX);
        assert_eq!(chart.build(mesh, frame), Some(ChartKind { source, relaxed: false }));
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
    fn takes_the_best_shapes_there_are() {
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
    fn places_on_edges_and_faces_have_coordinates() {
        let (mesh, frame, _) = rolled(false, None);
        let mut chart = Chart::default();
        chart.patch_mut().start(&mesh, [FaceId(0)].into_iter());
        chart.build(&mesh, &frame).unwrap();
        let [a, b] = mesh.edge(EdgeId(0));
        let middle = chart.point(&mesh, &SurfacePoint::Edge { edge: EdgeId(0), parameter: 0.5 }).unwrap();
        let expected = nalgebra::center(&chart.vertex(a).unwrap(), &chart.vertex(b).unwrap());
        assert!((middle - expected).norm() < 1e-15);
        let place = SurfacePoint::Face { face: FaceId(0), barycentric: [0.0, 1.0, 0.0] };
        assert_eq!(chart.point(&mesh, &place), chart.vertex(mesh.face(FaceId(0))[1]));
        let far = SurfacePoint::Vertex(VertexId(48));
        assert_eq!(chart.point(&mesh, &far), None);
    }
}
