//! Writing a glTF file back with other positions.

use std::{borrow::Cow, io::Write, ops::Range, path::PathBuf};

use base64::{Engine, engine::general_purpose::STANDARD as BASE64};

use crate::{
    error::WriteError,
    formats::text::{Edit, write_number},
};

use super::{
    container::{Chunks, Container},
    data::Buffers,
    json::{Spans, edited, replacing},
    place::Place,
    usage::Bytes,
};

/// A glTF file as it was read.
#[derive(Clone, Debug)]
pub(crate) struct GltfDocument {
    pub(crate) source: Vec<u8>,
    pub(crate) chunks: Chunks,
    pub(crate) buffers: Buffers,
    pub(crate) blocks: Vec<Block>,
}

/// Where and how a file is written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Destination {
    /// In which container.
    pub(crate) container: Container,
    /// Whether into the folder of the file that was read, from which its links lead to its buffers.
    pub(crate) same_folder: bool,
}

/// Buffers with other positions.
struct Stored<'a> {
    /// Owned where a byte changed.
    buffers: Vec<Cow<'a, [u8]>>,
    /// The places in which positions changed.
    moved: Vec<&'a Place>,
}

/// The vertices of one accessor at one node.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub(crate) vertices: Range<usize>,
    /// Where their positions are in the file, or why these can't be replaced.
    pub(crate) place: Result<Place, String>,
}

impl Block {
    /// Where and how the position of a vertex is stored; nothing for a vertex that did not move.
    fn stored(
        &self,
        vertex: usize,
        before: &[[f64; 3]],
        after: &[[f64; 3]],
    ) -> Result<Option<(&Place, [f32; 3])>, WriteError> {
        if before[vertex].map(f64::to_bits) == after[vertex].map(f64::to_bits) {
            return Ok(None);
        }
        let fixed = |reason: &str| WriteError::FixedCoordinates { vertex, reason: reason.to_owned() };
        let place = self.place.as_ref().map_err(|reason| fixed(reason))?;
        let stored = place.stored(after[vertex]).ok_or_else(|| fixed("it is beyond single precision"))?;
        Ok(Some((place, stored)))
    }
}

impl GltfDocument {
    /// The files of buffers that are files of their own.
    pub(crate) fn linked_files(&self) -> impl Iterator<Item = &PathBuf> {
        self.buffers.files()
    }

    /// Whether world positions are singles, since no node transforms what is stored.
    pub(crate) fn is_single_precision(&self) -> bool {
        self.blocks.iter().all(|block| block.place.as_ref().is_ok_and(|place| place.is_identity))
    }

    /// Ranges of vertices whose positions can't change, each with the reason.
    pub(crate) fn fixed_vertices(&self) -> impl Iterator<Item = (Range<usize>, &str)> {
        self.blocks.iter().filter_map(|block| Some((block.vertices.clone(), block.place.as_ref().err()?.as_str())))
    }

    /// The container of the file that was read.
    pub(crate) fn container(&self) -> Container {
        self.chunks.container
    }

    /// Writes the file with other positions, `num_vertices x 3`.
    ///
    /// Besides positions this changes only: the bounds of accessors whose positions changed; and buffers in files of
    /// their own, which become `data:` links if their bytes changed or if their link would not lead to them from
    /// another folder.
    pub(crate) fn write(
        &self,
        before: &[[f64; 3]],
        after: &[[f64; 3]],
        destination: Destination,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        let Stored { buffers, moved } = self.stored(before, after)?;
        let all_found = destination.same_folder || self.buffers.files().next().is_none();
        if moved.is_empty() && destination.container == self.container() && all_found {
            return Ok(out.write_all(&self.source)?);
        }
        let json = &self.source[self.chunks.json.clone()];
        let spans = Spans::find(json).map_err(|error| WriteError::Io(error.into()))?;
        let mut edits = Vec::new();
        for place in moved {
            edits.extend(bounds_edits(place, &buffers[place.bytes.buffer], &spans));
        }
        for (at, bytes) in buffers.iter().enumerate() {
            let is_changed = matches!(bytes, Cow::Owned(_));
            edits.extend(self.link_edit(at, bytes, is_changed, destination, json, &spans));
        }
        let binary = self.binary_chunk(&buffers, destination.container);
        let json = edited(json, edits);
        Ok(self.chunks.write(&self.source, destination.container, &json, binary.as_deref(), out)?)
    }

    /// The positions that reading the file gives, once it was written with others.
    pub(crate) fn stored_positions(
        &self,
        before: &[[f64; 3]],
        after: &[[f64; 3]],
    ) -> Result<Vec<[f64; 3]>, WriteError> {
        let mut positions = before.to_vec();
        for block in &self.blocks {
            for vertex in block.vertices.clone() {
                if let Some((place, stored)) = block.stored(vertex, before, after)? {
                    positions[vertex] = place.read_back(stored);
                }
            }
        }
        Ok(positions)
    }

    /// The buffers with other positions.
    fn stored(&self, before: &[[f64; 3]], after: &[[f64; 3]]) -> Result<Stored<'_>, WriteError> {
        let mut buffers: Vec<Cow<'_, [u8]>> = self.buffers.all().map(Cow::from).collect();
        let mut moved = Vec::new();
        for block in &self.blocks {
            let mut has_moved = false;
            for (slot, vertex) in block.vertices.clone().enumerate() {
                let Some((place, stored)) = block.stored(vertex, before, after)? else { continue };
                let Bytes { buffer, start, stride, .. } = place.bytes;
                let at = start + slot * stride;
                for (axis, value) in stored.into_iter().enumerate() {
                    buffers[buffer].to_mut()[at + 4 * axis..at + 4 * axis + 4].copy_from_slice(&value.to_le_bytes());
                }
                has_moved = true;
            }
            moved.extend(block.place.as_ref().ok().filter(|_| has_moved));
        }
        Ok(Stored { buffers, moved })
    }

    /// Whether a buffer is the binary chunk of the file in some container. A text file that becomes a binary one puts
    /// its first buffer there.
    fn is_in_chunk(&self, buffer: usize, container: Container) -> bool {
        let was_text = self.container() == Container::Text;
        container == Container::Binary
            && buffer == 0
            && (was_text || self.chunks.binary.is_some() && !self.buffers.is_linked(0))
    }

    /// The edit of the link of a buffer, if it needs another one.
    fn link_edit(
        &self,
        at: usize,
        bytes: &[u8],
        is_changed: bool,
        destination: Destination,
        json: &[u8],
        spans: &Spans,
    ) -> Option<Edit> {
        let span = &spans.buffers[at];
        if self.is_in_chunk(at, destination.container) {
            return span.remove_uri(json);
        }
        let is_lost = self.is_in_chunk(at, self.container()) || !destination.same_folder && self.buffers.is_file(at);
        (is_changed || is_lost).then(|| {
            let bytes = &bytes[..self.buffers.length(at).min(bytes.len())];
            span.set_uri(&format!("data:application/octet-stream;base64,{}", BASE64.encode(bytes)))
        })
    }

    /// The binary chunk of the file in some container, if it has one.
    fn binary_chunk(&self, buffers: &[Cow<'_, [u8]>], container: Container) -> Option<Vec<u8>> {
        let own = self.chunks.binary.clone().map(|range| &self.source[range]);
        if !self.is_in_chunk(0, container) {
            // A chunk that no buffer uses is kept.
            return own.map(<[u8]>::to_vec);
        }
        let bytes = buffers.first()?;
        let bytes = &bytes[..self.buffers.length(0).min(bytes.len())];
        let mut chunk = own.map_or_else(Vec::new, <[u8]>::to_vec);
        chunk.resize(chunk.len().max(bytes.len()), 0);
        chunk[..bytes.len()].copy_from_slice(bytes);
        Some(chunk)
    }
}

/// The edits that set the bounds of an accessor to those of its positions in `buffer`.
fn bounds_edits(place: &Place, buffer: &[u8], spans: &Spans) -> Vec<Edit> {
    let Bytes { start, stride, count, .. } = place.bytes;
    let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for element in 0..count {
        let [low, high] = &mut bounds;
        for (axis, (low, high)) in low.iter_mut().zip(high).enumerate() {
            let at = start + element * stride + 4 * axis;
            let value = f32::from_le_bytes([buffer[at], buffer[at + 1], buffer[at + 2], buffer[at + 3]]);
            *low = low.min(value);
            *high = high.max(value);
        }
    }
    let spans = spans.bounds[place.accessor].iter().cloned();
    spans.zip(bounds).filter_map(|(span, bound)| Some(replacing(&span?, array(bound)))).collect()
}

/// Three singles as a JSON array that reads back to the same numbers as doubles.
fn array(values: [f32; 3]) -> Vec<u8> {
    let mut text = vec![b'['];
    for (axis, value) in values.into_iter().enumerate() {
        if axis > 0 {
            text.push(b',');
        }
        write_number(value.into(), &mut text).unwrap_or_else(|error| unreachable!("writing into memory: {error}"));
    }
    text.push(b']');
    text
}
