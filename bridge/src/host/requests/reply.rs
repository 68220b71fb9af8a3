//! What a host is answered.

use iceoryx2::prelude::EventId;
use untangled_proto::{PROTOCOL_VERSION, PayloadLayout, ReplyHeader, memory::reply_sample_bytes, names};
use untangled_transport::{memory, throttle::Throttle};

use crate::host::{
    front::{Pending, REPLY_BYTES},
    shared::Shared,
};

/// The content of a reply.
pub(super) struct Answer {
    pub(super) header: ReplyHeader,
    pub(super) payload: Vec<u8>,
}

/// Sends a reply, and logs where that fails.
pub(super) fn reply(shared: &Shared, pending: &Pending, token: [u64; 2], layout: PayloadLayout, answer: &Answer) {
    if let Err(reason) = send(shared, pending, token, layout, answer) {
        static LOST: Throttle = Throttle::new();
        if let Some(num_suppressed) = LOST.admit() {
            // Most likely the client is gone; a session that it registered ends when no host comes.
            tracing::info!(reason, num_suppressed, "sending a reply");
        }
    }
}

fn send(
    shared: &Shared,
    pending: &Pending,
    token: [u64; 2],
    layout: PayloadLayout,
    answer: &Answer,
) -> Result<(), String> {
    let length = answer.payload.len();
    // Times 2, since samples grow by powers of two. Only the pages that are written to are taken.
    if length > REPLY_BYTES && memory::free().is_ok_and(|free| free < reply_sample_bytes(2 * length, layout)) {
        return Err("/dev/shm is full".to_owned());
    }
    let says = |error: &dyn std::fmt::Debug| format!("iceoryx2 reports {error:?}");
    let mut reply = pending.loan_slice_uninit(length).map_err(|error| says(&error))?;
    let header = ReplyHeader { token, ..answer.header };
    let from_daemon = header.instance != 0;
    *reply.user_header_mut() = ReplyHeader {
        protocol_version: if from_daemon { header.protocol_version } else { PROTOCOL_VERSION },
        instance: shared.instance,
        ..header
    };
    reply.write_from_slice(&answer.payload).send().map_err(|error| says(&error))?;
    // An error means that the client is gone.
    let _ = shared.reply_notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPLY));
    Ok(())
}
