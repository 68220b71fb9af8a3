//! Values of fields, as far as meshes and their places need them.

/// A value; what no mesh needs is [`Value::Other`].
#[derive(Clone, Debug, PartialEq)]
pub(in crate::usd) enum Value {
    /// `None` in the text: the opinion that there is no value.
    Blocked,
    Bool(bool),
    /// A scalar of any numeric type, or the components of a vector, of a quaternion (real part first) or of a matrix
    /// (row by row).
    Numbers(Vec<f64>),
    /// A token, string or asset path.
    Text(String),
    /// Several tokens or strings.
    Texts(Vec<String>),
    /// An array of integers.
    Integers(Vec<i64>),
    /// An array of vectors of two or three singles, flat.
    Singles(Vec<f32>),
    Other,
}

impl Value {
    pub(in crate::usd) fn as_text(&self) -> Option<&str> {
        if let Self::Text(text) = self { Some(text) } else { None }
    }

    pub(in crate::usd) fn as_number(&self) -> Option<f64> {
        if let Self::Numbers(numbers) = self { numbers.first().copied() } else { None }
    }

    pub(in crate::usd) fn as_bool(&self) -> Option<bool> {
        match self {
            Self::Bool(value) => Some(*value),
            Self::Numbers(numbers) => numbers.first().map(|&value| value > 0.0),
            _ => None,
        }
    }
}

/// Where a value is: decoded only when it is asked for.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::usd) enum Slot {
    /// By its representation in a crate file.
    Binary(u64),
    /// By its bytes in a text.
    Text {
        /// First byte.
        start: u64,
        /// Number of bytes.
        length: u64,
    },
}
