//! Takes the intersection paths of frames from the daemon, while somebody listens at the other end.

use iceoryx2::{port::subscriber::Subscriber, prelude::Node, sample::Sample};
use untangled_client::RequestError;
use untangled_proto::{names::SessionService, paths::PathsHeader};
use untangled_transport::services::{self, Ipc};

use super::shape::{Shape, failed};
use crate::wire::plain;

/// Takes paths; they come before the correction of their frame.
#[derive(Debug)]
pub(in super::super) struct PathsPort {
    subscriber: Subscriber<Ipc, [u8], PathsHeader>,
    /// Paths of a newer frame than the last correction.
    early: Option<Sample<Ipc, [u8], PathsHeader>>,
}

impl PathsPort {
    pub(in super::super) fn open(node: &Node<Ipc>, shape: &Shape) -> Result<Self, RequestError> {
        let subscriber = services::open_paths(node, &shape.name(SessionService::Paths))
            .map_err(|error| failed("opening the paths service", &error))?
            .subscriber_builder()
            .create()
            .map_err(|error| failed("creating a subscriber", &error))?;
        Ok(Self { subscriber, early: None })
    }

    /// What a message carries of the paths of a frame whose correction has come.
    pub(in super::super) fn take(&mut self, frame: u64) -> Option<Vec<u8>> {
        loop {
            let paths = match self.early.take() {
                Some(paths) => paths,
                None => self.subscriber.receive().ok().flatten()?,
            };
            // A copy: it is compared and sent.
            let header = *paths.user_header();
            if header.frame == frame {
                return Some([plain::bytes_of(&[header]), paths.payload()].concat());
            }
            if header.frame > frame {
                self.early = Some(paths);
                return None;
            }
        }
    }
}
