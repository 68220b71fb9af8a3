//! Text of files as a terminal may show it.

use std::fmt::{self, Display, Formatter, Write};

/// A text of unknown origin, shown with its control characters escaped: names in a file, and names of files, must not
/// move the cursor, colour the terminal, change its title, or turn the direction of writing.
///
/// ```
/// use untangled_mesh_io::Printable;
///
/// assert_eq!(Printable("sleeve \u{1b}[2Jleft\n").to_string(), "sleeve \\u{1b}[2Jleft\\n");
/// assert_eq!(Printable("Ärmel \"links\"").to_string(), "Ärmel \"links\"");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Printable<T>(pub T);

impl<T: Display> Display for Printable<T> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(Escaping(formatter), "{}", self.0)
    }
}

/// What a file is refused for, with words of the file in it: as [`Printable`], and cut where it is longer than a reader
/// wants, since a word of a file may be as long as the file.
pub(crate) struct Reason<T>(pub(crate) T);

/// Most characters of a reason.
const LONGEST_REASON: usize = 500;

impl<T: Display> Display for Reason<T> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        let shown = Printable(&self.0).to_string();
        match shown.char_indices().nth(LONGEST_REASON) {
            Some((end, _)) => write!(formatter, "{}...", &shown[..end]),
            None => formatter.write_str(&shown),
        }
    }
}

/// Hands text on with control characters escaped.
struct Escaping<'a, 'f>(&'a mut Formatter<'f>);

impl Write for Escaping<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut rest = text;
        while let Some(at) = rest.find(acts_on_terminals) {
            let (plain, tail) = rest.split_at(at);
            self.0.write_str(plain)?;
            let mut characters = tail.chars();
            if let Some(control) = characters.next() {
                write!(self.0, "{}", control.escape_default())?;
            }
            rest = characters.as_str();
        }
        self.0.write_str(rest)
    }
}

/// Whether a character acts on the terminal or on the characters round it instead of being seen: C0 and C1 controls,
/// line and paragraph separators, and the marks of the bidirectional algorithm (Unicode Standard Annex 9).
fn acts_on_terminals(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{061c}')
        || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printable_escapes_what_acts_on_terminals_and_keeps_all_else() {
        let shown = |text: &str| Printable(text).to_string();
        assert_eq!(shown("a\u{1b}]0;title\u{7}b"), "a\\u{1b}]0;title\\u{7}b");
        assert_eq!(shown("\u{9b}31m\r\n\t"), "\\u{9b}31m\\r\\n\\t");
        assert_eq!(shown("abc\u{202e}fed\u{2069}"), "abc\\u{202e}fed\\u{2069}");
        assert_eq!(shown("袖 \\ ' \" é 👕"), "袖 \\ ' \" é 👕");
        assert_eq!(shown(""), "");
    }

    #[test]
    fn reason_is_cut_after_500_characters_as_they_are_shown() {
        assert_eq!(Reason("ä".repeat(500)).to_string(), "ä".repeat(500));
        assert_eq!(Reason("ä".repeat(501)).to_string(), "ä".repeat(500) + "...");
        assert_eq!(Reason("\0".repeat(1000)).to_string(), "\\u{0}".repeat(100) + "...");
    }
}
