//! Which of the two sides of a path is inside, where something says more than their sizes.

use super::{
    flood::{Flood, Terms},
    winding::winding_number,
    work::by_work,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
    paths::{IntersectionPaths, PathPoint, SurfacePoint},
    predicates::{Side, side_of_plane},
    settings::{InsideChoice, Settings},
};

/// What all decisions about one frame look at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) paths: &'a IntersectionPaths,
    pub(crate) settings: &'a Settings,
}

/// The inside after a fill that separated: by layers, by winding numbers, by pins, by work, or else the smaller
/// side. Its vertices are then
/// complete in `flood`.
pub(crate) fn choose_side(flood: &mut Flood, scene: &Scene<'_>, points: &[PathPoint], terms: &Terms<'_>) -> usize {
    let Settings { layer_order, winding, pinned_outside, .. } = *scene.settings;
    let mut choice = None;
    if layer_order && let Some(layers) = scene.mesh.layers() {
        choice = by_layers(flood, scene, layers, points);
    }
    if winding && choice.is_none() {
        choice = by_winding(flood, scene);
    }
    if pinned_outside && choice.is_none() {
        flood.complete(scene.mesh, terms);
        choice = by_pins(flood, scene.mesh);
    }
    if scene.settings.inside == InsideChoice::Work && choice.is_none() {
        flood.complete(scene.mesh, terms);
        choice = by_work(flood, scene, points);
    }
    let inside = choice.unwrap_or(flood.smaller());
    if inside != flood.smaller() {
        flood.complete(scene.mesh, terms);
    }
    inside
}

/// Each edge that pierces a face of another layer votes: its end behind an inner layer, or in front of an outer one, is inside.
fn by_layers(flood: &Flood, scene: &Scene<'_>, layers: &[u32], points: &[PathPoint]) -> Option<usize> {
    let mut votes = [0usize; 2];
    for point in points {
        let (SurfacePoint::Edge { edge, .. }, SurfacePoint::Face { face, .. }) = (point.own, point.partner) else {
            continue;
        };
        let [a, b, c] = scene.mesh.face(face);
        let wrong_side = |vertex: VertexId| {
            let (own, partner) = (layers[vertex.index()], layers[a.index()]);
            let side =
                side_of_plane(scene.frame.site(a), scene.frame.site(b), scene.frame.site(c), scene.frame.site(vertex));
            (own != partner).then_some((side == Side::Below) == (own > partner))
        };
        for end in scene.mesh.edge(edge) {
            if let (Some(wrong), Some(side)) = (wrong_side(end), flood.side_of(end)) {
                votes[if wrong { side } else { 1 - side }] += 1;
            }
        }
    }
    (votes[0] != votes[1]).then_some(usize::from(votes[1] > votes[0]))
}

/// On solids: the side whose faces do not part an outside from an inside.
fn by_winding(flood: &Flood, scene: &Scene<'_>) -> Option<usize> {
    let wrong = [0, 1].map(|side| {
        let face = whole_face(flood, scene.mesh, side)?;
        // Half way between the two sides of a face that is where it should be.
        winding_number(scene.mesh, scene.frame, face).map(|number| (number - 0.5).abs() > 0.25)
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

fn by_pins(flood: &Flood, mesh: &Mesh) -> Option<usize> {
    let pinned = [0, 1].map(|side| flood.side(side).iter().any(|&vertex| mesh.is_pinned(vertex)));
    match pinned {
        [true, false] => Some(1),
        [false, true] => Some(0),
        _ => None,
    }
}
