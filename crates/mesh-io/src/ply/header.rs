//! The header of a PLY file.

use super::super::{ReadErrorKind, text};

/// How the values after the header are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    #[default]
    F64,
}

impl Scalar {
    fn parse(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes of one number in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

/// One property of an element.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: Vec<u8>,
    /// Type of the length, if it is a list.
    pub(super) count: Option<Scalar>,
    pub(super) item: Scalar,
}

/// One kind of element.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: Vec<u8>,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// What the header says, and where it ends.
#[derive(Clone, Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    pub(super) body: usize,
}

/// Parses the header. An error comes with its line.
pub(super) fn parse(source: &[u8]) -> Result<Header, (Option<usize>, ReadErrorKind)> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut start = 0;
    for line_number in 1.. {
        let malformed = |reason: String| (Some(line_number), ReadErrorKind::Malformed(reason));
        let Some(length) = source[start..].iter().position(|&byte| byte == b'\n') else {
            return Err((Some(line_number), ReadErrorKind::Truncated { element: "the header".into() }));
        };
        let line = &source[start..start + length];
        start += length + 1;
        let mut words = line.split(|&byte| text::is_space(byte)).filter(|word| !word.is_empty());
        let words: [&[u8]; 5] = std::array::from_fn(|_| words.next().unwrap_or_default());
        match words {
            [b"ply", ..] if line_number == 1 => {}
            _ if line_number == 1 => return Err(malformed("a PLY file starts with the line `ply`".into())),
            [b"comment" | b"obj_info" | b"", ..] => {}
            [b"format", name, ..] => {
                encoding = Some(match name {
                    b"ascii" => Encoding::Ascii,
                    b"binary_little_endian" => Encoding::LittleEndian,
                    b"binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(malformed(format!("unknown format `{}`", text::shortened(name)))),
                });
            }
            [b"element", name, count, ..] => {
                let count = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok()).ok_or_else(|| {
                    malformed(format!("element `{}` needs a number of entries", text::shortened(name)))
                })?;
                elements.push(Element { name: name.to_vec(), count, properties: Vec::new() });
            }
            [b"property", rest @ ..] => {
                let (count, item, name) = match rest {
                    [b"list", count, item, name] => (Some(count), item, name),
                    [item, name, ..] => (None, item, name),
                };
                let scalar = |name: &[u8]| {
                    Scalar::parse(name).ok_or_else(|| malformed(format!("unknown type `{}`", text::shortened(name))))
                };
                let property =
                    Property { name: name.to_vec(), count: count.map(scalar).transpose()?, item: scalar(item)? };
                let element = elements.last_mut();
                element.ok_or_else(|| malformed("a property before any element".into()))?.properties.push(property);
            }
            [b"end_header", ..] => break,
            [word, ..] => return Err(malformed(format!("unknown word `{}` in the header", text::shortened(word)))),
        }
    }
    let Some(encoding) = encoding else {
        return Err((None, ReadErrorKind::Malformed("the header names no format".into())));
    };
    Ok(Header { encoding, elements, body: start })
}
