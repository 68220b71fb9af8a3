//! A state of the cloth: host to daemon, once a frame.

use iceoryx2_bb_derive_macros::ZeroCopySend;
use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;

/// Flag in [`StateHeader::flags`], for sessions with a repair service: this frame is to be repaired. The correction of
/// the frame comes as ever; the repair comes beside it when it is done.
pub const REPAIR: u32 = 1;

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
    /// [`REPAIR`] or 0.
    pub flags: u32,
    /// With the setting `repair` = `auto`: [`CorrectionHeader::progress`](crate::CorrectionHeader::progress) of the
    /// newest correction of the same motion, or zeros where a motion begins anew. Zero otherwise.
    pub progress: [u64; 2],
    /// Most time for the repair that [`REPAIR`] asks for, in microseconds; 0 for that of the setting
    /// `repair_deadline_us`.
    pub repair_deadline_us: u64,
    /// Zero.
    pub reserved: u64,
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
    pub fn as_arrays(positions: &[Self]) -> &[[f32; 3]] {
        // SAFETY: `Self` is repr(C) with the array as its only field, so size, alignment and valid values are the
        // array's.
        unsafe { std::slice::from_raw_parts(positions.as_ptr().cast(), positions.len()) }
    }

    /// The same memory as arrays, to write to.
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
    pub fn as_arrays(positions: &[Self]) -> &[[f64; 3]] {
        // SAFETY: `Self` is repr(C) with the array as its only field, so size, alignment and valid values are the
        // array's.
        unsafe { std::slice::from_raw_parts(positions.as_ptr().cast(), positions.len()) }
    }

    /// The same memory as arrays, to write to.
    #[must_use]
    pub fn as_arrays_mut(positions: &mut [Self]) -> &mut [[f64; 3]] {
        // SAFETY: `Self` is repr(C) with the array as its only field, so size, alignment and valid values are the
        // array's.
        unsafe { std::slice::from_raw_parts_mut(positions.as_mut_ptr().cast(), positions.len()) }
    }
}
