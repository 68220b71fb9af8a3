//! Charts: 2D coordinates of a part of the cloth, roughly in metres.

use nalgebra::{Point2, Vector2, Vector3};

use super::{
    MaterialPoint,
    cut::Cut,
    locate::{Locator, Place},
    material::weights_in,
    motion::Motion,
    patch::Patch,
    relax::Relaxation,
    shapes::{self, Shape, ShapeSource},
    unfold::Unfolding,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
    paths::SurfacePoint,
};

/// Unfoldings that close up to this part of an edge are taken as they are.
const LARGEST_MISFIT: f64 = 0.02;
/// A patch stays cut where the cut gapes by more than this many of its edges, on the mean: round a tube it gapes by the girth, round a
/// mere hole in a dome it nearly closes.
const WIDE_GAP: f64 = 3.0;
/// A cut that is not one motion of the plane, but for this part of its edges, has no period.
const PERIOD_TOLERANCE: f64 = 0.5;
/// How often a point is looked for beyond the cut, to either side.
pub(crate) const TURNS: i32 = 2;

/// How a chart was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChartKind {
    /// What its faces take their shapes from.
    pub source: ShapeSource,
    /// Whether the shapes had to be changed to fit together (a dome, an annulus, a dart); otherwise the faces were only moved.
    pub relaxed: bool,
    /// Whether it was cut open, because the patch closes on itself (a tube). The chart then goes on beyond the cut by its period.
    pub cut: bool,
}

/// A patch with 2D coordinates.
#[derive(Debug, Default)]
pub(crate) struct Chart {
    patch: Patch,
    shapes: Vec<Shape>,
    unfolding: Unfolding,
    cut: Cut,
    is_cut: bool,
    /// Takes the chart to the next of its copies beyond the cut.
    period: Option<Motion>,
    relaxation: Relaxation,
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
        self.is_cut = self.unfolding.misfit > LARGEST_MISFIT && self.cut_open(mesh);
        let relaxed = self.unfolding.misfit > LARGEST_MISFIT
            && self.relaxation.relax(&self.patch, &self.shapes, &mut self.unfolding);
        if relaxed {
            self.unfolding.measure_length(&self.patch);
        }
        self.scale_to_metres(frame)?;
        self.period = if self.is_cut { self.fit_period() } else { None };
        self.index();
        Some(ChartKind { source, relaxed, cut: self.is_cut })
    }

    /// Cuts a patch open that closes on itself, and unfolds it again.
    fn cut_open(&mut self, mesh: &Mesh) -> bool {
        if !self.cut.find(mesh, &self.patch, &self.unfolding) {
            return false;
        }
        self.patch.cut(mesh, &self.cut.sides);
        if self.unfolding.unfold(mesh, &self.patch, &self.shapes) && self.gap() > WIDE_GAP {
            return true;
        }
        self.patch.join();
        self.unfolding.unfold(mesh, &self.patch, &self.shapes);
        false
    }

    /// The two ends of each edge of the cut, as they lie on either side of it, taken in one direction through the cut.
    fn banks(&self) -> impl Iterator<Item = [[Point2<f64>; 2]; 2]> + Clone + '_ {
        let bank = move |&[(face, side), (next, _)]: &[(usize, usize); 2]| {
            let here = self.patch.corners()[face];
            let ends = [here[side], here[(side + 1) % 3]];
            let there = ends.map(|end| {
                let name = self.patch.vertices()[end as usize];
                let same = |&&corner: &&u32| self.patch.vertices()[corner as usize] == name;
                self.patch.corners()[next].iter().find(same).copied().unwrap_or(end)
            });
            [ends, there].map(|bank| bank.map(|end| self.unfolding.points[end as usize]))
        };
        let across = |bank: &[[Point2<f64>; 2]; 2]| bank[1][0] - bank[0][0] + (bank[1][1] - bank[0][1]);
        let first = self.cut.edges.first().map_or_else(Vector2::zeros, |edge| across(&bank(edge)));
        self.cut
            .edges
            .iter()
            .map(bank)
            .map(move |bank| if across(&bank).dot(&first) < 0.0 { [bank[1], bank[0]] } else { bank })
    }

    /// By how much the cut gapes, in lengths of its edges.
    fn gap(&self) -> f64 {
        let (mut gap, mut length) = (0.0, 0.0);
        for [one, other] in self.banks() {
            gap += (other[0] - one[0]).norm() + (other[1] - one[1]).norm();
            length += (one[1] - one[0]).norm() + (other[1] - other[0]).norm();
        }
        gap / length
    }

    /// The motion from one side of the cut to the other, where there is one.
    fn fit_period(&self) -> Option<Motion> {
        let pairs = self.banks().flat_map(|[one, other]| [[one[0], other[0]], [one[1], other[1]]]);
        let (period, rest) = Motion::fit(pairs)?;
        #[expect(clippy::cast_precision_loss, reason = "a count of edges")]
        let count = self.cut.edges.len() as f64;
        let length = self.banks().map(|[one, _]| (one[1] - one[0]).norm()).sum::<f64>() / count;
        (rest <= PERIOD_TOLERANCE * length).then_some(period)
    }

    /// The motion that takes the chart to its next copy beyond its cut; nothing where it has no cut or no such motion.
    pub(crate) fn period(&self) -> Option<Motion> {
        self.period
    }

    /// Makes the period that of a path that runs round, where it does.
    pub(crate) fn set_period(&mut self, period: Option<Motion>) {
        self.period = period.or(self.period);
    }

    /// Texture coordinates have no unit: the sides of the chart get the total length that they have in the world.
    fn scale_to_metres(&mut self, frame: &Frame) -> Option<()> {
        let mut world = 0.0;
        for (&[a, b, c], _) in self.reached() {
            let at = |corner: u32| frame.position(self.patch.vertices()[corner as usize]);
            let (a, b, c) = (at(a), at(b), at(c));
            world += (b - a).norm() + (c - b).norm() + (a - c).norm();
        }
        let scale = world / self.unfolding.length;
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        for point in &mut self.unfolding.points {
            *point *= scale;
        }
        Some(())
    }

    fn reached(&self) -> impl Iterator<Item = (&[u32; 3], usize)> {
        self.patch
            .corners()
            .iter()
            .enumerate()
            .filter(|&(face, _)| self.unfolding.is_reached(face))
            .map(|(f, c)| (c, f))
    }

    fn index(&mut self) {
        self.has_point.clear();
        self.has_point.resize(self.patch.vertices().len(), false);
        self.locator.start();
        for (face, corners) in self.patch.corners().iter().enumerate() {
            if !self.unfolding.is_reached(face) {
                continue;
            }
            for &corner in corners {
                self.has_point[corner as usize] = true;
            }
            // Where the chart goes on by its period, the cut is no outline.
            let goes_on = |side: usize| self.is_cut && self.period.is_some() && self.cut.sides[face][side];
            let rim = [0, 1, 2].map(|side| self.unfolding.rims[face][side] && !goes_on(side));
            self.locator.add(face, corners.map(|corner| self.unfolding.points[corner as usize]), rim);
        }
        self.locator.finish();
    }

    /// The coordinates of a vertex, if it belongs to the chart.
    pub(crate) fn vertex(&self, vertex: VertexId) -> Option<Point2<f64>> {
        let local = self.patch.local_vertex(vertex)?;
        self.has_point[local].then(|| self.unfolding.points[local])
    }

    /// The coordinates of the corners of a face, if it belongs to the chart. Along a cut they are not those of its neighbour.
    pub(crate) fn corners(&self, face: FaceId) -> Option<[Point2<f64>; 3]> {
        let local = self.patch.local_face(face).filter(|&local| self.unfolding.is_reached(local))?;
        Some(self.patch.corners()[local].map(|corner| self.unfolding.points[corner as usize]))
    }

    /// The coordinates of a place of a face of the chart.
    pub(crate) fn point_in(&self, mesh: &Mesh, face: FaceId, place: &SurfacePoint) -> Option<Point2<f64>> {
        let weights = weights_in(mesh, face, place)?;
        Some(weighted(self.corners(face)?, weights))
    }

    /// The coordinates of a point of the cloth, if it belongs to the chart.
    pub(crate) fn material_point(&self, mesh: &Mesh, point: &MaterialPoint) -> Option<Point2<f64>> {
        let [a, b, c] = point.vertices;
        if a == b && b == c {
            return self.vertex(a);
        }
        let is_it = |face: &&FaceId| mesh.face(**face) == point.vertices;
        let face = mesh.vertex_faces(a).iter().find(is_it)?;
        Some(weighted(self.corners(*face)?, point.weights))
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
        let [flat, b, c] = self.corners(face)?;
        let [x, y, z] = mesh.face(face).map(|corner| frame.position(corner));
        Some(Sides { u: b - flat, v: c - flat, x: y - x, y: z - x })
    }

    /// The point of the cloth with the given coordinates, here or in a copy of the chart beyond its cut, or the nearest on the outline.
    pub(crate) fn locate(&self, mesh: &Mesh, point: Point2<f64>) -> Option<MaterialPoint> {
        let there = |place: Place| MaterialPoint {
            vertices: mesh.face(self.patch.faces()[place.face]),
            weights: place.barycentric,
        };
        let copies = || turns(self.period).map(|motion| motion.apply(point));
        if let Some(place) = copies().find_map(|point| self.locator.within(point)) {
            return Some(there(place));
        }
        let nearest = copies().filter_map(|point| self.locator.nearest_on_outline(point));
        nearest.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| there(place))
    }
}

/// The motions to the copies of a chart, itself first.
pub(crate) fn turns(period: Option<Motion>) -> impl Iterator<Item = Motion> {
    let others = if period.is_some() { TURNS } else { 0 };
    let counts = (1..=others).flat_map(|count| [count, -count]);
    let motions = counts.filter_map(move |count| Some(period?.times(count)));
    std::iter::once(Motion::IDENTITY).chain(motions)
}

fn weighted([a, b, c]: [Point2<f64>; 3], weights: [f64; 3]) -> Point2<f64> {
    Point2::from(a.coords * weights[0] + b.coords * weights[1] + c.coords * weights[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        correspond::samples::{sheet, sheet_faces, tube},
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
    fn a_tube_is_cut_open_and_goes_on_by_its_girth() {
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
            for point in [point, next, period.times(-1).apply(point)] {
                let found = chart.locate(&mesh, point).unwrap();
                assert!((found.position(&frame) - frame.position(vertex)).norm() < 1e-9);
            }
        }
    }
}
