//! CROSS: two chains from the boundary that meet in one loop vertex, joined to a path that passes through it.
//!
//! Each chain leaves the vertex along two branches on the cloth, its copies: `A`, which ends on the boundary, and `B`,
//! which ends inside. Joining `A` with `A` and `B` with `B` of another chain, or leaving `A` folded back to `B`, draws
//! [chords](super::chords) in the circle of branches round the vertex; chains are joined only where no chords cross.
//!
//! BLLB: two chains from different loop vertices that end on boundaries which touch exactly there.

use super::{
    chords::{Branch, Chords},
    fan::{FanOrder, ordered_fan},
    view::{BoundaryEnd, ChainView, Ends},
};
use crate::mesh::{EdgeId, FaceId, VertexId};

/// How a chain is joined with others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Join {
    /// It is a path pair of its own.
    #[default]
    Alone,
    /// It is one half of a CROSS, together with a chain of a higher index.
    Cross { partner: usize },
    /// It is one half of a BLLB, together with a chain of a higher index.
    Touching { partner: usize },
    /// It is the other half of either.
    Second,
}

/// Joins the chains of a frame, reusing its memory.
#[derive(Debug, Default)]
pub(crate) struct Joiner {
    joins: Vec<Join>,
    /// Chains from a loop vertex to the boundary, by their loop vertex.
    loop_chains: Vec<(VertexId, usize)>,
    /// The boundary vertices next to the ends of these chains.
    boundary_ends: Vec<EndVertex>,
    fan: Vec<(FaceId, VertexId)>,
    ranks: Vec<(FaceId, usize)>,
    branches: Vec<Branch>,
    chords: Chords,
}

/// A boundary vertex next to the end of a chain, with the bits of its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct EndVertex {
    place: [u64; 3],
    vertex: VertexId,
    loop_vertex: VertexId,
    /// Orders the chains of one loop vertex independently of their numbers.
    crossing: (EdgeId, [VertexId; 3]),
    chain: usize,
}

impl EndVertex {
    fn meets(&self, other: &Self) -> bool {
        self.vertex != other.vertex && self.chain != other.chain && self.loop_vertex != other.loop_vertex
    }
}

impl Joiner {
    /// Decides for all chains.
    ///
    /// Cost: where k chains meet in one loop vertex, O(k^2) for these and O(k^3) at worst.
    pub(crate) fn join(&mut self, view: &ChainView<'_>) {
        let num_chains = view.chains.chains.len();
        self.joins.clear();
        self.joins.resize(num_chains, Join::Alone);
        self.loop_chains.clear();
        for chain in 0..num_chains {
            if let Ends::LoopBoundary(vertex, _) = view.ends(chain) {
                self.loop_chains.push((vertex, chain));
            }
        }
        self.loop_chains.sort_unstable();
        let mut rest = std::mem::take(&mut self.loop_chains);
        for group in rest.chunk_by_mut(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            // Where several readings are possible the shortest paths are joined: a choice that no numbering can change.
            // Lengths that are exactly equal are told apart by where the paths end, which the order of faces can't
            // change.
            group.sort_unstable_by_key(|&(_, chain)| {
                // Not negative, so that the bits are in the order of the values.
                (view.length_m(chain).to_bits(), view.last_crossing(chain), chain)
            });
            self.join_at(view, group[0].0, group);
        }
        self.join_touching(view, &rest);
        self.loop_chains = rest;
    }

    /// Joins two of the remaining chains where they end on boundaries that touch: two vertices of one position, one on
    /// each.
    fn join_touching(&mut self, view: &ChainView<'_>, loop_chains: &[(VertexId, usize)]) {
        self.boundary_ends.clear();
        for &(loop_vertex, chain) in loop_chains.iter().filter(|&&(_, chain)| self.joins[chain] == Join::Alone) {
            if let Ends::LoopBoundary(_, BoundaryEnd { edge, .. }) = view.ends(chain)
                && view.mesh.is_boundary_edge(edge)
            {
                for vertex in view.mesh.edge(edge) {
                    // Positions are compared by their bits; adding zero turns a negative zero into a positive one.
                    let place = view.frame.position(vertex).coords.map(|x| (x + 0.0).to_bits()).into();
                    let crossing = view.last_crossing(chain);
                    self.boundary_ends.push(EndVertex { place, vertex, loop_vertex, crossing, chain });
                }
            }
        }
        self.boundary_ends.sort_unstable();
        for group in self.boundary_ends.chunk_by(|a, b| a.place == b.place) {
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

    /// How one chain is joined.
    pub(crate) fn of_chain(&self, chain: usize) -> Join {
        self.joins[chain]
    }

    /// Joins the chains of one loop vertex, the shortest first, with each the first of the others that it can be joined
    /// with.
    fn join_at(&mut self, view: &ChainView<'_>, vertex: VertexId, group: &[(VertexId, usize)]) {
        if !ordered_fan(view.mesh, vertex, &mut self.fan) || !self.sort_branches(view, vertex, group) {
            return;
        }
        self.chords.reset(&self.branches, group.len());
        for i in 0..group.len() {
            let Some(j) = (i + 1..group.len()).find(|&j| self.chords.can_join(i, j)) else { continue };
            self.chords.join(i, j);
            let (lower, higher) = (group[i].1.min(group[j].1), group[i].1.max(group[j].1));
            self.joins[lower] = Join::Cross { partner: higher };
            self.joins[higher] = Join::Second;
        }
    }

    /// Puts the branches of a group in their order round the vertex; false if one does not lie in its fan.
    fn sort_branches(&mut self, view: &ChainView<'_>, vertex: VertexId, group: &[(VertexId, usize)]) -> bool {
        self.branches.clear();
        let fan = FanOrder::new(&self.fan, &mut self.ranks);
        for (member, &(_, chain)) in group.iter().enumerate() {
            let Ends::LoopBoundary(_, BoundaryEnd { bounded, .. }) = view.ends(chain) else { return false };
            for copy in [bounded, 1 - bounded] {
                let towards = view.surface_point(chain, copy, 1);
                let face = view.face(chain, copy, 0);
                let Some((rank, fraction)) = fan.direction(view.mesh, vertex, face, towards) else {
                    return false;
                };
                self.branches.push(Branch { rank, fraction, member, bounded: copy == bounded });
            }
        }
        self.branches.sort_by(|a, b| a.rank.cmp(&b.rank).then(a.fraction.total_cmp(&b.fraction)));
        true
    }
}
