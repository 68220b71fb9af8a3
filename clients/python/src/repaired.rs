//! A repair without a daemon, and its judgement.

use std::{collections::BTreeSet, ops::ControlFlow};

use untangle::{
    mesh::Mesh,
    relax::{BlockedPath, InfeasiblePlace, Iteration, RelaxError, RelaxSettings, open_gap, relax},
};
use untangled_checker::{CheckError, edge_face_hits, near_pairs, vertices_behind_layers, vertices_inside};

/// A repaired state, and what is left.
pub(crate) struct Repaired {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) num_iterations: usize,
    pub(crate) blocked: Vec<BlockedPath>,
    pub(crate) infeasible: Vec<InfeasiblePlace>,
}

impl Repaired {
    /// Untangles, and opens a gap where one is asked for, unless `report` ended the work.
    pub(crate) fn of(
        mesh: &Mesh,
        positions: &[[f64; 3]],
        settings: &RelaxSettings,
        gap_m: Option<f64>,
        report: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
    ) -> Result<Self, RelaxError> {
        let relaxed = relax(mesh, positions, settings, &mut *report)?;
        let mut repaired = Self {
            positions: relaxed.positions,
            num_iterations: relaxed.history.len(),
            blocked: relaxed.blocked,
            infeasible: Vec::new(),
        };
        if let Some(gap_m) = gap_m.filter(|_| !relaxed.interrupted) {
            let max_iterations = settings.max_iterations.saturating_sub(repaired.num_iterations);
            let settings = RelaxSettings { max_iterations, ..settings.clone() };
            let opened = open_gap(mesh, &repaired.positions, gap_m, &settings, &mut *report, &|| false)?;
            repaired.positions = opened.positions;
            repaired.num_iterations += opened.history.len();
            repaired.infeasible = opened.infeasible;
        }
        Ok(repaired)
    }
}

/// What is wrong with a state, by a judge that shares no code with the repair.
pub(crate) struct Verdict {
    pub(crate) num_edge_face: usize,
    /// Vertices of cloth inside of a body.
    pub(crate) num_inside: usize,
    /// Vertices of cloth behind an inner layer.
    pub(crate) num_behind: usize,
    /// Pairs of primitives below the gap, if there is one.
    pub(crate) num_pairs_below: Option<usize>,
}

impl Verdict {
    /// Judges a state. The mesh says what is outwards of its layers.
    pub(crate) fn of(mesh: &Mesh, positions: &[[f64; 3]], gap_m: Option<f64>) -> Result<Self, CheckError> {
        let corners = |face| mesh.face(face).map(|vertex| vertex.0);
        let cloth: Vec<[u32; 3]> = mesh.face_ids().filter(|&face| !mesh.is_body_face(face)).map(corners).collect();
        let body: Vec<[u32; 3]> = mesh.face_ids().filter(|&face| mesh.is_body_face(face)).map(corners).collect();
        let first_body = cloth.len();
        let triangles = [cloth.clone(), body.clone()].concat();
        let of_body: Vec<u32> = body.iter().flatten().copied().collect();
        let of_cloth: BTreeSet<u32> = cloth.iter().flatten().copied().collect();
        let near = |gap_m| near_pairs(positions, &triangles, first_body, gap_m).map(|found| found.total());
        Ok(Self {
            num_edge_face: count_edge_face(positions, &triangles, &of_body)?,
            num_inside: if body.is_empty() { 0 } else { vertices_inside(positions, of_cloth, &body)?.len() },
            num_behind: num_behind(mesh, positions, &cloth)?,
            num_pairs_below: gap_m.map(near).transpose()?,
        })
    }
}

/// Vertices of cloth behind an inner layer; `cloth` are the faces that are not those of bodies.
fn num_behind(mesh: &Mesh, positions: &[[f64; 3]], cloth: &[[u32; 3]]) -> Result<usize, CheckError> {
    let (Some(numbers), Some(outwards)) = (mesh.layers(), mesh.outwards()) else { return Ok(0) };
    let faces = mesh.face_ids().filter(|&face| !mesh.is_body_face(face));
    let are_outwards: Vec<bool> = faces.map(|face| outwards[face.index()]).collect();
    Ok(vertices_behind_layers(positions, cloth, numbers, &are_outwards)?.len())
}

/// Edges that pierce a face, but those of bodies that pierce a face of one.
pub(crate) fn count_edge_face(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    body: &[u32],
) -> Result<usize, CheckError> {
    let body: BTreeSet<u32> = body.iter().copied().collect();
    let are_bodies = |vertices: &[u32]| vertices.iter().all(|vertex| body.contains(vertex));
    let hits = edge_face_hits(positions, triangles)?;
    Ok(hits.iter().filter(|hit| !(are_bodies(&hit.edge) && are_bodies(&triangles[hit.triangle as usize]))).count())
}
