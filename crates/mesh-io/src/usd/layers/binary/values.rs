//! Values of crate files, by their representation: a type, flags, and a number that is the value itself or says where
//! it is.

use super::{
    integers::{decode, decompress, most_bytes},
    tables::{Tables, bounded},
};
use crate::usd::{
    fault::Fault,
    layers::{
        spec::{ArcTarget, ListOp, Retiming},
        value::{Slot, Value},
    },
};

/// The representation of a value.
#[derive(Clone, Copy)]
pub(super) struct Rep(pub(super) u64);

/// Types by their number in the file.
mod kind {
    pub(super) const BOOL: u8 = 1;
    pub(super) const INT: u8 = 3;
    pub(super) const UINT: u8 = 4;
    pub(super) const INT64: u8 = 5;
    pub(super) const UINT64: u8 = 6;
    pub(super) const FLOAT: u8 = 8;
    pub(super) const DOUBLE: u8 = 9;
    pub(super) const STRING: u8 = 10;
    pub(super) const TOKEN: u8 = 11;
    pub(super) const ASSET_PATH: u8 = 12;
    pub(super) const MATRIX4D: u8 = 15;
    pub(super) const QUATD: u8 = 16;
    pub(super) const QUATF: u8 = 17;
    pub(super) const VEC2F: u8 = 20;
    pub(super) const VEC3D: u8 = 23;
    pub(super) const VEC3F: u8 = 24;
    pub(super) const TOKEN_LIST_OP: u8 = 32;
    pub(super) const STRING_LIST_OP: u8 = 33;
    pub(super) const TOKEN_VECTOR: u8 = 41;
    pub(super) const SPECIFIER: u8 = 42;
    pub(super) const TIME_SAMPLES: u8 = 46;
    pub(super) const DOUBLE_VECTOR: u8 = 48;
    pub(super) const STRING_VECTOR: u8 = 50;
    pub(super) const VALUE_BLOCK: u8 = 51;
    pub(super) const PAYLOAD: u8 = 47;
}

impl Rep {
    fn kind(self) -> u8 {
        (self.0 >> 48).to_le_bytes()[0]
    }

    fn is_array(self) -> bool {
        self.0 >> 63 & 1 == 1
    }

    fn is_inlined(self) -> bool {
        self.0 >> 62 & 1 == 1
    }

    fn is_compressed(self) -> bool {
        self.0 >> 61 & 1 == 1
    }

    fn payload(self) -> u64 {
        self.0 & ((1 << 48) - 1)
    }

    fn inline(self) -> [u8; 4] {
        let [a, b, c, d, ..] = self.0.to_le_bytes();
        [a, b, c, d]
    }
}

/// A place in the file, from which numbers are read one after the other.
pub(super) struct Reader<'t> {
    tables: &'t Tables,
    at: u64,
}

impl<'t> Reader<'t> {
    pub(super) fn new(tables: &'t Tables, at: u64) -> Self {
        Self { tables, at }
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let bytes = self.tables.source.array(self.at)?;
        self.at += N as u64;
        Ok(bytes)
    }

    fn long(&mut self) -> Result<u64, Fault> {
        self.array().map(u64::from_le_bytes)
    }

    fn index(&mut self) -> Result<u32, Fault> {
        self.array().map(u32::from_le_bytes)
    }

    fn double(&mut self) -> Result<f64, Fault> {
        self.array().map(f64::from_le_bytes)
    }

    /// Elements of a size, as many as a number before them says.
    fn elements<const N: usize>(&mut self) -> Result<Vec<[u8; N]>, Fault> {
        let count = self.long()?;
        self.some::<N>(count)
    }

    fn some<const N: usize>(&mut self, count: u64) -> Result<Vec<[u8; N]>, Fault> {
        let size = count.checked_mul(N as u64).ok_or_else(|| Fault::new("refers to bytes beyond its end"))?;
        let bytes = self.tables.source.read(self.at, size)?;
        self.at += size;
        Ok(bytes.as_chunks::<N>().0.to_vec())
    }

    fn string(&mut self) -> Result<String, Fault> {
        let index = self.index()?;
        self.tables.string(index).map(ToOwned::to_owned)
    }

    pub(super) fn selections(&mut self) -> Result<Vec<(String, String)>, Fault> {
        let count = self.long()?;
        let count = bounded(&self.tables.source, count, 8)?;
        (0..count).map(|_| Ok((self.string()?, self.string()?))).collect()
    }

    fn retiming(&mut self) -> Result<Retiming, Fault> {
        Ok(Retiming { offset: self.double()?, scale: self.double()? })
    }

    pub(super) fn retimings(&mut self) -> Result<Vec<Retiming>, Fault> {
        let count = self.long()?;
        let count = bounded(&self.tables.source, count, 16)?;
        (0..count).map(|_| self.retiming()).collect()
    }

    /// A list of edits, by a function that reads one list.
    fn list_op<T>(&mut self, read: impl Fn(&mut Self) -> Result<Vec<T>, Fault>) -> Result<ListOp<T>, Fault> {
        let [flags] = self.array()?;
        let mut list = |bit: u8| if flags >> bit & 1 == 1 { read(self) } else { Ok(Vec::new()) };
        // In this order in the file; what was `added` in old files stands before what is appended.
        let [explicit, mut added, prepended, mut appended, deleted] =
            [list(1)?, list(2)?, list(5)?, list(6)?, list(3)?];
        added.append(&mut appended);
        Ok(ListOp { explicit: (flags & 1 == 1).then_some(explicit), prepended, appended: added, deleted })
    }

    fn arcs(&mut self, has_data: bool) -> Result<Vec<ArcTarget>, Fault> {
        let count = self.long()?;
        let count = bounded(&self.tables.source, count, 8)?;
        (0..count).map(|_| self.arc(has_data)).collect()
    }

    /// A reference (`has_data`) or a payload.
    fn arc(&mut self, has_data: bool) -> Result<ArcTarget, Fault> {
        let asset = self.string()?;
        let prim = self.index()?;
        let prim = self.tables.path(prim)?;
        let retiming = if has_data || self.tables.version >= 8 { self.retiming()? } else { Retiming::default() };
        if has_data {
            self.skip_dictionary()?;
        }
        Ok(ArcTarget { asset, prim, retiming })
    }

    /// Custom data of a reference.
    fn skip_dictionary(&mut self) -> Result<(), Fault> {
        for _ in 0..self.long()? {
            self.index()?;
            // A value: the distance to its representation, which lies behind what it refers to.
            let distance = self.array().map(i64::from_le_bytes)?;
            let at = (self.at - 8).checked_add_signed(distance).filter(|at| *at >= self.at);
            self.at = at.ok_or_else(|| Fault::new("has a dictionary that is broken"))?;
            self.long()?;
        }
        Ok(())
    }

    pub(super) fn references(&mut self) -> Result<ListOp<ArcTarget>, Fault> {
        self.list_op(|reader| reader.arcs(true))
    }

    /// The paths of a list that were not deleted.
    pub(super) fn paths(&mut self) -> Result<Vec<String>, Fault> {
        let tables = self.tables;
        let op = self.list_op(|reader| reader.elements::<4>())?;
        let items = [op.explicit.unwrap_or_default(), op.prepended, op.appended].concat();
        tables.texts(items, |index| tables.path(index))
    }

    /// A list of payloads, or in old files one payload.
    pub(super) fn payloads(&mut self, rep: Rep) -> Result<ListOp<ArcTarget>, Fault> {
        if rep.kind() == kind::PAYLOAD {
            let explicit = Some(vec![self.arc(false)?]);
            return Ok(ListOp { explicit, ..ListOp::default() });
        }
        self.list_op(|reader| reader.arcs(false))
    }

    /// Time codes, and where the values are.
    fn samples(&mut self) -> Result<Vec<(f64, Slot)>, Fault> {
        let broken = || Fault::new("has time samples that are broken");
        let start = self.at;
        let distance = self.array().map(i64::from_le_bytes)?;
        self.at = start.checked_add_signed(distance).ok_or_else(broken)?;
        let times = Rep(self.long()?);
        let start = self.at;
        let Value::Numbers(times) = self.tables.value(times)? else { return Err(broken()) };
        let distance = self.array().map(i64::from_le_bytes)?;
        self.at = start.checked_add_signed(distance).ok_or_else(broken)?;
        let values = self.elements::<8>()?;
        if values.len() != times.len() || !times.is_sorted_by(|a, b| a < b) {
            return Err(broken());
        }
        let slots = values.into_iter().map(|rep| Slot::Binary(u64::from_le_bytes(rep)));
        Ok(times.into_iter().zip(slots).collect())
    }
}

impl Tables {
    /// Time samples of a field.
    pub(super) fn samples(&self, rep: Rep) -> Result<Vec<(f64, Slot)>, Fault> {
        if rep.kind() != kind::TIME_SAMPLES || rep.is_inlined() {
            return Err(Fault::new("has time samples that are broken"));
        }
        Reader::new(self, rep.payload()).samples()
    }

    /// Where the value of a representation is read.
    pub(super) fn reader(&self, rep: Rep) -> Reader<'_> {
        Reader::new(self, rep.payload())
    }

    /// Decodes a value. Cost: that of its bytes.
    pub(super) fn value(&self, rep: Rep) -> Result<Value, Fault> {
        if rep.is_array() { self.array_value(rep) } else { self.scalar(rep) }
    }

    fn scalar(&self, rep: Rep) -> Result<Value, Fault> {
        let mut reader = self.reader(rep);
        let inline = rep.inline();
        let small = |count: usize| inline[..count].iter().map(|&byte| f64::from(byte.cast_signed())).collect();
        let numbers = |numbers: Vec<f64>| Value::Numbers(numbers);
        Ok(match (rep.kind(), rep.is_inlined()) {
            (kind::VALUE_BLOCK, _) => Value::Blocked,
            (kind::BOOL, true) => Value::Bool(inline[0] != 0),
            (kind::TOKEN | kind::ASSET_PATH, true) => Value::Text(self.token(u32::from_le_bytes(inline))?.to_owned()),
            (kind::STRING, true) => Value::Text(self.string(u32::from_le_bytes(inline))?.to_owned()),
            (kind::INT | kind::INT64 | kind::SPECIFIER, true) => numbers(vec![i32::from_le_bytes(inline).into()]),
            (kind::UINT | kind::UINT64, true) => numbers(vec![u32::from_le_bytes(inline).into()]),
            (kind::FLOAT | kind::DOUBLE, true) => numbers(vec![f32::from_le_bytes(inline).into()]),
            (kind::DOUBLE, false) => numbers(vec![reader.double()?]),
            (kind::VEC3F | kind::VEC3D, true) => numbers(small(3)),
            (kind::VEC3F, false) => numbers(singles(&reader.some::<4>(3)?)),
            (kind::VEC3D, false) => numbers(doubles(&reader.some::<8>(3)?)),
            (kind::QUATF, false) => numbers(real_first(singles(&reader.some::<4>(4)?))),
            (kind::QUATD, false) => numbers(real_first(doubles(&reader.some::<8>(4)?))),
            (kind::MATRIX4D, true) => {
                let diagonal: Vec<f64> = small(4);
                let mut matrix = vec![0.0; 16];
                diagonal.iter().enumerate().for_each(|(index, value)| matrix[5 * index] = *value);
                numbers(matrix)
            }
            (kind::MATRIX4D, false) => numbers(doubles(&reader.some::<8>(16)?)),
            (kind::TOKEN_VECTOR, false) => Value::Texts(self.tokens_at(reader.elements::<4>()?)?),
            (kind::STRING_VECTOR, false) => Value::Texts(self.strings_at(reader.elements::<4>()?)?),
            (kind::DOUBLE_VECTOR, false) => numbers(doubles(&reader.elements::<8>()?)),
            (kind::TOKEN_LIST_OP | kind::STRING_LIST_OP, false) => {
                let op = reader.list_op(|reader| reader.elements::<4>())?;
                let items = [op.explicit.unwrap_or_default(), op.prepended, op.appended].concat();
                let is_string = rep.kind() == kind::STRING_LIST_OP;
                Value::Texts(if is_string { self.strings_at(items)? } else { self.tokens_at(items)? })
            }
            _ => Value::Other,
        })
    }

    fn tokens_at(&self, indices: Vec<[u8; 4]>) -> Result<Vec<String>, Fault> {
        self.texts(indices, |index| self.token(index).map(ToOwned::to_owned))
    }

    fn strings_at(&self, indices: Vec<[u8; 4]>) -> Result<Vec<String>, Fault> {
        self.texts(indices, |index| self.string(index).map(ToOwned::to_owned))
    }

    /// Texts by their indices; each may be long, and named often.
    fn texts(&self, indices: Vec<[u8; 4]>, text: impl Fn(u32) -> Result<String, Fault>) -> Result<Vec<String>, Fault> {
        let mut num_bytes = 0;
        let text = |index: [u8; 4]| {
            let text = text(u32::from_le_bytes(index))?;
            num_bytes += (text.len() + size_of::<String>()) as u64;
            bounded(&self.source, num_bytes, 1)?;
            Ok(text)
        };
        indices.into_iter().map(text).collect()
    }

    fn array_value(&self, rep: Rep) -> Result<Value, Fault> {
        let mut reader = self.reader(rep);
        let mut count = 0;
        if rep.payload() != 0 && !rep.is_inlined() {
            if self.version < 5 {
                reader.index()?;
            }
            count = if self.version < 7 { reader.index()?.into() } else { reader.long()? };
        }
        // Fewer than 16 elements are never compressed, and the flag means nothing before arrays could be.
        let is_compressed = rep.is_compressed() && self.version >= 5;
        if is_compressed && !matches!(rep.kind(), kind::INT | kind::UINT) {
            return self.compressed_numbers(reader, rep.kind(), count);
        }
        Ok(match rep.kind() {
            kind::INT | kind::UINT if is_compressed && count >= 4 => {
                let count = bounded(&self.source, count, 4)?;
                let block = reader.block()?;
                let values = decode(&decompress(&block, most_bytes(count))?, count)?;
                Value::Integers(values.into_iter().map(i64::from).collect())
            }
            kind::INT | kind::UINT => {
                let values = reader.some::<4>(count)?;
                Value::Integers(values.into_iter().map(|value| i32::from_le_bytes(value).into()).collect())
            }
            kind::DOUBLE => Value::Numbers(doubles(&reader.some::<8>(count)?)),
            kind::TOKEN => Value::Texts(self.tokens_at(reader.some::<4>(count)?)?),
            kind::VEC2F => Value::Singles(flat(&reader.some::<8>(count)?)),
            kind::VEC3F => Value::Singles(flat(&reader.some::<12>(count)?)),
            _ => Value::Other,
        })
    }

    /// Doubles that are compressed: as whole numbers, or as indices into a table.
    fn compressed_numbers(&self, mut reader: Reader<'_>, kind: u8, count: u64) -> Result<Value, Fault> {
        if kind != kind::DOUBLE {
            return Ok(Value::Other);
        }
        let count_bounded = bounded(&self.source, count, 8)?;
        if count_bounded < 4 {
            return Ok(Value::Numbers(doubles(&reader.some::<8>(count)?)));
        }
        let broken = || Fault::new("has an array that is broken");
        let [code] = reader.array()?;
        let table = match code {
            b'i' => None,
            b't' => {
                let size = reader.index()?;
                Some(doubles(&reader.some::<8>(size.into())?))
            }
            _ => return Err(broken()),
        };
        let block = reader.block()?;
        let values = decode(&decompress(&block, most_bytes(count_bounded))?, count_bounded)?;
        let number = |value: i32| match &table {
            None => Ok(f64::from(value)),
            Some(table) => usize::try_from(value).ok().and_then(|at| table.get(at)).copied().ok_or_else(broken),
        };
        Ok(Value::Numbers(values.into_iter().map(number).collect::<Result<_, _>>()?))
    }
}

impl Reader<'_> {
    fn block(&mut self) -> Result<Vec<u8>, Fault> {
        let length = self.long()?;
        self.tables.source.read(self.at, length)
    }
}

fn singles(values: &[[u8; 4]]) -> Vec<f64> {
    values.iter().map(|value| f32::from_le_bytes(*value).into()).collect()
}

fn doubles(values: &[[u8; 8]]) -> Vec<f64> {
    values.iter().map(|value| f64::from_le_bytes(*value)).collect()
}

fn flat<const N: usize>(values: &[[u8; N]]) -> Vec<f32> {
    values.as_flattened().as_chunks::<4>().0.iter().map(|value| f32::from_le_bytes(*value)).collect()
}

/// The file has the real part of a quaternion last.
fn real_first(mut numbers: Vec<f64>) -> Vec<f64> {
    numbers.rotate_right(1);
    numbers
}
