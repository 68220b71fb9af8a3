//! From an analysis to labels.

use super::{VertexLabel, surroundings::Surroundings};
use crate::{
    analysis::Analysis,
    frame::Frame,
    geometry::mean_edge_length,
    mesh::{Mesh, VertexId},
    settings::Settings,
};

/// Finds labels, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Labeller {
    surroundings: [Surroundings; 2],
}

/// What does not change while the labels of one frame are found.
#[derive(Clone, Copy)]
struct View<'a> {
    mesh: &'a Mesh,
    frame: &'a Frame,
    analysis: &'a Analysis,
    settings: &'a Settings,
}

/// A vertex's part in a tangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    InsideOrNear,
    WithinReach,
}

impl Labeller {
    /// Writes the labels of a frame into `labels`, by vertex and pair, no vertex twice with one pair. Pairs for which
    /// there was no time have labels near their paths only.
    ///
    /// Cost: for each pair O(n log n) in the vertices inside and within reach.
    pub fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        analysis: &Analysis,
        settings: &Settings,
        labels: &mut Vec<VertexLabel>,
    ) {
        labels.clear();
        let view = View { mesh, frame, analysis, settings };
        for (place, &copy) in analysis.regions.order.iter().enumerate() {
            if copy <= analysis.paths.copies[copy].partner {
                self.label_pair(&view, copy, place < analysis.regions.num_done, labels);
            }
        }
        labels.sort_unstable();
        labels.dedup_by(|later, kept| {
            let is_same = later.vertex == kept.vertex && later.pair() == kept.pair();
            if is_same {
                kept.label |= later.side();
            }
            is_same
        });
    }

    /// Labels the surroundings of a path and of its partner.
    fn label_pair(&mut self, view: &View<'_>, first: usize, is_done: bool, labels: &mut Vec<VertexLabel>) {
        let View { mesh, frame, analysis, .. } = *view;
        let partner = analysis.paths.copies[first].partner;
        let both = [first, partner];
        let num_paths = if partner == first { 1 } else { 2 };
        let mut depths_m = [0.0; 2];
        let mut is_divided = false;
        for (index, &copy) in both[..num_paths].iter().enumerate() {
            let around = &mut self.surroundings[index];
            around.start(mesh, frame, analysis, &analysis.paths.copies[copy]);
            depths_m[index] = around.depth_m(mesh, frame, analysis.regions.vertices_of(copy));
            is_divided |= analysis.regions.by_copy[copy].as_ref().is_some_and(|region| region.partitioning);
        }
        if num_paths == 1 {
            depths_m[1] = depths_m[0];
        }
        let pair = &analysis.paths.pairs[analysis.paths.copies[first].pair];
        let slip_m = if is_divided || !is_done || pair.closed { 0.0 } else { 0.5 * pair.length_m };
        let margin_m = margin_m(view, first);
        let near_m = margin_m.max(slip_m);
        let is_joint = analysis.regions.by_copy[first].as_ref().is_some_and(|region| region.joint);
        let writer = Writer { view, first, is_twofold: num_paths == 2 && depths_m.iter().all(|&depth| depth > near_m) };
        for (index, &copy) in both[..num_paths].iter().enumerate() {
            let sheet = match num_paths {
                1 => VertexLabel::BOTH,
                _ => [VertexLabel::FIRST, VertexLabel::SECOND][index],
            };
            let inside = if is_joint { VertexLabel::BOTH } else { sheet };
            for &vertex in analysis.regions.vertices_of(copy) {
                writer.write(vertex, inside, Part::InsideOrNear, labels);
            }
            let range = [near_m, depths_m[1 - index] + margin_m];
            self.surroundings[index].visit(mesh, frame, range, |vertex, is_near| {
                let part = if is_near { Part::InsideOrNear } else { Part::WithinReach };
                writer.write(vertex, sheet, part, labels);
            });
        }
    }
}

/// Writes the labels of one pair.
struct Writer<'a> {
    view: &'a View<'a>,
    first: usize,
    /// Whether both sheets have vertices within reach only, so that one number can't keep them apart.
    is_twofold: bool,
}

impl Writer<'_> {
    fn write(&self, vertex: VertexId, side: u32, part: Part, labels: &mut Vec<VertexLabel>) {
        let paths = &self.view.analysis.paths;
        let pair = paths.copies[self.first].pair;
        let mut push = |pair: usize, side: u32| {
            #[expect(clippy::cast_possible_truncation, reason = "there are fewer pairs than 2^29")]
            labels.push(VertexLabel { vertex, label: 4 * pair as u32 + side });
        };
        let second_number = pair + paths.pairs.len();
        match part {
            Part::InsideOrNear => {
                push(pair, side);
                if self.is_twofold {
                    push(second_number, side);
                }
            }
            // On one sheet alone two vertices within reach would not meet a label of the other side.
            Part::WithinReach if side == VertexLabel::BOTH => push(pair, VertexLabel::FIRST),
            Part::WithinReach if self.is_twofold && side == VertexLabel::FIRST => push(second_number, side),
            Part::WithinReach => push(pair, side),
        }
    }
}

/// Half the thickness of the cloth, in metres; half a mean edge of the faces along the path where none is set.
fn margin_m(view: &View<'_>, copy: usize) -> f64 {
    let paths = &view.analysis.paths;
    let segments = &paths.segments[paths.copies[copy].segments.clone()];
    let faces = segments.iter().flat_map(|segment| [segment.own, segment.partner]);
    let thickness_m = view.settings.thickness_m.or_else(|| mean_edge_length(view.mesh, view.frame, faces));
    0.5 * thickness_m.unwrap_or(0.0)
}
