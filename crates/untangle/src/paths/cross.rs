//! CROSS: two chains from the boundary that meet in one loop vertex, joined to a path that passes through it.
//!
//! Each chain leaves the vertex along two half-paths on the cloth, `A`, which ends on the boundary, and `B`, which ends
//! inside. Seen from above the vertex, joining `A` with `A` and `B` with `B` of another chain, or leaving `A` folded
//! back to `B`, draws chords in the circle of half-paths. A reading of the paths is possible only if its chords do not
//! cross.
//!
//! BLLB: two chains from different loop vertices that end on boundaries which touch exactly there.

use super::{
    fan::{FanOrder, chords_cross, ordered_fan},
    view::{BoundaryEnd, ChainView, Ends},
};
use crate::mesh::{EdgeId, FaceId, VertexId};

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
    ranks: Vec<(FaceId, usize)>,
    half_paths: Vec<HalfPath>,
    chords: Chords,
}

/// A boundary vertex next to the end of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Touching {
    place: [u64; 3],
    vertex: VertexId,
    loop_vertex: VertexId,
    /// Tells the chains of one loop vertex apart, whatever their numbers.
    crossing: (EdgeId, [VertexId; 3]),
    chain: usize,
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
    /// In the group of chains at the vertex.
    member: usize,
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
            // Lengths that are exactly equal are told apart by where the paths end, which the order of faces can't
            // change.
            group.sort_unstable_by_key(|&(_, chain)| {
                // Not negative, so that the bits are in the order of the values.
                (view.length_m(chain).to_bits(), view.last_crossing(chain), chain)
            });
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
                    let crossing = view.last_crossing(chain);
                    self.touching.push(Touching { place, vertex, loop_vertex, crossing, chain });
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
        self.chords.begin(&self.half_paths, group.len());
        for i in 0..group.len() {
            let Some(j) = (i + 1..group.len()).find(|&j| self.chords.can_join(i, j)) else { continue };
            self.chords.join(i, j);
            let (lower, higher) = (group[i].1.min(group[j].1), group[i].1.max(group[j].1));
            self.joins[lower] = Join::Cross { partner: higher };
            self.joins[higher] = Join::Second;
        }
    }

    /// Puts the half-paths of a group in their order round the vertex; false if one does not lie in its fan.
    fn sort_half_paths(&mut self, view: &ChainView<'_>, vertex: VertexId, group: &[(VertexId, usize)]) -> bool {
        self.half_paths.clear();
        let fan = FanOrder::new(&self.fan, &mut self.ranks);
        for (member, &(_, chain)) in group.iter().enumerate() {
            let Ends::LoopBoundary(_, BoundaryEnd { bounded, .. }) = view.ends(chain) else { return false };
            for copy in [bounded, 1 - bounded] {
                let towards = view.surface_point(chain, copy, 1);
                let face = view.face(chain, copy, 0);
                let Some((rank, fraction)) = fan.direction(view.mesh, vertex, face, towards) else {
                    return false;
                };
                self.half_paths.push(HalfPath { rank, fraction, member, bounded: copy == bounded });
            }
        }
        self.half_paths.sort_by(|a, b| a.rank.cmp(&b.rank).then(a.fraction.total_cmp(&b.fraction)));
        true
    }
}

/// The chords of all chains at a vertex: each place on the circle of half-paths has its mate.
#[derive(Debug, Default)]
struct Chords {
    mates: Vec<usize>,
    /// Places of the bounded and of the free half-path of each chain.
    places: Vec<[usize; 2]>,
    joined: Vec<bool>,
    /// Number of chords that cross the chord of each chain, and of pairs of chords that cross in all.
    crossings: Vec<usize>,
    num_crossings: usize,
}

impl Chords {
    /// Every chain folded back.
    fn begin(&mut self, half_paths: &[HalfPath], num_chains: usize) {
        self.mates.clear();
        self.mates.resize(2 * num_chains, 0);
        self.places.clear();
        self.places.resize(num_chains, [0; 2]);
        self.joined.clear();
        self.joined.resize(num_chains, false);
        for (place, half) in half_paths.iter().enumerate() {
            self.places[half.member][usize::from(!half.bounded)] = place;
        }
        for &[a, b] in &self.places {
            (self.mates[a], self.mates[b]) = (b, a);
        }
        self.count();
    }

    fn count(&mut self) {
        let places = &self.places;
        let crosses = |i: usize, j: usize| i != j && chords_cross(places[i], places[j]);
        self.crossings.clear();
        self.crossings.extend((0..places.len()).map(|i| (0..places.len()).filter(|&j| crosses(i, j)).count()));
        self.num_crossings = self.crossings.iter().sum::<usize>() / 2;
    }

    /// Whether no chords cross once two chains that are still folded are joined.
    fn can_join(&self, i: usize, j: usize) -> bool {
        if self.joined[i] || self.joined[j] {
            return false;
        }
        // All chords that cross have to be those of these two.
        let both = usize::from(chords_cross(self.places[i], self.places[j]));
        if self.num_crossings + both != self.crossings[i] + self.crossings[j] {
            return false;
        }
        let [[a, c], [b, d]] = [self.places[i], self.places[j]];
        !chords_cross([a, b], [c, d]) && [[a, b], [c, d]].into_iter().all(|chord| self.is_free(chord, [a, b, c, d]))
    }

    /// Whether no chord but those of the four `ends` crosses this one.
    fn is_free(&self, [a, b]: [usize; 2], ends: [usize; 4]) -> bool {
        let within = a.min(b) + 1..a.max(b);
        within.clone().all(|place| ends.contains(&place) || within.contains(&self.mates[place]))
    }

    fn join(&mut self, i: usize, j: usize) {
        for (a, b) in self.places[i].into_iter().zip(self.places[j]) {
            (self.mates[a], self.mates[b]) = (b, a);
        }
        self.joined[i] = true;
        self.joined[j] = true;
        // Or they would not have been joined.
        self.crossings.fill(0);
        self.num_crossings = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether no two of these chords cross, from the definition.
    fn is_planar(chords: &[[usize; 2]]) -> bool {
        chords.iter().enumerate().all(|(i, &a)| chords[i + 1..].iter().all(|&b| !chords_cross(a, b)))
    }

    #[test]
    fn joins_are_those_that_leave_no_crossing() {
        let mut state = 1u64;
        let mut next = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            usize::try_from(state >> 33).unwrap() % below
        };
        let (mut chords, mut num_joins) = (Chords::default(), 0);
        for _ in 0..3_000 {
            let count = 2 + next(5);
            let mut half_paths: Vec<HalfPath> = (0..2 * count)
                .map(|k| HalfPath { rank: 0, fraction: 0.0, member: k / 2, bounded: k % 2 == 0 })
                .collect();
            for k in (1..half_paths.len()).rev() {
                half_paths.swap(k, next(k + 1));
            }
            chords.begin(&half_paths, count);
            let place = |member: usize, bounded: bool| {
                half_paths.iter().position(|half| half.member == member && half.bounded == bounded).unwrap()
            };
            let mut partner: Vec<Option<usize>> = vec![None; count];
            let reading = |partner: &[Option<usize>]| -> Vec<[usize; 2]> {
                let chord = |(i, &j): (usize, &Option<usize>)| match j {
                    None => vec![[place(i, true), place(i, false)]],
                    Some(j) if i < j => vec![[place(i, true), place(j, true)], [place(i, false), place(j, false)]],
                    Some(_) => vec![],
                };
                partner.iter().enumerate().flat_map(chord).collect()
            };
            for i in 0..count {
                for j in i + 1..count {
                    let mut joined = partner.clone();
                    (joined[i], joined[j]) = (Some(j), Some(i));
                    let is_free = partner[i].is_none() && partner[j].is_none();
                    let expected = is_free && is_planar(&reading(&joined));
                    assert_eq!(chords.can_join(i, j), expected, "{half_paths:?} {partner:?} {i} {j}");
                    if expected && next(2) == 0 {
                        chords.join(i, j);
                        partner = joined;
                        num_joins += 1;
                    }
                }
            }
        }
        assert!(num_joins > 500, "{num_joins}");
    }
}
