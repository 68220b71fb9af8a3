//! Which of the two sides of a path is inside, where the settings or the mesh say more than the sizes of the sides.

mod winding;
mod work;

use super::{
    flood::{FillRules, Flood},
    view::FrameView,
};
use crate::{
    mesh::{FaceId, Mesh, VertexId},
    paths::{PathPoint, SurfacePoint},
    predicates::{Side, side_of_plane},
    settings::{InsideChoice, Settings},
};
use winding::winding_number;
use work::WorkSearch;

/// Chooses sides, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct SideChooser {
    work: WorkSearch,
}

impl SideChooser {
    /// The inside after a fill that separated: decided by layers, winding numbers, pins, work, and last by size, the
    /// first of them that is switched on and has an answer. The vertices of the inside are complete in `flood`
    /// afterwards.
    pub(crate) fn choose(
        &mut self,
        flood: &mut Flood,
        view: &FrameView<'_>,
        points: &[PathPoint],
        rules: &FillRules<'_>,
    ) -> usize {
        let Settings { layer_order, winding, pinned_outside, .. } = *view.settings;
        let mut choice = None;
        if layer_order && let Some(layers) = view.mesh.layers() {
            choice = by_layers(flood, view, layers, points);
        }
        if winding && choice.is_none() {
            choice = by_winding(flood, view);
        }
        if pinned_outside && choice.is_none() {
            flood.complete(view.mesh, rules);
            choice = by_pins(flood, view.mesh);
        }
        if view.settings.inside == InsideChoice::Work && choice.is_none() {
            choice = self.work.cheaper_side(flood, view, points, rules);
        }
        let inside = choice.unwrap_or(flood.smaller());
        if inside != flood.smaller() {
            flood.complete(view.mesh, rules);
        }
        inside
    }
}

/// Each edge that pierces a face of another layer has one vote: its end behind an inner layer, or in front of an outer
/// one, is inside. Faces look outwards, unless the mesh says otherwise.
fn by_layers(flood: &Flood, view: &FrameView<'_>, layers: &[u32], points: &[PathPoint]) -> Option<usize> {
    let mut votes = [0usize; 2];
    for point in points {
        let (SurfacePoint::Edge { edge, .. }, SurfacePoint::Face { face, .. }) = (point.own, point.partner) else {
            continue;
        };
        let [a, b, c] = view.mesh.face(face);
        let behind =
            if view.mesh.outwards().is_none_or(|outwards| outwards[face.index()]) { Side::Below } else { Side::Above };
        let wrong_side = |vertex: VertexId| {
            let (own, partner) = (layers[vertex.index()], layers[a.index()]);
            let side =
                side_of_plane(view.frame.site(a), view.frame.site(b), view.frame.site(c), view.frame.site(vertex));
            (own != partner).then_some((side == behind) == (own > partner))
        };
        for end in view.mesh.edge(edge) {
            if let (Some(wrong), Some(side)) = (wrong_side(end), flood.side_of(end)) {
                votes[if wrong { side } else { 1 - side }] += 1;
            }
        }
    }
    (votes[0] != votes[1]).then_some(usize::from(votes[1] > votes[0]))
}

/// On solids: the side whose faces do not separate the outside from the inside, by their winding number.
fn by_winding(flood: &Flood, view: &FrameView<'_>) -> Option<usize> {
    let wrong = [0, 1].map(|side| {
        let face = whole_face(flood, view.mesh, side)?;
        // A face that is where it belongs has 1 on one of its sides and 0 on the other.
        winding_number(view.mesh, view.frame, face).map(|number| (number - 0.5).abs() > 0.25)
    });
    match wrong {
        [Some(true), Some(false)] => Some(0),
        [Some(false), Some(true)] => Some(1),
        _ => None,
    }
}

/// The first face with all its corners on one side.
fn whole_face(flood: &Flood, mesh: &Mesh, side: usize) -> Option<FaceId> {
    let is_whole = |face: &FaceId| mesh.face(*face).into_iter().all(|corner| flood.side_of(corner) == Some(side));
    flood.side(side).iter().find_map(|&vertex| mesh.vertex_faces(vertex).iter().copied().find(is_whole))
}

/// The side without pinned vertices, where the other one has some.
fn by_pins(flood: &Flood, mesh: &Mesh) -> Option<usize> {
    let pinned = [0, 1].map(|side| flood.side(side).iter().any(|&vertex| mesh.is_pinned(vertex)));
    match pinned {
        [true, false] => Some(1),
        [false, true] => Some(0),
        _ => None,
    }
}
