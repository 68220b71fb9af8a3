//! Intersection contours: path pairs as chains of segments between two sheets, and pieces of them.

use nalgebra::{Matrix3, Point3, SymmetricEigen, Vector3};

use crate::{
    frame::Frame,
    geometry::mean_edge_length,
    mesh::{FaceId, Mesh},
    paths::{IntersectionPaths, PathPoint, PathSegment, SurfacePoint},
};

/// A segment between two sheets, with its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContourSegment {
    /// The face of the first and of the second sheet.
    pub(crate) faces: [FaceId; 2],
    pub(crate) ends: [PathPoint; 2],
}

impl ContourSegment {
    pub(crate) fn middle(&self) -> Point3<f64> {
        nalgebra::center(&self.ends[0].position, &self.ends[1].position)
    }

    /// From its first end to its second, in metres.
    pub(crate) fn vector(&self) -> Vector3<f64> {
        self.ends[1].position - self.ends[0].position
    }
}

/// Some segments of a chain in the world. The sheet of `own` places is the first sheet, that of `partner` places the
/// second; where the chain ends in a loop vertex both are parts of one.
#[derive(Clone, Debug)]
pub(crate) struct Contour {
    pub(crate) segments: Vec<ContourSegment>,
    /// Mean edge length of the faces along it, in metres.
    pub(crate) edge_length_m: f64,
}

impl Contour {
    fn of(mesh: &Mesh, frame: &Frame, segments: Vec<ContourSegment>) -> Option<Self> {
        let faces = segments.iter().flat_map(|segment| segment.faces);
        let edge_length_m = mean_edge_length(mesh, frame, faces)?;
        Some(Self { segments, edge_length_m })
    }

    pub(crate) fn length_m(&self) -> f64 {
        self.segments.iter().map(|segment| segment.vector().norm()).sum()
    }

    /// The principal axes of its segments' middles, the longest last, with the spread along each.
    pub(crate) fn principal_axes(&self) -> [Vector3<f64>; 3] {
        #[expect(clippy::cast_precision_loss, reason = "a count")]
        let share = 1.0 / self.segments.len() as f64;
        let centre = self.segments.iter().map(|segment| segment.middle().coords * share).sum::<Vector3<f64>>();
        let mut covariance = Matrix3::zeros();
        for segment in &self.segments {
            let from_centre = segment.middle().coords - centre;
            covariance += from_centre * from_centre.transpose() * share;
        }
        let eigen = SymmetricEigen::new(covariance);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        order.map(|k| eigen.eigenvectors.column(k).into_owned())
    }

    /// Its two halves across its longest axis; nothing where it has less than `least` segments for each.
    pub(crate) fn halves(&self, mesh: &Mesh, frame: &Frame, least: usize) -> Option<[Self; 2]> {
        if self.segments.len() < 2 * least {
            return None;
        }
        let axis = self.principal_axes()[2];
        let mut sorted = self.segments.clone();
        let place = |segment: &ContourSegment| axis.dot(&segment.middle().coords);
        sorted.sort_by(|a, b| place(a).total_cmp(&place(b)).then(a.faces.cmp(&b.faces)));
        let upper = sorted.split_off(sorted.len() / 2);
        Some([Self::of(mesh, frame, sorted)?, Self::of(mesh, frame, upper)?])
    }
}

/// All contours of a frame, each pair of paths once, in the order of the paths. A path that is its own corresponding
/// path runs along its contour twice: its way up to the second loop vertex is taken.
pub(crate) fn contours(mesh: &Mesh, frame: &Frame, paths: &IntersectionPaths) -> Vec<Contour> {
    let mut contours = Vec::new();
    for (copy, path) in paths.copies.iter().enumerate().filter(|(copy, path)| path.partner >= *copy) {
        let (points, mut segments) = (&paths.points[path.points.clone()], &paths.segments[path.segments.clone()]);
        if path.partner == copy
            && let Some(turn) = turning_point(points)
        {
            segments = &segments[..turn];
        }
        let segment = |(segment, ends): (&PathSegment, &[PathPoint])| ContourSegment {
            faces: [segment.own, segment.partner],
            ends: [ends[0], ends[1]],
        };
        contours.extend(Contour::of(mesh, frame, segments.iter().zip(points.windows(2)).map(segment).collect()));
    }
    contours
}

/// The place in the middle of a path where it turns back.
fn turning_point(points: &[PathPoint]) -> Option<usize> {
    (1..points.len() - 1).find(|&index| matches!(points[index].own, SurfacePoint::Vertex(_)))
}
