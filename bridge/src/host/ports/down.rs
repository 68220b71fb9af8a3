//! All ports towards the host together.

use iceoryx2::{
    port::notifier::Notifier,
    prelude::{EventId, Node},
};
use untangled_proto::names::{self, SessionService};
use untangled_transport::services::{self, Event, Ipc};

use super::{
    super::refusal::Refusal, corrections::CorrectionPort, error::DeliverError, paths::PathsPort, repairs::RepairPort,
    shape::Shape,
};
use crate::wire::message::Kind;

/// What goes to the host. Fields are dropped in order: ports before services.
#[derive(Debug)]
pub(crate) struct DownPorts {
    corrections: CorrectionPort,
    repairs: Option<RepairPort>,
    paths: PathsPort,
    notifier: Notifier<Ipc>,
    _event: Event,
}

impl DownPorts {
    pub(crate) fn create(node: &Node<Ipc>, shape: &Shape<'_>) -> Result<Self, Refusal> {
        let event = services::create_session_event(node, &shape.name(SessionService::Event))
            .map_err(|error| Refusal::failed("creating the session's event", &error))?;
        let notifier =
            event.notifier_builder().create().map_err(|error| Refusal::failed("creating a notifier", &error))?;
        let corrections = CorrectionPort::create(node, shape)?;
        let repairs = if shape.has_repairs() { Some(RepairPort::create(node, shape)?) } else { None };
        let paths = PathsPort::create(node, shape)?;
        Ok(Self { corrections, repairs, paths, notifier, _event: event })
    }

    /// Whether somebody listens to paths.
    pub(crate) fn wants_paths(&self) -> bool {
        self.paths.has_subscriber()
    }

    /// Hands a message on, and wakes the host where it waits for such a message.
    pub(crate) fn deliver(&mut self, kind: Kind, body: &[u8]) -> Result<(), DeliverError> {
        let event = match kind {
            Kind::Dense | Kind::Sparse => {
                self.corrections.send(kind, body)?;
                names::EVENT_CORRECTION
            }
            Kind::Repair => {
                self.repairs.as_mut().ok_or(DeliverError::Malformed)?.send(body)?;
                names::EVENT_REPAIR
            }
            // The correction of the frame follows, and wakes the host.
            Kind::Paths => return self.paths.send(body),
            _ => return Err(DeliverError::Malformed),
        };
        // An error means that the host is gone; the next check for hosts ends the session.
        let _ = self.notifier.notify_with_custom_event_id(EventId::new(event));
        Ok(())
    }
}
