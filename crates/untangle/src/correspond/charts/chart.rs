//! The chart of a patch: how it is made, and where faces, vertices and points lie in it.

use nalgebra::{Point2, Vector2, Vector3};

use super::{
    cut::Cut,
    locator::{Locator, Place},
    parameterization::ArapParameterization,
    patch::Patch,
    period::{UnfoldedCut, deck_transformations},
    shapes::{self, Shape, ShapeSource},
    similarity::Similarity,
    unfolding::Unfolding,
};
use crate::{
    correspond::material_point::{MaterialPoint, weights_in},
    frame::Frame,
    geometry::perimeter,
    mesh::{FaceId, Mesh, VertexId},
    paths::SurfacePoint,
};

/// An unfolding whose faces differ from their shapes by no more than this part of their longest side needs no
/// parameterisation.
const LARGEST_MISFIT: f64 = 0.02;
/// A patch stays cut where the cut gapes by more than this many of its edges, on the mean: round a tube it gapes by the
/// girth, round a mere hole in a dome it nearly closes.
const WIDE_GAP: f64 = 3.0;

/// How a chart was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChartKind {
    /// What its faces take their shapes from.
    pub source: ShapeSource,
    /// Whether the shapes had to be changed to fit together (a dome, an annulus, a dart); otherwise the faces were only
    /// moved.
    pub relaxed: bool,
    /// Whether it was cut open, because the patch closes on itself (a tube). The chart then goes on beyond the cut by
    /// its period.
    pub cut: bool,
}

/// A patch with 2D coordinates, in memory that is kept from one patch to the next.
#[derive(Debug, Default)]
pub(crate) struct Chart {
    patch: Patch,
    shapes: Vec<Shape>,
    /// Places of the vertices in a smooth chart.
    places: Vec<Point2<f64>>,
    unfolding: Unfolding,
    cut: Cut,
    is_cut: bool,
    /// The deck transformation from the chart to the next of its copies beyond the cut.
    period: Option<Similarity>,
    parameterization: ArapParameterization,
    locator: Locator,
    /// For each vertex of the patch whether a face of it was reached.
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

    /// Gives coordinates to all faces that edges of the patch connect with its first one. Nothing for one-sided
    /// patches, and where a length is zero or not finite.
    ///
    /// Cost: O(n) in the faces where the patch unfolds, else that of two sparse factorisations.
    pub(crate) fn build(&mut self, mesh: &Mesh, frame: &Frame) -> Option<ChartKind> {
        self.patch.connect(mesh);
        let mut relaxed = false;
        let source = if shapes::smooth_places(mesh, &self.patch, &mut self.places) {
            self.is_cut = false;
            self.unfolding.take(&self.patch, &self.places);
            ShapeSource::Uvs
        } else {
            let source = shapes::measure(mesh, frame, &self.patch, &mut self.shapes);
            relaxed = self.flatten(source)?;
            source
        };
        self.scale_to_metres(frame)?;
        self.period = if self.is_cut { self.unfolded_cut().fit_period() } else { None };
        self.fill_locator();
        Some(ChartKind { source, relaxed, cut: self.is_cut })
    }

    /// Lays the shapes of the faces side by side, and says whether they had to be changed. Nothing for one-sided
    /// patches.
    fn flatten(&mut self, source: ShapeSource) -> Option<bool> {
        if !self.unfolding.unfold(&self.patch, &self.shapes) {
            return None;
        }
        self.is_cut = self.unfolding.misfit > LARGEST_MISFIT && self.cut_open();
        // Lengths of one world agree along common sides, texture coordinates beyond a seam need not.
        let has_one_scale = source != ShapeSource::Uvs;
        let relaxed = self.unfolding.misfit > LARGEST_MISFIT
            && self.parameterization.flatten(&self.patch, &self.shapes, has_one_scale, &mut self.unfolding);
        if relaxed {
            self.unfolding.measure_length(&self.patch);
        }
        Some(relaxed)
    }

    /// Cuts a patch that closes on itself open, and unfolds it again. False, with the patch whole, where it needs no
    /// cut.
    fn cut_open(&mut self) -> bool {
        if !self.cut.find(&self.patch, &self.unfolding) {
            return false;
        }
        self.patch.cut(&self.cut.sides);
        if self.unfolding.unfold(&self.patch, &self.shapes) && self.unfolded_cut().gap() > WIDE_GAP {
            return true;
        }
        self.patch.undo_cut();
        self.unfolding.unfold(&self.patch, &self.shapes);
        false
    }

    fn unfolded_cut(&self) -> UnfoldedCut<'_> {
        UnfoldedCut { patch: &self.patch, cut: &self.cut, unfolding: &self.unfolding }
    }

    /// The deck transformation from the chart to its next copy beyond its cut; nothing where it has no cut, or no
    /// similarity fits.
    pub(crate) fn period(&self) -> Option<Similarity> {
        self.period
    }

    /// Replaces the period by that of a path that winds round a tube, where it does.
    pub(crate) fn set_period(&mut self, period: Option<Similarity>) {
        self.period = period.or(self.period);
    }

    /// Texture coordinates have no unit: scales the chart so that its sides have the total length that they have in the
    /// world. Nothing where there is no such scale.
    fn scale_to_metres(&mut self, frame: &Frame) -> Option<()> {
        let mut world = 0.0;
        for (face, corners) in self.patch.corners().iter().enumerate() {
            if self.unfolding.is_reached(face) {
                world += perimeter(corners.map(|corner| frame.position(self.patch.vertices()[corner as usize])));
            }
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

    /// Gives all faces that have a place, and the outline, to the locator.
    fn fill_locator(&mut self) {
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
            let is_outline = [0, 1, 2].map(|side| self.unfolding.outline[face][side] && !goes_on(side));
            self.locator.add(face, corners.map(|corner| self.unfolding.points[corner as usize]), is_outline);
        }
        self.locator.finish();
    }

    /// The coordinates of a vertex, if it belongs to the chart.
    pub(crate) fn vertex(&self, vertex: VertexId) -> Option<Point2<f64>> {
        let local = self.patch.local_vertex(vertex)?;
        self.has_point[local].then(|| self.unfolding.points[local])
    }

    /// The coordinates of the corners of a face, if it belongs to the chart. Along a cut they are not those of its
    /// neighbour.
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
        let has_vertices = |face: &&FaceId| mesh.face(**face) == point.vertices;
        let face = mesh.vertex_faces(a).iter().find(has_vertices)?;
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
        let [a, b, c] = self.corners(face)?;
        let [x, y, z] = mesh.face(face).map(|corner| frame.position(corner));
        Some(Sides { u: b - a, v: c - a, x: y - x, y: z - x })
    }

    /// The point of the cloth with the given coordinates, here or in a copy of the chart beyond its cut; where there is
    /// none, the nearest on the outline.
    pub(crate) fn locate(&self, mesh: &Mesh, point: Point2<f64>) -> Option<MaterialPoint> {
        let there = |place: Place| MaterialPoint {
            vertices: mesh.face(self.patch.faces()[place.face]),
            weights: place.barycentric,
        };
        let copies = || deck_transformations(self.period).map(|deck| deck.apply(point));
        if let Some(place) = copies().find_map(|point| self.locator.within(point)) {
            return Some(there(place));
        }
        let nearest = copies().filter_map(|point| self.locator.nearest_on_outline(point));
        nearest.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| there(place))
    }
}

fn weighted([a, b, c]: [Point2<f64>; 3], weights: [f64; 3]) -> Point2<f64> {
    Point2::from(a.coords * weights[0] + b.coords * weights[1] + c.coords * weights[2])
}
