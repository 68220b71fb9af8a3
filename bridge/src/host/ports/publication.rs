//! A publisher of a session whose samples have a greatest length, with all of its shared memory taken.

use iceoryx2::{
    port::publisher::Publisher, prelude::ZeroCopySend, sample_mut_uninit::SampleMutUninit,
    service::port_factory::publish_subscribe::PortFactory,
};
use std::mem::MaybeUninit;
use untangled_proto::Status;
use untangled_transport::{Domain, memory, services::Ipc};

use super::{super::refusal::Refusal, error::DeliverError};

/// A publisher and its service. Fields are dropped in order: the port before its service.
#[derive(Debug)]
pub(crate) struct Publication<E: std::fmt::Debug + ZeroCopySend + 'static, H: std::fmt::Debug + ZeroCopySend + 'static>
{
    publisher: Publisher<Ipc, [E], H>,
    _service: PortFactory<Ipc, [E], H>,
}

impl<E, H> Publication<E, H>
where
    E: std::fmt::Debug + ZeroCopySend + 'static,
    H: std::fmt::Debug + Default + ZeroCopySend + 'static,
{
    /// Makes the publisher; `what` it carries, in words.
    pub(crate) fn create(
        service: PortFactory<Ipc, [E], H>,
        room: usize,
        domain: &Domain,
        what: &str,
    ) -> Result<Self, Refusal> {
        let publisher = service
            .publisher_builder()
            .initial_max_slice_len(room)
            .max_loaned_samples(1)
            .create()
            .map_err(|error| Refusal::failed("creating a publisher", &error))?;
        memory::commit(domain, publisher.id().value()).map_err(|error| match error.kind() {
            std::io::ErrorKind::StorageFull => Refusal::new(
                Status::NotEnoughMemory,
                format_args!("{} has no room for the session's {what}: {error}", memory::FOLDER),
            ),
            _ => Refusal::new(Status::Internal, format_args!("taking shared memory: {error}")),
        })?;
        Ok(Self { publisher, _service: service })
    }

    /// The longest sample.
    pub(crate) fn room(&self) -> usize {
        self.publisher.initial_max_slice_len()
    }

    /// A sample of so many elements.
    pub(crate) fn loan(&self, num_elements: usize) -> Result<SampleMutUninit<Ipc, [MaybeUninit<E>], H>, DeliverError> {
        self.publisher.loan_slice_uninit(num_elements).map_err(|error| DeliverError::transport(&error))
    }
}
