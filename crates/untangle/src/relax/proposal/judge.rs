//! Judges where a displacement leads: what intersects there, and how long the paths are, island by island.

use nalgebra::Point3;

use crate::{
    frame::Frame,
    intersect::{Intersections, Intersector, SearchEnd, SearchLimits},
    mesh::Mesh,
    relax::{
        settings::StopObserver,
        step::{Islands, Tangle, measure_touched},
    },
};

/// How tangled a state is.
#[derive(Debug, Default)]
pub(super) struct Merits {
    /// For each island, and last for what touches none; what touches several counts for each.
    pub(super) islands: Vec<Tangle>,
    /// All of it, each intersection once.
    pub(super) all: Tangle,
}

impl Merits {
    /// Measures what was found in a frame.
    pub(super) fn measure(&mut self, mesh: &Mesh, frame: &Frame, found: &Intersections, islands: &Islands) {
        measure_touched(mesh, frame, found, islands, &mut self.islands, &mut self.all);
    }
}

/// How a judgement ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Judgement {
    /// The merits are those of the state.
    Done,
    /// No state: more intersects than the limits allow, or positions are out of range.
    Refused,
    /// Time was up.
    OutOfTime,
}

/// Judges states of one mesh, reusing its memory.
#[derive(Debug, Default)]
pub(super) struct Judge {
    pub(super) merits: Merits,
    frame: Frame,
    intersector: Intersector,
    found: Intersections,
}

impl Judge {
    /// Marks the islands that intersect others that are marked, in the state that was judged last.
    pub(super) fn spread_worse(&self, mesh: &Mesh, islands: &Islands, is_worse: &mut [bool]) {
        let before = is_worse.to_vec();
        for found in &self.found.edge_face {
            let ([a, b], [c, d, e]) = (mesh.edge(found.edge), mesh.face(found.face));
            let touched = [a, b, c, d, e].map(|vertex| islands.of(vertex));
            if touched.iter().any(|&island| before[island]) {
                touched.into_iter().for_each(|island| is_worse[island] = true);
            }
        }
    }

    /// Judges a state, exactly: by all of its intersections.
    ///
    /// Cost: one search for intersections.
    pub(super) fn judge(
        &mut self,
        mesh: &Mesh,
        positions: &[Point3<f64>],
        islands: &Islands,
        limits: SearchLimits,
        should_stop: &dyn Fn() -> bool,
    ) -> Judgement {
        if self.frame.set(mesh, positions.iter().map(|point| (*point).into())).is_err() {
            return Judgement::Refused;
        }
        let mut observer = StopObserver(should_stop);
        match self.intersector.intersect_within(mesh, &self.frame, limits, &mut observer, &mut self.found) {
            SearchEnd::Complete => {
                self.merits.measure(mesh, &self.frame, &self.found, islands);
                Judgement::Done
            }
            SearchEnd::TooManyPairs => Judgement::Refused,
            SearchEnd::OutOfTime => Judgement::OutOfTime,
        }
    }
}
