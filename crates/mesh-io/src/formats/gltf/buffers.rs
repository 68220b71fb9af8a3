//! The buffers of a glTF document.

use std::{
    fs,
    path::{Path, PathBuf},
};

use base64::{
    Engine,
    alphabet::STANDARD,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};
use gltf::{
    Document,
    buffer::{Source, View},
};

use crate::error::ReadErrorKind;

/// All buffers of a document.
#[derive(Clone, Debug, Default)]
pub(crate) struct Buffers {
    bytes: Vec<Vec<u8>>,
    /// Length of each as the document says.
    lengths: Vec<usize>,
    /// Whether each has a link.
    is_linked: Vec<bool>,
    /// The file of each, if it is a file of its own.
    links: Vec<Option<PathBuf>>,
}

impl Buffers {
    /// Loads all buffers: the binary chunk, `data:` links, and files in `folder`.
    pub(crate) fn load(
        document: &Document,
        folder: Option<&Path>,
        mut blob: Option<Vec<u8>>,
    ) -> Result<Self, ReadErrorKind> {
        let mut buffers = Self::default();
        for buffer in document.buffers() {
            let mut file = None;
            buffers.is_linked.push(matches!(buffer.source(), Source::Uri(_)));
            let bytes = match buffer.source() {
                Source::Uri(link) if !link.starts_with("data:") => {
                    let name = percent_decoded(link).filter(|_| !link.contains("://")).ok_or_else(|| {
                        ReadErrorKind::Malformed(format!("buffer {}: `{link}` is not a relative path", buffer.index()))
                    })?;
                    let path = folder.unwrap_or_else(|| Path::new("")).join(name);
                    let bytes = fs::read(&path).map_err(|error| {
                        ReadErrorKind::Malformed(format!("buffer {}: {}: {error}", buffer.index(), path.display()))
                    })?;
                    file = Some(path);
                    bytes
                }
                Source::Uri(link) => padded(decode_data_link(link).map_err(|error| invalid(&error))?),
                Source::Bin => padded(blob.take().ok_or_else(|| invalid("missing binary portion of binary glTF"))?),
            };
            if bytes.len() < buffer.length() {
                return Err(ReadErrorKind::Truncated { element: format!("buffer {}", buffer.index()) });
            }
            buffers.bytes.push(bytes);
            buffers.lengths.push(buffer.length());
            buffers.links.push(file);
        }
        Ok(buffers)
    }

    /// The bytes of each, at least as many as the document says.
    pub(crate) fn all(&self) -> &[Vec<u8>] {
        &self.bytes
    }

    /// The file of each, if it is a file of its own.
    pub(crate) fn links(&self) -> &[Option<PathBuf>] {
        &self.links
    }

    /// Whether a buffer has a link; without, it is the binary chunk.
    pub(crate) fn is_linked(&self, buffer: usize) -> bool {
        self.is_linked[buffer]
    }

    /// Length of a buffer in bytes, as the document says.
    pub(crate) fn length(&self, buffer: usize) -> usize {
        self.lengths[buffer]
    }

    /// `length` bytes of a view from `offset` on, if the view and its buffer have them.
    pub(crate) fn slice(&self, view: &View<'_>, offset: usize, length: usize) -> Option<&[u8]> {
        let start = view.offset();
        let bytes = self.bytes.get(view.buffer().index())?.get(start..start.checked_add(view.length())?)?;
        bytes.get(offset..offset.checked_add(length)?)
    }
}

/// The bytes of a `data:` link, whose contents are Base64, padded or not.
fn decode_data_link(link: &str) -> Result<Vec<u8>, String> {
    let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let content = link.strip_prefix("data:").unwrap_or(link);
    let mut parts = content.split(";base64,");
    let media_type = parts.next().unwrap_or_default();
    GeneralPurpose::new(&STANDARD, config).decode(parts.next().unwrap_or(media_type)).map_err(|error| error.to_string())
}

/// Writers may state a length that counts the padding of a chunk.
fn padded(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

fn invalid(reason: &str) -> ReadErrorKind {
    ReadErrorKind::Malformed(format!("not a valid glTF document: {reason}"))
}

/// Decodes a relative link to a path; `None` if it is not UTF-8.
fn percent_decoded(link: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(link.len());
    let mut rest = link.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = if *first == b'%' { tail.get(..2) } else { None };
        let code = code.and_then(|code| u8::from_str_radix(std::str::from_utf8(code).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(bytes).ok()
}
