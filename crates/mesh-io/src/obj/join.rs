//! An OBJ file as a piece of a larger one: its lines stay, but for the numbers by which they name each other.

use std::io::Write;

use super::{
    super::{
        MeshFile, WriteError,
        text::{self, Edit, LogicalLines, Tokens},
    },
    read::{ObjDocument, mark_length},
};

/// What has been written before a piece.
#[derive(Clone, Debug, Default)]
pub(super) struct Before {
    /// Number of `v`, `vt` and `vn`.
    pub(super) counts: [usize; 3],
    /// Which of [`STATES`] is set.
    is_set: [bool; STATES.len()],
    /// What ends the last line.
    pub(super) separator: &'static str,
    /// Whether anything has been written.
    pub(super) has_pieces: bool,
}

/// Words that hold for all elements after them, and the line that takes each back. For materials OBJ has none: a name that no library
/// defines is what readers take for "without".
const STATES: [(&[u8], &str); 3] = [(b"g", "g default"), (b"s", "s off"), (b"usemtl", "usemtl none")];

/// Words of free-form geometry, whose numbers are not understood here.
const FREE_FORM: [&[u8]; 12] =
    [b"curv", b"curv2", b"surf", b"trim", b"hole", b"scrv", b"sp", b"con", b"bsp", b"bzp", b"cdc", b"cdp"];

impl Before {
    /// Lines that take back what is set.
    pub(super) fn resets(&mut self) -> impl Iterator<Item = &'static str> {
        let was_set = std::mem::take(&mut self.is_set);
        STATES.iter().zip(was_set).filter(|(_, was_set)| *was_set).map(|((_, reset), _)| *reset)
    }
}

/// What a piece holds, found in one pass.
#[derive(Debug, Default)]
struct Survey {
    edits: Vec<Edit>,
    counts: [usize; 3],
    /// Which of [`STATES`] are set anywhere.
    is_set: [bool; STATES.len()],
    /// Which of [`STATES`] are set before the first element, if there is one.
    is_set_first: Option<[bool; STATES.len()]>,
    /// Whether the piece names itself before its first element.
    has_name: bool,
}

impl ObjDocument {
    /// Writes the file after others, with other positions. It begins as an object of its own and without what the others have set.
    pub(super) fn write_after(
        &self,
        before: &mut Before,
        name: &str,
        mesh: &MeshFile,
        positions: &[[f64; 3]],
        out: &mut dyn Write,
    ) -> Result<(), WriteError> {
        let survey = self.survey(before).map_err(|(line, word)| WriteError::Join {
            path: mesh.path().to_path_buf(),
            line,
            keyword: text::shortened(word),
        })?;
        let first_line = self.source.split_inclusive(|&byte| byte == b'\n').next().unwrap_or_default();
        let end = if first_line.ends_with(b"\r\n") { "\r\n" } else { "\n" };
        let mut start = 0;
        if before.has_pieces {
            start = mark_length(&self.source);
            if !survey.has_name {
                write!(out, "o {name}{end}")?;
            }
            let is_set_first = survey.is_set_first.unwrap_or([true; STATES.len()]);
            for (state, (_, reset)) in STATES.iter().enumerate() {
                if before.is_set[state] && !is_set_first[state] {
                    write!(out, "{reset}{end}")?;
                }
            }
        }
        let moves = text::coordinate_edits(&self.source, &self.coordinate_offsets, mesh.positions(), positions);
        let mut edits: Vec<Edit> = moves.chain(survey.edits).collect();
        edits.sort_by_key(|edit| edit.start);
        text::write_edited(&self.source, start, edits.into_iter(), out)?;
        let is_ended = self.source.ends_with(b"\n");
        // A backslash at the end would take the next line into this one.
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

    /// Looks at every line. An error is a line that can't be joined, and its first word.
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

/// Moves the positive numbers of an element's corners on by what was written before. Negative ones count back and stay.
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
