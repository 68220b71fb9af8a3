//! The displacement that keeps a gap, beside that of the paths.

use nalgebra::{Point3, Vector3};

use super::{
    judge::{Judge, Judgement},
    line_search::Scene,
    values::step_of,
};
use crate::{mesh::VertexId, relax::step::sent, respond::Responder, settings::Settings};

/// Adds the displacements of pairs that are nearer than the thickness, reusing its memory.
#[derive(Debug, Default)]
pub(super) struct KeptApart {
    judge: Judge,
    vertices: Vec<VertexId>,
    displacements: Vec<Vector3<f64>>,
    positions: Vec<Point3<f64>>,
}

impl KeptApart {
    /// Adds them to corrections that hold the displacement of the paths, or none; nothing where the state with them
    /// would be more tangled, or time is up before that is known.
    ///
    /// Cost: nothing without a thickness. A search for pairs; where there are some, one for intersections, or two where
    /// something intersects.
    pub(super) fn add(
        &mut self,
        scene: &Scene<'_>,
        settings: &Settings,
        responder: &mut Responder,
        should_stop: &dyn Fn() -> bool,
    ) {
        let Scene { mesh, frame, islands, now, precision, limits } = *scene;
        let Some(gap_m) = settings.gap_m() else { return };
        let Self { judge, vertices, displacements, positions } = self;
        vertices.clear();
        displacements.clear();
        for (vertex, displacement) in responder.find_gap_displacements(mesh, frame, gap_m, should_stop) {
            vertices.push(vertex);
            displacements.push(sent(displacement));
        }
        if vertices.is_empty() {
            return;
        }
        let corrections = responder.corrections();
        positions.clear();
        positions.extend_from_slice(frame.positions());
        for &vertex in &corrections.touched {
            positions[vertex.index()] = precision.moved(frame.position(vertex), step_of(mesh, corrections, vertex));
        }
        let mut merit = |positions: &[Point3<f64>]| {
            let judgement = judge.judge(mesh, positions, islands, limits, should_stop);
            (judgement == Judgement::Done).then(|| judge.merits.all.merit())
        };
        // Of a frame that is not tangled nothing else moves.
        let before = if now.all.is_none() { Some(0.0) } else { merit(positions) };
        for (&vertex, displacement) in vertices.iter().zip(&*displacements) {
            positions[vertex.index()] = precision.moved(frame.position(vertex), *displacement);
        }
        let after = before.and_then(|_| merit(positions));
        match after.zip(before) {
            Some((after, before)) if after <= before => responder.add_displacements(mesh, vertices, displacements),
            _ => responder.leave_out_gap(),
        }
    }
}
