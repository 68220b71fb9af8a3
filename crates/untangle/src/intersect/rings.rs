//! The vertices round each vertex, in turn: known from the topology, listed once.

use super::boxes::WIDTH;
use crate::mesh::{FaceId, Mesh, VertexId};

/// Rings among which those of as many neighbours are looked for: near each other, as long as their vertices are.
const WINDOW: usize = 1024;

/// Rings of all vertices whose faces could meet beyond them.
#[derive(Debug, Default)]
pub(crate) struct Rings {
    centres: Vec<VertexId>,
    offsets: Vec<u32>,
    around: Vec<VertexId>,
    /// Most of those that close, in eights.
    eights: Vec<Eight>,
    /// Their neighbours, side by side.
    around_eights: Vec<[u32; WIDTH]>,
    /// All others.
    others: Vec<u32>,
}

/// Eight rings that close, of as many neighbours each.
#[derive(Debug)]
struct Eight {
    numbers: [u32; WIDTH],
    centres: [u32; WIDTH],
    /// In `around_eights`.
    start: u32,
    num_around: u32,
}

/// Eight rings side by side, as indices of vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EightRings<'a> {
    /// Their own numbers.
    pub(crate) numbers: &'a [u32; WIDTH],
    pub(crate) centres: &'a [u32; WIDTH],
    /// Their neighbours in turn, each once.
    pub(crate) around: &'a [[u32; WIDTH]],
}

/// The neighbourhood of one vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ring<'a> {
    pub(crate) centre: VertexId,
    /// Its neighbours in turn, one face between each two; a ring that closes ends in its first vertex again. Empty where the faces do not form
    /// one simple fan.
    pub(crate) around: &'a [VertexId],
}

impl Rings {
    /// Rings of the corners of `faces`, in the order in which these first have them. Cost: linear in the faces, but quadratic round one
    /// vertex.
    pub(crate) fn new(mesh: &Mesh, faces: &[FaceId]) -> Self {
        let mut rings = Self { offsets: vec![0], ..Self::default() };
        let mut is_listed = vec![false; mesh.num_vertices()];
        let mut rest = Vec::new();
        for &face in faces {
            for centre in mesh.face(face) {
                if std::mem::replace(&mut is_listed[centre.index()], true) {
                    continue;
                }
                let first = rings.around.len();
                let is_simple = rings.walk(mesh, centre, &mut rest);
                let ring = &rings.around[first..];
                let closes = is_simple && ring.first() == ring.last();
                // Faces of so few that each shares an edge with each other one can't meet.
                let are_all_joined = is_simple && ring.len() - 1 <= if closes { 3 } else { 2 };
                if are_all_joined || !is_simple {
                    rings.around.truncate(first);
                }
                if !are_all_joined {
                    rings.centres.push(centre);
                    rings.offsets.push(small(rings.around.len()));
                }
            }
        }
        rings.put_side_by_side();
        rings
    }

    /// Sorts the rings into eights of as many neighbours, and others.
    fn put_side_by_side(&mut self) {
        let mut window = Vec::new();
        for first in (0..self.len()).step_by(WINDOW) {
            window.clear();
            for ring in first..(first + WINDOW).min(self.len()) {
                let around = self.get(ring).around;
                let closes = around.len() > 1 && around.first() == around.last();
                window.push((if closes { around.len() - 1 } else { 0 }, ring));
            }
            window.sort_unstable();
            for alike in window.chunk_by(|a, b| a.0 == b.0) {
                let num_around = alike[0].0;
                let (in_eights, others) = alike.split_at(if num_around > 0 { alike.len() / WIDTH * WIDTH } else { 0 });
                for eight in in_eights.chunks_exact(WIDTH) {
                    let rings: [usize; WIDTH] = std::array::from_fn(|lane| eight[lane].1);
                    let start = small(self.around_eights.len());
                    for step in 0..num_around {
                        self.around_eights.push(rings.map(|ring| self.get(ring).around[step].0));
                    }
                    let centres = rings.map(|ring| self.centres[ring].0);
                    let num_around = small(num_around);
                    self.eights.push(Eight { numbers: rings.map(small), centres, start, num_around });
                }
                self.others.extend(others.iter().map(|&(_, ring)| small(ring)));
            }
        }
    }

    /// How many rings are listed in eights, in eights of rings.
    pub(crate) fn num_eights(&self) -> usize {
        self.eights.len()
    }

    #[inline(always)]
    pub(crate) fn eight(&self, index: usize) -> EightRings<'_> {
        let Eight { numbers, centres, start, num_around } = &self.eights[index];
        let around = &self.around_eights[*start as usize..(*start + *num_around) as usize];
        EightRings { numbers, centres, around }
    }

    /// The rings that are in no eight.
    pub(crate) fn others(&self) -> &[u32] {
        &self.others
    }

    /// Appends the ring; false if the faces do not form one simple fan.
    fn walk(&mut self, mesh: &Mesh, centre: VertexId, rest: &mut Vec<[VertexId; 2]>) -> bool {
        let faces = mesh.vertex_faces(centre);
        if faces.len() > super::neighbours::MOST_FACES {
            return false;
        }
        rest.clear();
        rest.extend(faces.iter().map(|&face| {
            let corners = mesh.face(face);
            let at = corners.iter().position(|&corner| corner == centre).unwrap_or_default();
            [corners[(at + 1) % 3], corners[(at + 2) % 3]]
        }));
        let is_end =
            |vertex: VertexId, sides: &[[VertexId; 2]]| sides.iter().filter(|side| side.contains(&vertex)).count() == 1;
        let start = rest.iter().flatten().copied().find(|&vertex| is_end(vertex, rest)).unwrap_or(rest[0][0]);
        let first = self.around.len();
        self.around.push(start);
        let mut last = start;
        while let Some(next) = rest.iter().position(|side| side.contains(&last)) {
            let [a, b] = rest.swap_remove(next);
            last = if a == last { b } else { a };
            if self.around[first + 1..].contains(&last) || (last == start && !rest.is_empty()) {
                return false;
            }
            self.around.push(last);
        }
        rest.is_empty()
    }

    /// Number of rings.
    pub(crate) fn len(&self) -> usize {
        self.centres.len()
    }

    #[inline(always)]
    pub(crate) fn get(&self, index: usize) -> Ring<'_> {
        let around = &self.around[self.offsets[index] as usize..self.offsets[index + 1] as usize];
        Ring { centre: self.centres[index], around }
    }
}

fn small(index: usize) -> u32 {
    u32::try_from(index).expect("two for each corner of a face at most")
}
