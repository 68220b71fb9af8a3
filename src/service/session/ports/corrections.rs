//! Sends the corrections of a session and wakes its host.

use iceoryx2::{
    port::{notifier::Notifier, publisher::Publisher},
    prelude::{EventId, Node, ZeroCopySend},
    service::port_factory::publish_subscribe,
};
use untangled_proto::{
    CorrectionHeader, Status,
    names::{self, SessionService},
};
use untangled_transport::{
    Domain, memory,
    services::{self, Event, Ipc},
};

use super::{dense::DenseSamples, finish::Finish, sparse::SparseSamples};
use crate::service::{
    error::{Refusal, ServeError},
    port_options::PortOptions,
    session::{clock::StageClock, publish::Values},
};

/// Sends corrections and wakes the host. Fields are dropped in order: ports before services.
#[derive(Debug)]
pub(crate) struct CorrectionPort {
    samples: Samples,
    notifier: Notifier<Ipc>,
    event: Event,
}

#[derive(Debug)]
enum Samples {
    Dense(DenseSamples),
    Sparse(SparseSamples),
}

impl CorrectionPort {
    pub(crate) fn create(node: &Node<Ipc>, port: &PortOptions<'_>) -> Result<Self, Refusal> {
        let name = |service| names::session(port.instance, port.session, service);
        let event = services::create_session_event(node, &name(SessionService::Event))
            .map_err(|error| failed("creating the session's event", &error))?;
        let notifier = event.notifier_builder().create().map_err(|error| failed("creating a notifier", &error))?;
        let samples = if port.options.is_sparse() {
            let service = services::create_sparse_corrections(node, &name(SessionService::Sparse))
                .map_err(|error| failed("creating the service of sparse corrections", &error))?;
            let room = untangled_proto::memory::sparse_words(port.num_vertices, port.options);
            Samples::Sparse(SparseSamples::new(publisher(&service, room, port.domain)?, service, port.options))
        } else {
            let service = services::create_corrections(node, &name(SessionService::Correction), port.layout)
                .map_err(|error| failed("creating the correction service", &error))?;
            Samples::Dense(DenseSamples::new(publisher(&service, port.num_vertices, port.domain)?, service))
        };
        Ok(Self { samples, notifier, event })
    }

    /// The event of the session.
    pub(crate) fn event(&self) -> &Event {
        &self.event
    }

    /// Writes a correction in place and its header, with the times so far, last; passes the header to `record`; sends
    /// the sample and wakes the host. Without values all of them are zero, and so are all flags.
    pub(crate) fn send(
        &mut self,
        header: &mut CorrectionHeader,
        clock: &mut StageClock,
        record: impl FnOnce(&CorrectionHeader),
        values: Option<&Values<'_>>,
    ) -> Result<(), ServeError> {
        let finish = Finish { header, clock, record };
        match &mut self.samples {
            Samples::Dense(samples) => samples.send(values, finish)?,
            Samples::Sparse(samples) => samples.send(values, finish)?,
        }
        // An error means that the host is gone; the next check for hosts ends the session.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(names::EVENT_CORRECTION));
        Ok(())
    }
}

/// The publisher of a service, with all of its shared memory taken.
fn publisher<E: std::fmt::Debug + ZeroCopySend + 'static>(
    service: &publish_subscribe::PortFactory<Ipc, [E], CorrectionHeader>,
    num_elements: usize,
    domain: &Domain,
) -> Result<Publisher<Ipc, [E], CorrectionHeader>, Refusal> {
    let publisher = service
        .publisher_builder()
        .initial_max_slice_len(num_elements)
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
    Ok(publisher)
}

fn failed(what: &str, error: &dyn std::fmt::Debug) -> Refusal {
    Refusal::new(Status::Internal, format_args!("{what} failed: iceoryx2 reports {error:?}"))
}
