//! What a round relaxes: a state as its files hold it, or as another reader of them sees it.

use std::collections::BTreeSet;

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, MeshDescription},
};
use untangled_mesh_io::MeshFile;

use crate::cli::{
    certificate::{Surface, single},
    input::Input,
    roles::Roles,
};

use super::report::Counts;

/// Most fans of a polygon that are tried, as the judge does.
const MOST_FANS: usize = 16;

/// A mesh and positions in which something intersects.
#[derive(Debug)]
pub(super) struct View {
    pub(super) mesh: Mesh,
    pub(super) frame: Frame,
    /// Whether its reader keeps single precision.
    pub(super) single_precision: bool,
}

impl View {
    /// The view of a state in which there is something to resolve; `counts` are those of the state. Nothing if every
    /// reader finds it clean, or if what a reader finds can't be shown to the relaxation.
    pub(super) fn of(files: &[MeshFile], roles: &Roles, pins: &[u32], state: &Input, counts: &Counts) -> Option<Self> {
        let certificate = &counts.certificate;
        if !counts.is_clean() {
            return Some(Self { mesh: state.mesh.clone(), frame: state.frame.clone(), single_precision: false });
        }
        if certificate.is_clean() || certificate.num_crossings > 0 || certificate.num_wrong()[0] > 0 {
            return None;
        }
        if certificate.is_tangled_by_rounding() {
            let frame = frame_of(state, &state.mesh, true)?;
            return Some(Self { mesh: state.mesh.clone(), frame, single_precision: true });
        }
        let single_precision = certificate.num_polygon_pairs == 0;
        Self::split_otherwise(files, roles, pins, state, single_precision)
    }

    /// The state with polygons that cross split so that most intersects.
    fn split_otherwise(
        files: &[MeshFile],
        roles: &Roles,
        pins: &[u32],
        state: &Input,
        single_precision: bool,
    ) -> Option<Self> {
        let surface = Surface::new(files, roles, state);
        let surface = if single_precision { surface.in_single_precision()? } else { surface };
        let pairs = surface.polygon_pairs();
        let num_corners = |polygon: &u32| surface.polygons[*polygon as usize][0].len();
        let most = pairs.iter().flatten().map(num_corners).max()?.min(MOST_FANS);
        let mut world = roles.join(&[], files).ok()?.description;
        world.pins = pins.to_vec();
        let mut best: Option<(usize, Self)> = None;
        for start in 0..most {
            for sides in [&[0, 1][..], &[0], &[1]] {
                let split: BTreeSet<u32> =
                    pairs.iter().flat_map(|pair| sides.iter().map(|&side: &usize| pair[side])).collect();
                let mut description = world.clone();
                for polygon in split {
                    make_fan(&mut description, &surface, polygon as usize, start);
                }
                let mesh = Mesh::new(state.weld.describe(&description)).ok()?;
                // A fan has as many triangles as the polygon had, and they point the same way.
                let mesh = mesh.with_outwards(state.mesh.outwards());
                let frame = frame_of(state, &mesh, single_precision)?;
                let mut found = Intersections::default();
                Intersector::default().intersect(&mesh, &frame, &mut found);
                let hits = found.edge_face.len();
                if hits > best.as_ref().map_or(0, |best| best.0) {
                    best = Some((hits, Self { mesh, frame, single_precision }));
                }
            }
        }
        best.map(|(_, view)| view)
    }
}

/// The frame of a state, rounded where asked for.
fn frame_of(state: &Input, mesh: &Mesh, single_precision: bool) -> Option<Frame> {
    let mut positions = state.weld.gather(&state.positions);
    if single_precision {
        for value in positions.as_flattened_mut() {
            *value = single(*value);
        }
    }
    Frame::new(mesh, &positions).ok()
}

/// Splits a polygon into the fan of one of its corners.
fn make_fan(description: &mut MeshDescription, surface: &Surface, polygon: usize, start: usize) {
    let [corners, triangles] = surface.polygons[polygon].clone();
    let corners = &surface.corners[corners];
    let count = corners.len();
    let own: Vec<u32> = surface.triangles[triangles.clone()].as_flattened().to_vec();
    let corner = |step: usize| corners[(start + step) % count];
    let fan: Vec<[u32; 3]> = (1..count - 1).map(|step| [corner(0), corner(step), corner(step + 1)]).collect();
    if let Some(uvs) = &mut description.uvs {
        let own_uvs: Vec<u32> = uvs.corners[triangles.clone()].as_flattened().to_vec();
        let uv_of = |vertex: u32| own.iter().position(|&other| other == vertex).map_or(own_uvs[0], |at| own_uvs[at]);
        for (slot, face) in uvs.corners[triangles.clone()].iter_mut().zip(&fan) {
            *slot = face.map(uv_of);
        }
    }
    description.faces[triangles].copy_from_slice(&fan);
}
