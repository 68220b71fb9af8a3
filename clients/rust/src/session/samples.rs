//! Receives corrections, in the form that the session has.

use iceoryx2::{
    port::subscriber::Subscriber,
    prelude::{Node, PortFactory},
    sample::Sample,
    service::{
        builder::publish_subscribe::PublishSubscribeOpenError::DoesNotExist,
        port_factory::publish_subscribe::PortFactory as Publications,
    },
};
use untangled_proto::{
    CorrectionHeader, SessionOptions, VertexCorrection, VertexEntry, VertexLabel, names::SessionService,
};
use untangled_transport::{
    node,
    services::{self, CorrectionService, Ipc, SparseService},
};

use crate::error::RequestError;

/// Receives corrections. Fields of a variant are dropped in order: ports before services.
#[derive(Debug)]
pub(crate) enum CorrectionPort {
    Dense(Subscriber<Ipc, [VertexCorrection], CorrectionHeader>, CorrectionService),
    Sparse(Subscriber<Ipc, [u32], CorrectionHeader>, SparseService, SessionOptions),
}

/// A correction that has come.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "a copied header is no reason to allocate for each frame")]
pub(crate) enum CorrectionSample {
    Dense(Sample<Ipc, [VertexCorrection], CorrectionHeader>),
    Sparse(SparseSample),
}

/// A sparse correction, with a copy of its header.
#[derive(Debug)]
pub(crate) struct SparseSample {
    header: CorrectionHeader,
    sample: Sample<Ipc, [u32], CorrectionHeader>,
}

impl CorrectionPort {
    /// Opens the service that a session has: that of sparse corrections where they were asked for, unless the daemon
    /// does not know them.
    pub(crate) fn open(
        node: &Node<Ipc>,
        name: impl Fn(SessionService) -> String,
        asked: SessionOptions,
    ) -> Result<Self, RequestError> {
        if asked.is_sparse() {
            match services::open_sparse_corrections(node, &name(SessionService::Sparse)) {
                Ok(service) => return Ok(Self::Sparse(subscriber(&service)?, service, asked)),
                Err(DoesNotExist) => {}
                Err(error) => {
                    return Err(RequestError::transport("opening the service of sparse corrections", &error));
                }
            }
        }
        let service = services::open_corrections(node, &name(SessionService::Correction))
            .map_err(|error| RequestError::transport("opening the correction service", &error))?;
        Ok(Self::Dense(subscriber(&service)?, service))
    }

    /// What the daemon does of what was asked for.
    pub(crate) fn options(&self) -> SessionOptions {
        match self {
            Self::Dense(..) => SessionOptions::default(),
            Self::Sparse(_, _, options) => *options,
        }
    }

    pub(crate) fn receive(&self) -> Result<Option<CorrectionSample>, iceoryx2::port::ReceiveError> {
        Ok(match self {
            Self::Dense(corrections, _) => corrections.receive()?.map(CorrectionSample::Dense),
            Self::Sparse(corrections, ..) => corrections
                .receive()?
                .map(|sample| CorrectionSample::Sparse(SparseSample { header: *sample.user_header(), sample })),
        })
    }

    /// Whether the daemon has not closed its side. Reads shared memory only.
    pub(crate) fn has_publisher(&self) -> bool {
        0 != match self {
            Self::Dense(_, service) => service.dynamic_config().number_of_publishers(),
            Self::Sparse(_, service, _) => service.dynamic_config().number_of_publishers(),
        }
    }

    /// Whether the process of the daemon is gone. Costs system calls.
    pub(crate) fn has_dead_user(&self) -> bool {
        match self {
            Self::Dense(_, service) => node::has_dead_user(service),
            Self::Sparse(_, service, _) => node::has_dead_user(service),
        }
    }
}

fn subscriber<E: std::fmt::Debug + iceoryx2::prelude::ZeroCopySend + 'static>(
    service: &Publications<Ipc, [E], CorrectionHeader>,
) -> Result<Subscriber<Ipc, [E], CorrectionHeader>, RequestError> {
    let created = service.subscriber_builder().create();
    created.map_err(|error| RequestError::transport("creating a subscriber", &error))
}

impl CorrectionSample {
    pub(crate) fn header(&self) -> &CorrectionHeader {
        match self {
            Self::Dense(sample) => sample.user_header(),
            Self::Sparse(sample) => &sample.header,
        }
    }

    /// Whether lengths and vertices are those of a session of so many vertices.
    pub(crate) fn is_whole(&self, num_vertices: usize) -> bool {
        match self {
            Self::Dense(sample) => sample.payload().len() == num_vertices,
            Self::Sparse(SparseSample { header, sample }) => {
                header.num_vertices as usize == num_vertices && header.split(sample.payload()).is_some()
            }
        }
    }
}

impl SparseSample {
    pub(crate) fn entries(&self) -> &[VertexEntry] {
        self.header.parts(self.sample.payload()).unwrap_or_default().0
    }

    pub(crate) fn labels(&self) -> &[VertexLabel] {
        self.header.parts(self.sample.payload()).unwrap_or_default().1
    }
}
