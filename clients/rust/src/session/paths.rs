//! The intersection paths of a frame, read in place in shared memory.

use iceoryx2::{port::subscriber::Subscriber, prelude::Node, sample::Sample};
use untangled_proto::paths::{PathPoint, PathRecord, PathsHeader};
use untangled_transport::services::{self, Ipc};

use crate::error::RequestError;

/// Paths as they were received.
#[derive(Debug)]
pub(crate) struct PathsSample {
    header: PathsHeader,
    sample: Sample<Ipc, [u8], PathsHeader>,
}

/// Receives paths; they come before the correction of their frame.
#[derive(Debug)]
pub(crate) struct PathsPort {
    subscriber: Subscriber<Ipc, [u8], PathsHeader>,
    /// Paths of a newer frame than the last correction.
    early: Option<PathsSample>,
}

/// The intersection paths of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Paths<'a> {
    /// One record for each path.
    pub records: &'a [PathRecord],
    /// The points of all paths, one after the other; [`PathRecord::points`] finds those of one.
    pub points: &'a [PathPoint],
}

impl PathsSample {
    /// Records and points; nothing where the lengths contradict each other.
    pub(crate) fn paths(&self) -> Option<Paths<'_>> {
        self.header.split(self.sample.payload()).map(|(records, points)| Paths { records, points })
    }
}

impl PathsPort {
    pub(crate) fn open(node: &Node<Ipc>, name: &str) -> Result<Self, RequestError> {
        let subscriber = services::open_paths(node, name)
            .map_err(|error| RequestError::transport("opening the paths service", &error))?
            .subscriber_builder()
            .create()
            .map_err(|error| RequestError::transport("creating a subscriber", &error))?;
        Ok(Self { subscriber, early: None })
    }

    /// The paths of a frame whose correction has come, if the daemon could send them.
    pub(crate) fn take(&mut self, frame: u64) -> Option<PathsSample> {
        loop {
            let paths = match self.early.take() {
                Some(paths) => paths,
                None => {
                    let sample = match self.subscriber.receive() {
                        Ok(sample) => sample?,
                        Err(error) => {
                            tracing::debug!(?error, frame, "receiving paths");
                            return None;
                        }
                    };
                    PathsSample { header: *sample.user_header(), sample }
                }
            };
            if paths.header.frame == frame {
                return Some(paths);
            }
            if paths.header.frame > frame {
                self.early = Some(paths);
                return None;
            }
        }
    }
}
