//! One request to the daemon and its reply.

use std::time::{Duration, Instant};

use iceoryx2::{
    identifiers::UniqueServerId,
    pending_response::PendingResponse,
    port::{client::Client as RequestPort, listener::Listener},
};
use untangled_proto::{PROTOCOL_VERSION, ReplyHeader, RequestHeader, RequestKind, Status, memory, names};
use untangled_transport::services::Ipc;

use super::{
    connection::Connection,
    poll::{Backoff, deadline_in},
    room::{check_memory, commit_memory},
};
use crate::error::RequestError;

/// A request that was sent. It has a port of its own, so that the memory of a large registration is freed after the
/// reply.
#[derive(Debug)]
pub struct Pending {
    response: PendingResponse<Ipc, [u8], RequestHeader, [u8], ReplyHeader>,
    listener: Listener<Ipc>,
    _port: RequestPort<Ipc, [u8], RequestHeader, [u8], ReplyHeader>,
    server: UniqueServerId,
    token: [u64; 2],
    pub(crate) sent: Instant,
}

/// A reply as it came: of any status, its payload not looked at.
#[derive(Clone, Debug)]
pub struct RawReply {
    /// Its header.
    pub header: ReplyHeader,
    /// Its payload.
    pub payload: Vec<u8>,
}

/// A reply with status 0.
#[derive(Clone, Debug)]
pub(crate) struct Reply {
    pub(crate) header: ReplyHeader,
    pub(crate) text: String,
}

/// How long a request that changes nothing waits for its reply before it is sent again; each time twice as long.
const FIRST_PATIENCE: Duration = Duration::from_secs(1);

/// Sends a request that changes nothing and waits for its reply, up to the deadline. Where none comes it is sent again,
/// over a port of its own: on an overloaded machine, while other clients were killed, one was never replied to.
pub(crate) fn ask(connection: &Connection, kind: RequestKind, deadline: Instant) -> Result<Reply, RequestError> {
    let begin = Instant::now();
    let mut patience = FIRST_PATIENCE;
    loop {
        let pending = Pending::send(connection, kind, 0, &[], 0)?;
        if let Some(reply) = pending.poll(connection, deadline.min(deadline_in(patience)))? {
            return Ok(reply);
        }
        if Instant::now() >= deadline {
            return Err(late(connection, begin));
        }
        patience *= 2;
    }
}

fn late(connection: &Connection, since: Instant) -> RequestError {
    RequestError::Timeout { domain: connection.domain.name().to_owned(), waited: since.elapsed() }
}

impl Pending {
    /// Sends a request and wakes the daemon.
    pub(crate) fn send(
        connection: &Connection,
        kind: RequestKind,
        session: u64,
        payload: &[u8],
        num_sections: u32,
    ) -> Result<Self, RequestError> {
        let header = RequestHeader {
            protocol_version: PROTOCOL_VERSION,
            kind: kind as u32,
            session,
            num_sections,
            ..RequestHeader::default()
        };
        Self::forward(connection, &header, payload)
    }

    /// Sends a request as somebody else made it, under a token of its own, and wakes the daemon.
    ///
    /// # Errors
    /// [`RequestError`]: there is no daemon, or no memory for the request.
    pub fn forward(connection: &Connection, header: &RequestHeader, payload: &[u8]) -> Result<Self, RequestError> {
        let server = connection.server().ok_or_else(|| RequestError::no_daemon(&connection.domain))?;
        let needed = memory::request_segment_bytes(payload.len(), connection.layout);
        check_memory(needed)?;
        // Listening begins before the request leaves, so that the reply's event can't be missed.
        let listener = connection
            .replies
            .listener_builder()
            .create()
            .map_err(|error| RequestError::transport("creating a listener", &error))?;
        let port = connection
            .requests
            .client_builder()
            .initial_max_slice_len(payload.len().max(1))
            // It sends one request.
            .override_request_preallocation(|_| memory::REQUEST_SAMPLES)
            .create()
            .map_err(|error| RequestError::transport("creating a request port", &error))?;
        commit_memory(&connection.domain, port.id().value(), needed)?;
        let token = halves(port.id().value());
        let mut request = port
            .loan_slice_uninit(payload.len())
            .map_err(|error| RequestError::transport("loaning a request", &error))?;
        *request.user_header_mut() = RequestHeader { token, ..*header };
        let response = request
            .write_from_slice(payload)
            .send()
            .map_err(|error| RequestError::transport("sending a request", &error))?;
        connection.wake(names::EVENT_REQUEST);
        Ok(Self { response, listener, _port: port, server, token, sent: Instant::now() })
    }

    /// Waits for the reply, up to the deadline. Without a reply the request is still open: call again, or drop it.
    pub(crate) fn poll(&self, connection: &Connection, deadline: Instant) -> Result<Option<Reply>, RequestError> {
        let Some(RawReply { header, payload }) = self.poll_raw(connection, deadline)? else { return Ok(None) };
        let text = String::from_utf8_lossy(&payload).into_owned();
        match Status::from_code(header.status) {
            Some(Status::Ok) => Ok(Some(Reply { header, text })),
            status => Err(RequestError::Refused { status: status.unwrap_or(Status::Internal), message: text }),
        }
    }

    /// Waits for the reply, up to the deadline, and takes a refusal for a reply as well.
    ///
    /// # Errors
    /// [`RequestError`]: the daemon went away.
    pub fn poll_raw(&self, connection: &Connection, deadline: Instant) -> Result<Option<RawReply>, RequestError> {
        let mut backoff = Backoff::new();
        loop {
            if let Some(reply) = self.receive()? {
                return Ok(Some(reply));
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(None);
            }
            // Another server is another daemon, which has not seen the request.
            if connection.server() != Some(self.server) {
                return Err(RequestError::no_daemon(&connection.domain));
            }
            backoff.sleep(&self.listener, left);
        }
    }

    /// Waits for the reply, up to the deadline; then the request is dropped.
    pub(crate) fn wait(self, connection: &Connection, deadline: Instant) -> Result<Reply, RequestError> {
        self.poll(connection, deadline)?.ok_or_else(|| late(connection, self.sent))
    }

    /// As [`wait`](Self::wait), and takes a refusal for a reply as well.
    pub(crate) fn wait_raw(self, connection: &Connection, deadline: Instant) -> Result<RawReply, RequestError> {
        self.poll_raw(connection, deadline)?.ok_or_else(|| late(connection, self.sent))
    }

    fn receive(&self) -> Result<Option<RawReply>, RequestError> {
        let response = loop {
            let received = self.response.receive();
            match received.map_err(|error| RequestError::transport("receiving a reply", &error))? {
                Some(response) if response.user_header().token == self.token => break response,
                // A late reply to a client that is gone, whose slot this one took.
                Some(_) => {}
                None => return Ok(None),
            }
        };
        Ok(Some(RawReply { header: *response.user_header(), payload: response.payload().to_vec() }))
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the lower half is what is wanted")]
fn halves(id: u128) -> [u64; 2] {
    [id as u64, (id >> 64) as u64]
}
