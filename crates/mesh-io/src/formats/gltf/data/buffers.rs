//! The buffers of a glTF document.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use base64::{
    Engine,
    alphabet::STANDARD,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};

use crate::{
    error::ReadErrorKind,
    formats::gltf::document::{Buffer, BufferView, Document, compressed, compression},
};

use super::link::{self, Linked};

/// All buffers of a document.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    buffers: Vec<Loaded>,
    /// Bytes read from files of their own, each file counted once.
    num_linked_bytes: usize,
}

/// One buffer.
#[derive(Clone, Debug)]
struct Loaded {
    /// Shared by buffers of the same file.
    bytes: Arc<Vec<u8>>,
    /// How many of the bytes belong to it.
    num_bytes: usize,
    /// Its length as the document says.
    length: usize,
    /// Whether it has a link; without, it is the binary chunk.
    is_linked: bool,
    /// Its file, if it is a file of its own.
    file: Option<PathBuf>,
}

impl Buffers {
    /// Loads all buffers: the binary chunk, `data:` links, and files in `folder`.
    pub(crate) fn load(document: &Document, folder: &Path, chunk: Option<&[u8]>) -> Result<Self, ReadErrorKind> {
        let files = LinkedFiles::read(document, folder)?;
        let num_linked_bytes = files.bytes.values().map(|bytes| bytes.len()).sum();
        let mut buffers = Self { buffers: Vec::with_capacity(document.buffers.len()), num_linked_bytes };
        for (at, (Buffer { byte_length, uri }, linked)) in document.buffers.iter().zip(files.of_buffers).enumerate() {
            let length = byte_length.0;
            let (file, bytes, num_bytes) = match (linked, uri, chunk) {
                (Some(Linked { path, resolved }), ..) => {
                    let bytes = Arc::clone(&files.bytes[&resolved]);
                    let num_bytes = bytes.len().min(length);
                    (Some(path), bytes, num_bytes)
                }
                (None, Some(uri), _) => {
                    let bytes = decode_data_link(uri).map_err(|error| refused(at, &format!("its data: {error}")))?;
                    own(bytes)
                }
                (None, None, Some(chunk)) if at == 0 => own(chunk.to_vec()),
                (None, None, _) => {
                    let missing = || refused(at, "it has no `uri`, and there is no binary chunk for it");
                    return Err(compression(document).map_or_else(missing, compressed));
                }
            };
            if num_bytes < length {
                return Err(ReadErrorKind::Truncated { element: format!("buffer {at}") });
            }
            buffers.buffers.push(Loaded { bytes, num_bytes, length, is_linked: uri.is_some(), file });
        }
        Ok(buffers)
    }

    /// The bytes of each, at least as many as the document says.
    pub(crate) fn all(&self) -> impl Iterator<Item = &[u8]> {
        self.buffers.iter().map(|buffer| &buffer.bytes[..buffer.num_bytes])
    }

    /// Bytes that were read from files of their own.
    pub(crate) fn num_linked_bytes(&self) -> usize {
        self.num_linked_bytes
    }

    /// The files of those that are files of their own.
    pub(crate) fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.buffers.iter().filter_map(|buffer| buffer.file.as_ref())
    }

    /// Whether a buffer is a file of its own.
    pub(crate) fn is_file(&self, buffer: usize) -> bool {
        self.buffers[buffer].file.is_some()
    }

    /// Whether a buffer has a link; without, it is the binary chunk.
    pub(crate) fn is_linked(&self, buffer: usize) -> bool {
        self.buffers[buffer].is_linked
    }

    /// Length of a buffer in bytes, as the document says.
    pub(crate) fn length(&self, buffer: usize) -> usize {
        self.buffers[buffer].length
    }

    /// `length` bytes of a view from `offset` on, if the view and its buffer have them.
    pub(crate) fn slice(&self, view: &BufferView, offset: usize, length: usize) -> Option<&[u8]> {
        let start = view.byte_offset.0;
        let buffer = self.buffers.get(view.buffer.0)?;
        let bytes = buffer.bytes[..buffer.num_bytes].get(start..start.checked_add(view.byte_length.0)?)?;
        bytes.get(offset..offset.checked_add(length)?)
    }
}

/// The files that the buffers of a document are. A file that is several buffers is read once, so that many links take
/// no more time and memory than one.
#[derive(Debug, Default)]
struct LinkedFiles {
    /// The file of each buffer, if it is one.
    of_buffers: Vec<Option<Linked>>,
    /// What was read, as much as the longest of its buffers needs. Only its sum is taken over all.
    bytes: HashMap<PathBuf, Arc<Vec<u8>>>,
}

impl LinkedFiles {
    fn read(document: &Document, folder: &Path) -> Result<Self, ReadErrorKind> {
        let mut files = Self::default();
        let mut lengths: HashMap<&Path, usize> = HashMap::new();
        for (at, Buffer { uri, .. }) in document.buffers.iter().enumerate() {
            let link = uri.as_deref().filter(|uri| !uri.starts_with("data:"));
            let linked = link.map(|link| link::resolve(link, folder)).transpose();
            files.of_buffers.push(linked.map_err(|reason| refused(at, &reason))?);
        }
        for (linked, buffer) in files.of_buffers.iter().zip(&document.buffers) {
            if let Some(linked) = linked {
                let length = lengths.entry(&linked.resolved).or_default();
                *length = buffer.byte_length.0.max(*length);
            }
        }
        for (at, linked) in files.of_buffers.iter().enumerate() {
            let Some(linked) = linked.as_ref().filter(|linked| !files.bytes.contains_key(&linked.resolved)) else {
                continue;
            };
            let bytes = linked.read(lengths[linked.resolved.as_path()]).map_err(|reason| refused(at, &reason))?;
            files.bytes.insert(linked.resolved.clone(), Arc::new(bytes));
        }
        Ok(files)
    }
}

fn refused(buffer: usize, reason: &str) -> ReadErrorKind {
    ReadErrorKind::Malformed(format!("buffer {buffer}: {reason}"))
}

/// Bytes of a document itself, as those of a buffer without a file. Writers may state a length that counts the padding
/// of a chunk.
fn own(mut bytes: Vec<u8>) -> (Option<PathBuf>, Arc<Vec<u8>>, usize) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let num_bytes = bytes.len();
    (None, Arc::new(bytes), num_bytes)
}

/// The bytes of a `data:` link, whose contents are Base64, padded or not.
fn decode_data_link(link: &str) -> Result<Vec<u8>, String> {
    let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let content = link.strip_prefix("data:").unwrap_or(link);
    let mut parts = content.split(";base64,");
    let media_type = parts.next().unwrap_or_default();
    GeneralPurpose::new(&STANDARD, config).decode(parts.next().unwrap_or(media_type)).map_err(|error| error.to_string())
}
