//! The two containers of glTF: JSON alone, or JSON and binary chunks in one file.

use std::{
    io::{self, Write},
    ops::Range,
};

use crate::error::ReadErrorKind;

/// Container of a glTF file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Container {
    /// `.gltf`: JSON.
    Text,
    /// `.glb`: chunks.
    Binary,
}

/// The byte ranges of a file: its JSON, its binary chunk, and the chunks of extensions after it.
#[derive(Clone, Debug)]
pub(crate) struct Chunks {
    pub(crate) container: Container,
    pub(crate) json: Range<usize>,
    pub(crate) binary: Option<Range<usize>>,
    rest: Range<usize>,
    /// What follows the end that the header states.
    beyond: Range<usize>,
}

const JSON: [u8; 4] = *b"JSON";
const BINARY: [u8; 4] = *b"BIN\0";
const HEADER: usize = 12;

impl Chunks {
    /// Finds the chunks.
    ///
    /// # Errors
    /// [`ReadErrorKind::Gltf`] for another version, [`ReadErrorKind::Truncated`] for a file that is cut off.
    pub(crate) fn find(source: &[u8]) -> Result<Self, ReadErrorKind> {
        if !source.starts_with(b"glTF") {
            let end = source.len();
            return Ok(Self {
                container: Container::Text,
                json: 0..end,
                binary: None,
                rest: end..end,
                beyond: end..end,
            });
        }
        let cut_off = |element: &str| ReadErrorKind::Truncated { element: element.to_owned() };
        let (version, length) = word(source, 4).zip(word(source, 8)).ok_or_else(|| cut_off("the header"))?;
        if version != 2 {
            return Err(ReadErrorKind::Malformed(format!("is glTF of version {version}; version 2 is read")));
        }
        if length < HEADER {
            return Err(ReadErrorKind::Malformed("the header says that the file is shorter than its header".into()));
        }
        let body = source.get(..length).ok_or_else(|| {
            let reason = format!("its header says that it has {length} bytes, and it has {}", source.len());
            ReadErrorKind::Malformed(reason)
        })?;
        let (kind, json) = chunk(body, HEADER).ok_or_else(|| cut_off("a chunk"))?;
        if kind != JSON {
            return Err(ReadErrorKind::Gltf("the first chunk is not JSON".into()));
        }
        let after_json = padded(json.end).min(length);
        let second =
            if after_json < length { chunk(body, after_json).ok_or_else(|| cut_off("a chunk"))?.into() } else { None };
        let binary = second.filter(|(kind, _)| *kind == BINARY).map(|(_, range)| range);
        let rest = binary.as_ref().map_or(after_json, |range| padded(range.end).min(length))..length;
        Ok(Self { container: Container::Binary, json, binary, rest, beyond: length..source.len() })
    }

    /// Writes the file with other JSON and another binary chunk, in either container. A binary file keeps the chunks of
    /// extensions.
    pub(crate) fn write(
        &self,
        source: &[u8],
        container: Container,
        json: &[u8],
        binary: Option<&[u8]>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        if container == Container::Text {
            return out.write_all(json);
        }
        // The padding of the source is taken off, since it is added again.
        let json = json.trim_ascii_end();
        let rest = &source[self.rest.clone()];
        let binary_length = binary.map_or(0, |binary| 8 + padded(binary.len()));
        let length = HEADER + 8 + padded(json.len()) + binary_length + rest.len();
        let encoded = |value: usize| {
            u32::try_from(value).map(u32::to_le_bytes).map_err(|_| {
                io::Error::new(io::ErrorKind::InvalidInput, "more than 4 GiB do not fit a .glb; write .obj or .ply")
            })
        };
        out.write_all(b"glTF\x02\0\0\0")?;
        out.write_all(&encoded(length)?)?;
        for (kind, data, filling) in [(JSON, Some(json), b' '), (BINARY, binary, 0)] {
            let Some(data) = data else { continue };
            out.write_all(&encoded(padded(data.len()))?)?;
            out.write_all(&kind)?;
            out.write_all(data)?;
            out.write_all(&vec![filling; padded(data.len()) - data.len()])?;
        }
        out.write_all(rest)?;
        out.write_all(&source[self.beyond.clone()])
    }
}

/// Kind and data of the chunk at an offset.
fn chunk(source: &[u8], at: usize) -> Option<([u8; 4], Range<usize>)> {
    let kind = source.get(at + 4..at + 8)?.try_into().ok()?;
    let data = at + 8..(at + 8).checked_add(word(source, at)?)?;
    (data.end <= source.len()).then_some((kind, data))
}

/// The little-endian word at an offset.
fn word(source: &[u8], at: usize) -> Option<usize> {
    let bytes = source.get(at..at.checked_add(4)?)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(bytes)).ok()
}

fn padded(length: usize) -> usize {
    length.next_multiple_of(4)
}
