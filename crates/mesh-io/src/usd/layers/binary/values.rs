//! Values of crate files, by their representation.

use super::{
    integers::{decode, decompress, most_bytes},
    reader::Reader,
    rep::{Rep, kind},
    tables::{Tables, bounded},
};
use crate::usd::{
    fault::Fault,
    layers::value::{Slot, Value},
};

impl Tables {
    /// Time samples of a field: time codes, and where the values are.
    pub(super) fn samples(&self, rep: Rep) -> Result<Vec<(f64, Slot)>, Fault> {
        let broken = || Fault::new("has time samples that are broken");
        if rep.kind() != kind::TIME_SAMPLES || rep.is_inlined() {
            return Err(broken());
        }
        let mut reader = self.reader(rep);
        reader.jump()?;
        let times = Rep(reader.long()?);
        let Value::Numbers(times) = self.value(times)? else { return Err(broken()) };
        reader.jump()?;
        let values = reader.elements::<8>()?;
        if values.len() != times.len() || !times.is_sorted_by(|a, b| a < b) {
            return Err(broken());
        }
        let slots = values.into_iter().map(|rep| Slot::Binary(u64::from_le_bytes(rep)));
        Ok(times.into_iter().zip(slots).collect())
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
