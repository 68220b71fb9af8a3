//! Centres of a fit: equidistant on the path, and beside it where the path alone does not determine the map across.

use nalgebra::{Point2, Vector2};

use super::thin_plate::ThinPlate;
use crate::{correspond::lifted::LiftedPair, geometry::left_normal};

/// Paths whose centres spread across their main direction by less than this part of their spread along it count as
/// nearly straight.
const NEARLY_STRAIGHT: f64 = 0.25;
/// Of centres that are closer to each other than this part of the path length one is kept.
const DUPLICATE: f64 = 1e-6;

/// Centres and the values that a fit must take there, in memory that is kept from one path to the next.
#[derive(Debug, Default)]
pub(crate) struct Centres {
    /// Places in the chart of the path.
    pub(crate) from: Vec<Point2<f64>>,
    /// The same places in the chart of the corresponding path.
    pub(crate) to: Vec<Point2<f64>>,
    /// How many lie on the path; those beside it follow.
    pub(crate) num_on_path: usize,
    /// Arclengths of the centres on the path, ascending.
    stations: Vec<f64>,
    /// Gaps between centres in which the fit misses the path by more than is tolerated.
    gaps: Vec<Gap>,
    /// Images of the points of the path.
    images: Vec<Point2<f64>>,
}

/// A part of the path between two centres.
#[derive(Clone, Copy, Debug)]
struct Gap {
    /// Index of the centre behind it.
    next: usize,
    /// Arclength half way between the two.
    middle: f64,
    /// By how much the fit misses the path there at worst.
    miss: f64,
}

impl Centres {
    /// Begins with `count` equidistant centres on the path.
    pub(crate) fn start(&mut self, pair: &LiftedPair, count: usize) {
        pair.sample(count, &mut self.stations);
    }

    /// Places the centres.
    ///
    /// Points on a straight path do not determine the map across it, and those on a nearly straight one do so by little
    /// more than noise. There the fit gets centres beside the path too: a point `offset` beside the path inside maps to
    /// one `offset` beside the corresponding path. The noise that the paper adds instead makes the slope across the
    /// path random. Centres outside would double the cost and make the targets no better, since only the inside is
    /// mapped.
    ///
    /// `sides` are those on which the inside and its image lie: 1 for left and -1 for right of the direction of travel.
    /// With `is_mutual` the map is its own inverse: every centre serves in both directions.
    pub(crate) fn place(&mut self, pair: &LiftedPair, sides: (f64, f64), offset: f64, is_mutual: bool) {
        self.from.clear();
        self.to.clear();
        for &station in &self.stations {
            let (own, partner) = pair.at_arclength(station);
            self.from.push(own);
            self.to.push(partner);
        }
        self.drop_duplicates(DUPLICATE * pair.length());
        self.num_on_path = self.from.len();
        if self.num_on_path >= 2 && spread(&self.from) < NEARLY_STRAIGHT {
            self.add_beside(sides, offset);
            self.drop_duplicates(1e-3 * offset);
        }
        if is_mutual {
            let count = self.from.len();
            self.from.extend_from_slice(&self.to);
            self.to.extend_from_slice(&self.from[..count]);
            self.drop_duplicates(1e-3 * offset);
        }
    }

    /// Adds a centre beside each of those on the path, on the inside.
    fn add_beside(&mut self, sides: (f64, f64), offset: f64) {
        for index in 0..self.num_on_path {
            let (before, behind) = (index.saturating_sub(1), (index + 1).min(self.num_on_path - 1));
            let (u, v) = (self.from[behind] - self.from[before], self.to[behind] - self.to[before]);
            let (length, image) = (u.norm(), v.norm());
            if length == 0.0 || image == 0.0 {
                continue;
            }
            // The map scales across the path as it does along it.
            let scale = (image / length).clamp(0.25, 4.0);
            let (across, image_across) = (left_normal(u / length) * sides.0, left_normal(v / image) * sides.1);
            self.from.push(self.from[index] + across * offset);
            self.to.push(self.to[index] + image_across * (offset * scale));
        }
    }

    /// Adds a centre half way between two where the fit misses the path between them by more than `tolerance`, the
    /// worst first, up to `most` centres. Returns by how much, in metres of the chart, it misses the path at worst, and
    /// whether centres were added.
    pub(crate) fn refine(&mut self, pair: &LiftedPair, plate: &ThinPlate, tolerance: f64, most: usize) -> (f64, bool) {
        self.gaps.clear();
        let count = self.stations.len();
        let mut residual: f64 = 0.0;
        plate.evaluate_all(&pair.own.points, &mut self.images);
        for ((at, partner), image) in pair.partner_points().zip(&self.images) {
            let miss = (image - partner).norm();
            residual = residual.max(miss);
            // A point behind the last centre of a closed path lies between it and the first.
            let next = self.stations.partition_point(|&station| station <= at);
            if next == 0 || miss <= tolerance {
                continue;
            }
            let end = self.stations.get(next).copied().unwrap_or(pair.length());
            match self.gaps.last_mut() {
                Some(gap) if gap.next == next => gap.miss = gap.miss.max(miss),
                _ => self.gaps.push(Gap { next, middle: 0.5 * (self.stations[next - 1] + end), miss }),
            }
        }
        self.gaps.sort_unstable_by(|a, b| b.miss.total_cmp(&a.miss).then(a.next.cmp(&b.next)));
        self.stations.extend(self.gaps.iter().take(most.saturating_sub(count)).map(|gap| gap.middle));
        self.stations.sort_unstable_by(f64::total_cmp);
        (residual, self.stations.len() > count)
    }

    /// Drops every centre that lies within `distance` of one before it.
    fn drop_duplicates(&mut self, distance: f64) {
        let squared = distance * distance;
        let mut kept = 0;
        for index in 0..self.from.len() {
            let point = self.from[index];
            if self.from[..kept].iter().all(|other| (other - point).norm_squared() > squared) {
                self.from[kept] = point;
                self.to[kept] = self.to[index];
                kept += 1;
            }
        }
        self.from.truncate(kept);
        self.to.truncate(kept);
    }
}

/// Spread of points across their main direction, as a part of the spread along it: the root of the ratio of the
/// eigenvalues of their covariance.
fn spread(points: &[Point2<f64>]) -> f64 {
    let mut mean = Vector2::zeros();
    for point in points {
        mean += point.coords;
    }
    #[expect(clippy::cast_precision_loss, reason = "counts of at most a thousand")]
    let mean = mean / points.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for point in points {
        let d = point.coords - mean;
        xx += d.x * d.x;
        xy += d.x * d.y;
        yy += d.y * d.y;
    }
    let middle = 0.5 * (xx + yy);
    let half = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
    if middle + half > 0.0 { ((middle - half).max(0.0) / (middle + half)).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        correspond::{charts::Chart, samples::sheet},
        frame::Frame,
        mesh::Mesh,
        paths::{PathPoint, PathSegment, SurfacePoint},
    };

    /// A straight path over a sheet of 1 m x 1 m at x = 0.42, its partner at x = 0.58, and the chart of the sheet.
    fn fold() -> (Mesh, Frame, Chart, Vec<PathPoint>, Vec<PathSegment>) {
        let (mesh, flat) = sheet(10, 10, 0.1);
        let positions: Vec<_> = flat.iter().map(|p| [p.x, p.y, 0.0]).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let mut chart = Chart::default();
        chart.patch_mut().start(&mesh, mesh.face_ids());
        chart.build(&mesh, &frame).unwrap();
        let place = |x: f64, y: f64| {
            let face = mesh
                .face_ids()
                .find_map(|face| {
                    let [a, b, c] = mesh.face(face).map(|v| flat[v.index()]);
                    let area = (b - a).perp(&(c - a));
                    let p = Point2::new(x, y);
                    let w = [(b - p).perp(&(c - p)), (c - p).perp(&(a - p)), (a - p).perp(&(b - p))].map(|w| w / area);
                    w.iter().all(|&w| w >= -1e-9).then_some((face, w))
                })
                .unwrap();
            SurfacePoint::Face { face: face.0, barycentric: face.1 }
        };
        let points = (0..=20)
            .map(|k| {
                let y = 0.2 + 0.03 * f64::from(k);
                PathPoint { position: [0.0, y, 0.0].into(), own: place(0.42, y), partner: place(0.58, y) }
            })
            .collect::<Vec<PathPoint>>();
        // Not a path as it is found, which has a point on every edge: each segment counts for the face of its first
        // point.
        let face = |place: &SurfacePoint| match *place {
            SurfacePoint::Face { face, .. } => face,
            _ => unreachable!("all places lie in faces"),
        };
        let segment = |point: &PathPoint| PathSegment { own: face(&point.own), partner: face(&point.partner) };
        let segments = points[..20].iter().map(segment).collect();
        (mesh, frame, chart, points, segments)
    }

    #[test]
    fn centres_of_straight_path_fit_the_reflection() {
        let (mesh, _, chart, points, segments) = fold();
        let mut pair = LiftedPair::default();
        assert!(pair.lift_own(&mesh, &points, &segments, false, &chart));
        assert!(pair.lift_partner(&mesh, &points, &segments, &chart));
        assert!((pair.length() - 0.6).abs() < 1e-12);
        let mut centres = Centres::default();
        // The path goes up: inside is to the right of it and to the left of its partner.
        let up = (pair.own.points[20] - pair.own.points[0]).normalize();
        let right = Vector2::new(up.y, -up.x);
        centres.start(&pair, 7);
        centres.place(&pair, (-1.0, 1.0), 0.05, false);
        assert_eq!((centres.num_on_path, centres.from.len()), (7, 14));
        let mut plate = ThinPlate::default();
        assert!(plate.fit(&centres.from, &centres.to));
        assert_eq!(plate.rank(), 17);
        for (along, across) in [(0.3, 0.02), (0.1, 0.2), (0.55, 0.3)] {
            let at = plate.evaluate(pair.own.points[0] + up * along + right * across);
            let gap = (pair.partner.points[0] - pair.own.points[0]).dot(&right);
            let expected = pair.own.points[0] + up * along + right * (gap - across);
            assert!((at - expected).norm() < 1e-9, "{at} {expected}");
        }
    }

    #[test]
    fn spread_of_circle_is_large_and_of_line_zero() {
        assert!(spread(&circle()) > 0.9);
        assert!(spread(&[Point2::new(0.0, 0.0), Point2::new(1.0, 1.0), Point2::new(2.0, 2.0)]) < 1e-7);
    }

    #[test]
    fn centres_in_one_place_are_dropped_but_the_first() {
        let circle = circle();
        let mut centres =
            Centres { from: vec![circle[0], circle[1], circle[0]], to: circle[..3].to_vec(), ..Centres::default() };
        centres.drop_duplicates(1e-9);
        assert_eq!(centres.from, circle[..2]);
        assert_eq!(centres.to, circle[..2]);
    }

    fn circle() -> Vec<Point2<f64>> {
        (0..8).map(|k| f64::from(k) * 0.785).map(|a| Point2::new(a.cos(), a.sin())).collect()
    }
}
