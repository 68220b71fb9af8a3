//! One-rings: the neighbours of each vertex in turn, taken from the topology once for each mesh.

use crate::{
    intersect::bvh::MAX_ADJACENT_FACES,
    mesh::{FaceId, Mesh, VertexId},
    simd::F32_LANES,
};

/// Number of successive one-rings among which eight of one valence are looked for: they are as near each other as their
/// vertices are.
const BATCH_WINDOW: usize = 1024;

/// One-rings of all vertices whose faces could intersect beyond them.
#[derive(Debug, Default)]
pub(crate) struct OneRings {
    centres: Vec<VertexId>,
    offsets: Vec<u32>,
    around: Vec<VertexId>,
    /// Most of the closed ones, in batches of eight.
    batches: Vec<Batch>,
    /// The neighbours in all batches, lane by lane.
    around_batches: Vec<[u32; F32_LANES]>,
    /// Those in no batch.
    unbatched: Vec<u32>,
}

/// Eight closed one-rings of the same valence.
#[derive(Debug)]
struct Batch {
    numbers: [u32; F32_LANES],
    centres: [u32; F32_LANES],
    /// In `around_batches`.
    start: u32,
    valence: u32,
}

/// Eight closed one-rings of the same valence, side by side, as indices of vertices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneRingsX8<'a> {
    /// Their numbers among all one-rings.
    pub(crate) numbers: &'a [u32; F32_LANES],
    pub(crate) centres: &'a [u32; F32_LANES],
    /// Their neighbours in turn, each once.
    pub(crate) around: &'a [[u32; F32_LANES]],
}

/// The one-ring of one vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneRing<'a> {
    pub(crate) centre: VertexId,
    /// Its neighbours in turn, one face between each two; a closed one-ring ends in its first vertex again. Empty where
    /// the faces do not form one simple fan.
    pub(crate) around: &'a [VertexId],
}

impl OneRings {
    /// One-rings of the corners of `faces`, in the order in which these first have them, but for those of bodies.
    ///
    /// Cost: O(n log n) in the faces.
    pub(crate) fn new(mesh: &Mesh, faces: &[FaceId]) -> Self {
        let mut rings = Self { offsets: vec![0], ..Self::default() };
        let mut is_listed = vec![false; mesh.num_vertices()];
        let mut rest = Vec::new();
        for &face in faces.iter().filter(|&&face| !mesh.is_body_face(face)) {
            for centre in mesh.face(face) {
                if !std::mem::replace(&mut is_listed[centre.index()], true) {
                    rings.push(mesh, centre, &mut rest);
                }
            }
        }
        rings.batch_by_valence();
        rings
    }

    /// Appends the one-ring of a vertex, unless its faces can't intersect.
    fn push(&mut self, mesh: &Mesh, centre: VertexId, rest: &mut Vec<[VertexId; 2]>) {
        let first = self.around.len();
        let is_simple = self.walk(mesh, centre, rest);
        let ring = &self.around[first..];
        let closes = is_simple && ring.first() == ring.last();
        // Faces of so few that each shares an edge with each other one can't intersect.
        let are_all_joined = is_simple && ring.len() - 1 <= if closes { 3 } else { 2 };
        if are_all_joined || !is_simple {
            self.around.truncate(first);
        }
        if !are_all_joined {
            self.centres.push(centre);
            self.offsets.push(index_u32(self.around.len()));
        }
    }

    /// Appends the neighbours of a vertex in turn; false if its faces do not form one simple fan.
    fn walk(&mut self, mesh: &Mesh, centre: VertexId, rest: &mut Vec<[VertexId; 2]>) -> bool {
        let faces = mesh.vertex_faces(centre);
        rest.clear();
        rest.extend(faces.iter().map(|&face| {
            let corners = mesh.face(face);
            let at = corners.iter().position(|&corner| corner == centre).unwrap_or_default();
            [corners[(at + 1) % 3], corners[(at + 2) % 3]]
        }));
        if faces.len() > MAX_ADJACENT_FACES {
            return walk_many(rest, &mut self.around);
        }
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

    /// Sorts the one-rings into batches of eight of the same valence, and those that are left.
    fn batch_by_valence(&mut self) {
        let mut window = Vec::new();
        for first in (0..self.len()).step_by(BATCH_WINDOW) {
            window.clear();
            for ring in first..(first + BATCH_WINDOW).min(self.len()) {
                let around = self.get(ring).around;
                let closes = around.len() > 1 && around.first() == around.last();
                window.push((if closes { around.len() - 1 } else { 0 }, ring));
            }
            window.sort_unstable();
            for alike in window.chunk_by(|a, b| a.0 == b.0) {
                let valence = alike[0].0;
                // Stars of many faces are always tested in the same way, so that counts of their pairs are always the
                // same.
                let is_batched = (1..=MAX_ADJACENT_FACES).contains(&valence);
                let num_batched = if is_batched { alike.len() / F32_LANES * F32_LANES } else { 0 };
                let (batched, unbatched) = alike.split_at(num_batched);
                for eight in batched.chunks_exact(F32_LANES) {
                    self.push_batch(valence, std::array::from_fn(|lane| eight[lane].1));
                }
                self.unbatched.extend(unbatched.iter().map(|&(_, ring)| index_u32(ring)));
            }
        }
    }

    fn push_batch(&mut self, valence: usize, rings: [usize; F32_LANES]) {
        let start = index_u32(self.around_batches.len());
        for step in 0..valence {
            self.around_batches.push(rings.map(|ring| self.get(ring).around[step].0));
        }
        let centres = rings.map(|ring| self.centres[ring].0);
        self.batches.push(Batch { numbers: rings.map(index_u32), centres, start, valence: index_u32(valence) });
    }

    pub(crate) fn num_batches(&self) -> usize {
        self.batches.len()
    }

    #[inline(always)]
    pub(crate) fn batch(&self, index: usize) -> OneRingsX8<'_> {
        let Batch { numbers, centres, start, valence } = &self.batches[index];
        let around = &self.around_batches[*start as usize..(*start + *valence) as usize];
        OneRingsX8 { numbers, centres, around }
    }

    /// The numbers of the one-rings that are in no batch.
    pub(crate) fn unbatched(&self) -> &[u32] {
        &self.unbatched
    }

    pub(crate) fn len(&self) -> usize {
        self.centres.len()
    }

    #[inline(always)]
    pub(crate) fn get(&self, index: usize) -> OneRing<'_> {
        let around = &self.around[self.offsets[index] as usize..self.offsets[index + 1] as usize];
        OneRing { centre: self.centres[index], around }
    }
}

/// Appends the neighbours of a vertex of many faces in turn, from the sides opposite to it; false if its faces do not
/// form one simple fan. Cost: O(n log n).
fn walk_many(sides: &[[VertexId; 2]], around: &mut Vec<VertexId>) -> bool {
    let mut ends: Vec<(VertexId, usize)> =
        sides.iter().enumerate().flat_map(|(side, ends)| ends.map(|end| (end, side))).collect();
    ends.sort_unstable();
    let of_vertex = |vertex: VertexId| {
        let first = ends.partition_point(|&(end, _)| end < vertex);
        &ends[first..first + ends[first..].partition_point(|&(end, _)| end == vertex)]
    };
    if ends.chunk_by(|a, b| a.0 == b.0).any(|run| run.len() > 2) {
        return false;
    }
    let start = ends.chunk_by(|a, b| a.0 == b.0).find(|run| run.len() == 1).map_or(sides[0][0], |run| run[0].0);
    around.push(start);
    let (mut last, mut from) = (start, usize::MAX);
    for num_walked in 1..=sides.len() {
        let Some(&(_, side)) = of_vertex(last).iter().find(|&&(_, side)| side != from) else { return false };
        let [a, b] = sides[side];
        (last, from) = (if a == last { b } else { a }, side);
        if last == start && num_walked < sides.len() {
            return false;
        }
        around.push(last);
    }
    true
}

fn index_u32(index: usize) -> u32 {
    u32::try_from(index).expect("two for each corner of a face at most")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshDescription;

    /// A sheet of 20 by 20 squares, two triangles each.
    fn sheet() -> Mesh {
        let squares = (0..20).flat_map(|row| (0..20).map(move |column| 21 * row + column));
        let faces = squares.flat_map(|a| [[a, a + 1, a + 21], [a + 21, a + 1, a + 22]]).collect();
        Mesh::new(MeshDescription { num_vertices: 21 * 21, faces, ..Default::default() }).unwrap()
    }

    #[test]
    fn one_rings_of_a_sheet_are_each_in_one_batch_or_unbatched() {
        let sheet = sheet();
        let all: Vec<FaceId> = sheet.face_ids().collect();
        let rings = OneRings::new(&sheet, &all);
        let mut numbers: Vec<u32> = rings.unbatched().to_vec();
        for batch in 0..rings.num_batches() {
            let batch = rings.batch(batch);
            for (lane, &number) in batch.numbers.iter().enumerate() {
                let ring = rings.get(number as usize);
                assert_eq!(batch.centres[lane], ring.centre.0);
                let around: Vec<u32> = batch.around.iter().map(|row| row[lane]).collect();
                let expected: Vec<u32> = ring.around.iter().map(|vertex| vertex.0).collect();
                let (last, rest) = expected.split_last().unwrap();
                assert_eq!((&around[..], around[0]), (rest, *last));
                numbers.push(number);
            }
        }
        numbers.sort_unstable();
        assert_eq!(numbers, (0..u32::try_from(rings.len()).unwrap()).collect::<Vec<_>>());
        assert!(rings.num_batches() > 40, "{}", rings.num_batches());
    }
}
