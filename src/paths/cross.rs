//! CROSS: two chains from the boundary that meet in one loop vertex, joined to a path that passes through it.
//!
//! Each chain leaves the vertex along two half-paths on the cloth, `A`, which ends on the boundary, and `B`, which ends inside.
//! Seen from above the vertex, joining `A` with `A` and `B` with `B` of another chain, or leaving `A` folded back to `B`, draws chords in the
//! circle of half-paths. A reading of the paths is possible only if its chords do not cross.
//!
//! BLLB: two chains from different loop vertices that end on boundaries which touch exactly there.

use super::{
    fan::{chords_cross, direction, ordered_fan},
    view::{BoundaryEnd, ChainView, Ends},
};
use crate::mesh::{FaceId, VertexId};

/// What becomes of a chain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Join {
    /// It is a path pair by itself.
    #[default]
    Alone,
    /// It is one half of a CROSS, together with a chain of a higher index.
    Cross { partner: usize },
    /// It is one half of a BLLB, together with a chain of a higher index.
    Touching { partner: usize },
    /// It is the other half of either.
    Second,
}

#[derive(Debug, Default)]
pub(crate) struct Crosses {
    joins: Vec<Join>,
    /// Chains that may be joined, by their loop vertex.
    candidates: Vec<(VertexId, usize)>,
    /// The vertices next to the ends of chains on the boundary.
    touching: Vec<Touching>,
    fan: Vec<(FaceId, VertexId)>,
    half_paths: Vec<HalfPath>,
}

/// A boundary vertex next to the end of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Touching {
    place: [u64; 3],
    vertex: VertexId,
    chain: usize,
    loop_vertex: VertexId,
}

impl Touching {
    fn meets(&self, other: &Self) -> bool {
        self.vertex != other.vertex && self.chain != other.chain && self.loop_vertex != other.loop_vertex
    }
}

/// A half-path at a vertex, sorted round it.
#[derive(Clone, Copy, Debug)]
struct HalfPath {
    rank: usize,
    fraction: f64,
    chain: usize,
    bounded: bool,
}

impl Crosses {
    /// Decides for all chains.
    pub(crate) fn join(&mut self, view: &ChainView<'_>) {
        let num_chains = view.chains.chains.len();
        self.joins.clear();
        self.joins.resize(num_chains, Join::Alone);
        self.candidates.clear();
        for chain in 0..num_chains {
            if let Ends::LoopBoundary(vertex, _) = view.ends(chain) {
                self.candidates.push((vertex, chain));
            }
        }
        self.candidates.sort_unstable();
        let mut rest = std::mem::take(&mut self.candidates);
        for group in rest.chunk_by_mut(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            // Where several readings are possible the shortest paths are joined: a choice that no numbering can change.
            group.sort_by(|a, b| view.length_m(a.1).total_cmp(&view.length_m(b.1)));
            self.join_at(view, group[0].0, group);
        }
        self.join_touching(view, &rest);
        self.candidates = rest;
    }

    /// Joins what is left where two chains end on boundaries that touch: two vertices of one position, one on each.
    fn join_touching(&mut self, view: &ChainView<'_>, candidates: &[(VertexId, usize)]) {
        self.touching.clear();
        for &(loop_vertex, chain) in candidates.iter().filter(|&&(_, chain)| self.joins[chain] == Join::Alone) {
            if let Ends::LoopBoundary(_, BoundaryEnd { edge, .. }) = view.ends(chain)
                && view.mesh.is_boundary_edge(edge)
            {
                for vertex in view.mesh.edge(edge) {
                    // Positions are compared as they are; adding zero makes one zero of two.
                    let place = view.frame.position(vertex).coords.map(|x| (x + 0.0).to_bits()).into();
                    self.touching.push(Touching { place, vertex, chain, loop_vertex });
                }
            }
        }
        self.touching.sort_unstable();
        for group in self.touching.chunk_by(|a, b| a.place == b.place) {
            let (Some(first), Some(second)) = (group.first(), group.iter().find(|end| end.meets(&group[0]))) else {
                continue;
            };
            if self.joins[first.chain] == Join::Alone && self.joins[second.chain] == Join::Alone {
                let (lower, higher) = (first.chain.min(second.chain), first.chain.max(second.chain));
                self.joins[lower] = Join::Touching { partner: higher };
                self.joins[higher] = Join::Second;
            }
        }
    }

    /// What becomes of one chain.
    pub(crate) fn of_chain(&self, chain: usize) -> Join {
        self.joins[chain]
    }

    fn join_at(&mut self, view: &ChainView<'_>, vertex: VertexId, group: &[(VertexId, usize)]) {
        if !ordered_fan(view.mesh, vertex, &mut self.fan) || !self.sort_half_paths(view, vertex, group) {
            return;
        }
        for (i, &(_, first)) in group.iter().enumerate() {
            for &(_, second) in &group[i + 1..] {
                let both_free = self.joins[first] == Join::Alone && self.joins[second] == Join::Alone;
                if both_free && self.is_planar(group, (first, second)) {
                    let (lower, higher) = (first.min(second), first.max(second));
                    self.joins[lower] = Join::Cross { partner: higher };
                    self.joins[higher] = Join::Second;
                }
            }
        }
    }

    /// Puts the half-paths of a group in their order round the vertex; false if one does not lie in its fan.
    fn sort_half_paths(&mut self, view: &ChainView<'_>, vertex: VertexId, group: &[(VertexId, usize)]) -> bool {
        self.half_paths.clear();
        for &(_, chain) in group {
            let Ends::LoopBoundary(_, BoundaryEnd { bounded, .. }) = view.ends(chain) else { return false };
            for copy in [bounded, 1 - bounded] {
                let towards = view.surface_point(chain, copy, 1);
                let face = view.face(chain, copy, 0);
                let Some((rank, fraction)) = direction(view.mesh, vertex, &self.fan, face, towards) else {
                    return false;
                };
                self.half_paths.push(HalfPath { rank, fraction, chain, bounded: copy == bounded });
            }
        }
        self.half_paths.sort_by(|a, b| a.rank.cmp(&b.rank).then(a.fraction.total_cmp(&b.fraction)));
        true
    }

    /// Whether the chords of all chains of the group, with this pair joined too, do not cross.
    fn is_planar(&self, group: &[(VertexId, usize)], pair: (usize, usize)) -> bool {
        let place = |chain: usize, bounded: bool| {
            let here = |half: &HalfPath| half.chain == chain && half.bounded == bounded;
            self.half_paths.iter().position(here).unwrap_or_default()
        };
        let joined = |a: usize, b: usize| [[place(a, true), place(b, true)], [place(a, false), place(b, false)]];
        let mut chords: Vec<[usize; 2]> = joined(pair.0, pair.1).to_vec();
        for &(_, chain) in group.iter().filter(|&&(_, chain)| chain != pair.0 && chain != pair.1) {
            match self.joins[chain] {
                Join::Alone => chords.push([place(chain, true), place(chain, false)]),
                Join::Cross { partner } => chords.extend(joined(chain, partner)),
                Join::Second | Join::Touching { .. } => {}
            }
        }
        chords.iter().enumerate().all(|(i, &a)| chords[i + 1..].iter().all(|&b| !chords_cross(a, b)))
    }
}
