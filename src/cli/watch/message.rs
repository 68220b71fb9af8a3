//! Messages for the page: a JSON document and arrays of numbers.
//!
//! `u32` length of the document, the document, spaces up to a multiple of 4, then the arrays, each at a multiple of 4;
//! all little-endian. The document is the header with a field `arrays`: for each array by its name the type of its
//! numbers, its offset from the first one in bytes, and how many numbers it has. `report/src/watch/message.ts` reads
//! it.

use std::sync::Arc;

use serde::Serialize;
use serde_json::{Map, Value, json};

/// A message that is being written.
#[derive(Debug, Default)]
pub(super) struct Message {
    arrays: Map<String, Value>,
    data: Vec<u8>,
}

impl Message {
    pub(super) fn singles(&mut self, name: &str, values: &[f32]) {
        self.array(name, "f32", values.len(), values.iter().flat_map(|value| value.to_le_bytes()));
    }

    pub(super) fn whole(&mut self, name: &str, values: &[u32]) {
        self.array(name, "u32", values.len(), values.iter().flat_map(|value| value.to_le_bytes()));
    }

    pub(super) fn bytes(&mut self, name: &str, values: &[u8]) {
        self.array(name, "u8", values.len(), values.iter().copied());
    }

    fn array(&mut self, name: &str, kind: &str, count: usize, bytes: impl Iterator<Item = u8>) {
        self.arrays.insert(name.to_owned(), json!([kind, self.data.len(), count]));
        self.data.extend(bytes);
        self.data.resize(self.data.len().next_multiple_of(4), 0);
    }

    /// The message with its header, which is an object.
    pub(super) fn finish(self, header: &impl Serialize) -> Arc<[u8]> {
        let mut header = serde_json::to_value(header).unwrap_or_default();
        header["arrays"] = Value::Object(self.arrays);
        let mut text = header.to_string();
        text.extend(std::iter::repeat_n(' ', text.len().next_multiple_of(4) - text.len()));
        let len = u32::try_from(text.len()).unwrap_or_else(|_| unreachable!("headers are short"));
        [&len.to_le_bytes()[..], text.as_bytes(), &self.data].concat().into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn message_says_where_each_array_is() {
        let mut message = Message::default();
        message.bytes("a", &[1, 2, 3]);
        message.singles("b", &[0.5]);
        message.whole("c", &[7, 8]);
        let bytes = message.finish(&json!({ "frame": 3 }));
        let len = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
        let header: Value = serde_json::from_slice(&bytes[4..4 + len]).unwrap();
        let arrays = json!({ "a": ["u8", 0, 3], "b": ["f32", 4, 1], "c": ["u32", 8, 2] });
        assert_eq!(header, json!({ "frame": 3, "arrays": arrays }));
        assert_eq!(bytes[4 + len..], [1, 2, 3, 0, 0, 0, 0, 63, 7, 0, 0, 0, 8, 0, 0, 0]);
        assert_eq!(len % 4, 0);
    }
}
