//! One frame of a session, as an observer sees it.

use std::time::Duration;

use untangled_proto::{
    CorrectionHeader, VertexEntry,
    correction::stage,
    flags,
    paths::{PathPoint, PathRecord},
    view::{InsideEntry, ViewHeader, ViewParts},
};
use untangled_transport::clock;

use super::mesh::ObservedMesh;
use crate::{
    error::FrameRefusal,
    session::{Paths, refusal},
};

/// One frame of a session: what its host sent, and what it got.
#[derive(Clone, Debug)]
pub struct Observation {
    header: ViewHeader,
    /// World positions in metres, `num_vertices`, rounded to single precision; empty where those of the frame can't be
    /// used.
    pub positions: Vec<[f32; 3]>,
    /// Values of all vertices, `num_vertices`, in the unit of [`ObservedMesh::correction`].
    pub corrections: Vec<[f32; 3]>,
    /// [`flags`] of all vertices, `num_vertices`.
    pub flags: Vec<u32>,
    /// Vertices inside, each with the pair of paths that it is inside of; a vertex may be inside of several.
    pub inside: Vec<InsideEntry>,
    /// For each pair of paths how far the farthest point inside is from where it should be, in metres; 0 where nothing
    /// inside has such a place: there is no region, or the response seeks no targets.
    pub depths_m: Vec<f32>,
    /// Frames of the session that were answered since the last observation, or the opening, and not seen.
    pub num_dropped: u64,
    records: Vec<PathRecord>,
    points: Vec<PathPoint>,
}

impl Observation {
    /// Copies a view of a session with this mesh.
    ///
    /// # Errors
    /// Words that say what does not fit together.
    pub fn read(header: ViewHeader, payload: &[u8], mesh: &ObservedMesh) -> Result<Self, String> {
        let parts = header.split(payload).ok_or("its length is not what its header says")?;
        let n = mesh.num_vertices;
        let positions: Vec<[f32; 3]> = parts.positions().collect();
        if !positions.is_empty() && positions.len() != n {
            return Err(format!("it has {} positions, and there are {n} vertices", positions.len()));
        }
        let (corrections, flags) = values(parts, mesh)?;
        let (records, points): (Vec<_>, Vec<_>) = (parts.records().collect(), parts.points().collect());
        for record in &records {
            let has_points = record.points(&points).len() == record.num_points as usize;
            // There are no more pairs than paths.
            if !has_points || [record.partner, record.pair].iter().any(|&number| number as usize >= records.len()) {
                return Err("a path names points, a path or a pair that are not there".to_owned());
            }
        }
        let (inside, depths_m): (Vec<_>, Vec<_>) = (parts.inside().collect(), parts.depths().collect());
        let num_pairs = records.iter().map(|record| record.pair as usize + 1).max().unwrap_or(0);
        if inside.iter().any(|entry| entry.vertex as usize >= n || entry.pair as usize >= num_pairs) {
            return Err("a vertex inside, or its pair of paths, is not there".to_owned());
        }
        if !depths_m.is_empty() && depths_m.len() != num_pairs {
            return Err(format!("it has {} depths, and there are {num_pairs} pairs of paths", depths_m.len()));
        }
        Ok(Self { header, positions, corrections, flags, inside, depths_m, num_dropped: 0, records, points })
    }

    /// Its number.
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.header.correction.frame
    }

    /// Counts, times, and the force and torque left over, as the host got them.
    #[must_use]
    pub fn header(&self) -> &CorrectionHeader {
        &self.header.correction
    }

    /// Frames of the session that were answered so far, this one included.
    #[must_use]
    pub fn num_frames(&self) -> u64 {
        self.header.num_frames
    }

    /// The paths of the frame; [`PathRecord::state`] says what became of each, see
    /// [`path_state`](super::path_state).
    #[must_use]
    pub fn paths(&self) -> Paths<'_> {
        Paths { records: &self.records, points: &self.points }
    }

    /// Why the frame was not corrected, if it was not.
    #[must_use]
    pub fn refusal(&self) -> Option<FrameRefusal> {
        refusal(&self.header.correction)
    }

    /// Time of each stage, by the names of [`stage::NAMES`]; the last is that of all together, from when the daemon
    /// began to read the frame.
    #[must_use]
    pub fn stage_times(&self) -> [(&'static str, Duration); 8] {
        std::array::from_fn(|k| (stage::NAMES[k], Duration::from_nanos(self.header.correction.stage_ns[k])))
    }

    /// When its correction had been sent, by `CLOCK_MONOTONIC` of this machine.
    #[must_use]
    pub fn sent(&self) -> Duration {
        Duration::from_nanos(self.header.sent_ns)
    }

    /// How long ago its correction was sent.
    #[must_use]
    pub fn age(&self) -> Duration {
        clock::monotonic().saturating_sub(self.sent())
    }
}

/// Values and flags of all vertices, from the entries of those that are touched.
fn values(parts: ViewParts<'_>, mesh: &ObservedMesh) -> Result<(Vec<[f32; 3]>, Vec<u32>), String> {
    let n = mesh.num_vertices;
    let (mut corrections, mut flags) = (vec![[0.0; 3]; n], vec![0; n]);
    for &vertex in mesh.pins.iter().chain(&mesh.body) {
        flags[vertex as usize] = flags::PINNED;
    }
    for VertexEntry { vertex, value, flags: own } in parts.entries() {
        let index = vertex as usize;
        if index >= n {
            return Err(format!("it has a correction of vertex {vertex}, and there are {n}"));
        }
        corrections[index] = value;
        flags[index] = own;
    }
    Ok((corrections, flags))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(header: ViewHeader, payload: &[u8]) -> Result<Observation, String> {
        let mesh = ObservedMesh { num_vertices: 2, pins: vec![0], ..ObservedMesh::default() };
        Observation::read(header, payload, &mesh)
    }

    #[test]
    fn entries_become_values_of_all_vertices_and_lies_are_told_apart() {
        let entry = VertexEntry { vertex: 1, value: [0.5, 0.0, -1.0], flags: flags::INSIDE };
        let bytes = |entry: VertexEntry| entry.to_words().map(u32::to_le_bytes).concat();
        let header = ViewHeader { num_entries: 1, ..ViewHeader::default() };
        let seen = read(header, &bytes(entry)).unwrap();
        assert_eq!(seen.corrections, [[0.0; 3], [0.5, 0.0, -1.0]]);
        assert_eq!(seen.flags, [flags::PINNED, flags::INSIDE]);
        assert!(seen.positions.is_empty());
        for (header, payload, words) in [
            (header, bytes(VertexEntry { vertex: 2, ..entry }), "a correction of vertex 2, and there are 2"),
            (header, vec![0; 19], "its length is not"),
            (ViewHeader { num_positions: 1, ..ViewHeader::default() }, vec![0; 12], "1 positions"),
            (
                ViewHeader { num_paths: 1, ..ViewHeader::default() },
                PathRecord { num_points: 1, ..PathRecord::default() }.to_bytes().to_vec(),
                "a path names points",
            ),
            (
                ViewHeader { num_paths: 1, ..ViewHeader::default() },
                PathRecord { pair: u32::MAX, ..PathRecord::default() }.to_bytes().to_vec(),
                "or a pair that are not there",
            ),
            (
                ViewHeader { num_inside: 1, ..ViewHeader::default() },
                InsideEntry { vertex: 1, pair: 0 }.to_bytes().to_vec(),
                "its pair of paths, is not there",
            ),
            (
                ViewHeader { num_paths: 1, num_inside: 1, ..ViewHeader::default() },
                [&PathRecord::default().to_bytes()[..], &InsideEntry { vertex: 2, pair: 0 }.to_bytes()].concat(),
                "a vertex inside",
            ),
            (ViewHeader { num_depths: 1, ..ViewHeader::default() }, vec![0; 4], "1 depths, and there are 0 pairs"),
        ] {
            let error = read(header, &payload).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }
}
