//! What the threads of a daemon end share.

use std::sync::{Arc, Mutex, PoisonError, atomic::AtomicBool};

use serde_json::{Value, json};
use untangled_proto::LIBRARY_VERSION;
use untangled_transport::{Domain, search};

use super::{hosts::Hosts, local::Local};
use crate::metrics::Metrics;

/// What the threads of a daemon end share.
pub(crate) struct Shared {
    pub(super) hosts: Hosts,
    pub(super) local: Mutex<Option<Arc<Local>>>,
    pub(super) metrics: Arc<Metrics>,
    pub(super) name: String,
    pub(super) domain: Domain,
    /// Names of hosts that may use the daemon; empty for all.
    pub(super) allowed: Vec<String>,
    pub(super) max_request_bytes: usize,
    /// A session was opened since the daemon was asked how much it has to do.
    pub(super) has_new_link: AtomicBool,
    pub(super) network: zenoh::Session,
}

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Shared {
    pub(super) fn local(&self) -> Option<Arc<Local>> {
        self.local.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn set_local(&self, local: Option<Arc<Local>>) {
        *self.local.lock().unwrap_or_else(PoisonError::into_inner) = local;
    }

    pub(super) fn is_allowed(&self, host: &str) -> bool {
        !host.is_empty() && (self.allowed.is_empty() || self.allowed.iter().any(|name| name == host))
    }

    pub(super) fn no_daemon(&self) -> String {
        format!("no daemon serves domain `{}` {}", self.domain.name(), search::explain(&self.domain))
    }

    pub(super) fn report(&self) -> Value {
        let hosts = self.hosts.list().into_iter();
        let hosts = hosts.map(|(name, num_sessions, silent_s)| {
            json!({ "name": &*name, "num_sessions": num_sessions, "silent_s": silent_s })
        });
        let mut report = self.metrics.report();
        report["end"] = "daemon".into();
        report["name"] = self.name.as_str().into();
        report["domain"] = self.domain.name().into();
        report["pid"] = std::process::id().into();
        report["library_version"] = LIBRARY_VERSION.into();
        report["has_daemon"] = self.local().is_some().into();
        report["hosts"] = hosts.collect();
        report
    }
}
