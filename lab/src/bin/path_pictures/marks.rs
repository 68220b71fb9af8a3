//! Rings and segments drawn over the one pair of paths of an analysis, in its colour.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use untangle::{
    analysis::Analysis,
    mesh::VertexId,
    paths::{PathCopy, PathPoint, PathType, SurfacePoint},
};

/// Adds a straight line.
pub(crate) fn segment(analysis: &mut Analysis, ends: [Point3<f64>; 2]) {
    line(analysis, ends.into_iter());
}

/// Adds a ball of three rings.
pub(crate) fn ball(analysis: &mut Analysis, centre: Point3<f64>, radius_m: f64) {
    const CORNERS: u32 = 16;
    for axis in 0..3 {
        let corners = (0..=CORNERS).map(|corner| {
            let (sine, cosine) = (TAU * f64::from(corner) / f64::from(CORNERS)).sin_cos();
            let mut offset = Vector3::zeros();
            offset[(axis + 1) % 3] = radius_m * cosine;
            offset[(axis + 2) % 3] = radius_m * sine;
            centre + offset
        });
        line(analysis, corners);
    }
}

fn line(analysis: &mut Analysis, positions: impl Iterator<Item = Point3<f64>>) {
    let paths = &mut analysis.paths;
    let start = paths.points.len();
    // Where the line lies on the cloth is not asked when it is drawn.
    let own = SurfacePoint::Vertex(VertexId(0));
    paths.points.extend(positions.map(|position| PathPoint { position, own, partner: own }));
    let (points, partner) = (start..paths.points.len(), paths.copies.len());
    paths.copies.push(PathCopy {
        path_type: PathType::Closed,
        closed: false,
        points,
        segments: 0..0,
        partner,
        pair: 0,
    });
    paths.pairs[0].copies = 0..paths.copies.len();
}
