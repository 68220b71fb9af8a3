//! Text formats: tokens, numbers, and replacing tokens without touching any other byte.

use std::io::{self, Write};

use crate::error::ReadErrorKind;

/// Tokens of one logical line, separated by white space and ended by a comment; a line that ends in `\` continues in
/// the next.
#[derive(Clone, Debug)]
pub(crate) struct Tokens<'a> {
    source: &'a [u8],
    at: usize,
    end: usize,
}

impl<'a> Tokens<'a> {
    /// The tokens of `source[start..end]`.
    pub(crate) fn new(source: &'a [u8], start: usize, end: usize) -> Self {
        Self { source, at: start, end }
    }

    /// Byte offset at which the search for the next token starts.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }
}

impl<'a> Iterator for Tokens<'a> {
    /// Byte offset in the source, and the token.
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let line = &self.source[..self.end];
        while self.at < self.end && (is_space(line[self.at]) || continues(line, self.at)) {
            self.at += 1;
        }
        if self.at == self.end || line[self.at] == b'#' {
            return None;
        }
        let start = self.at;
        while self.at < self.end && !is_space(line[self.at]) && !continues(line, self.at) {
            self.at += 1;
        }
        Some((start, &line[start..self.at]))
    }
}

/// Whether a byte is white space between tokens.
pub(crate) fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// Whether the backslash at `at` is the last character of its line.
fn continues(source: &[u8], at: usize) -> bool {
    source[at] == b'\\' && matches!(&source[at + 1..], [] | [b'\n', ..] | [b'\r', b'\n', ..] | [b'\r'])
}

/// The logical lines of a text: each with the number of its first line, from 1, and its range of bytes.
#[derive(Debug)]
pub(crate) struct LogicalLines<'a> {
    source: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> LogicalLines<'a> {
    /// The lines of a whole text.
    pub(crate) fn new(source: &'a [u8]) -> Self {
        Self { source, at: 0, line: 1 }
    }
}

impl<'a> Iterator for LogicalLines<'a> {
    type Item = (usize, Tokens<'a>);

    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.source.len() {
            return None;
        }
        let (start, first_line) = (self.at, self.line);
        let is_comment = self.source[start..].iter().find(|&&byte| byte != b' ' && byte != b'\t') == Some(&b'#');
        loop {
            let rest = &self.source[self.at..];
            let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
            let text = rest[..length].strip_suffix(b"\r").unwrap_or(&rest[..length]);
            let is_last = self.at + length >= self.source.len();
            // A comment does not continue: one that ends in a backslash most likely ends in the path of a folder.
            let goes_on = !is_comment && !is_last && text.ends_with(b"\\");
            self.at += length + 1;
            self.line += 1;
            if !goes_on || self.at >= self.source.len() {
                let end = self.at.min(self.source.len());
                return Some((first_line, Tokens::new(self.source, start, end)));
            }
        }
    }
}

/// Parses a finite number; `element` names its owner in the error.
pub(crate) fn finite_number(token: &[u8], element: impl Fn() -> String) -> Result<f64, ReadErrorKind> {
    let Some(value) = number(token) else {
        return Err(ReadErrorKind::NotANumber { element: element(), text: shortened(token) });
    };
    if value.is_finite() { Ok(value) } else { Err(ReadErrorKind::NotFinite { element: element(), value }) }
}

/// Parses the double nearest to a decimal number.
pub(crate) fn number(token: &[u8]) -> Option<f64> {
    std::str::from_utf8(token).ok()?.parse().ok()
}

/// At most 32 characters of a token, for a message on one line.
pub(crate) fn shortened(token: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(token).chars().filter(|c| !c.is_control()).take(33).collect();
    if text.chars().count() > 32 { format!("{}...", text.chars().take(32).collect::<String>()) } else { text }
}

/// The line of a byte, counted from 1.
pub(crate) fn line_of(source: &[u8], offset: usize) -> usize {
    1 + source[..offset.min(source.len())].iter().filter(|&&byte| byte == b'\n').count()
}

/// Writes a number so that reading it gives the same double.
pub(crate) fn write_number(value: f64, out: &mut dyn Write) -> io::Result<()> {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-5..1e16).contains(&magnitude) {
        write!(out, "{value:e}")
    } else {
        write!(out, "{value}")
    }
}

/// Writes `source` with other coordinates: the tokens of coordinates that changed are replaced, every other byte stays.
///
/// `tokens` holds the byte offsets of the three coordinates of each vertex, in the order of the text.
pub(crate) fn write_replaced(
    source: &[u8],
    tokens: &[[usize; 3]],
    before: &[[f64; 3]],
    after: &[[f64; 3]],
    out: &mut dyn Write,
) -> io::Result<()> {
    write_edited(source, 0, coordinate_edits(source, tokens, before, after), out)
}

/// A token of a text and its replacement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Edit {
    /// Byte offset of the token.
    pub(crate) start: usize,
    /// Its length in bytes.
    pub(crate) length: usize,
    /// The replacement.
    pub(crate) text: Vec<u8>,
}

/// The edits that [`write_replaced`] makes, in the order of the text.
pub(crate) fn coordinate_edits<'a>(
    source: &'a [u8],
    tokens: &'a [[usize; 3]],
    before: &'a [[f64; 3]],
    after: &'a [[f64; 3]],
) -> impl Iterator<Item = Edit> + 'a {
    tokens.iter().zip(before).zip(after).flat_map(move |((starts, before), after)| {
        let mut order = [0, 1, 2];
        order.sort_unstable_by_key(|&axis| starts[axis]);
        let moved = order.into_iter().filter(|&axis| before[axis].to_bits() != after[axis].to_bits());
        moved.map(|axis| {
            let start = starts[axis];
            let token = Tokens::new(source, start, source.len()).next();
            let mut text = Vec::new();
            write_number(after[axis], &mut text).unwrap_or_else(|error| unreachable!("writing into memory: {error}"));
            Edit { start, length: token.map_or(0, |(_, token)| token.len()), text }
        })
    })
}

/// Writes `source` from the byte `from` on with edits, sorted by their start.
pub(crate) fn write_edited(
    source: &[u8],
    from: usize,
    edits: impl Iterator<Item = Edit>,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut written = from;
    for Edit { start, length, text } in edits {
        out.write_all(&source[written..start])?;
        out.write_all(&text)?;
        written = start + length;
    }
    out.write_all(&source[written..])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(source: &[u8]) -> Vec<(usize, Vec<&[u8]>)> {
        LogicalLines::new(source).map(|(line, tokens)| (line, tokens.map(|(_, token)| token).collect())).collect()
    }

    #[test]
    fn logical_lines_join_continued_lines_and_stop_at_comments() {
        let source = b"f 1\\\n 2 \\\r\n3\r\n# C:\\\nv 1 # x\nend\\";
        let expected: Vec<(usize, Vec<&[u8]>)> =
            vec![(1, vec![b"f", b"1", b"2", b"3"]), (4, vec![]), (5, vec![b"v", b"1"]), (6, vec![b"end"])];
        assert_eq!(lines(source), expected);
    }

    #[test]
    fn write_number_of_any_double_reads_back_to_the_same_bits() {
        for value in [0.1, -0.0, 1e300, 5e-324, 123_456_789.123_456_79, f64::MAX, 1e16, -1e-5] {
            let mut text = Vec::new();
            write_number(value, &mut text).unwrap();
            assert_eq!(number(&text).unwrap().to_bits(), value.to_bits(), "{}", String::from_utf8_lossy(&text));
            assert!(text.len() < 26);
        }
    }
}
