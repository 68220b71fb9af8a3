//! USD archives, `.usdz`: layers that stand in a zip file as they are, the root layer first.

use super::source::Source;
use crate::usd::fault::Fault;

const LOCAL: [u8; 4] = *b"PK\x03\x04";
const CENTRAL: [u8; 4] = *b"PK\x01\x02";
const END: [u8; 4] = *b"PK\x05\x06";
const END_SIZE: u64 = 22;
/// The end of an archive may have a comment behind it.
const MOST_COMMENT: u64 = 1 << 16;

/// A file in an archive.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) start: u64,
    pub(super) length: u64,
}

/// Whether these are the first bytes of an archive.
pub(super) fn is_archive(start: &[u8]) -> bool {
    start.starts_with(&LOCAL)
}

/// The files of an archive, in its order.
pub(super) fn entries(source: &Source) -> Result<Vec<Entry>, Fault> {
    let broken = || Fault::new("is a broken archive");
    let tail_length = source.length().min(END_SIZE + MOST_COMMENT);
    let tail = source.read(source.length() - tail_length, tail_length)?;
    let end = tail.windows(4).rposition(|window| window == END).ok_or_else(broken)?;
    let end = tail.get(end..).unwrap_or_default();
    let (size, start) = (long(end, 12).ok_or_else(broken)?, long(end, 16).ok_or_else(broken)?);
    let directory = source.read(start, size)?;
    let mut rest = directory.as_slice();
    let mut entries = Vec::new();
    while rest.starts_with(&CENTRAL) {
        let [name, extra, comment] = [28, 30, 32].map(|at| short(rest, at).unwrap_or(0));
        let local = long(rest, 42).ok_or_else(broken)?;
        let text = rest.get(46..46 + name).ok_or_else(broken)?;
        let name_text = String::from_utf8_lossy(text).into_owned();
        if short(rest, 10) != Some(0) {
            return Err(Fault::new(format!("holds {name_text} compressed, which archives of USD must not")));
        }
        let length = long(rest, 24).ok_or_else(broken)?;
        let header: [u8; 30] = source.array(local)?;
        let [name_length, extra_length] = [26, 28].map(|at| short(&header, at).unwrap_or(0) as u64);
        let start = local + 30 + name_length + extra_length;
        entries.push(Entry { name: name_text, start, length });
        rest = rest.get(46 + name + extra + comment..).ok_or_else(broken)?;
    }
    // The directory may be in any order; the first file is the root layer.
    entries.sort_by_key(|entry| entry.start);
    Ok(entries)
}

fn short(bytes: &[u8], at: usize) -> Option<usize> {
    bytes.get(at..)?.first_chunk::<2>().map(|bytes| u16::from_le_bytes(*bytes).into())
}

fn long(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk::<4>().map(|bytes| u32::from_le_bytes(*bytes).into())
}
