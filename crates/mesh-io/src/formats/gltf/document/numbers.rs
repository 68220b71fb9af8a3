//! Numbers of a JSON document, refused in words where they are of another kind.

use std::fmt::{self, Formatter};

use serde::{
    Deserialize, Deserializer,
    de::{Error, Visitor},
};

/// A place in one of the lists of a document, a number of bytes or of elements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Count(pub(crate) usize);

/// A number of single precision, as transforms have it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Single(pub(crate) f32);

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_u64(CountVisitor)
    }
}

struct CountVisitor;

impl Visitor<'_> for CountVisitor {
    type Value = Count;

    fn expecting(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str("a whole number")
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Count, E> {
        usize::try_from(number).map(Count).map_err(|_| E::custom("the number is too large"))
    }
}

impl<'de> Deserialize<'de> for Single {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_f32(SingleVisitor)
    }
}

struct SingleVisitor;

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "the format takes these numbers for single precision"
)]
impl Visitor<'_> for SingleVisitor {
    type Value = Single;

    fn expecting(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number")
    }

    fn visit_f64<E>(self, number: f64) -> Result<Single, E> {
        Ok(Single(number as f32))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Single, E> {
        Ok(Single(number as f32))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Single, E> {
        Ok(Single(number as f32))
    }
}
