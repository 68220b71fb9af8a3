//! Frames of a daemon: `wrong` (cloth on the wrong side of bodies and layers), `lines` (paths as lines, and what is
//! known of them), `frame` (one frame as a message for the page), and here the daemon and its sessions.

mod frame;
mod lines;
mod wrong;

use std::{sync::Arc, time::Duration};

use serde_json::json;
use untangled_client::observe::{self, ObservedMesh, Observer, ObserverOptions};

use self::frame::Framer;
use super::{
    message::Message,
    source::{Feed, SessionLine, Source},
};

/// How long a daemon may take to answer: on a busy machine longer than it takes to say that there is none.
const PATIENCE: Duration = Duration::from_secs(5);
/// The role of a vertex of a body; those of others are their layers, counted from 0.
const BODY: u8 = 255;

/// The daemon of a domain.
#[derive(Clone, Debug)]
pub(super) struct Observed {
    domain: String,
}

impl Observed {
    pub(super) fn new(domain: &str) -> Self {
        Self { domain: domain.to_owned() }
    }

    fn options(&self) -> ObserverOptions {
        ObserverOptions {
            domain: Some(self.domain.clone()),
            timeout: PATIENCE,
            name: Some("untangled watch".to_owned()),
        }
    }
}

impl Source for Observed {
    fn name(&self) -> &str {
        &self.domain
    }

    fn sessions(&self) -> Result<Vec<SessionLine>, String> {
        let found = observe::sessions(&self.options()).map_err(|error| error.to_string())?;
        let line = |session: &observe::ObservedSession| SessionLine {
            session: name_of(session.instance, session.session),
            host: session.host.as_ref().map_or_else(
                || format!("session {}", session.session),
                |host| format!("session {} of {}, process {}", session.session, host.name, host.pid),
            ),
            num_vertices: session.num_vertices,
            num_faces: session.num_faces,
            num_frames: session.num_frames,
        };
        Ok(found.iter().map(line).collect())
    }

    fn open(&self, session: &str) -> Result<Box<dyn Feed>, String> {
        let id = session.split_once('-').and_then(|(_, id)| id.parse().ok());
        let id = id.ok_or_else(|| "there is no such session".to_owned())?;
        let observer = Observer::open(self.options(), id).map_err(|error| error.to_string())?;
        if name_of(observer.session().instance, id) != session {
            return Err("the session has ended with its daemon".to_owned());
        }
        let framer = Framer::new(observer.mesh());
        Ok(Box::new(Observing { observer, framer }))
    }
}

/// Ids of sessions begin anew with each run of a daemon.
fn name_of(instance: u64, session: u64) -> String {
    format!("{instance:x}-{session}")
}

struct Observing {
    observer: Observer,
    framer: Framer,
}

impl Feed for Observing {
    fn mesh(&self) -> Arc<[u8]> {
        let mesh = self.observer.mesh();
        let mut message = Message::default();
        message.whole("triangles", mesh.triangles.as_flattened());
        message.bytes("roles", &roles(mesh));
        message.finish(&json!({ "num_vertices": mesh.num_vertices }))
    }

    fn latest(&mut self, timeout: Duration) -> Result<Option<Arc<[u8]>>, String> {
        let latest = self.observer.latest(timeout).map_err(|error| error.to_string())?;
        Ok(latest.and_then(|seen| self.framer.message(&seen)))
    }
}

/// The role of each vertex; none where all are cloth of one layer.
fn roles(mesh: &ObservedMesh) -> Vec<u8> {
    if mesh.body.is_empty() && mesh.layers.is_none() {
        return Vec::new();
    }
    let layers = mesh.layers.clone().unwrap_or_else(|| vec![0; mesh.num_vertices]);
    let mut known = layers.clone();
    known.sort_unstable();
    known.dedup();
    let place = |layer: &u32| u8::try_from(known.partition_point(|other| other < layer)).unwrap_or(BODY - 1);
    let mut roles: Vec<u8> = layers.iter().map(|layer| place(layer).min(BODY - 1)).collect();
    for &vertex in &mesh.body {
        roles[vertex as usize] = BODY;
    }
    roles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roles_are_layers_in_their_order_and_bodies() {
        let mesh = |layers: Option<Vec<u32>>, body: Vec<u32>| ObservedMesh {
            num_vertices: 4,
            layers,
            body,
            ..ObservedMesh::default()
        };
        assert!(roles(&mesh(None, Vec::new())).is_empty(), "cloth of one layer");
        assert_eq!(roles(&mesh(None, vec![3])), [0, 0, 0, BODY]);
        assert_eq!(roles(&mesh(Some(vec![7, 2, 7, 40]), vec![1])), [1, BODY, 1, 2]);
    }
}
