//! Writing a glTF file back with other positions.

use std::{borrow::Cow, io::Write, ops::Range, path::PathBuf};

use base64::{Engine, engine::general_purpose::STANDARD as BASE64};

use super::{
    super::{
        WriteError,
        text::{Edit, write_number},
    },
    buffers::Buffers,
    container::{Chunks, Container},
    json::{Spans, edited, replacing},
    place::{Bytes, Place},
};

/// A glTF file as it was read.
#[derive(Clone, Debug)]
pub(crate) struct GltfDocument {
    pub(super) source: Vec<u8>,
    pub(super) chunks: Chunks,
    pub(super) buffers: Buffers,
    pub(super) blocks: Vec<Block>,
}

/// Vertices that one node places.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) vertices: Range<usize>,
    /// Where they stand in the file, or why they can't move there.
    pub(super) place: Result<Place, String>,
}

impl GltfDocument {
    /// Files of their own that hold buffers.
    pub(crate) fn linked_files(&self) -> impl Iterator<Item = &PathBuf> {
        self.buffers.links().iter().flatten()
    }

    /// Whether positions of the world are singles: every node leaves them where they are stored.
    pub(crate) fn is_single_precision(&self) -> bool {
        self.blocks.iter().all(|block| block.place.as_ref().is_ok_and(|place| place.is_identity))
    }

    /// Vertices that can't move, each range with the reason.
    pub(crate) fn fixed_vertices(&self) -> impl Iterator<Item = (Range<usize>, &str)> {
        self.blocks.iter().filter_map(|block| Some((block.vertices.clone(), block.place.as_ref().err()?.as_str())))
    }

    /// The form of the file.
    pub(crate) fn container(&self) -> Container {
        self.chunks.container
    }

    /// Writes the file, in either form, with other positions. Nothing else changes, but for this: the bounds of accessors whose positions moved; and
    /// a buffer whose file holds positions that moved, or would not be found from another folder, stands in the file as a `data:` link.
    pub(crate) fn write(
        &self,
        before: &[[f64; 3]],
        after: &[[f64; 3]],
        container: Container,
        same_folder: bool,
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        let mut buffers: Vec<Cow<'_, [u8]>> =
            self.buffers.all().iter().map(|bytes| Cow::from(bytes.as_slice())).collect();
        let mut moved = Vec::new();
        for block in &self.blocks {
            let mut has_moved = false;
            for (slot, vertex) in block.vertices.clone().enumerate() {
                if before[vertex].map(f64::to_bits) == after[vertex].map(f64::to_bits) {
                    continue;
                }
                let fixed = |reason: &str| WriteError::FixedCoordinates { vertex, reason: reason.to_owned() };
                let place = block.place.as_ref().map_err(|reason| fixed(reason))?;
                let stored = place.stored(after[vertex]).ok_or_else(|| fixed("it is beyond single precision"))?;
                let Bytes { buffer, start, stride, .. } = place.bytes;
                let at = start + slot * stride;
                for (axis, value) in stored.into_iter().enumerate() {
                    buffers[buffer].to_mut()[at + 4 * axis..at + 4 * axis + 4].copy_from_slice(&value.to_le_bytes());
                }
                has_moved = true;
            }
            moved.extend(block.place.as_ref().ok().filter(|_| has_moved));
        }
        let all_found = same_folder || self.buffers.links().iter().all(Option::is_none);
        if moved.is_empty() && container == self.container() && all_found {
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
            edits.extend(self.link_edit(at, bytes, is_changed, container, same_folder, json, &spans));
        }
        let binary = self.binary_chunk(&buffers, container);
        Ok(self.chunks.write(&self.source, container, &edited(json, edits), binary.as_deref(), out)?)
    }

    /// Whether a buffer stands in the binary chunk of a file of some form. A document that becomes a binary one puts its first there.
    fn is_in_chunk(&self, buffer: usize, container: Container) -> bool {
        let was_text = self.container() == Container::Text;
        container == Container::Binary
            && buffer == 0
            && (was_text || self.chunks.binary.is_some() && !self.buffers.is_linked(0))
    }

    #[expect(clippy::too_many_arguments, reason = "the one place where all these meet")]
    fn link_edit(
        &self,
        at: usize,
        bytes: &[u8],
        is_changed: bool,
        container: Container,
        same_folder: bool,
        json: &[u8],
        spans: &Spans,
    ) -> Option<Edit> {
        let span = &spans.buffers[at];
        if self.is_in_chunk(at, container) {
            return span.remove_uri(json);
        }
        let is_lost = self.is_in_chunk(at, self.container()) || !same_folder && self.buffers.links()[at].is_some();
        (is_changed || is_lost).then(|| {
            let bytes = &bytes[..self.buffers.length(at).min(bytes.len())];
            span.set_uri(&format!("data:application/octet-stream;base64,{}", BASE64.encode(bytes)))
        })
    }

    fn binary_chunk(&self, buffers: &[Cow<'_, [u8]>], container: Container) -> Option<Vec<u8>> {
        let own = self.chunks.binary.clone().map(|range| &self.source[range]);
        if !self.is_in_chunk(0, container) {
            // A chunk that no buffer uses is not ours to drop.
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

/// The edits that give an accessor the bounds that its positions have in `buffer`.
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

/// Three singles as JSON, so that they are the same read as doubles.
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
