//! The structural sections of a crate file: tokens, fields, paths and specs.
//!
//! Counts are checked against the length of the file before anything is allocated for them.

use std::collections::BTreeMap;

use super::integers::{decode, decompress, most_bytes};
use crate::usd::{fault::Fault, layers::source::Source};

pub(super) const MAGIC: &[u8; 8] = b"PXR-USDC";
/// The oldest version with compressed sections, and the newest that is known.
const VERSIONS: [u8; 2] = [4, 13];
const MOST_SECTIONS: u64 = 64;
/// Ends a set of fields.
pub(super) const END: u32 = u32::MAX;

/// The sections of a crate file, and the file for values.
#[derive(Debug)]
pub(super) struct Tables {
    pub(super) source: Source,
    /// The second number of its version; the first is 0.
    pub(super) version: u8,
    pub(super) tokens: Vec<String>,
    pub(super) strings: Vec<u32>,
    /// The token of its name, and the representation of its value.
    pub(super) fields: Vec<(u32, u64)>,
    /// Indices of fields, each set ended by [`END`].
    pub(super) field_sets: Vec<u32>,
    /// By the index of a path.
    pub(super) paths: Vec<PathNode>,
    /// The first index of the set of fields, by the index of a path.
    pub(super) specs: BTreeMap<u32, u32>,
}

/// A path: the one above it, and its own last element.
#[derive(Clone, Debug, Default)]
pub(super) struct PathNode {
    /// Nothing of the root, and of an index that no path has.
    pub(super) parent: Option<u32>,
    pub(super) token: u32,
    pub(super) is_property: bool,
}

/// Reads numbers of a section one after the other.
struct Cursor<'s> {
    source: &'s Source,
    at: u64,
}

impl Cursor<'_> {
    fn number(&mut self) -> Result<u64, Fault> {
        let value = self.source.number(self.at)?;
        self.at += 8;
        Ok(value)
    }

    fn block(&mut self) -> Result<Vec<u8>, Fault> {
        let length = self.number()?;
        let bytes = self.source.read(self.at, length)?;
        self.at += length;
        Ok(bytes)
    }

    /// The number of elements of a section, of so many bytes each when decoded.
    fn count(&mut self, size: u64) -> Result<usize, Fault> {
        let count = self.number()?;
        bounded(self.source, count, size)
    }

    fn integers(&mut self, count: usize) -> Result<Vec<i32>, Fault> {
        decode(&decompress(&self.block()?, most_bytes(count))?, count)
    }

    fn indices(&mut self, count: usize) -> Result<Vec<u32>, Fault> {
        Ok(self.integers(count)?.into_iter().map(i32::cast_unsigned).collect())
    }
}

/// A number of elements, if a file of its length may have as many.
pub(super) fn bounded(source: &Source, count: u64, size: u64) -> Result<usize, Fault> {
    let needed = count.checked_mul(size).filter(|needed| *needed <= source.budget());
    let count = needed.and_then(|_| usize::try_from(count).ok());
    count.ok_or_else(|| Fault::new("asks for more than its bytes could hold"))
}

impl Tables {
    /// Reads all sections.
    pub(super) fn read(source: Source) -> Result<Self, Fault> {
        let header: [u8; 24] = source.array(0)?;
        let (magic, rest) = header.split_first_chunk::<8>().unwrap_or((MAGIC, &[]));
        let [major, version, ..] = rest else { return Err(Fault::new("is no crate file")) };
        let [oldest, newest] = VERSIONS;
        if magic != MAGIC || *major != 0 || !(oldest..=newest).contains(version) {
            return Err(Fault::new(format!(
                "is of crate version {major}.{version}; 0.{oldest} to 0.{newest} are read"
            )));
        }
        let version = *version;
        let sections = sections(&source)?;
        let at = |name: &str| {
            let start = sections.get(name).ok_or_else(|| Fault::new(format!("has no section {name}")))?;
            Ok::<_, Fault>(Cursor { source: &source, at: *start })
        };
        let tokens = tokens(&mut at("TOKENS")?)?;
        let strings = strings(&mut at("STRINGS")?)?;
        let fields = fields(&mut at("FIELDS")?)?;
        let mut cursor = at("FIELDSETS")?;
        let count = cursor.count(4)?;
        let field_sets = cursor.indices(count)?;
        let paths = paths(&mut at("PATHS")?, tokens.len())?;
        let specs = specs(&mut at("SPECS")?)?;
        Ok(Self { version, tokens, strings, fields, field_sets, paths, specs, source })
    }

    pub(super) fn token(&self, index: u32) -> Result<&str, Fault> {
        self.tokens.get(index as usize).map(String::as_str).ok_or_else(|| Fault::new("refers to a token that is none"))
    }

    pub(super) fn string(&self, index: u32) -> Result<&str, Fault> {
        let token = self.strings.get(index as usize);
        self.token(*token.ok_or_else(|| Fault::new("refers to a string that is none"))?)
    }

    /// Texts by their indices; each may be long, and named often.
    pub(super) fn texts(
        &self,
        indices: Vec<[u8; 4]>,
        text: impl Fn(u32) -> Result<String, Fault>,
    ) -> Result<Vec<String>, Fault> {
        let mut num_bytes = 0;
        let text = |index: [u8; 4]| {
            let text = text(u32::from_le_bytes(index))?;
            num_bytes += (text.len() + size_of::<String>()) as u64;
            bounded(&self.source, num_bytes, 1)?;
            Ok(text)
        };
        indices.into_iter().map(text).collect()
    }
}

/// Where sections start, by name.
fn sections(source: &Source) -> Result<BTreeMap<String, u64>, Fault> {
    let start = source.number(16)?;
    let count = source.number(start)?;
    if count > MOST_SECTIONS {
        return Err(Fault::new(format!("has {count} sections")));
    }
    let bytes = source.read(start + 8, 32 * count)?;
    let section = |bytes: &[u8; 32]| {
        let name = bytes[..16].split(|&byte| byte == 0).next().unwrap_or_default();
        let start = bytes[16..24].first_chunk::<8>().map_or(0, |start| u64::from_le_bytes(*start));
        (String::from_utf8_lossy(name).into_owned(), start)
    };
    Ok(bytes.as_chunks::<32>().0.iter().map(section).collect())
}

fn tokens(cursor: &mut Cursor<'_>) -> Result<Vec<String>, Fault> {
    let count = cursor.count(1)?;
    let size = cursor.count(1)?;
    let bytes = decompress(&cursor.block()?, size)?;
    let text = String::from_utf8(bytes).map_err(|_| Fault::new("has tokens that are no text"))?;
    let tokens: Vec<String> = text.split_terminator('\0').map(ToOwned::to_owned).collect();
    if tokens.len() == count { Ok(tokens) } else { Err(Fault::new("has not the tokens that it promises")) }
}

fn strings(cursor: &mut Cursor<'_>) -> Result<Vec<u32>, Fault> {
    let count = cursor.number()?;
    let size = count.checked_mul(4).ok_or_else(|| Fault::new("asks for more than its bytes could hold"))?;
    let bytes = cursor.source.read(cursor.at, size)?;
    Ok(bytes.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect())
}

fn fields(cursor: &mut Cursor<'_>) -> Result<Vec<(u32, u64)>, Fault> {
    let count = cursor.count(12)?;
    let names = cursor.indices(count)?;
    let bytes = decompress(&cursor.block()?, 8 * count)?;
    let values = bytes.as_chunks::<8>().0.iter().map(|bytes| u64::from_le_bytes(*bytes));
    let fields: Vec<_> = names.into_iter().zip(values).collect();
    if fields.len() == count { Ok(fields) } else { Err(Fault::new("has not the fields that it promises")) }
}

/// Paths in the order of a walk: each with its index, its last element (negative for properties), and where its next
/// sibling stands (-1: none, but a child follows; -2: neither; 0: no child, the sibling follows).
fn paths(cursor: &mut Cursor<'_>, num_tokens: usize) -> Result<Vec<PathNode>, Fault> {
    let num_paths = cursor.count(16)?;
    let count = cursor.count(16)?;
    let broken = || Fault::new("has paths that contradict each other");
    if count > num_paths {
        return Err(broken());
    }
    let indices = cursor.indices(count)?;
    let elements = cursor.integers(count)?;
    let jumps = cursor.integers(count)?;
    let mut nodes = vec![PathNode::default(); num_paths];
    let mut pending = if count == 0 { Vec::new() } else { vec![(0, None)] };
    let mut num_seen = 0;
    while let Some((mut at, mut parent)) = pending.pop() {
        loop {
            // Of a walk that visits nothing twice.
            num_seen += 1;
            if num_seen > count {
                return Err(broken());
            }
            let (&own, &element, &jump) = (
                indices.get(at).ok_or_else(broken)?,
                elements.get(at).ok_or_else(broken)?,
                jumps.get(at).ok_or_else(broken)?,
            );
            let node = nodes.get_mut(own as usize).ok_or_else(broken)?;
            let token = element.unsigned_abs();
            if token as usize >= num_tokens && parent.is_some() {
                return Err(broken());
            }
            *node = PathNode { parent, token, is_property: element < 0 };
            let sibling = usize::try_from(jump).ok();
            match (jump, sibling) {
                (1.., Some(sibling)) => {
                    pending.push((at + sibling, parent));
                    parent = Some(own);
                }
                (-1, _) => parent = Some(own),
                (0, _) => {}
                _ => break,
            }
            at += 1;
        }
    }
    Ok(nodes)
}

fn specs(cursor: &mut Cursor<'_>) -> Result<BTreeMap<u32, u32>, Fault> {
    let count = cursor.count(12)?;
    let paths = cursor.indices(count)?;
    let field_sets = cursor.indices(count)?;
    Ok(paths.into_iter().zip(field_sets).collect())
}
