//! The view of a frame as bytes.

use untangle::{analysis::Analysis, frame::Frame, mesh::VertexId, untangler::Outcome};
use untangled_proto::{
    CorrectionHeader,
    view::{InsideEntry, POSITION_BYTES, ViewHeader, path_state},
};

use super::records;
use crate::service::session::{cloth::Cloth, publish::Values};

/// What a frame has to show.
pub(in crate::service::session) struct View<'a> {
    pub(in crate::service::session) correction: &'a CorrectionHeader,
    pub(in crate::service::session) cloth: &'a Cloth,
    /// Its positions, if they can be used.
    pub(in crate::service::session) frame: Option<&'a Frame>,
    /// Paths and corrections, if there are such.
    pub(in crate::service::session) found: Option<(&'a Outcome<'a>, &'a Values<'a>)>,
}

/// Memory for what becomes of each pair of paths.
#[derive(Debug, Default)]
pub(super) struct Memory {
    states: Vec<u32>,
    depths_m: Vec<f64>,
    /// Vertices of the host, where these are welded.
    inside: Vec<VertexId>,
}

/// Writes a view into `bytes`. Gives back its header, without count and time.
pub(super) fn encode(view: &View<'_>, bytes: &mut Vec<u8>, memory: &mut Memory) -> ViewHeader {
    let Memory { states, depths_m, inside } = memory;
    bytes.clear();
    let mut header = ViewHeader { correction: *view.correction, ..ViewHeader::default() };
    if let Some((outcome, values)) = view.found {
        let paths = &outcome.analysis.paths;
        find_states(outcome.analysis, outcome.corrections.left_out.num_pairs, states);
        [header.num_paths, header.num_points] = records::write(paths, |copy| states[paths.copies[copy].pair], bytes);
        for entry in values.entries() {
            bytes.extend_from_slice(entry.to_words().map(u32::to_le_bytes).as_flattened());
            header.num_entries += 1;
        }
    }
    if let Some(frame) = view.frame {
        header.num_positions = write_positions(view.cloth, frame, bytes);
        if let Some((outcome, _)) = view.found {
            header.num_inside = write_inside(view.cloth, outcome.analysis, inside, bytes);
            header.num_depths = write_depths(outcome, frame, depths_m, bytes);
        }
    }
    header
}

/// Writes the positions of the host's vertices behind what is there; how many there are.
fn write_positions(cloth: &Cloth, frame: &Frame, bytes: &mut Vec<u8>) -> u32 {
    let (begin, n) = (bytes.len(), cloth.num_vertices());
    // At once, and then in place: much faster than growing by each number.
    bytes.resize(begin + n * POSITION_BYTES, 0);
    for (vertex, position) in bytes[begin..].chunks_exact_mut(POSITION_BYTES).enumerate() {
        let point = frame.position(cloth.mesh_vertex(vertex));
        for (word, value) in position.as_chunks_mut::<4>().0.iter_mut().zip(point.iter()) {
            #[expect(clippy::cast_possible_truncation, reason = "single precision is enough to look at")]
            let value = *value as f32;
            *word = value.to_le_bytes();
        }
    }
    u32::try_from(n).unwrap_or(u32::MAX)
}

/// Writes the host's vertices inside of each path with its pair; how many there are. `host` is memory.
fn write_inside(cloth: &Cloth, analysis: &Analysis, host: &mut Vec<VertexId>, bytes: &mut Vec<u8>) -> u32 {
    let mut count = 0;
    for (copy, path) in analysis.paths.copies.iter().enumerate() {
        let pair = u32::try_from(path.pair).unwrap_or(u32::MAX);
        for &VertexId(vertex) in cloth.host_vertices(analysis.regions.vertices_of(copy), host) {
            bytes.extend_from_slice(&InsideEntry { vertex, pair }.to_bytes());
            count += 1;
        }
    }
    count
}

/// Writes for each pair how far the farthest point inside is from its target; how many pairs there are.
fn write_depths(outcome: &Outcome<'_>, frame: &Frame, depths_m: &mut Vec<f64>, bytes: &mut Vec<u8>) -> u32 {
    let (paths, found) = (&outcome.analysis.paths, outcome.correspondences);
    depths_m.clear();
    depths_m.resize(paths.pairs.len(), 0.0);
    for path in &found.paths {
        let depth_m = &mut depths_m[paths.copies[path.copy].pair];
        for attraction in &found.attractions[path.attractions.clone()] {
            let way = attraction.target.position(frame) - attraction.source.position(frame);
            *depth_m = depth_m.max(way.norm());
        }
    }
    #[expect(clippy::cast_possible_truncation, reason = "single precision is enough to look at")]
    bytes.extend(depths_m.iter().flat_map(|&depth_m| (depth_m as f32).to_le_bytes()));
    u32::try_from(depths_m.len()).unwrap_or(u32::MAX)
}

/// What became of each pair of paths. Those that were left out are the last in the order of work.
fn find_states(analysis: &Analysis, mut num_left_out: usize, states: &mut Vec<u32>) {
    let Analysis { paths, regions, .. } = analysis;
    states.clear();
    states.resize(paths.pairs.len(), path_state::NO_REGION);
    for (copy, region) in paths.copies.iter().zip(&regions.by_copy) {
        if region.as_ref().is_some_and(|region| !region.vertices.is_empty()) {
            states[copy.pair] = path_state::REGION;
        }
    }
    for &copy in regions.order.iter().rev() {
        let state = &mut states[paths.copies[copy].pair];
        if *state != path_state::LEFT_OUT {
            if num_left_out == 0 {
                return;
            }
            num_left_out -= 1;
            *state = path_state::LEFT_OUT;
        }
    }
}
