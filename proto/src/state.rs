//! A state of the cloth: host to daemon, once a frame.

use iceoryx2_bb_derive_macros::ZeroCopySend;
use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;

/// Header of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.StateHeader")]
pub struct StateHeader {
    /// Number of the frame: the host's choice, larger than the one before.
    pub frame: u64,
    /// Simulated time in seconds; finite.
    pub simulated_s: f64,
    /// Length of the step that the correction will be applied in, in seconds, from 1e-9 to 1e9.
    pub dt_s: f64,
    /// Number of positions, as registered.
    pub num_vertices: u32,
    /// Zero.
    pub flags: u32,
    /// Zero.
    pub reserved: [u64; 4],
}

/// Position of a vertex in metres, single precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.PositionF32")]
pub struct PositionF32(pub [f32; 3]);

/// Position of a vertex in metres, double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, ZeroCopySend)]
#[repr(C)]
#[type_name("untangled.v1.PositionF64")]
pub struct PositionF64(pub [f64; 3]);

impl PositionF32 {
    /// The same memory as arrays.
    #[must_use]
    pub fn as_arrays_mut(positions: &mut [Self]) -> &mut [[f32; 3]] {
        // SAFETY: `Self` is repr(C) with the array as its only field, so size, alignment and valid values are the
        // array's.
        unsafe { std::slice::from_raw_parts_mut(positions.as_mut_ptr().cast(), positions.len()) }
    }
}

impl PositionF64 {
    /// The same memory as arrays.
    #[must_use]
    pub fn as_arrays_mut(positions: &mut [Self]) -> &mut [[f64; 3]] {
        // SAFETY: `Self` is repr(C) with the array as its only field, so size, alignment and valid values are the
        // array's.
        unsafe { std::slice::from_raw_parts_mut(positions.as_mut_ptr().cast(), positions.len()) }
    }
}
