//! The daemon's ports of a session, each with the service that it belongs to.

use iceoryx2::{
    port::{notifier::Notifier, publisher::Publisher, subscriber::Subscriber},
    prelude::{EventId, Node, PortFactory},
    sample::Sample,
};
use untangled_proto::{
    CorrectionHeader, PayloadLayout, PositionF32, PositionF64, Precision, StateHeader, Status, VertexCorrection,
    names::{self, SessionService},
};
use untangled_transport::{
    Domain, memory,
    services::{self, CorrectionService, Event, Ipc, Position, States},
};

use untangle::{frame::Frame, mesh::Mesh};

use super::{
    clock::StageClock,
    ingest::{self, StateFault},
};
use crate::service::{
    error::{Refusal, ServeError},
    throttle::Throttle,
};

/// Receives states, in the precision that the host chose.
#[derive(Debug)]
pub(crate) enum StatePort {
    F32(Subscription<PositionF32>),
    F64(Subscription<PositionF64>),
}

/// A subscriber, dropped before its service. The service knows whether there is a publisher.
#[derive(Debug)]
pub(crate) struct Subscription<P: Position> {
    subscriber: Subscriber<Ipc, [P], StateHeader>,
    service: States<P>,
}

impl StatePort {
    pub(crate) fn create(
        node: &Node<Ipc>,
        instance: u64,
        session: u64,
        precision: Precision,
        layout: PayloadLayout,
    ) -> Result<Self, ServeError> {
        let name = names::session(instance, session, SessionService::State);
        Ok(match precision {
            Precision::F32 => Self::F32(Subscription::create(node, &name, layout)?),
            Precision::F64 => Self::F64(Subscription::create(node, &name, layout)?),
        })
    }

    /// Whether a host is there to send states.
    pub(crate) fn has_publisher(&self) -> bool {
        0 != match self {
            Self::F32(states) => states.service.dynamic_config().number_of_publishers(),
            Self::F64(states) => states.service.dynamic_config().number_of_publishers(),
        }
    }

    /// Whether a state has come.
    pub(crate) fn has_state(&self) -> bool {
        match self {
            Self::F32(states) => states.has_state(),
            Self::F64(states) => states.has_state(),
        }
    }

    /// The newest state that has come, copied and checked into `frame`.
    pub(crate) fn read_newest(&self, frame: &mut Frame, mesh: &Mesh) -> Option<(StateHeader, Result<(), StateFault>)> {
        match self {
            Self::F32(states) => {
                let sample = states.newest()?;
                Some((*sample.user_header(), ingest::read_f32(frame, mesh, sample.payload())))
            }
            Self::F64(states) => {
                let sample = states.newest()?;
                Some((*sample.user_header(), ingest::read_f64(frame, mesh, sample.payload())))
            }
        }
    }
}

impl<P: Position> Subscription<P> {
    fn create(node: &Node<Ipc>, name: &str, layout: PayloadLayout) -> Result<Self, ServeError> {
        let service = P::create_states(node, name, layout)
            .map_err(|error| ServeError::transport("creating the state service", &error))?;
        let subscriber = service
            .subscriber_builder()
            .create()
            .map_err(|error| ServeError::transport("creating a subscriber", &error))?;
        Ok(Self { subscriber, service })
    }

    /// The newest state: the buffer has room for one, and an older state is overwritten.
    fn newest(&self) -> Option<Sample<Ipc, [P], StateHeader>> {
        self.subscriber.receive().unwrap_or_else(|error| {
            warn(&error);
            None
        })
    }

    fn has_state(&self) -> bool {
        self.subscriber.has_samples().unwrap_or_else(|error| {
            warn(&error);
            false
        })
    }
}

fn warn(error: &dyn std::fmt::Debug) {
    static FAILED: Throttle = Throttle::new();
    if let Some(num_suppressed) = FAILED.admit() {
        tracing::warn!(?error, num_suppressed, "receiving a state");
    }
}

/// Sends corrections and wakes the host. Fields are dropped in order: ports before services.
#[derive(Debug)]
pub(crate) struct CorrectionPort {
    publisher: Publisher<Ipc, [VertexCorrection], CorrectionHeader>,
    notifier: Notifier<Ipc>,
    _service: CorrectionService,
    _event: Event,
}

impl CorrectionPort {
    pub(crate) fn create(
        node: &Node<Ipc>,
        domain: &Domain,
        instance: u64,
        session: u64,
        num_vertices: usize,
        layout: PayloadLayout,
    ) -> Result<Self, Refusal> {
        let failed = |what, error: &dyn std::fmt::Debug| {
            Refusal::new(Status::Internal, format_args!("{what} failed: iceoryx2 reports {error:?}"))
        };
        let name = |service| names::session(instance, session, service);
        let event = services::create_session_event(node, &name(SessionService::Event))
            .map_err(|error| failed("creating the session's event", &error))?;
        let notifier = event.notifier_builder().create().map_err(|error| failed("creating a notifier", &error))?;
        let service = services::create_corrections(node, &name(SessionService::Correction), layout)
            .map_err(|error| failed("creating the correction service", &error))?;
        let publisher = service
            .publisher_builder()
            .initial_max_slice_len(num_vertices)
            .max_loaned_samples(1)
            .create()
            .map_err(|error| failed("creating a publisher", &error))?;
        memory::commit(domain, publisher.id().value()).map_err(|error| match error.kind() {
            std::io::ErrorKind::StorageFull => Refusal::new(
                Status::NotEnoughMemory,
                format_args!("{} has no room for the session's corrections: {error}", memory::FOLDER),
            ),
            _ => Refusal::new(Status::Internal, format_args!("taking shared memory: {error}")),
        })?;
        Ok(Self { publisher, notifier, _service: service, _event: event })
    }

    /// Writes a correction in place and its header, with the times so far, last; passes the header to `record`; sends
    /// the sample and wakes the host.
    pub(crate) fn send(
        &self,
        header: &mut CorrectionHeader,
        clock: &mut StageClock,
        record: impl FnOnce(&CorrectionHeader),
        vertex: impl FnMut(usize) -> VertexCorrection,
    ) -> Result<(), ServeError> {
        let sample = self
            .publisher
            .loan_slice_uninit(self.publisher.initial_max_slice_len())
            .map_err(|error| ServeError::transport("loaning a correction", &error))?;
        let mut sample = sample.write_from_fn(vertex);
        header.stage_ns = clock.finish();
        *sample.user_header_mut() = *header;
        // Before it is sent, so that a host that has the correction finds it counted.
        record(header);
        sample.send().map_err(|error| ServeError::transport("sending a correction", &error))?;
        // An error means that the host is gone; the next check for hosts ends the session.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(names::EVENT_CORRECTION));
        Ok(())
    }
}
