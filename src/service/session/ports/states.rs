//! Receives the states of a session.

use iceoryx2::{
    port::subscriber::Subscriber,
    prelude::{Node, PortFactory},
    sample::Sample,
};
use untangled_proto::{
    PayloadLayout, PositionF32, PositionF64, Precision, StateHeader,
    names::{self, SessionService},
};
use untangled_transport::services::{Ipc, Position, States};

use untangle::frame::Frame;
use untangled_transport::throttle::Throttle;

use super::super::{
    cloth::Cloth,
    ingest::{self, StateFault},
};
use crate::service::error::ServeError;

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

    /// The newest state that has come, copied and checked into `frame`. `copied` is memory for a welded cloth.
    pub(crate) fn read_newest(
        &self,
        frame: &mut Frame,
        cloth: &Cloth,
        copied: &mut Vec<[f64; 3]>,
    ) -> Option<(StateHeader, Result<(), StateFault>)> {
        let mesh = cloth.mesh();
        match self {
            Self::F32(states) => {
                let sample = states.newest()?;
                let read = match cloth.weld() {
                    Some(weld) => {
                        let coordinates = |position: PositionF32| position.0;
                        ingest::read_welded(frame, mesh, weld, sample.payload(), coordinates, copied)
                    }
                    None => ingest::read_f32(frame, mesh, sample.payload()),
                };
                Some((*sample.user_header(), read))
            }
            Self::F64(states) => {
                let sample = states.newest()?;
                let read = match cloth.weld() {
                    Some(weld) => {
                        let coordinates = |position: PositionF64| position.0;
                        ingest::read_welded(frame, mesh, weld, sample.payload(), coordinates, copied)
                    }
                    None => ingest::read_f64(frame, mesh, sample.payload()),
                };
                Some((*sample.user_header(), read))
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
