//! Arrays of which most elements are at rest, in few bytes.
//!
//! A correction of all vertices has a value for few of them, and a repair moves few. Only these cross the network, with
//! their indices; all others are zero, or zero with the flag of a pinned vertex, and which vertices are pinned crosses
//! once. What comes out is what went in, to the bit; where that is shorter, all elements are sent as they are.
//!
//! Layout, little-endian: form `u32`, number of the set of pins `u32`, number of entries `u32`, zero `u32`; in form
//! 3 (a new set of pins) a bit for each element, in bytes; entries of an index `u32` and an element, or all elements.

use crate::{element::Element, plain};

/// All elements.
const FULL: u32 = 0;
/// Entries; all others are zero.
const ZERO: u32 = 1;
/// Entries; all others are zero, and pinned where the set of pins says so.
const PINS: u32 = 2;
/// As [`PINS`], and a set of pins before the entries.
const NEW_PINS: u32 = 3;

const HEAD_BYTES: usize = 16;
const INDEX_BYTES: usize = 4;

/// Which vertices are pinned, as both ends of a link know it.
#[derive(Clone, Debug, Default)]
pub struct Pins {
    /// Counts the sets of a link; 0 before the first.
    number: u32,
    bits: Vec<u8>,
}

/// Why elements can't be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementsError {
    /// Lengths or indices contradict each other.
    Malformed,
    /// The set of pins that they build on has not come.
    PinsMissing,
}

impl Pins {
    fn get(&self, index: usize) -> bool {
        self.bits.get(index / 8).is_some_and(|byte| byte >> (index % 8) & 1 == 1)
    }

    /// Forgets the set, so that the next elements bring a new one.
    pub fn forget(&mut self) {
        self.bits.clear();
    }

    /// Writes elements behind `out` in the form that takes the fewest bytes.
    ///
    /// Cost: two passes over the elements.
    pub fn write<E: Element>(&mut self, elements: &[E], out: &mut Vec<u8>) {
        let entry = INDEX_BYTES + size_of::<E>();
        let has_pins = self.bits.len() == elements.len().div_ceil(8);
        let [mut zero, mut known, mut new] = [0; 3];
        for (index, element) in elements.iter().enumerate() {
            zero += usize::from(!element.is_rest(false));
            known += usize::from(!element.is_rest(self.get(index)));
            new += usize::from(!element.is_rest(element.is_pinned()));
        }
        let forms = [
            (size_of_val(elements), FULL),
            (zero * entry, ZERO),
            (if has_pins { known * entry } else { usize::MAX }, PINS),
            (new * entry + elements.len().div_ceil(8), NEW_PINS),
        ];
        // The first of equal ones.
        let form = forms.into_iter().min_by_key(|(bytes, _)| *bytes).map_or(FULL, |(_, form)| form);
        let num_entries = match form {
            ZERO => zero,
            PINS => known,
            NEW_PINS => new,
            _ => elements.len(),
        };
        if form == NEW_PINS {
            self.number += 1;
            self.bits.clear();
            self.bits.resize(elements.len().div_ceil(8), 0);
            for (index, _) in elements.iter().enumerate().filter(|(_, element)| element.is_pinned()) {
                self.bits[index / 8] |= 1 << (index % 8);
            }
        }
        let count = u32::try_from(num_entries).unwrap_or(u32::MAX);
        for word in [form, self.number, count, 0] {
            out.extend_from_slice(&word.to_le_bytes());
        }
        match form {
            FULL => out.extend_from_slice(plain::bytes_of(elements)),
            ZERO => write_entries(elements, out, |_| false),
            NEW_PINS => {
                out.extend_from_slice(&self.bits);
                write_entries(elements, out, |index| self.get(index));
            }
            _ => write_entries(elements, out, |index| self.get(index)),
        }
    }

    /// Reads so many elements, and hands out the elements at rest and the entries, in two calls of closures: all
    /// elements by `rest`, then some again by `entry`.
    ///
    /// # Errors
    /// [`ElementsError`]; nothing was handed out then.
    pub fn read<'a, E: Element>(
        &mut self,
        bytes: &'a [u8],
        num_elements: usize,
    ) -> Result<Elements<'a, E>, ElementsError> {
        let malformed = ElementsError::Malformed;
        let (head, body) = bytes.split_at_checked(HEAD_BYTES).ok_or(malformed)?;
        let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|k| head[4 * at + k]));
        let (form, number, num_entries) = (word(0), word(1), word(2) as usize);
        let num_bytes = num_elements.div_ceil(8);
        let entries = match form {
            FULL => {
                let is_whole = num_entries == num_elements && Some(body.len()) == bytes_for::<E>(num_elements, 0);
                return if is_whole { Ok(Elements::Full(body, std::marker::PhantomData)) } else { Err(malformed) };
            }
            ZERO => body,
            PINS if self.number == number && self.bits.len() == num_bytes => body,
            PINS => return Err(ElementsError::PinsMissing),
            NEW_PINS => body.get(num_bytes..).ok_or(malformed)?,
            _ => return Err(malformed),
        };
        let is_whole = Some(entries.len()) == bytes_for::<E>(num_entries, INDEX_BYTES);
        let stride = INDEX_BYTES + size_of::<E>();
        if !is_whole || entries.chunks_exact(stride).any(|entry| index_of(entry) >= num_elements) {
            return Err(malformed);
        }
        if form == NEW_PINS {
            self.number = number;
            self.bits.clear();
            self.bits.extend_from_slice(&body[..num_bytes]);
        }
        Ok(Elements::Some { entries, has_pins: form != ZERO, _element: std::marker::PhantomData })
    }

    /// What an element at rest is, of elements that were just read.
    #[must_use]
    pub fn rest<E: Element>(&self, elements: &Elements<'_, E>, index: usize) -> E {
        match elements {
            Elements::Some { has_pins: true, .. } => E::rest(self.get(index)),
            _ => E::rest(false),
        }
    }
}

/// Elements as they were read.
#[derive(Clone, Copy, Debug)]
pub enum Elements<'a, E> {
    /// All of them.
    Full(&'a [u8], std::marker::PhantomData<E>),
    /// Those that are not at rest.
    Some {
        /// Indices, each with its element.
        entries: &'a [u8],
        /// Whether pinned vertices have their flag at rest.
        has_pins: bool,
        /// Their type.
        _element: std::marker::PhantomData<E>,
    },
}

impl<'a, E: Element> Elements<'a, E> {
    /// The elements that are not at rest, each with its index.
    pub fn entries(&self) -> impl Iterator<Item = (usize, E)> + 'a {
        let (bytes, stride) = match *self {
            Self::Full(bytes, _) => (bytes, size_of::<E>()),
            Self::Some { entries, .. } => (entries, INDEX_BYTES + size_of::<E>()),
        };
        bytes.chunks_exact(stride).enumerate().filter_map(move |(k, entry)| {
            let (index, element) = match stride > size_of::<E>() {
                true => (index_of(entry), &entry[INDEX_BYTES..]),
                false => (k, entry),
            };
            Some((index, plain::from_bytes(element)?))
        })
    }
}

/// Bytes of so many elements with so much before each.
fn bytes_for<E>(count: usize, before: usize) -> Option<usize> {
    count.checked_mul(size_of::<E>() + before)
}

fn index_of(entry: &[u8]) -> usize {
    entry.first_chunk().map_or(usize::MAX, |index| u32::from_le_bytes(*index) as usize)
}

fn write_entries<E: Element>(elements: &[E], out: &mut Vec<u8>, is_pinned: impl Fn(usize) -> bool) {
    for (index, element) in elements.iter().enumerate() {
        if !element.is_rest(is_pinned(index)) {
            // Sessions have at most 2^24 vertices.
            out.extend_from_slice(&u32::try_from(index).unwrap_or(u32::MAX).to_le_bytes());
            out.extend_from_slice(plain::bytes_of(std::slice::from_ref(element)));
        }
    }
}

#[cfg(test)]
mod tests {
    use untangled_proto::{VertexCorrection, flags};

    use super::*;

    const REST: VertexCorrection = VertexCorrection { value: [0.0; 3], flags: 0 };
    const PINNED: VertexCorrection = VertexCorrection { value: [0.0; 3], flags: flags::PINNED };

    fn round_trip(from: &mut Pins, to: &mut Pins, elements: &[VertexCorrection]) -> usize {
        let mut bytes = Vec::new();
        from.write(elements, &mut bytes);
        let read = to.read::<VertexCorrection>(&bytes, elements.len()).unwrap();
        let mut out: Vec<_> = (0..elements.len()).map(|index| to.rest(&read, index)).collect();
        read.entries().for_each(|(index, element)| out[index] = element);
        assert_eq!(plain::bytes_of(&out), plain::bytes_of(elements));
        bytes.len()
    }

    #[test]
    fn elements_come_back_to_the_bit_and_those_at_rest_cost_nothing() {
        let (mut from, mut to) = (Pins::default(), Pins::default());
        let mut cloth = vec![REST; 1000];
        assert_eq!(round_trip(&mut from, &mut to, &cloth), HEAD_BYTES);
        cloth[..300].fill(PINNED);
        cloth[7] = VertexCorrection { value: [-0.0, 1.0, f32::NAN], flags: 9 };
        assert_eq!(round_trip(&mut from, &mut to, &cloth), HEAD_BYTES + 125 + 20, "the pins cross once");
        cloth[900].value[2] = -0.0;
        assert_eq!(round_trip(&mut from, &mut to, &cloth), HEAD_BYTES + 40);
        assert_eq!(round_trip(&mut from, &mut to, &[REST; 1000]), HEAD_BYTES, "a frame that was refused");
        assert_eq!(round_trip(&mut from, &mut to, &cloth), HEAD_BYTES + 40);
        cloth.fill(VertexCorrection { value: [1.0; 3], flags: 3 });
        assert_eq!(round_trip(&mut from, &mut to, &cloth), HEAD_BYTES + 16_000, "all of them");
        assert_eq!(round_trip(&mut from, &mut to, &[]), HEAD_BYTES);
    }

    #[test]
    fn read_refuses_false_lengths_counts_and_indices_and_asks_for_pins_it_does_not_have() {
        let mut pins = Pins::default();
        let mut bytes = Vec::new();
        let mut cloth = [PINNED; 100];
        cloth[99].value[0] = 1.0;
        pins.write(&cloth, &mut bytes);
        let read = |bytes: &[u8], count| Pins::default().read::<VertexCorrection>(bytes, count).map(drop);
        assert_eq!(read(&bytes, 100), Ok(()));
        assert_eq!(read(&bytes, 99), Err(ElementsError::Malformed), "an index out of range");
        for (at, value) in [(0, 9), (8, 2), (8, 0), (11, 0xff)] {
            let mut bad = bytes.clone();
            bad[at] = value;
            assert_eq!(read(&bad, 100), Err(ElementsError::Malformed), "{at}");
        }
        for length in 0..bytes.len() {
            assert_eq!(read(&bytes[..length], 100), Err(ElementsError::Malformed), "{length}");
        }
        let mut later = Vec::new();
        pins.write(&cloth, &mut later);
        assert_eq!(read(&later, 100), Err(ElementsError::PinsMissing));
        pins.forget();
        let mut again = Vec::new();
        pins.write(&cloth, &mut again);
        assert_eq!(read(&again, 100), Ok(()));
    }
}
