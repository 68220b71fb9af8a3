//! From a sample that a peer wrote to a validated frame.

use untangled_proto::{PositionF32, PositionF64, StateHeader, Status, correction::NO_FAULT, limits};

use untangle::{frame::{Frame, FrameError}, mesh::Mesh};

/// Why a state can't be used: the status and the fault of its correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StateFault {
    pub(super) status: Status,
    pub(super) index: u64,
    pub(super) value: f64,
}

/// Checks a header, which must be a copy, against the session.
pub(super) fn check_header(header: &StateHeader, num_vertices: usize) -> Result<(), StateFault> {
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

/// Copies single-precision positions into `frame`, each read once and checked after it was read.
pub(super) fn read_f32(frame: &mut Frame, mesh: &Mesh, positions: &[PositionF32]) -> Result<(), StateFault> {
    frame.set(mesh, positions.iter().map(|position| read_once(position).0)).map_err(fault)
}

/// Copies double-precision positions into `frame`, each read once and checked after it was read.
pub(super) fn read_f64(frame: &mut Frame, mesh: &Mesh, positions: &[PositionF64]) -> Result<(), StateFault> {
    frame.set(mesh, positions.iter().map(|position| read_once(position).0)).map_err(fault)
}

/// Reads what a peer may be writing to.
fn read_once<P: Copy>(position: &P) -> P {
    // SAFETY: a reference can be read from. Volatile, so that the value that is checked is the one that is kept: nothing may read it again.
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
    fn headers_that_lie_are_refused() {
        let good = StateHeader { frame: 1, dt_s: 0.01, num_vertices: 3, ..StateHeader::default() };
        assert_eq!(check_header(&good, 3), Ok(()));
        for dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-12] {
            assert!(check_header(&StateHeader { dt_s, ..good }, 3).is_err(), "{dt_s}");
        }
        assert!(check_header(&StateHeader { simulated_s: f64::NAN, ..good }, 3).is_err());
        assert!(check_header(&good, 4).is_err());
    }
}
