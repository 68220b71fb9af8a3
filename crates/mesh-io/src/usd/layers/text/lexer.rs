//! Tokens of a text layer.

use std::borrow::Cow;

use crate::usd::fault::Fault;

/// A token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token<'b> {
    /// An identifier, a keyword, a type or a number: what stands without quotes.
    Word(&'b str),
    /// A string without its quotes, escapes as they stand.
    Quoted(&'b str),
    /// An asset path without its `@`.
    Asset(&'b str),
    /// A path without its `<` and `>`.
    Path(&'b str),
    /// Any of `(){}[]=:;,`.
    Sign(u8),
    End,
}

/// Goes through the bytes of a text.
#[derive(Clone, Debug)]
pub(super) struct Lexer<'b> {
    bytes: &'b [u8],
    at: usize,
}

const WORD: fn(u8) -> bool = |byte| {
    byte.is_ascii_alphanumeric() || byte >= 0x80 || matches!(byte, b'_' | b':' | b'.' | b'-' | b'+' | b'!' | b'|')
};

impl<'b> Lexer<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The offset of the next token.
    pub(super) fn offset(&mut self) -> usize {
        self.skip_space();
        self.at
    }

    /// The offset behind the last token.
    pub(super) fn end(&self) -> usize {
        self.at
    }

    /// The bytes from an offset up to the end of the last token.
    pub(super) fn between(&self, start: usize) -> &'b [u8] {
        self.bytes.get(start..self.at).unwrap_or_default()
    }

    /// The line of an offset, counted from 1.
    fn line(&self, offset: usize) -> usize {
        1 + self.bytes[..offset.min(self.bytes.len())].iter().filter(|&&byte| byte == b'\n').count()
    }

    pub(super) fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault { line: Some(self.line(self.at)), reason: reason.into() }
    }

    fn skip_space(&mut self) {
        while let Some(&byte) = self.bytes.get(self.at) {
            if byte == b'#' {
                self.at += self.bytes[self.at..].iter().take_while(|&&byte| byte != b'\n').count();
            } else if byte.is_ascii_whitespace() {
                self.at += 1;
            } else {
                return;
            }
        }
    }

    pub(super) fn peek(&self) -> Result<Token<'b>, Fault> {
        self.clone().next()
    }

    /// Takes a sign if it is the next token.
    pub(super) fn take(&mut self, sign: u8) -> bool {
        self.skip_space();
        let is_there = self.bytes.get(self.at) == Some(&sign);
        self.at += usize::from(is_there);
        is_there
    }

    /// Takes the bracket that closes what was opened before an offset, if it is the next token.
    pub(super) fn take_end(&mut self, sign: u8, opened: usize) -> Result<bool, Fault> {
        let is_there = self.take(sign);
        if is_there || self.at < self.bytes.len() { Ok(is_there) } else { Err(self.unclosed(sign, opened)) }
    }

    fn unclosed(&self, sign: u8, opened: usize) -> Fault {
        let line = self.line(opened);
        self.fault(format!("ends, and what is opened in line {line} is not closed: `{}` is missing", char::from(sign)))
    }

    pub(super) fn expect(&mut self, sign: u8) -> Result<(), Fault> {
        if self.take(sign) {
            return Ok(());
        }
        Err(self.fault(format!("`{}` is needed here", char::from(sign))))
    }

    pub(super) fn next(&mut self) -> Result<Token<'b>, Fault> {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let Some(&first) = rest.first() else { return Ok(Token::End) };
        match first {
            b'"' | b'\'' => self.quoted(first).map(Token::Quoted),
            b'@' => self.asset().map(Token::Asset),
            b'<' => {
                let length =
                    rest.iter().position(|&byte| byte == b'>').ok_or_else(|| self.fault("a path has no end"))?;
                self.at += length + 1;
                self.text(&rest[1..length]).map(Token::Path)
            }
            _ if WORD(first) => {
                let length = rest.iter().take_while(|&&byte| WORD(byte)).count();
                self.at += length;
                self.text(&rest[..length]).map(Token::Word)
            }
            _ => {
                self.at += 1;
                Ok(Token::Sign(first))
            }
        }
    }

    fn text(&self, bytes: &'b [u8]) -> Result<&'b str, Fault> {
        std::str::from_utf8(bytes).map_err(|_| self.fault("what stands here is no text"))
    }

    fn quoted(&mut self, quote: u8) -> Result<&'b str, Fault> {
        let rest = &self.bytes[self.at..];
        let marks = if rest.starts_with(&[quote; 3]) { 3 } else { 1 };
        let mut length = marks;
        while !rest[length..].starts_with(&[quote; 3][..marks]) {
            length += match rest.get(length) {
                None => return Err(self.fault("a string has no end")),
                Some(b'\\') => 2,
                Some(_) => 1,
            };
            length = length.min(rest.len());
        }
        self.at += length + marks;
        self.text(&rest[marks..length])
    }

    fn asset(&mut self) -> Result<&'b str, Fault> {
        let rest = &self.bytes[self.at..];
        let marks = if rest.starts_with(b"@@@") { 3 } else { 1 };
        let end = rest[marks..].windows(marks).position(|window| window.iter().all(|&byte| byte == b'@'));
        let end = end.ok_or_else(|| self.fault("an asset path has no end"))?;
        self.at += end + 2 * marks;
        self.text(&rest[marks..marks + end])
    }

    /// What stands before a sign, which is taken too.
    pub(super) fn until(&mut self, sign: u8) -> Result<&'b str, Fault> {
        self.skip_space();
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&byte| byte == sign || byte == b'\n');
        let length = length.filter(|&length| rest[length] == sign);
        let length = length.ok_or_else(|| self.fault(format!("`{}` is needed here", char::from(sign))))?;
        self.at += length + 1;
        self.text(rest[..length].trim_ascii())
    }

    /// Skips a value: a token, or all up to the bracket that closes it.
    pub(super) fn skip_value(&mut self) -> Result<(), Fault> {
        let (start, mut open) = (self.offset(), Vec::new());
        loop {
            match self.next()? {
                Token::Sign(b'(') => open.push(b')'),
                Token::Sign(b'[') => open.push(b']'),
                Token::Sign(b'{') => open.push(b'}'),
                Token::Sign(sign @ (b')' | b']' | b'}')) => match open.pop() {
                    Some(needed) if needed == sign => {}
                    Some(needed) => return Err(self.fault(format!("`{}` is needed here", char::from(needed)))),
                    None => return Err(self.fault("a value is needed here")),
                },
                Token::End => match open.first() {
                    Some(needed) => return Err(self.unclosed(*needed, start)),
                    None => return Err(self.fault("ends where a value is needed")),
                },
                _ => {}
            }
            if open.is_empty() {
                return Ok(());
            }
        }
    }
}

/// A string with its escapes replaced.
pub(super) fn unescape(text: &str) -> Cow<'_, str> {
    if !text.contains('\\') {
        return text.into();
    }
    let mut out = String::new();
    let mut chars = text.chars();
    while let Some(char) = chars.next() {
        out.push(match (char, char == '\\') {
            (_, true) => match chars.next().unwrap_or('\\') {
                'n' => '\n',
                't' => '\t',
                'r' => '\r',
                other => other,
            },
            _ => char,
        });
    }
    out.into()
}
