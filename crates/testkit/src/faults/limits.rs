//! Requests with fields at their limits and beyond: each gets one reply.

use untangled_proto::{RequestHeader, RequestKind, Status};

use super::{
    limit_cases::limit_cases,
    row::Row,
    witness::{bystanders, finish},
};
use crate::process::{Programs, RawPeer, header};

/// Every field of every request at its limits and beyond them, and text that is none.
pub fn request_limits(programs: Programs) -> Row {
    let mut row = Row { what: "request with a field at its limits or beyond".into(), ..Row::default() };
    let (domain, daemon, witness) = bystanders(programs);
    let peer = RawPeer::new(&domain);
    for (request, payload) in limit_cases() {
        row.num_tries += 1;
        let Some((reply, text)) = peer.request(request, &payload) else {
            row.num_lost += 1;
            continue;
        };
        let known = Status::from_code(reply.status).is_some_and(|status| status != Status::Internal);
        let in_words = reply.status == 0 || !text.is_empty();
        if !known || !in_words || reply.token != request.token || std::str::from_utf8(&text).is_err() {
            eprintln!("{request:?}: {reply:?} {}", String::from_utf8_lossy(&text));
            row.num_wrong += 1;
        }
        if reply.status == 0 && request.kind == RequestKind::Register as u32 {
            let close = RequestHeader { session: reply.session, ..header(RequestKind::Close as u32, 0) };
            row.num_lost += u64::from(peer.request(close, &[]).is_none_or(|(reply, _)| reply.status != 0));
        }
    }
    row.note = "each got one reply, a refusal in words where it was due".into();
    drop(peer);
    finish(&domain, daemon, witness, &mut row);
    row
}
