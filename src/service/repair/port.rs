//! The daemon's port for the repairs of a session.

use iceoryx2::{
    port::{notifier::Notifier, publisher::Publisher},
    prelude::{EventId, Node},
};
use untangled_proto::{
    PositionF32, PositionF64, Precision, RepairHeader, Status,
    names::{self, SessionService},
};
use untangled_transport::{
    memory,
    services::{Event, Ipc, Position, Repairs},
};

use crate::service::{
    error::{Refusal, ServeError},
    port_options::PortOptions,
};

/// Sends repairs and wakes the host.
#[derive(Debug)]
pub(crate) struct RepairPort {
    publisher: Displacements,
    notifier: Notifier<Ipc>,
}

/// A publisher in the precision of the session.
#[derive(Debug)]
enum Displacements {
    F32(Publication<PositionF32>),
    F64(Publication<PositionF64>),
}

/// Fields are dropped in order: the port before its service.
#[derive(Debug)]
struct Publication<P: Position> {
    publisher: Publisher<Ipc, [P], RepairHeader>,
    _service: Repairs<P>,
}

impl RepairPort {
    /// Creates the service of a session, and its publisher; `event` is that of the session.
    pub(crate) fn create(node: &Node<Ipc>, event: &Event, options: &PortOptions<'_>) -> Result<Self, Refusal> {
        let notifier = event.notifier_builder().create().map_err(|error| failed("creating a notifier", &error))?;
        let publisher = match options.precision {
            Precision::F32 => Displacements::F32(Publication::create(node, options)?),
            Precision::F64 => Displacements::F64(Publication::create(node, options)?),
        };
        Ok(Self { publisher, notifier })
    }

    /// Sends a repair, `num_vertices x 3` in metres, and wakes the host.
    pub(crate) fn send(&self, header: &RepairHeader, displacements: &[[f64; 3]]) -> Result<(), ServeError> {
        let displacement = |index: usize| displacements.get(index).copied().unwrap_or_default();
        match &self.publisher {
            #[expect(clippy::cast_possible_truncation, reason = "of a session in single precision, which hold it")]
            Displacements::F32(port) => {
                port.send(header, |index| PositionF32(displacement(index).map(|value| value as f32)))?;
            }
            Displacements::F64(port) => port.send(header, |index| PositionF64(displacement(index)))?,
        }
        // An error means that the host is gone; the next check for hosts ends the session.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPAIR));
        Ok(())
    }
}

impl<P: Position> Publication<P> {
    fn create(node: &Node<Ipc>, options: &PortOptions<'_>) -> Result<Self, Refusal> {
        let &PortOptions { domain, instance, session, num_vertices, layout, .. } = options;
        let name = names::session(instance, session, SessionService::Repair);
        let service =
            P::create_repairs(node, &name, layout).map_err(|error| failed("creating the repair service", &error))?;
        let publisher = service
            .publisher_builder()
            .initial_max_slice_len(num_vertices)
            .max_loaned_samples(1)
            .create()
            .map_err(|error| failed("creating a publisher", &error))?;
        memory::commit(domain, publisher.id().value()).map_err(|error| match error.kind() {
            std::io::ErrorKind::StorageFull => Refusal::new(
                Status::NotEnoughMemory,
                format_args!("{} has no room for the session's repairs: {error}", memory::FOLDER),
            ),
            _ => Refusal::new(Status::Internal, format_args!("taking shared memory: {error}")),
        })?;
        Ok(Self { publisher, _service: service })
    }

    fn send(&self, header: &RepairHeader, displacement: impl FnMut(usize) -> P) -> Result<(), ServeError> {
        let sample = self
            .publisher
            .loan_slice_uninit(self.publisher.initial_max_slice_len())
            .map_err(|error| ServeError::transport("loaning a repair", &error))?;
        let mut sample = sample.write_from_fn(displacement);
        *sample.user_header_mut() = *header;
        sample.send().map_err(|error| ServeError::transport("sending a repair", &error))?;
        Ok(())
    }
}

fn failed(what: &str, error: &dyn std::fmt::Debug) -> Refusal {
    Refusal::new(Status::Internal, format_args!("{what} failed: iceoryx2 reports {error:?}"))
}
