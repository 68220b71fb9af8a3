//! A state that is being written: shared memory that the host writes positions into.

use std::sync::Arc;

use iceoryx2::{port::publisher::Publisher, prelude::ZeroCopySend, sample_mut::SampleMut};
use untangled_proto::{PositionF32, PositionF64, StateHeader};
use untangled_transport::services::Ipc;

use super::{link::StatePort, repair::StateWishes};
use crate::error::RequestError;

/// When a state is from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepTime {
    /// Simulated time in seconds.
    pub simulated_s: f64,
    /// Length of the step in which the correction will be applied, in seconds.
    pub dt_s: f64,
}

/// A state that is being written, in shared memory: for hosts that can't write all of it in one call. A session lends
/// one at a time. A loan that is dropped unsent has no effect.
#[derive(Debug)]
pub struct Loan {
    sample: Loaned,
    step: StepTime,
    num_registrations: u32,
    memory: LoanMemory,
}

/// Keeps the memory that a session lent mapped, though not its contents: for bindings to languages in which a program
/// may read there after the state was sent or the session has ended. Until it is dropped, the daemon takes the host for
/// alive.
#[derive(Clone, Debug)]
pub struct LoanMemory(#[expect(dead_code, reason = "held for its memory")] Arc<StatePort>);

#[derive(Debug)]
enum Loaned {
    F32(SampleMut<Ipc, [PositionF32], StateHeader>),
    F64(SampleMut<Ipc, [PositionF64], StateHeader>),
}

impl Loan {
    pub(crate) fn new(states: &Arc<StatePort>, step: StepTime, num_registrations: u32) -> Result<Self, RequestError> {
        let sample = match &**states {
            StatePort::F32(publisher) => Loaned::F32(loan(publisher)?),
            StatePort::F64(publisher) => Loaned::F64(loan(publisher)?),
        };
        Ok(Self { sample, step, num_registrations, memory: LoanMemory(Arc::clone(states)) })
    }

    /// A guard that keeps the memory of the positions mapped.
    #[must_use]
    pub fn memory(&self) -> LoanMemory {
        self.memory.clone()
    }

    /// Positions in metres, `num_vertices x 3`, of a session in single precision; nothing in double. They hold values
    /// of an earlier frame, so every one must be written.
    #[must_use]
    pub fn positions_f32(&mut self) -> Option<&mut [[f32; 3]]> {
        match &mut self.sample {
            Loaned::F32(sample) => Some(PositionF32::as_arrays_mut(sample.payload_mut())),
            Loaned::F64(_) => None,
        }
    }

    /// [`positions_f32`](Self::positions_f32) of a session in double precision; nothing in single.
    #[must_use]
    pub fn positions_f64(&mut self) -> Option<&mut [[f64; 3]]> {
        match &mut self.sample {
            Loaned::F64(sample) => Some(PositionF64::as_arrays_mut(sample.payload_mut())),
            Loaned::F32(_) => None,
        }
    }

    /// Which registration of its session it was lent by.
    pub(crate) fn num_registrations(&self) -> u32 {
        self.num_registrations
    }

    pub(crate) fn send(self, frame: u64, num_vertices: u32, wishes: StateWishes) -> Result<(), RequestError> {
        let StepTime { simulated_s, dt_s } = self.step;
        let StateWishes { flags, time_us: repair_deadline_us, progress } = wishes;
        let header =
            StateHeader { frame, simulated_s, dt_s, num_vertices, flags, progress, repair_deadline_us, reserved: 0 };
        match self.sample {
            Loaned::F32(sample) => send(sample, header),
            Loaned::F64(sample) => send(sample, header),
        }
    }
}

fn loan<P: std::fmt::Debug + ZeroCopySend + 'static>(
    publisher: &Publisher<Ipc, [P], StateHeader>,
) -> Result<SampleMut<Ipc, [P], StateHeader>, RequestError> {
    let sample = publisher
        .loan_slice_uninit(publisher.initial_max_slice_len())
        .map_err(|error| RequestError::transport("loaning a state", &error))?;
    // SAFETY: the memory is a file mapping, which the system provides zeroed and which only ever held positions, and
    // every pattern of bits is a valid `[f32; 3]` or `[f64; 3]`, the only instances of `P`.
    Ok(unsafe { sample.assume_init() })
}

fn send<P: std::fmt::Debug + ZeroCopySend + 'static>(
    mut sample: SampleMut<Ipc, [P], StateHeader>,
    header: StateHeader,
) -> Result<(), RequestError> {
    *sample.user_header_mut() = header;
    sample.send().map_err(|error| RequestError::transport("sending a state", &error))?;
    Ok(())
}
