//! The two containers of glTF: JSON alone, or JSON and binary chunks in one file.

use std::{
    io::{self, Write},
    ops::Range,
};

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
}

const JSON: [u8; 4] = *b"JSON";
const BINARY: [u8; 4] = *b"BIN\0";
const HEADER: usize = 12;

impl Chunks {
    /// Finds the chunks; `None` for a file that is cut off.
    pub(crate) fn find(source: &[u8]) -> Option<Self> {
        if !source.starts_with(b"glTF") {
            let end = source.len();
            return Some(Self { container: Container::Text, json: 0..end, binary: None, rest: end..end });
        }
        let (kind, json) = chunk(source, HEADER)?;
        let after_json = padded(json.end).min(source.len());
        let second = chunk(source, after_json).filter(|(kind, _)| *kind == BINARY).map(|(_, range)| range);
        let rest = second.as_ref().map_or(after_json, |range| padded(range.end).min(source.len()))..source.len();
        (kind == JSON).then_some(Self { container: Container::Binary, json, binary: second, rest })
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
        let rest = if self.container == Container::Binary { &source[self.rest.clone()] } else { &[] };
        let binary_length = binary.map_or(0, |binary| 8 + padded(binary.len()));
        let length = HEADER + 8 + padded(json.len()) + binary_length + rest.len();
        let word = |value: usize| {
            u32::try_from(value).map(u32::to_le_bytes).map_err(|_| {
                io::Error::new(io::ErrorKind::InvalidInput, "more than 4 GiB do not fit a .glb; write .obj or .ply")
            })
        };
        out.write_all(b"glTF\x02\0\0\0")?;
        out.write_all(&word(length)?)?;
        for (kind, data, filling) in [(JSON, Some(json), b' '), (BINARY, binary, 0)] {
            let Some(data) = data else { continue };
            out.write_all(&word(padded(data.len()))?)?;
            out.write_all(&kind)?;
            out.write_all(data)?;
            out.write_all(&vec![filling; padded(data.len()) - data.len()])?;
        }
        out.write_all(rest)
    }
}

/// Kind and data of the chunk at an offset.
fn chunk(source: &[u8], at: usize) -> Option<([u8; 4], Range<usize>)> {
    let header = source.get(at..at.checked_add(8)?)?;
    let length = u32::from_le_bytes(header[..4].try_into().ok()?);
    let data = at + 8..(at + 8).checked_add(usize::try_from(length).ok()?)?;
    (data.end <= source.len()).then_some((header[4..].try_into().ok()?, data))
}

fn padded(length: usize) -> usize {
    length.next_multiple_of(4)
}
