//! A path on one of its two sheets, lifted to the universal cover of a chart.

use nalgebra::Point2;

use crate::{
    correspond::charts::{Chart, Similarity, deck_transformations},
    mesh::{FaceId, Mesh},
    paths::{PathPoint, PathSegment, Sheet, SurfacePoint},
};

/// A closed path winds round a tube if the end of its lift is farther from the start than this part of its length.
const WINDING_GAP: f64 = 0.3;
/// About so many points of a path are enough to tell which copy of a point is nearest to it.
const NUM_STATIONS: usize = 60;

/// The points of a path in the plane, as they lie in a chart and its copies.
#[derive(Debug, Default)]
pub(crate) struct LiftedPath {
    /// The points, one after the other. A path that winds round a tube does not end where it starts.
    pub(crate) points: Vec<Point2<f64>>,
    /// For each segment the deck transformation from its face, as it lies in the chart, to the copy in which the path
    /// runs there.
    decks: Vec<Similarity>,
    /// For a closed path that winds round a tube the deck transformation from one round to the next.
    pub(crate) period: Option<Similarity>,
}

impl LiftedPath {
    /// Lifts a path. False if a part of it lies outside of the chart.
    pub(super) fn lift(
        &mut self,
        mesh: &Mesh,
        points: &[PathPoint],
        segments: &[PathSegment],
        sheet: Sheet,
        closed: bool,
        chart: &Chart,
    ) -> bool {
        self.points.clear();
        self.decks.clear();
        self.period = None;
        let mut deck = Similarity::IDENTITY;
        for (index, point) in points.iter().enumerate() {
            let place = sheet.place(point);
            let face = segments.get(index).map(|segment| sheet.face(segment));
            let before = index.checked_sub(1).map(|before| sheet.face(&segments[before]));
            if let (Some(before), Some(face)) = (before, face)
                && let Some(transition) = transition(mesh, chart, before, face, place)
            {
                deck = deck.after(&transition);
            }
            let its_own = if let SurfacePoint::Face { face, .. } = *place { Some(face) } else { None };
            let mut faces = [its_own, face, before].into_iter().flatten();
            let Some(here) = faces.find_map(|face| chart.point_in(mesh, face, place)) else {
                return false;
            };
            self.points.push(deck.apply(here));
            if face.is_some() {
                self.decks.push(deck);
            }
        }
        if closed && let (Some(last), Some(first), Some(point)) = (segments.last(), segments.first(), points.first()) {
            let transition = transition(mesh, chart, sheet.face(last), sheet.face(first), sheet.place(point));
            self.period = self.winding_period(transition.map_or(deck, |transition| deck.after(&transition)));
        }
        self.points.len() >= 2
    }

    /// The deck transformation after one round of a closed path, where it moves the start by more than the gap that an
    /// unfolding leaves.
    fn winding_period(&self, deck: Similarity) -> Option<Similarity> {
        let length: f64 = self.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        ((deck.apply(self.points[0]) - self.points[0]).norm() > WINDING_GAP * length).then_some(deck)
    }

    /// The face of the segment at a path point, and its corners, as they lie beside that point.
    pub(super) fn corners(
        &self,
        chart: &Chart,
        segments: &[PathSegment],
        sheet: Sheet,
        index: usize,
    ) -> Option<(FaceId, [Point2<f64>; 3])> {
        let segment = index.min(segments.len() - 1);
        let face = sheet.face(&segments[segment]);
        Some((face, chart.corners(face)?.map(|corner| self.decks[segment].apply(corner))))
    }

    /// The copy of a point of the chart that is nearest to the path, and its distance from some of its points.
    pub(crate) fn nearest_copy(&self, chart: &Chart, point: Point2<f64>) -> (Point2<f64>, f64) {
        let stride = self.points.len() / NUM_STATIONS + 1;
        let distance = |point: Point2<f64>| {
            let squared = self.points.iter().step_by(stride).map(|station| (station - point).norm_squared());
            squared.fold(f64::INFINITY, f64::min)
        };
        let copies = deck_transformations(self.period.or_else(|| chart.period())).map(|deck| deck.apply(point));
        let nearest = copies.map(|copy| (copy, distance(copy))).min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or((point, 0.0), |(copy, squared)| (copy, squared.sqrt()))
    }
}

/// The similarity that puts a face beside the one before it where a path runs from one to the other; nothing where they
/// lie beside each other in the chart.
fn transition(mesh: &Mesh, chart: &Chart, before: FaceId, face: FaceId, place: &SurfacePoint) -> Option<Similarity> {
    if before == face {
        return None;
    }
    match *place {
        SurfacePoint::Edge { edge, .. } => {
            let ends = |face: FaceId| {
                let corners = chart.corners(face)?;
                let [a, b] = mesh.edge(edge).map(|end| mesh.face(face).iter().position(|&corner| corner == end));
                Some([corners[a?], corners[b?]])
            };
            let (from, to) = (ends(face)?, ends(before)?);
            if from == to { None } else { Similarity::between_segments(from, to) }
        }
        SurfacePoint::Vertex(_) => {
            let (from, to) = (chart.point_in(mesh, face, place)?, chart.point_in(mesh, before, place)?);
            (from != to).then(|| Similarity::between_points(from, to))
        }
        SurfacePoint::Face { .. } => None,
    }
}
