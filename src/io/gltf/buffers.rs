//! The bytes that a glTF document refers to.

use std::{fs, path::Path};

use gltf::{
    Document,
    buffer::{Data, Source, View},
};

use super::super::ReadErrorKind;

/// All buffers of a document.
#[derive(Debug)]
pub(super) struct Buffers(Vec<Vec<u8>>);

impl Buffers {
    /// Loads all buffers: the binary chunk, `data:` links, and files in `folder`.
    pub(super) fn load(
        document: &Document,
        folder: Option<&Path>,
        mut blob: Option<Vec<u8>>,
    ) -> Result<Self, ReadErrorKind> {
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            let bytes = match buffer.source() {
                Source::Uri(link) if !link.starts_with("data:") => {
                    let name = percent_decoded(link).filter(|_| !link.contains("://")).ok_or_else(|| {
                        ReadErrorKind::Malformed(format!("buffer {}: `{link}` is not a relative path", buffer.index()))
                    })?;
                    let path = folder.unwrap_or_else(|| Path::new("")).join(name);
                    fs::read(&path).map_err(|error| {
                        ReadErrorKind::Malformed(format!("buffer {}: {}: {error}", buffer.index(), path.display()))
                    })?
                }
                source => Data::from_source_and_blob(source, None, &mut blob)?.0,
            };
            if bytes.len() < buffer.length() {
                return Err(ReadErrorKind::Truncated { element: format!("buffer {}", buffer.index()) });
            }
            buffers.push(bytes);
        }
        Ok(Self(buffers))
    }

    /// `length` bytes of a view from `offset` on, if the view and its buffer hold them.
    pub(super) fn slice(&self, view: &View<'_>, offset: usize, length: usize) -> Option<&[u8]> {
        let start = view.offset();
        let bytes = self.0.get(view.buffer().index())?.get(start..start.checked_add(view.length())?)?;
        bytes.get(offset..offset.checked_add(length)?)
    }
}

/// A relative link as a path; nothing if it is no text.
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
