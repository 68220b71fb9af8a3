//! An observer of a session.

use std::time::{Duration, Instant};

use untangled_proto::{
    PROTOCOL_VERSION, RequestHeader, RequestKind, Status,
    control::OBSERVE,
    sections::{SectionWriter, id},
};

use super::{
    error::ObserveError,
    link::Link,
    mesh::ObservedMesh,
    observation::Observation,
    sessions::{ObservedProcess, ObservedSession, ObserverOptions, connect, list},
};
use crate::{
    client::Client,
    control::{Backoff, Pending, RETRY, RawReply, deadline_in},
    error::RequestError,
};

/// Watches one session. Any thread may use it, one at a time.
///
/// The session does not wait for it: frames that come while nobody calls [`latest`](Self::latest) take each other's
/// place. The first observation is that of the first frame after the opening.
#[derive(Debug)]
pub struct Observer {
    link: Link,
    mesh: ObservedMesh,
    session: ObservedSession,
    /// Which one of its host's sessions of this size it is, counted by their ids.
    place: usize,
    /// Frames that the session had answered with the last observation, or at the opening.
    num_frames: u64,
    options: ObserverOptions,
}

impl Observer {
    /// Begins to watch a session, by its id.
    ///
    /// Cost: two requests and one for each 64 KiB of the mesh, 12 bytes a face.
    ///
    /// # Errors
    /// [`ObserveError`]; in particular [`RequestError::Refused`] where there is no such session, and with
    /// [`Status::TooManyObservers`] where the daemon may not open as many files as one more observer takes.
    pub fn open(options: ObserverOptions, session: u64) -> Result<Self, ObserveError> {
        let client = connect(&options)?;
        let found = list(&client)?;
        let Some(chosen) = found.iter().find(|known| known.session == session) else {
            let message = format!("there is no session {session}");
            return Err(RequestError::Refused { status: Status::UnknownSession, message }.into());
        };
        Self::begin(&client, options, chosen, &found)
    }

    fn begin(
        client: &Client,
        options: ObserverOptions,
        session: &ObservedSession,
        all: &[ObservedSession],
    ) -> Result<Self, ObserveError> {
        let place = all.iter().filter(|other| is_like(other, session)).take_while(|other| *other != session).count();
        let (instance, mesh) = ask(client, &options, session.session)?;
        let connection = client.connection();
        let link = Link::open(connection.node(), connection.domain(), instance, session.session)?;
        Ok(Self { link, mesh, place, num_frames: session.num_frames, session: session.clone(), options })
    }

    /// Watches the session that takes the place of one that has ended: of the same host, of the same size, and among
    /// several of those the same one by the order of registration. Waits for it up to `timeout`.
    ///
    /// # Errors
    /// [`ObserveError`], of the last attempt: that there is no daemon, or that its host has no such session.
    pub fn reopen(&mut self, timeout: Duration) -> Result<(), ObserveError> {
        let deadline = deadline_in(timeout);
        loop {
            let left = deadline.saturating_duration_since(Instant::now());
            let options = ObserverOptions { timeout: left.min(self.options.timeout), ..self.options.clone() };
            match self.follow(options) {
                Ok(next) => {
                    *self = next;
                    return Ok(());
                }
                Err(error) if Instant::now() >= deadline => return Err(error),
                Err(_) => std::thread::sleep(RETRY),
            }
        }
    }

    fn follow(&self, options: ObserverOptions) -> Result<Self, ObserveError> {
        let client = connect(&options)?;
        let found = list(&client)?;
        let next = found.iter().filter(|session| is_like(session, &self.session)).nth(self.place);
        let next = next.ok_or_else(|| ObserveError::SessionEnded {
            session: self.session.session,
            domain: client.domain().name().to_owned(),
        })?;
        Self::begin(&client, self.options.clone(), next, &found)
    }

    /// The session, as it was when it was opened.
    #[must_use]
    pub fn session(&self) -> &ObservedSession {
        &self.session
    }

    /// What stays the same: triangles, bodies, layers, pins.
    #[must_use]
    pub fn mesh(&self) -> &ObservedMesh {
        &self.mesh
    }

    /// The newest frame that was not seen yet, copied; waits for one up to `timeout`. None where none has come.
    ///
    /// Cost: a copy of 28 bytes for each vertex, and of the paths.
    ///
    /// # Errors
    /// [`ObserveError::SessionEnded`] and [`ObserveError::DaemonGone`] at the end;
    /// [`ObserveError::Malformed`] for a frame that can't be right, after which others may come.
    pub fn latest(&mut self, timeout: Duration) -> Result<Option<Observation>, ObserveError> {
        let deadline = deadline_in(timeout);
        let mut backoff = Backoff::new();
        loop {
            if let Some(seen) = self.link.receive(&self.mesh)? {
                return Ok(Some(self.count(seen)));
            }
            self.link.check()?;
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            self.link.sleep(&mut backoff, left);
        }
    }

    fn count(&mut self, mut seen: Observation) -> Observation {
        let num_frames = seen.num_frames();
        seen.num_dropped = num_frames.saturating_sub(self.num_frames).saturating_sub(1);
        self.num_frames = num_frames;
        seen
    }
}

/// Whether two sessions are of one host, and of one size.
fn is_like(one: &ObservedSession, other: &ObservedSession) -> bool {
    let host = |session: &ObservedSession| session.host.as_ref().map(|ObservedProcess { pid, .. }| *pid);
    let size = |session: &ObservedSession| (session.num_vertices, session.num_faces);
    host(one) == host(other) && size(one) == size(other)
}

/// Fetches a session's mesh, from which on its views are published. Gives back the daemon's run as well.
fn ask(client: &Client, options: &ObserverOptions, session: u64) -> Result<(u64, ObservedMesh), ObserveError> {
    if !client.daemon().features.iter().any(|name| name == OBSERVE) {
        return Err(ObserveError::TooOld { domain: client.domain().name().to_owned() });
    }
    let malformed = |what: String| ObserveError::Malformed { session, what };
    let mut bytes = Vec::new();
    loop {
        let RawReply { header, payload } = ask_part(client, options, session, bytes.len() as u64)?;
        bytes.extend_from_slice(&payload);
        if bytes.len() as u64 >= header.num_bytes {
            let mesh = ObservedMesh::read(&bytes).map_err(malformed)?;
            return Ok((header.instance, mesh));
        }
        if payload.is_empty() {
            return Err(malformed("a part of its mesh is empty".to_owned()));
        }
        if bytes.len() as u64 > ObservedMesh::MOST_BYTES {
            return Err(malformed("its mesh is larger than any".to_owned()));
        }
    }
}

/// Asks for the part of a session's mesh that begins at a byte.
fn ask_part(client: &Client, options: &ObserverOptions, session: u64, from: u64) -> Result<RawReply, ObserveError> {
    let connection = client.connection();
    let mut writer = SectionWriter::default();
    writer.bytes(id::FROM, from.to_le_bytes().to_vec());
    if let Some(name) = &options.name {
        writer.bytes(id::NAME, name.clone().into_bytes());
    }
    let (payload, num_sections) = writer.finish();
    let header = RequestHeader {
        protocol_version: PROTOCOL_VERSION,
        kind: RequestKind::Observe as u32,
        session,
        num_sections,
        ..RequestHeader::default()
    };
    let pending = Pending::forward(connection, &header, &payload)?;
    let reply = pending.wait_raw(connection, deadline_in(options.timeout))?;
    match Status::from_code(reply.header.status) {
        Some(Status::Ok) => Ok(reply),
        status => {
            let message = String::from_utf8_lossy(&reply.payload).into_owned();
            Err(RequestError::Refused { status: status.unwrap_or(Status::Internal), message }.into())
        }
    }
}
