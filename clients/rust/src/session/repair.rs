//! A repair, read in place in shared memory, and what a session asks for with its states.

use std::time::Duration;

use iceoryx2::{
    port::subscriber::Subscriber, prelude::Node, sample::Sample,
    service::builder::publish_subscribe::PublishSubscribeOpenError,
};
use untangled_proto::{
    PositionF32, PositionF64, Precision, RepairHeader, Status,
    correction::NO_FAULT,
    repair::{CERTIFIED, TRUNCATED},
    state,
};
use untangled_transport::services::{Ipc, Position};

use crate::error::{FrameRefusal, RequestError, iceoryx2_says};

/// The part of the time for a repair that the daemon may work; the rest is for its check and the way back.
const WORKED: f64 = 0.75;

/// The displacement of every vertex of one frame to a state without intersections, or as near to it as the daemon came
/// in its time.
///
/// Positions of the frame plus their displacements, added in the precision of the session, are the very bits that the
/// daemon checked. It stays in shared memory and readable until it is dropped; a session can hold
/// [`REPAIR_BORROWED`](untangled_proto::limits::REPAIR_BORROWED) of them less one.
#[derive(Debug)]
pub struct Repair {
    header: RepairHeader,
    sample: RepairSample,
}

/// A sample in the precision of the session.
#[derive(Debug)]
pub(crate) enum RepairSample {
    F32(Sample<Ipc, [PositionF32], RepairHeader>),
    F64(Sample<Ipc, [PositionF64], RepairHeader>),
}

impl Repair {
    /// A sample as a repair, if the daemon could use the frame.
    pub(crate) fn new(sample: RepairSample) -> Result<Self, FrameRefusal> {
        let header = *sample.header();
        if header.status == Status::Ok.code() {
            return Ok(Self { header, sample });
        }
        Err(FrameRefusal {
            frame: header.frame,
            status: Status::from_code(header.status).unwrap_or(Status::Internal),
            fault_index: Some(header.fault_index).filter(|&index| index != NO_FAULT),
            fault_value: header.fault_value,
            header_field: None,
        })
    }

    /// The frame whose positions the displacements are added to.
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.header.frame
    }

    /// Counts, times and how much the cloth changes.
    #[must_use]
    pub fn header(&self) -> &RepairHeader {
        &self.header
    }

    /// Whether an exact check found no crossing, and no cloth inside of a body or behind an inner layer, in what the
    /// host has after adding the displacements.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        self.header.flags & CERTIFIED != 0
    }

    /// Whether its time was up: it leads to the best state so far.
    #[must_use]
    pub fn is_truncated(&self) -> bool {
        self.header.flags & TRUNCATED != 0
    }

    /// Displacements in metres, `num_vertices x 3`, of a session in single precision; nothing in double.
    #[must_use]
    pub fn displacements_f32(&self) -> Option<&[[f32; 3]]> {
        match &self.sample {
            RepairSample::F32(sample) => Some(PositionF32::as_arrays(sample.payload())),
            RepairSample::F64(_) => None,
        }
    }

    /// Displacements in metres, `num_vertices x 3`, of a session in double precision; nothing in single.
    #[must_use]
    pub fn displacements_f64(&self) -> Option<&[[f64; 3]]> {
        match &self.sample {
            RepairSample::F64(sample) => Some(PositionF64::as_arrays(sample.payload())),
            RepairSample::F32(_) => None,
        }
    }
}

impl RepairSample {
    pub(crate) fn header(&self) -> &RepairHeader {
        match self {
            Self::F32(sample) => sample.user_header(),
            Self::F64(sample) => sample.user_header(),
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::F32(sample) => sample.payload().len(),
            Self::F64(sample) => sample.payload().len(),
        }
    }
}

/// Receives repairs, in the precision of the session.
#[derive(Debug)]
pub(crate) enum RepairPort {
    F32(Subscriber<Ipc, [PositionF32], RepairHeader>),
    F64(Subscriber<Ipc, [PositionF64], RepairHeader>),
}

impl RepairPort {
    /// Opens the repair service of a session; nothing where a daemon has none.
    pub(crate) fn open(node: &Node<Ipc>, name: &str, precision: Precision) -> Result<Option<Self>, RequestError> {
        Ok(match precision {
            Precision::F32 => subscribe(node, name)?.map(Self::F32),
            Precision::F64 => subscribe(node, name)?.map(Self::F64),
        })
    }

    /// The next repair that has come; one of the wrong length is dropped.
    pub(crate) fn receive(&self, num_vertices: usize) -> Result<Option<RepairSample>, String> {
        loop {
            let sample = match self {
                Self::F32(port) => port.receive().map(|sample| sample.map(RepairSample::F32)),
                Self::F64(port) => port.receive().map(|sample| sample.map(RepairSample::F64)),
            };
            match sample.map_err(|error| iceoryx2_says(&error))? {
                Some(sample) if sample.len() != num_vertices => {}
                sample => return Ok(sample),
            }
        }
    }
}

fn subscribe<P: Position>(
    node: &Node<Ipc>,
    name: &str,
) -> Result<Option<Subscriber<Ipc, [P], RepairHeader>>, RequestError> {
    let service = match P::open_repairs(node, name) {
        Err(PublishSubscribeOpenError::DoesNotExist) => return Ok(None),
        service => service.map_err(|error| RequestError::transport("opening the repair service", &error))?,
    };
    let subscriber = service.subscriber_builder().create();
    Ok(Some(subscriber.map_err(|error| RequestError::transport("creating a subscriber", &error))?))
}

/// What a session asks for with its next state, and what it knows of repairs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wishes {
    /// Whether the next state is to be repaired.
    is_asked: bool,
    /// Most time for that in microseconds; 0 for that of the settings.
    time_us: u64,
    /// Of the newest correction, which goes back to the daemon with the next state of the motion.
    pub(crate) progress: [u64; 2],
    /// Repairs of this frame and of older ones are of no use: they were published before a repair was handed out.
    pub(crate) obsolete: u64,
}

impl Wishes {
    /// Asks for a repair of the next state, of which the daemon has a part of `time`.
    pub(crate) fn ask(&mut self, time: Option<Duration>) {
        let micros = |time: Duration| u64::try_from(time.mul_f64(WORKED).as_micros()).unwrap_or(u64::MAX).max(1);
        (self.is_asked, self.time_us) = (true, time.map_or(0, micros));
    }

    /// The fields of the next state's header; it was asked for once.
    pub(crate) fn take(&mut self) -> StateWishes {
        let is_asked = std::mem::take(&mut self.is_asked);
        let time_us = std::mem::take(&mut self.time_us);
        StateWishes { flags: if is_asked { state::REPAIR } else { 0 }, time_us, progress: self.progress }
    }
}

/// What a state's header asks for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StateWishes {
    pub(crate) flags: u32,
    pub(crate) time_us: u64,
    pub(crate) progress: [u64; 2],
}
