//! The targets of points inside: their images under the fitted map, located in the chart of the corresponding path.

use nalgebra::{Point2, Point3};

use super::{
    charts::Chart, correspondences::Attraction, fit::ThinPlate, lifted::LiftedPair, material_point::MaterialPoint,
    path_input::PathInput,
};
use crate::{geometry::left_normal, mesh::FaceId};

/// The map of one path, from its own chart to that of the corresponding path.
#[derive(Clone, Copy, Debug)]
pub(super) struct TargetMap<'a> {
    pub(super) own: &'a Chart,
    pub(super) partner: &'a Chart,
    pub(super) pair: &'a LiftedPair,
    pub(super) plate: &'a ThinPlate,
    /// The sides on which the inside and its image lie.
    pub(super) sides: (f64, f64),
}

/// Points inside and where they go, in memory that is kept from one path to the next.
#[derive(Debug, Default)]
pub(super) struct TargetScratch {
    face_points: Vec<(FaceId, usize, Point3<f64>)>,
    sources: Vec<MaterialPoint>,
    /// Places of the sources in the chart of the path, and their images in that of the corresponding path.
    places: Vec<Point2<f64>>,
    images: Vec<Point2<f64>>,
}

impl TargetMap<'_> {
    /// Adds an attraction for each point inside: the vertices of the region, or, of a region without vertices, points
    /// of the faces that the path runs through.
    pub(super) fn attract(
        &self,
        input: &PathInput<'_>,
        scratch: &mut TargetScratch,
        attractions: &mut Vec<Attraction>,
    ) {
        let TargetScratch { face_points, sources, places, images } = scratch;
        sources.clear();
        places.clear();
        let mut add = |source: MaterialPoint| {
            if let Some(point) = self.own.material_point(input.mesh, &source) {
                sources.push(source);
                places.push(self.nearest_copy(point));
            }
        };
        if input.region.is_empty() {
            points_within(input, face_points, &mut add);
        }
        for &vertex in input.region {
            add(MaterialPoint::vertex(vertex));
        }
        if self.pair.only_partner_winds() {
            images.clear();
            images.extend(places.iter().map(|&point| self.offset_image(point)));
        } else {
            self.plate.evaluate_all(places, images);
        }
        for (&source, &image) in sources.iter().zip(&*images) {
            if let Some(target) = self.partner.locate(input.mesh, image) {
                attractions.push(Attraction { source, target });
            }
        }
    }

    /// The copy of a point of the chart that the map is to be taken at.
    fn nearest_copy(&self, point: Point2<f64>) -> Point2<f64> {
        let goes_on = self.pair.own.period.is_some() || self.own.period().is_some();
        if goes_on && !self.pair.only_partner_winds() { self.pair.own.nearest_copy(self.own, point).0 } else { point }
    }

    /// The image of a point where the inside is a disc and its image an annulus, between which no injective map
    /// exists: as far beside the corresponding path as the point lies beside the path.
    fn offset_image(&self, point: Point2<f64>) -> Point2<f64> {
        let mut nearest = (f64::INFINITY, point);
        let (own, partner) = (&self.pair.own.points, &self.pair.partner.points);
        for (u, v) in own.windows(2).zip(partner.windows(2)) {
            let (step, image) = (u[1] - u[0], v[1] - v[0]);
            let (length, image_length) = (step.norm(), image.norm());
            if length == 0.0 || image_length == 0.0 {
                continue;
            }
            let part = ((point - u[0]).dot(&step) / (length * length)).clamp(0.0, 1.0);
            let distance = (point - (u[0] + step * part)).norm();
            if distance < nearest.0 {
                let inside = step.perp(&(point - u[0])) * self.sides.0;
                let across = left_normal(image) / image_length * (self.sides.1 * inside.signum());
                let scale = (image_length / length).clamp(0.25, 4.0);
                nearest = (distance, v[0] + image * part + across * (distance * scale));
            }
        }
        nearest.1
    }
}

/// Finds one point inside on each face that a region without vertices runs through: the mean of the middles of the
/// path's segments in the face. A face with a single segment has no inside of its own and gets none.
fn points_within(
    input: &PathInput<'_>,
    scratch: &mut Vec<(FaceId, usize, Point3<f64>)>,
    found: &mut impl FnMut(MaterialPoint),
) {
    let PathInput { mesh, points, segments, .. } = *input;
    scratch.clear();
    for (index, segment) in segments.iter().enumerate() {
        if let Some(middle) = MaterialPoint::middle(mesh, segment.own, [&points[index].own, &points[index + 1].own]) {
            scratch.push((segment.own, index, Point3::from(middle.weights)));
        }
    }
    scratch.sort_unstable_by_key(|&(face, index, _)| (face, index));
    for of_face in scratch.chunk_by(|a, b| a.0 == b.0).filter(|of_face| of_face.len() > 1) {
        let mut weights = [0.0; 3];
        for (_, _, middle) in of_face {
            for (sum, weight) in weights.iter_mut().zip(middle.iter()) {
                *sum += weight;
            }
        }
        let sum: f64 = weights.iter().sum();
        found(MaterialPoint { vertices: mesh.face(of_face[0].0), weights: weights.map(|weight| weight / sum) });
    }
}
