//! From a sample that a peer wrote to a validated frame.

use untangled_proto::{PositionF32, PositionF64, StateHeader, Status, correction::NO_FAULT, limits};

use untangle::{
    frame::{Frame, FrameError},
    mesh::{Mesh, VertexId},
    weld::Weld,
};

/// Why a state can't be used: the status and the fault of its correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateFault {
    /// Status of the correction.
    pub status: Status,
    /// The vertex at fault, or [`NO_FAULT`].
    pub index: u64,
    /// The value at fault.
    pub value: f64,
}

/// Checks a header, which must be a copy, against the session.
///
/// # Errors
/// [`Status::BadHeader`] for a step or a time that is out of range, or for another number of vertices than registered.
pub fn check_header(header: &StateHeader, num_vertices: usize) -> Result<(), StateFault> {
    let bad = |value| Err(StateFault { status: Status::BadHeader, index: NO_FAULT, value });
    // Written so that NaN fails.
    if !(limits::MIN_DT_S..=limits::MAX_DT_S).contains(&header.dt_s) {
        return bad(header.dt_s);
    }
    if !header.simulated_s.is_finite() {
        return bad(header.simulated_s);
    }
    if usize::try_from(header.num_vertices) != Ok(num_vertices) {
        return bad(f64::from(header.num_vertices));
    }
    Ok(())
}

/// Copies single-precision positions, `num_vertices x 3` in metres, into `frame`. Each is read once and the copy is
/// checked.
///
/// # Errors
/// [`Status::BadHeader`] for a wrong number, [`Status::BadPosition`] for one that is too large or not finite.
pub fn read_f32(frame: &mut Frame, mesh: &Mesh, positions: &[PositionF32]) -> Result<(), StateFault> {
    frame.set(mesh, positions.iter().map(|position| read_once(position).0)).map_err(fault)
}

/// Copies double-precision positions into `frame`, as [`read_f32`] does.
///
/// # Errors
/// As [`read_f32`].
pub fn read_f64(frame: &mut Frame, mesh: &Mesh, positions: &[PositionF64]) -> Result<(), StateFault> {
    frame.set(mesh, positions.iter().map(|position| read_once(position).0)).map_err(fault)
}

/// Copies positions of the host into `frame`, those of welded vertices once. `copied` is memory for them.
///
/// # Errors
/// As [`read_f32`]; also [`Status::BadPosition`] for a vertex that is not where another one is with which it was
/// welded.
pub(crate) fn read_welded<P: Copy, T: Copy + Into<f64>>(
    frame: &mut Frame,
    mesh: &Mesh,
    weld: &Weld,
    positions: &[P],
    coordinates: impl Fn(P) -> [T; 3],
    copied: &mut Vec<[f64; 3]>,
) -> Result<(), StateFault> {
    if positions.len() != weld.num_vertices() {
        return Err(fault(FrameError::Length { given: positions.len(), expected: weld.num_vertices() }));
    }
    copied.clear();
    copied.extend(positions.iter().map(|position| coordinates(read_once(position)).map(Into::into)));
    let first = |vertex: VertexId| weld.first(vertex);
    frame.set(mesh, mesh_positions(mesh, |vertex| copied[first(vertex) as usize])).map_err(|error| {
        let fault = fault(error);
        let index = u32::try_from(fault.index).map_or(fault.index, |vertex| first(VertexId(vertex)).into());
        StateFault { index, ..fault }
    })?;
    for (vertex, &position) in (0u32..).zip(&*copied) {
        let place = copied[first(weld.of(vertex)) as usize];
        if let Some(axis) = (0..3).find(|&axis| differ(position[axis], place[axis])) {
            return Err(StateFault { status: Status::BadPosition, index: vertex.into(), value: position[axis] });
        }
    }
    Ok(())
}

fn mesh_positions(mesh: &Mesh, place: impl Fn(VertexId) -> [f64; 3]) -> impl ExactSizeIterator<Item = [f64; 3]> {
    (0..u32::try_from(mesh.num_vertices()).unwrap_or(u32::MAX)).map(move |vertex| place(VertexId(vertex)))
}

/// Whether two coordinates are different places; a NaN is.
#[expect(clippy::float_cmp, reason = "one place is the same place to the bit, but for the sign of zero")]
fn differ(one: f64, other: f64) -> bool {
    one.is_nan() || one != other
}

/// Reads memory that a peer may be writing to.
fn read_once<P: Copy>(position: &P) -> P {
    // SAFETY: a reference can be read from. The read is volatile, so that the compiler does not read the memory a
    // second time and the value that is checked is the value that is kept.
    unsafe { std::ptr::read_volatile(position) }
}

fn fault(error: FrameError) -> StateFault {
    match error {
        #[expect(
            clippy::cast_precision_loss,
            reason = "a number for a message; sessions have fewer than 2^53 vertices"
        )]
        FrameError::Length { given, .. } => {
            StateFault { status: Status::BadHeader, index: NO_FAULT, value: given as f64 }
        }
        FrameError::Coordinate { vertex, value, .. } => {
            StateFault { status: Status::BadPosition, index: vertex as u64, value }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_header_rejects_bad_step_time_and_vertex_count() {
        let good = StateHeader { frame: 1, dt_s: 0.01, num_vertices: 3, ..StateHeader::default() };
        assert_eq!(check_header(&good, 3), Ok(()));
        for dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-12] {
            assert!(check_header(&StateHeader { dt_s, ..good }, 3).is_err(), "{dt_s}");
        }
        assert!(check_header(&StateHeader { simulated_s: f64::NAN, ..good }, 3).is_err());
        assert!(check_header(&good, 4).is_err());
    }
}
