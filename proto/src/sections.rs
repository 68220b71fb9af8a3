//! The payload of a request: a table of sections, then their bytes.
//!
//! The table has [`RequestHeader::num_sections`](crate::RequestHeader) entries of 24 bytes, little-endian: id `u32`,
//! zero `u32`, offset `u64` from the start of the payload, length in bytes `u64`. Offsets are multiples of 8.

use thiserror::Error;

use crate::limits::MAX_SECTIONS;

/// Section ids.
pub mod id {
    /// [`RegisterParams`](crate::RegisterParams).
    pub const PARAMS: u32 = 1;
    /// `num_faces x 3` vertex indices, `u32`.
    pub const TRIANGLES: u32 = 2;
    /// `num_coordinates x 2` texture coordinates, `f64`.
    pub const UV_COORDINATES: u32 = 3;
    /// `num_faces x 3` indices of texture coordinates, one for each corner, `u32`.
    pub const UV_CORNERS: u32 = 4;
    /// `num_vertices x 3` unstrained positions in metres, `f64`.
    pub const REST_POSITIONS: u32 = 5;
    /// `num_vertices` masses in kilograms, `f64`.
    pub const MASSES: u32 = 6;
    /// Indices of vertices that the host does not let move, `u32`.
    pub const PINS: u32 = 7;
    /// `num_vertices` layers, from the body outwards, `u32`.
    pub const LAYERS: u32 = 8;
    /// Settings: a JSON object of the names in `untangled config`; names left out keep the daemon's defaults.
    pub const SETTINGS: u32 = 9;
    /// Bits of [`SessionOptions`](crate::SessionOptions), one `u32`; all zero where the section is not there.
    pub const OPTIONS: u32 = 10;
    /// Indices of vertices that belong to bodies, `u32`: the host alone moves them, and cloth belongs outside.
    pub const BODY: u32 = 11;
    /// What an observer is called: UTF-8, at most [`MAX_NAME_BYTES`](crate::limits::MAX_NAME_BYTES) bytes without
    /// control characters.
    pub const NAME: u32 = 12;
    /// Where the part of a mesh begins that an observer asks for, in bytes, one `u64`; 0 without it.
    pub const FROM: u32 = 13;
    /// For an observer: for each face 1 where its normal points outwards of its layer, else 0; `num_faces` bytes.
    pub const OUTWARDS: u32 = 14;
}

const ENTRY_BYTES: usize = 24;

/// What is wrong with a section table or a section.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SectionError {
    /// More sections than allowed.
    #[error("the request has {given} sections; at most {MAX_SECTIONS} are allowed")]
    TooMany {
        /// Sections given.
        given: usize,
    },
    /// The payload ends before the table does.
    #[error("the section table needs {needed} bytes, but the request has {given}")]
    Table {
        /// Bytes of the table.
        needed: usize,
        /// Bytes of the payload.
        given: usize,
    },
    /// A section lies outside of the payload, or its offset is no multiple of 8.
    #[error("section {id} at offset {offset} with {length} bytes does not fit a request of {given} bytes")]
    Range {
        /// Id of the section.
        id: u32,
        /// Its offset.
        offset: u64,
        /// Its length.
        length: u64,
        /// Bytes of the payload.
        given: usize,
    },
    /// A section stands twice in the table.
    #[error("section {id} stands twice in the table")]
    Twice {
        /// Id of the section.
        id: u32,
    },
    /// A section has a length that its elements don't divide.
    #[error("section {id} has {length} bytes, not a multiple of {element}")]
    Length {
        /// Id of the section.
        id: u32,
        /// Its length.
        length: usize,
        /// Bytes of one element.
        element: usize,
    },
}

/// Sections of a payload, checked once. The entries are copies, so that a peer that goes on writing can't move a
/// section.
#[derive(Clone, Debug)]
pub struct Sections<'a> {
    entries: Vec<(u32, &'a [u8])>,
}

impl<'a> Sections<'a> {
    /// Reads and checks the table.
    ///
    /// # Errors
    /// [`SectionError`], naming the section at fault.
    pub fn parse(payload: &'a [u8], num_sections: usize) -> Result<Self, SectionError> {
        if num_sections > MAX_SECTIONS {
            return Err(SectionError::TooMany { given: num_sections });
        }
        let given = payload.len();
        let needed = num_sections * ENTRY_BYTES;
        let table = payload.get(..needed).ok_or(SectionError::Table { needed, given })?;
        let mut entries: Vec<(u32, &[u8])> = Vec::with_capacity(num_sections);
        for entry in table.chunks_exact(ENTRY_BYTES) {
            let id = u32::from_le_bytes(std::array::from_fn(|k| entry[k]));
            let offset = u64::from_le_bytes(std::array::from_fn(|k| entry[8 + k]));
            let length = u64::from_le_bytes(std::array::from_fn(|k| entry[16 + k]));
            let bytes = usize::try_from(offset)
                .ok()
                .filter(|offset| offset % 8 == 0)
                .and_then(|start| Some(start..start.checked_add(usize::try_from(length).ok()?)?))
                .and_then(|range| payload.get(range))
                .ok_or(SectionError::Range { id, offset, length, given })?;
            if entries.iter().any(|entry| entry.0 == id) {
                return Err(SectionError::Twice { id });
            }
            entries.push((id, bytes));
        }
        Ok(Self { entries })
    }

    /// The bytes of a section, if it is there.
    #[must_use]
    pub fn bytes(&self, id: u32) -> Option<&'a [u8]> {
        self.entries.iter().find(|entry| entry.0 == id).map(|entry| entry.1)
    }

    /// A section of indices, copied.
    ///
    /// # Errors
    /// [`SectionError::Length`].
    pub fn u32s<const N: usize>(&self, id: u32) -> Result<Option<Vec<[u32; N]>>, SectionError> {
        self.elements(id, u32::from_le_bytes)
    }

    /// A section of numbers, copied.
    ///
    /// # Errors
    /// [`SectionError::Length`].
    pub fn f64s<const N: usize>(&self, id: u32) -> Result<Option<Vec<[f64; N]>>, SectionError> {
        self.elements(id, f64::from_le_bytes)
    }

    fn elements<T, const BYTES: usize, const N: usize>(
        &self,
        id: u32,
        from_le: impl Fn([u8; BYTES]) -> T,
    ) -> Result<Option<Vec<[T; N]>>, SectionError> {
        let Some(bytes) = self.bytes(id) else { return Ok(None) };
        let element = BYTES * N;
        if !bytes.len().is_multiple_of(element) {
            return Err(SectionError::Length { id, length: bytes.len(), element });
        }
        let one = |bytes: &[u8], k: usize| from_le(std::array::from_fn(|byte| bytes[BYTES * k + byte]));
        Ok(Some(bytes.chunks_exact(element).map(|bytes| std::array::from_fn(|k| one(bytes, k))).collect()))
    }
}

/// Writes the payload of a request.
#[derive(Clone, Debug, Default)]
pub struct SectionWriter {
    entries: Vec<(u32, Vec<u8>)>,
}

impl SectionWriter {
    /// Adds a section of bytes.
    pub fn bytes(&mut self, id: u32, bytes: Vec<u8>) -> &mut Self {
        self.entries.push((id, bytes));
        self
    }

    /// Adds a section of indices.
    pub fn u32s<const N: usize>(&mut self, id: u32, values: &[[u32; N]]) -> &mut Self {
        self.bytes(id, values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect())
    }

    /// Adds a section of numbers.
    pub fn f64s<const N: usize>(&mut self, id: u32, values: &[[f64; N]]) -> &mut Self {
        self.bytes(id, values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect())
    }

    /// The payload, and the number of its sections.
    ///
    /// # Panics
    /// With more sections than [`MAX_SECTIONS`].
    #[must_use]
    pub fn finish(&self) -> (Vec<u8>, u32) {
        assert!(self.entries.len() <= MAX_SECTIONS, "{} sections", self.entries.len());
        let mut offset = self.entries.len() * ENTRY_BYTES;
        let mut payload = Vec::new();
        for (id, bytes) in &self.entries {
            payload.extend_from_slice(&u64::from(*id).to_le_bytes());
            payload.extend_from_slice(&(offset as u64).to_le_bytes());
            payload.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
            offset = (offset + bytes.len()).next_multiple_of(8);
        }
        for (_, bytes) in &self.entries {
            payload.extend_from_slice(bytes);
            payload.resize(payload.len().next_multiple_of(8), 0);
        }
        let num_sections = u32::try_from(self.entries.len()).unwrap_or(u32::MAX);
        (payload, num_sections)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn payload() -> (Vec<u8>, usize) {
        let mut writer = SectionWriter::default();
        writer.u32s(id::TRIANGLES, &[[1, 2, 3]]).bytes(id::SETTINGS, b"{}".to_vec()).f64s(id::MASSES, &[[0.5]]);
        let (payload, num) = writer.finish();
        (payload, num as usize)
    }

    #[test]
    fn sections_round_trip() {
        let (payload, num) = payload();
        let sections = Sections::parse(&payload, num).unwrap();
        assert_eq!(sections.u32s(id::TRIANGLES), Ok(Some(vec![[1, 2, 3]])));
        assert_eq!(sections.bytes(id::SETTINGS), Some(&b"{}"[..]));
        assert_eq!(sections.f64s(id::MASSES), Ok(Some(vec![[0.5]])));
        assert_eq!(sections.u32s::<1>(id::PINS), Ok(None));
        assert_eq!(
            sections.u32s::<2>(id::TRIANGLES),
            Err(SectionError::Length { id: id::TRIANGLES, length: 12, element: 8 })
        );
    }

    #[test]
    fn parse_rejects_wrong_counts_offsets_and_lengths() {
        let (good, num) = payload();
        assert!(matches!(Sections::parse(&good, MAX_SECTIONS + 1), Err(SectionError::TooMany { .. })));
        assert!(matches!(Sections::parse(&good[..num * ENTRY_BYTES - 1], num), Err(SectionError::Table { .. })));
        assert!(matches!(Sections::parse(&good[..good.len() - 1], num), Err(SectionError::Range { .. })));
        for (at, value) in [(8, 4u64), (8, u64::MAX - 7), (16, u64::MAX), (16, 1 << 40)] {
            let mut bad = good.clone();
            bad[at..at + 8].copy_from_slice(&value.to_le_bytes());
            assert!(matches!(Sections::parse(&bad, num), Err(SectionError::Range { .. })), "{at} {value}");
        }
        let mut bad = good.clone();
        bad[ENTRY_BYTES] = good[0];
        assert_eq!(Sections::parse(&bad, num).unwrap_err(), SectionError::Twice { id: id::TRIANGLES });
    }
}
