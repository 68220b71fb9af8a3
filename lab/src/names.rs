//! Values of command-line options that are names of settings.

use serde::{
    Deserialize,
    de::{IntoDeserializer, value::Error},
};

/// The value with a name, as settings files spell it.
///
/// # Errors
/// There is none of this name.
pub fn named<'de, T: Deserialize<'de>>(name: &'de str) -> Result<T, Error> {
    T::deserialize(IntoDeserializer::<Error>::into_deserializer(name))
}
