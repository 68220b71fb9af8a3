//! Chords of a circle: which chains at a loop vertex may be joined.
//!
//! The branches at a vertex are places on a circle, seen from above the vertex. A chain that folds back there is a
//! chord between its own two branches; two chains that are joined are two chords, from bounded to bounded and from free
//! to free branch. A reading of the paths is possible only if no two chords cross.

/// One of the two copies of a chain where it leaves a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    /// Place of its face in the fan of the vertex.
    pub(crate) rank: usize,
    /// Direction within the face.
    pub(crate) fraction: f64,
    /// Index of its chain in the group of chains at the vertex.
    pub(crate) member: usize,
    /// Whether it belongs to the copy that ends on the boundary.
    pub(crate) bounded: bool,
}

/// The chords of all chains at a vertex: each place on the circle of branches has a mate.
#[derive(Debug, Default)]
pub(crate) struct Chords {
    mates: Vec<usize>,
    /// Places of the bounded and of the free branch of each chain.
    places: Vec<[usize; 2]>,
    joined: Vec<bool>,
    /// Number of chords that cross the chord of each chain, and of pairs of chords that cross in all.
    crossings: Vec<usize>,
    num_crossings: usize,
}

impl Chords {
    /// Draws the chords of chains that are all folded back; `branches` are in their order round the vertex.
    ///
    /// Cost: quadratic in the chains.
    pub(crate) fn reset(&mut self, branches: &[Branch], num_chains: usize) {
        self.mates.clear();
        self.mates.resize(2 * num_chains, 0);
        self.places.clear();
        self.places.resize(num_chains, [0; 2]);
        self.joined.clear();
        self.joined.resize(num_chains, false);
        for (place, branch) in branches.iter().enumerate() {
            self.places[branch.member][usize::from(!branch.bounded)] = place;
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
    pub(crate) fn can_join(&self, i: usize, j: usize) -> bool {
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

    /// Joins two chains that [can be joined](Self::can_join).
    pub(crate) fn join(&mut self, i: usize, j: usize) {
        for (a, b) in self.places[i].into_iter().zip(self.places[j]) {
            (self.mates[a], self.mates[b]) = (b, a);
        }
        self.joined[i] = true;
        self.joined[j] = true;
        // Only chains whose joining leaves no crossing are joined.
        self.crossings.fill(0);
        self.num_crossings = 0;
    }
}

/// Whether two chords of a circle cross, given the places of their ends along it; all four differ.
fn chords_cross([a, b]: [usize; 2], [c, d]: [usize; 2]) -> bool {
    let between = |x: usize| a.min(b) < x && x < a.max(b);
    between(c) != between(d)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether no two of these chords cross, from the definition.
    fn is_planar(chords: &[[usize; 2]]) -> bool {
        chords.iter().enumerate().all(|(i, &a)| chords[i + 1..].iter().all(|&b| !chords_cross(a, b)))
    }

    #[test]
    fn can_join_allows_exactly_what_leaves_no_crossing() {
        let mut state = 1u64;
        let mut next = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            usize::try_from(state >> 33).unwrap() % below
        };
        let (mut chords, mut num_joins) = (Chords::default(), 0);
        for _ in 0..3_000 {
            let count = 2 + next(5);
            let mut branches: Vec<Branch> =
                (0..2 * count).map(|k| Branch { rank: 0, fraction: 0.0, member: k / 2, bounded: k % 2 == 0 }).collect();
            for k in (1..branches.len()).rev() {
                branches.swap(k, next(k + 1));
            }
            chords.reset(&branches, count);
            let place = |member: usize, bounded: bool| {
                branches.iter().position(|branch| branch.member == member && branch.bounded == bounded).unwrap()
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
                    assert_eq!(chords.can_join(i, j), expected, "{branches:?} {partner:?} {i} {j}");
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

    #[test]
    fn chords_cross_where_their_ends_alternate() {
        assert!(chords_cross([0, 2], [1, 3]));
        assert!(!chords_cross([0, 1], [2, 3]));
        assert!(!chords_cross([0, 3], [2, 1]));
    }
}
