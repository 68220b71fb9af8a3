//! Regular cleanup of dead iceoryx2 nodes: their ports, services and tags, as far as iceoryx2 removes them.

use std::time::{Duration, Instant};

use iceoryx2::prelude::Node;

use super::changes::ChangeDetector;
use crate::{Domain, node as nodes, services::Ipc};

/// When dead nodes were last looked for.
#[derive(Debug)]
pub struct DeadNodes {
    last: Instant,
    changes: ChangeDetector,
}

impl DeadNodes {
    /// How often dead nodes are looked for.
    pub const INTERVAL: Duration = Duration::from_millis(500);

    /// None yet.
    #[must_use]
    pub fn new(domain: &Domain) -> Self {
        Self { last: Instant::now(), changes: ChangeDetector::new(domain) }
    }

    /// Whether an interval has passed since the last cleanup.
    #[must_use]
    pub fn is_due(&self) -> bool {
        self.last.elapsed() >= Self::INTERVAL
    }

    /// Cleans up dead nodes, unless nothing has changed since the last time.
    pub fn clean_up(&mut self, node: &Node<Ipc>) {
        if !self.changes.is_unchanged() {
            nodes::clean_up_dead(node);
        }
        self.last = Instant::now();
    }
}
