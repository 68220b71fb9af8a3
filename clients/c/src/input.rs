//! Reads and writes at addresses of the caller: null, alignment, length and UTF-8 are checked.

use std::ffi::{CStr, c_char};

use crate::error::Fault;

/// An array of the caller's; nothing for null.
///
/// # Safety
/// Where `start` is not null, `count` elements lie there, and they are not written while the slice is used.
pub(crate) unsafe fn optional<'a, T: Copy>(
    name: &str,
    start: *const T,
    count: usize,
    most: usize,
) -> Result<Option<&'a [T]>, Fault> {
    if start.is_null() {
        return Ok(None);
    }
    if !start.is_aligned() {
        return Err(Fault::argument(format_args!("`{name}` is not aligned to {} bytes", align_of::<T>())));
    }
    if count > most {
        return Err(Fault::argument(format_args!("`{name}` has {count} elements; at most {most} can be")));
    }
    // SAFETY: neither null nor unaligned, and far shorter than the address space; the rest is the caller's promise.
    Ok(Some(unsafe { std::slice::from_raw_parts(start, count) }))
}

/// An array that must be there unless it is empty.
///
/// # Safety
/// As [`optional`].
pub(crate) unsafe fn array<'a, T: Copy>(
    name: &str,
    start: *const T,
    count: usize,
    most: usize,
) -> Result<&'a [T], Fault> {
    if count == 0 {
        return Ok(&[]);
    }
    // SAFETY: the caller's promise.
    unsafe { optional(name, start, count, most) }?.ok_or_else(|| null(name))
}

/// A text; nothing for null.
///
/// # Safety
/// Where `start` is not null, a zero byte ends the text there, and the text is not written meanwhile.
pub(crate) unsafe fn text<'a>(name: &str, start: *const c_char) -> Result<Option<&'a str>, Fault> {
    if start.is_null() {
        return Ok(None);
    }
    // SAFETY: not null; the rest is the caller's promise.
    let text = unsafe { CStr::from_ptr(start) };
    text.to_str().map(Some).map_err(|_| Fault::argument(format_args!("`{name}` is not UTF-8")))
}

/// The place where a result is written.
///
/// # Safety
/// Where `place` is not null, a `T` may be written there, and it is not used otherwise meanwhile.
pub(crate) unsafe fn place<'a, T>(name: &str, place: *mut T) -> Result<&'a mut std::mem::MaybeUninit<T>, Fault> {
    if place.is_null() {
        return Err(null(name));
    }
    if !place.is_aligned() {
        return Err(Fault::argument(format_args!("`{name}` is not aligned to {} bytes", align_of::<T>())));
    }
    // SAFETY: neither null nor unaligned; the rest is the caller's promise. What is there needs no value.
    Ok(unsafe { &mut *place.cast() })
}

pub(crate) fn null(name: &str) -> Fault {
    Fault::argument(format_args!("`{name}` is null"))
}
