//! The header of a PLY file.

use crate::{error::ReadErrorKind, formats::text};

/// How the values after the header are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Scalar {
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
    pub(crate) fn size(self) -> usize {
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
pub(crate) struct Property {
    pub(crate) name: Vec<u8>,
    /// Type of the length, if it is a list.
    pub(crate) count: Option<Scalar>,
    pub(crate) item: Scalar,
}

/// One kind of element.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub(crate) name: Vec<u8>,
    pub(crate) count: usize,
    pub(crate) properties: Vec<Property>,
}

/// The contents of a header.
#[derive(Clone, Debug)]
pub(crate) struct Header {
    pub(crate) encoding: Encoding,
    pub(crate) elements: Vec<Element>,
    /// Byte offset of the first value.
    pub(crate) body: usize,
}

/// Parses the header. An error comes with its line.
pub(crate) fn parse(source: &[u8]) -> Result<Header, (Option<usize>, ReadErrorKind)> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut start = 0;
    for line_number in 1.. {
        let Some(length) = source[start..].iter().position(|&byte| byte == b'\n') else {
            return Err((Some(line_number), ReadErrorKind::Truncated { element: "the header".into() }));
        };
        let mut words =
            source[start..start + length].split(|&byte| text::is_space(byte)).filter(|word| !word.is_empty());
        let words: [&[u8]; 5] = std::array::from_fn(|_| words.next().unwrap_or_default());
        start += length + 1;
        match words {
            [b"ply", ..] if line_number == 1 => continue,
            _ if line_number == 1 => Err("a PLY file starts with the line `ply`".into()),
            [b"comment" | b"obj_info" | b"", ..] => continue,
            [b"format", name, ..] => encoding_of(name).map(|found| encoding = Some(found)),
            [b"element", name, count, ..] => element(name, count).map(|element| elements.push(element)),
            [b"property", rest @ ..] => property(rest).and_then(|property| {
                let element = elements.last_mut().ok_or("a property before any element")?;
                element.properties.push(property);
                Ok(())
            }),
            [b"end_header", ..] => break,
            [word, ..] => Err(format!("unknown word `{}` in the header", text::shortened(word))),
        }
        .map_err(|reason: String| (Some(line_number), ReadErrorKind::Malformed(reason)))?;
    }
    let Some(encoding) = encoding else {
        return Err((None, ReadErrorKind::Malformed("the header names no format".into())));
    };
    Ok(Header { encoding, elements, body: start })
}

fn encoding_of(name: &[u8]) -> Result<Encoding, String> {
    match name {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(format!("unknown format `{}`", text::shortened(name))),
    }
}

fn element(name: &[u8], count: &[u8]) -> Result<Element, String> {
    let count = std::str::from_utf8(count)
        .ok()
        .and_then(|count| count.parse().ok())
        .ok_or_else(|| format!("element `{}` needs a number of entries", text::shortened(name)))?;
    Ok(Element { name: name.to_vec(), count, properties: Vec::new() })
}

/// Parses the words of a line after `property`.
fn property(words: [&[u8]; 4]) -> Result<Property, String> {
    let (count, item, name) = match words {
        [b"list", count, item, name] => (Some(count), item, name),
        [item, name, ..] => (None, item, name),
    };
    let scalar = |name: &[u8]| Scalar::parse(name).ok_or_else(|| format!("unknown type `{}`", text::shortened(name)));
    Ok(Property { name: name.to_vec(), count: count.map(scalar).transpose()?, item: scalar(item)? })
}
