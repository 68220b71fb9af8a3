//! An OBJ file as one piece of a larger file: its lines stay, but for the indices by which they refer to each other.

use std::{
    io::{self, Write},
    path::Path,
};

use crate::{
    error::WriteError,
    formats::text::{self, Edit, LogicalLines, Tokens},
};

use super::read::{ObjDocument, mark_length};

/// The state of the larger file before a piece.
#[derive(Clone, Debug, Default)]
pub(crate) struct Before {
    /// Number of `v`, `vt` and `vn`.
    pub(crate) counts: [usize; 3],
    /// Which of [`STATES`] are set.
    is_set: [bool; STATES.len()],
    /// Written before the next piece, where the last line has no end.
    pub(crate) separator: &'static str,
    /// Whether anything has been written.
    pub(crate) has_pieces: bool,
}

/// Keywords that apply to all elements after them, and the line that resets each. OBJ has no reset for materials;
/// readers take a name that no library defines for no material.
const STATES: [(&[u8], &str); 3] = [(b"g", "g default"), (b"s", "s off"), (b"usemtl", "usemtl none")];

/// Keywords of free-form geometry, whose indices are not understood here.
const FREE_FORM: [&[u8]; 12] =
    [b"curv", b"curv2", b"surf", b"trim", b"hole", b"scrv", b"sp", b"con", b"bsp", b"bzp", b"cdc", b"cdp"];

impl Before {
    /// The lines that reset all states that are set.
    pub(crate) fn resets(&mut self) -> impl Iterator<Item = &'static str> {
        let was_set = std::mem::take(&mut self.is_set);
        STATES.iter().zip(was_set).filter(|(_, was_set)| *was_set).map(|((_, reset), _)| *reset)
    }
}

/// What one pass over the lines of a piece finds.
#[derive(Debug, Default)]
struct Survey {
    edits: Vec<Edit>,
    counts: [usize; 3],
    /// Which of [`STATES`] are set anywhere in the piece.
    is_set: [bool; STATES.len()],
    /// Which of [`STATES`] are set before the first element, if there is one.
    is_set_first: Option<[bool; STATES.len()]>,
    /// Whether the piece names itself before its first element.
    has_name: bool,
}

impl ObjDocument {
    /// Writes the file after others, with other positions. The piece is an object of its own, called `name` unless it
    /// names itself, and the states that earlier pieces have set are reset.
    pub(crate) fn write_after(
        &self,
        before: &mut Before,
        name: &str,
        path: &Path,
        [own, positions]: [&[[f64; 3]]; 2],
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        let survey = self.survey(before).map_err(|(line, word)| WriteError::Join {
            path: path.to_path_buf(),
            line,
            keyword: text::shortened(word),
        })?;
        let mut start = 0;
        if before.has_pieces {
            start = mark_length(&self.source);
            self.write_opening(before, &survey, name, out)?;
        }
        let moves = text::coordinate_edits(&self.source, &self.coordinate_offsets, own, positions);
        let mut edits: Vec<Edit> = moves.chain(survey.edits).collect();
        edits.sort_by_key(|edit| edit.start);
        text::write_edited(&self.source, start, edits.into_iter(), out)?;
        let is_ended = self.source.ends_with(b"\n");
        // A backslash at the end would continue the last line with the first of the next piece.
        let goes_on = self.source.trim_ascii_end().ends_with(b"\\");
        before.separator = match (is_ended, goes_on) {
            (true, false) => "",
            (false, true) => "\n\n",
            _ => "\n",
        };
        before.has_pieces = true;
        for (count, more) in before.counts.iter_mut().zip(survey.counts) {
            *count += more;
        }
        for (is_set, more) in before.is_set.iter_mut().zip(survey.is_set) {
            *is_set |= more;
        }
        Ok(())
    }

    /// Writes the lines that separate the piece from earlier ones.
    fn write_opening(&self, before: &Before, survey: &Survey, name: &str, out: &mut dyn Write) -> io::Result<()> {
        let first_line = self.source.split_inclusive(|&byte| byte == b'\n').next().unwrap_or_default();
        let end = if first_line.ends_with(b"\r\n") { "\r\n" } else { "\n" };
        if !survey.has_name {
            write!(out, "o {name}{end}")?;
        }
        let is_set_first = survey.is_set_first.unwrap_or([true; STATES.len()]);
        for (state, (_, reset)) in STATES.iter().enumerate() {
            if before.is_set[state] && !is_set_first[state] {
                write!(out, "{reset}{end}")?;
            }
        }
        Ok(())
    }

    /// Surveys all lines. The error is the line, and its keyword, that can't be joined.
    fn survey(&self, before: &Before) -> Result<Survey, (usize, &[u8])> {
        let mut survey = Survey::default();
        let skipped = mark_length(&self.source);
        for (line, mut tokens) in LogicalLines::new(&self.source[skipped..]) {
            let Some((_, word)) = tokens.next() else { continue };
            match word {
                b"v" => survey.counts[0] += 1,
                b"vt" => survey.counts[1] += 1,
                b"vn" => survey.counts[2] += 1,
                b"f" | b"fo" | b"l" | b"p" => {
                    survey.is_set_first.get_or_insert(survey.is_set);
                    shift(tokens, skipped, before.counts, &mut survey.edits);
                }
                b"o" => survey.has_name |= survey.is_set_first.is_none(),
                _ if before.has_pieces && FREE_FORM.contains(&word) => return Err((line, word)),
                _ => {
                    if let Some(state) = STATES.iter().position(|(name, _)| *name == word) {
                        survey.is_set[state] = true;
                    }
                }
            }
        }
        Ok(survey)
    }
}

/// Shifts the positive indices of an element's corners by the counts of earlier pieces. Negative indices count back and
/// stay.
fn shift(tokens: Tokens<'_>, skipped: usize, counts: [usize; 3], edits: &mut Vec<Edit>) {
    for (offset, token) in tokens {
        let mut start = skipped + offset;
        for (field, count) in token.split(|&byte| byte == b'/').zip(counts) {
            let number = std::str::from_utf8(field).ok().and_then(|field| field.parse::<usize>().ok());
            if let Some(number) = number.filter(|&number| number > 0 && count > 0) {
                edits.push(Edit { start, length: field.len(), text: (number + count).to_string().into_bytes() });
            }
            start += field.len() + 1;
        }
    }
}
