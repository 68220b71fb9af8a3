//! The view of a frame as bytes.

use untangle::{analysis::Analysis, frame::Frame, untangler::Outcome};
use untangled_proto::{
    CorrectionHeader,
    view::{POSITION_BYTES, ViewHeader, path_state},
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

/// Writes a view into `bytes`; `states` is memory. Gives back its header, without count and time.
pub(super) fn encode(view: &View<'_>, bytes: &mut Vec<u8>, states: &mut Vec<u32>) -> ViewHeader {
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
