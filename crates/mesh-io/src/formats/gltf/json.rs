//! Edits of a JSON text that leave every other byte unchanged.

use std::ops::Range;

use serde::Deserialize;
use serde_json::value::RawValue;

use crate::formats::text::{Edit, write_edited};

/// Byte ranges of what may be edited in the JSON of a glTF document.
#[derive(Debug, Default)]
pub(crate) struct Spans {
    /// `min` and `max` of each accessor.
    pub(crate) bounds: Vec<[Option<Range<usize>>; 2]>,
    /// Each buffer.
    pub(crate) buffers: Vec<BufferSpan>,
}

/// The byte ranges of one buffer.
#[derive(Debug)]
pub(crate) struct BufferSpan {
    /// The whole object.
    object: Range<usize>,
    /// The value of `uri`.
    uri: Option<Range<usize>>,
}

#[derive(Deserialize)]
struct Root<'a> {
    #[serde(borrow, default)]
    accessors: Vec<&'a RawValue>,
    #[serde(borrow, default)]
    buffers: Vec<&'a RawValue>,
}

#[derive(Deserialize)]
struct AccessorText<'a> {
    #[serde(borrow)]
    min: Option<&'a RawValue>,
    #[serde(borrow)]
    max: Option<&'a RawValue>,
}

#[derive(Deserialize)]
struct BufferText<'a> {
    #[serde(borrow)]
    uri: Option<&'a RawValue>,
}

impl Spans {
    /// Finds all of them.
    pub(crate) fn find(json: &[u8]) -> Result<Self, serde_json::Error> {
        let span = |value: &RawValue| {
            // The value borrows from the text, so its address gives its offset.
            let start = value.get().as_ptr().addr() - json.as_ptr().addr();
            start..start + value.get().len()
        };
        let Root { accessors, buffers } = serde_json::from_slice(json)?;
        let mut spans = Self::default();
        for accessor in accessors {
            let AccessorText { min, max } = serde_json::from_str(accessor.get())?;
            spans.bounds.push([min.map(span), max.map(span)]);
        }
        for buffer in buffers {
            let BufferText { uri } = serde_json::from_str(buffer.get())?;
            spans.buffers.push(BufferSpan { object: span(buffer), uri: uri.map(span) });
        }
        Ok(spans)
    }
}

impl BufferSpan {
    /// The edit that sets the link of the buffer.
    pub(crate) fn set_uri(&self, link: &str) -> Edit {
        match &self.uri {
            Some(uri) => replacing(uri, format!("\"{link}\"").into_bytes()),
            None => {
                let inside = self.object.start + 1;
                // `byteLength` is mandatory, so another member follows the comma.
                replacing(&(inside..inside), format!("\"uri\":\"{link}\",").into_bytes())
            }
        }
    }

    /// The edit that removes the link, if there is one.
    pub(crate) fn remove_uri(&self, json: &[u8]) -> Option<Edit> {
        let uri = self.uri.clone()?;
        let key_end = json[..uri.start].iter().rposition(|&byte| byte == b'"')?;
        let key_start = json[..key_end].iter().rposition(|&byte| byte == b'"')?;
        let (before, after) = (json[..key_start].trim_ascii_end(), json[uri.end..].trim_ascii_start());
        let range = match (before.strip_suffix(b","), after.strip_prefix(b",")) {
            (_, Some(after)) => key_start..json.len() - after.len(),
            (Some(before), None) => before.len()..uri.end,
            (None, None) => key_start..uri.end,
        };
        Some(replacing(&range, Vec::new()))
    }
}

/// The text after all edits, which must not overlap.
pub(crate) fn edited(json: &[u8], mut edits: Vec<Edit>) -> Vec<u8> {
    edits.sort_by_key(|edit| edit.start);
    let mut text = Vec::with_capacity(json.len());
    write_edited(json, 0, edits.into_iter(), &mut text)
        .unwrap_or_else(|error| unreachable!("writing into memory: {error}"));
    text
}

/// The edit that replaces a range.
pub(crate) fn replacing(range: &Range<usize>, text: Vec<u8>) -> Edit {
    Edit { start: range.start, length: range.len(), text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffer_span_sets_and_removes_a_link_and_keeps_all_else() {
        let cases = [
            (r#"{"buffers": [{"uri": "a.bin", "byteLength": 4}]}"#, r#"{"buffers": [{ "byteLength": 4}]}"#),
            (r#"{"buffers":[ { "byteLength":4 , "uri" : "a" } ] }"#, r#"{"buffers":[ { "byteLength":4  } ] }"#),
            (r#"{"buffers":[{"a":1,"uri":"","b":2}],"x":1}"#, r#"{"buffers":[{"a":1,"b":2}],"x":1}"#),
        ];
        for (with, without) in cases {
            let json = with.as_bytes();
            let spans = Spans::find(json).unwrap();
            let removed = edited(json, vec![spans.buffers[0].remove_uri(json).unwrap()]);
            assert_eq!(String::from_utf8(removed.clone()).unwrap(), without);
            let replaced = edited(json, vec![spans.buffers[0].set_uri("b")]);
            let value =
                |json: &[u8]| serde_json::from_slice::<serde_json::Value>(json).unwrap()["buffers"][0]["uri"].clone();
            assert_eq!(value(&replaced), "b");
            let spans = Spans::find(&removed).unwrap();
            assert!(spans.buffers[0].remove_uri(&removed).is_none());
            assert_eq!(value(&edited(&removed, vec![spans.buffers[0].set_uri("c")])), "c");
        }
    }

    #[test]
    fn spans_find_the_byte_ranges_of_bounds() {
        let json = br#"{"accessors":[{"max": [1, 2, 3],"count":1},{},{"min":[0],"max":null}]}"#;
        let spans = Spans::find(json).unwrap();
        let text =
            |span: &Option<Range<usize>>| span.clone().map(|span| String::from_utf8_lossy(&json[span]).into_owned());
        assert_eq!(spans.bounds[0].each_ref().map(text), [None, Some("[1, 2, 3]".into())]);
        assert_eq!(spans.bounds[1].each_ref().map(text), [None, None]);
        assert_eq!(spans.bounds[2].each_ref().map(text), [Some("[0]".into()), None]);
    }
}
