//! Compressed blocks and integers of crate files.
//!
//! A block is LZ4, of one chunk or several. Integers are differences to the one before, in a block: one common
//! difference, two bits for each integer that say how wide its own is, then the differences.

use lz4_flex::block::decompress_into;

use crate::usd::fault::Fault;

/// LZ4 gives at most so many bytes for each of its own.
const MOST_RATIO: usize = 255;

/// Decompresses a block of at most `most` bytes.
pub(super) fn decompress(block: &[u8], most: usize) -> Result<Vec<u8>, Fault> {
    let (&num_chunks, mut rest) = block.split_first().ok_or_else(broken)?;
    let mut out = vec![0; most.min(rest.len().saturating_mul(MOST_RATIO).saturating_add(16))];
    let mut size = 0;
    if num_chunks == 0 {
        size = decompress_into(rest, &mut out).map_err(|_| broken())?;
    }
    for _ in 0..num_chunks {
        let (length, data) = rest.split_first_chunk::<4>().ok_or_else(broken)?;
        let length = usize::try_from(i32::from_le_bytes(*length)).map_err(|_| broken())?;
        let (chunk, after) = data.split_at_checked(length).ok_or_else(broken)?;
        size += decompress_into(chunk, &mut out[size..]).map_err(|_| broken())?;
        rest = after;
    }
    out.truncate(size);
    Ok(out)
}

/// Bytes that integers of 4 bytes take at most before they are compressed.
pub(super) fn most_bytes(count: usize) -> usize {
    4 + count.div_ceil(4) + 4 * count
}

/// Integers of 4 bytes.
pub(super) fn decode(bytes: &[u8], count: usize) -> Result<Vec<i32>, Fault> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let (common, rest) = bytes.split_first_chunk::<4>().ok_or_else(broken)?;
    let common = i32::from_le_bytes(*common);
    let (codes, mut rest) = rest.split_at_checked(count.div_ceil(4)).ok_or_else(broken)?;
    let mut values = Vec::with_capacity(count);
    let mut value = 0i32;
    for index in 0..count {
        let code = codes[index / 4] >> (2 * (index % 4)) & 3;
        let difference = match code {
            0 => common,
            1 => i32::from(i8::from_le_bytes(take(&mut rest)?)),
            2 => i32::from(i16::from_le_bytes(take(&mut rest)?)),
            _ => i32::from_le_bytes(take(&mut rest)?),
        };
        value = value.wrapping_add(difference);
        values.push(value);
    }
    Ok(values)
}

fn take<const N: usize>(bytes: &mut &[u8]) -> Result<[u8; N], Fault> {
    let (first, rest) = bytes.split_first_chunk::<N>().ok_or_else(broken)?;
    *bytes = rest;
    Ok(*first)
}

fn broken() -> Fault {
    Fault::new("has a compressed block that is broken")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_of_all_widths_are_decoded_as_the_format_says() {
        // 123, 124, 125, 100125, 100125, 100126, 100126 with the common difference 1.
        let mut bytes = 1i32.to_le_bytes().to_vec();
        bytes.extend([0b11_00_00_01, 0b00_01_00_01]);
        bytes.extend([123]);
        bytes.extend(100_000i32.to_le_bytes());
        bytes.extend([0, 0]);
        assert_eq!(decode(&bytes, 7).unwrap(), [123, 124, 125, 100_125, 100_125, 100_126, 100_126]);
        assert!(decode(&bytes[..bytes.len() - 1], 7).is_err());
        assert!(decode(&[], 1).is_err());
    }

    #[test]
    fn block_of_several_chunks_is_decompressed_and_a_cut_one_refused() {
        let parts: [&[u8]; 2] = [b"aaaaaaaaaaaaaaaaaaaa", b"bcd"];
        let mut block = vec![2];
        for part in parts {
            let chunk = lz4_flex::block::compress(part);
            block.extend(i32::try_from(chunk.len()).unwrap().to_le_bytes());
            block.extend(chunk);
        }
        assert_eq!(decompress(&block, 64).unwrap(), parts.concat());
        assert!(decompress(&block[..block.len() - 1], 64).is_err());
        assert!(decompress(&block, 21).is_err(), "more than there should be");
        assert!(decompress(&[], 64).is_err());
    }
}
