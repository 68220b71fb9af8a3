//! The image of a point inside, in the other chart.

use nalgebra::{Point2, Vector2};

use super::{MaterialPoint, chart::Chart, rbf::ThinPlate, track::Track};
use crate::mesh::Mesh;

/// The map of one path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Image<'a> {
    pub(crate) own: &'a Chart,
    pub(crate) partner: &'a Chart,
    pub(crate) track: &'a Track,
    pub(crate) plate: &'a ThinPlate,
    /// The sides on which the inside and its image lie.
    pub(crate) sides: (f64, f64),
}

impl Image<'_> {
    /// The place of the other sheet that a point inside has penetrated, if it lies in the chart.
    pub(crate) fn of(&self, mesh: &Mesh, source: &MaterialPoint) -> Option<MaterialPoint> {
        let point = self.own.material_point(mesh, source)?;
        let image = if self.track.winds_off() {
            self.beside(point)
        } else if self.track.own.period.is_some() || self.own.period().is_some() {
            self.plate.evaluate(self.track.own.nearest_copy(self.own, point).0)
        } else {
            self.plate.evaluate(point)
        };
        self.partner.locate(mesh, image)
    }

    /// Where the inside is a disc and its image a tube, no map of the plane takes the one to the other. There a point beside the path goes
    /// as far beside the corresponding path.
    fn beside(&self, point: Point2<f64>) -> Point2<f64> {
        let mut nearest = (f64::INFINITY, point);
        let (own, partner) = (&self.track.own.points, &self.track.partner.points);
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
                let across = Vector2::new(-image.y, image.x) / image_length * (self.sides.1 * inside.signum());
                let scale = (image_length / length).clamp(0.25, 4.0);
                nearest = (distance, v[0] + image * part + across * (distance * scale));
            }
        }
        nearest.1
    }
}
