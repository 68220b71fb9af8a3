//! The shortest way in which the sheets of a contour leave each other, as windows round it see them.

use nalgebra::Vector3;

use super::{contour::Contour, directions::directions, shadow::Shadow, sheets::Sheets};
use crate::{frame::Frame, intersect::Intersections, mesh::Mesh, sides::Orientation};

/// The first radius of the windows round a contour, in mean edge lengths, and its growth.
const FIRST_RADIUS: f64 = 4.0;
const RADIUS_GROWTH: f64 = 2.0;
/// Windows this many times narrower are looked at where wide ones meet and see a deep overlap: on a coarse mesh they
/// hold other parts of the surface, which overlap elsewhere.
const NARROWER: [f64; 2] = [4.0, 2.0];
/// A shallow overlap is as deep in windows twice as wide, within this factor.
const STEADY: f64 = 1.3;
/// What narrow windows see counts where it is below this part of the depth that wide ones see.
const FAR_SHALLOWER: f64 = 0.5;
const MAX_GROWTHS: usize = 5;
/// Windows end at so many faces.
pub(super) const MAX_FACES: usize = 4000;
/// What overlaps is seen whole where the sheets are apart after this part of the radius.
const WHOLE: f64 = 0.6;

/// Where windows of the first radius see a depth of more than this many mean edge lengths, narrower ones are looked at.
const DEEP: f64 = 1.0;
/// Directions with a lower cosine are different ways out.
const DIFFERENT: f64 = 0.7;
/// A half keeps the direction of its whole unless another is shorter than this part of it.
const KEEP: f64 = 0.8;

/// What motions are found for.
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) orientation: &'a Orientation,
    pub(crate) found: &'a Intersections,
}

/// The shortest motion of those looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shortest {
    pub(super) direction: Vector3<f64>,
    pub(super) depth_m: f64,
    /// The radius of the windows that were looked at.
    pub(super) radius_m: f64,
}

/// The windows of one contour after the other, reusing their memory.
#[derive(Debug, Default)]
pub(super) struct Windows {
    /// Which of the ways that are about as short is taken.
    pub(super) variant: usize,
    pub(super) sheets: Sheets,
    pub(super) shadow: Shadow,
}

impl Windows {
    /// The shortest motion of a contour. The windows round it grow until they see all that overlaps. A direction that
    /// is given is kept where others are hardly better.
    pub(super) fn shortest(&mut self, scene: &Scene<'_>, contour: &Contour, kept: Option<Vector3<f64>>) -> Shortest {
        let Scene { mesh, frame, orientation, .. } = *scene;
        let mut candidates: Vec<(f64, Vector3<f64>)> = kept.iter().map(|&direction| (0.0, direction)).collect();
        candidates.extend(
            directions(mesh, frame, orientation, contour, kept.is_none()).into_iter().map(|direction| (0.0, direction)),
        );
        let mut radius_m = self.grow_until_whole(scene, contour, &mut candidates, kept);
        if let Some(narrow_m) = self.narrow(scene, contour, &mut candidates, kept) {
            radius_m = narrow_m;
        }
        let (least, mut direction) = candidates[0];
        let mut depth_m = least;
        // Where the shortest way has not helped, others that are about as short may.
        if let Some((depth, other)) = self.other_way(&candidates, contour) {
            return Shortest { direction: other, depth_m: depth, radius_m };
        }
        if let Some(found) = candidates.iter().find(|found| kept == Some(found.1) && KEEP * found.0 <= least) {
            (depth_m, direction) = *found;
        }
        Shortest { direction, depth_m, radius_m }
    }

    /// Lets windows grow until they see all that overlaps, from the first radius on, and sorts the directions by their
    /// depths there. Gives back the radius.
    fn grow_until_whole(
        &mut self,
        scene: &Scene<'_>,
        contour: &Contour,
        candidates: &mut [(f64, Vector3<f64>)],
        kept: Option<Vector3<f64>>,
    ) -> f64 {
        let mut radius_m = FIRST_RADIUS * contour.edge_length_m;
        for growth in 0..=MAX_GROWTHS {
            let is_complete = self.sheets.grow(scene.mesh, scene.frame, contour, radius_m, MAX_FACES);
            self.measure(scene, candidates, kept);
            if candidates[0].0 <= WHOLE * radius_m || !is_complete || growth == MAX_GROWTHS {
                break;
            }
            radius_m *= RADIUS_GROWTH;
        }
        radius_m
    }

    /// Where the windows have grown into each other, measures and sorts the directions in windows narrower than the
    /// first, if these see a shallow overlap that is about as deep in one as in the next, and far shallower than so
    /// far. Gives back the radius of the wider of the two.
    fn narrow(
        &mut self,
        scene: &Scene<'_>,
        contour: &Contour,
        candidates: &mut [(f64, Vector3<f64>)],
        kept: Option<Vector3<f64>>,
    ) -> Option<f64> {
        let wide_m = candidates[0].0;
        if wide_m <= DEEP * contour.edge_length_m || !self.sheets.meet(scene.mesh) {
            return None;
        }
        let mut narrow: Vec<_> = candidates.iter().map(|&(_, direction)| (0.0, direction)).collect();
        let mut before_m = f64::INFINITY;
        let mut radius_m = 0.0;
        for factor in NARROWER {
            radius_m = FIRST_RADIUS / factor * contour.edge_length_m;
            self.sheets.grow(scene.mesh, scene.frame, contour, radius_m, MAX_FACES);
            self.measure(scene, &mut narrow, kept);
            let is_shallow = narrow[0].0 <= WHOLE * radius_m && narrow[0].0 <= FAR_SHALLOWER * wide_m;
            if !is_shallow || narrow[0].0 > STEADY * before_m {
                return None;
            }
            before_m = narrow[0].0;
        }
        candidates.copy_from_slice(&narrow);
        Some(radius_m)
    }

    /// Measures the depths in the present windows and sorts the directions by them. A wider window can only add to a
    /// depth: what was deeper than the least so far needs no second look.
    fn measure(&mut self, scene: &Scene<'_>, candidates: &mut [(f64, Vector3<f64>)], kept: Option<Vector3<f64>>) {
        let mut least = f64::INFINITY;
        for (depth, direction) in candidates.iter_mut() {
            let is_kept = kept.is_some_and(|kept| kept == *direction);
            if *depth < least || is_kept {
                let limit = if is_kept { f64::INFINITY } else { least };
                *depth = self.depth_m(scene.mesh, scene.frame, *direction, limit);
                least = least.min(*depth);
            }
        }
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// A direction other than the shortest, for shallow contours that have not moved.
    fn other_way(&self, candidates: &[(f64, Vector3<f64>)], contour: &Contour) -> Option<(f64, Vector3<f64>)> {
        let limit = candidates[0].0 * 3.0 + contour.edge_length_m;
        let mut found: Vec<(f64, Vector3<f64>)> = Vec::new();
        for &(depth, direction) in candidates.iter().filter(|(depth, _)| *depth <= limit) {
            if found.iter().all(|(_, other)| other.dot(&direction) < DIFFERENT) {
                found.push((depth, direction));
            }
        }
        (self.variant > 0 && found.len() > 1).then(|| found[self.variant % found.len()])
    }

    fn depth_m(&mut self, mesh: &Mesh, frame: &Frame, direction: Vector3<f64>, limit_m: f64) -> f64 {
        let [first, second] = &self.sheets.faces;
        self.shadow.look(mesh, frame.positions(), [first, second], direction);
        self.shadow.depth_m(limit_m)
    }
}
