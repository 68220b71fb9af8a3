//! Messages that the other end may not have.
//!
//! A connection that breaks loses what is on its way, and nobody tells. The newest message of each sort is kept until
//! the other end says that it has it, and is sent again when it has said nothing for long. Messages are counted by
//! reference: keeping one copies nothing.

use std::time::{Duration, Instant};

use zenoh::bytes::ZBytes;

use super::window::LOST;
use crate::wire::message::{ENVELOPE_BYTES, Envelope, Kind};

/// Longest time before a message is sent once more: on a link that takes longer for one, copies would fill it.
const LONGEST_WAIT: Duration = Duration::from_secs(16);

/// The newest message of each sort: paths, which a frame's correction follows; states or corrections; repairs.
#[derive(Debug, Default)]
pub(super) struct Unacknowledged([Option<Kept>; 3]);

#[derive(Debug)]
struct Kept {
    message: Message,
    since: Instant,
    /// How long its acknowledgement is waited for.
    wait: Duration,
}

/// A message as it was sent.
#[derive(Clone, Debug)]
pub(super) struct Message {
    pub(super) kind: Kind,
    pub(super) sequence: u64,
    /// Envelope, perhaps of an earlier number, and body.
    pub(super) bytes: ZBytes,
}

impl Message {
    /// The bytes with an envelope of this number.
    pub(super) fn numbered(&self, link: u64) -> ZBytes {
        let bytes = self.bytes.to_bytes();
        let body = &bytes[ENVELOPE_BYTES..];
        let mut message = Envelope { kind: self.kind, link, sequence: self.sequence }.begin(body.len());
        message.extend_from_slice(body);
        ZBytes::from(message)
    }
}

impl Unacknowledged {
    /// A message leaves, in the place of the one before it of its sort.
    pub(super) fn keep(&mut self, message: Message, now: Instant) {
        self.keep_for(message, now, LOST);
    }

    fn keep_for(&mut self, message: Message, now: Instant, wait: Duration) {
        if let Some(sort) = sort(message.kind) {
            self.0[sort] = Some(Kept { message, since: now, wait });
        }
    }

    /// The other end has all messages up to this one.
    pub(super) fn acknowledge(&mut self, sequence: u64) {
        for kept in &mut self.0 {
            kept.take_if(|kept| kept.message.sequence <= sequence);
        }
    }

    /// The next message that was waited for in vain, if there is one. It is kept on under the number `sequence`, under
    /// which it has to leave: the other end takes no number below the newest that it has seen.
    pub(super) fn take_lost(&mut self, sequence: u64, now: Instant) -> Option<Message> {
        let is_lost = |kept: &Kept| now.duration_since(kept.since) > kept.wait;
        let lost = self.0.iter_mut().find_map(|kept| kept.take_if(|kept| is_lost(kept)))?;
        let message = Message { sequence, bytes: lost.message.bytes, ..lost.message };
        self.keep_for(message.clone(), now, (2 * lost.wait).min(LONGEST_WAIT));
        Some(message)
    }
}

fn sort(kind: Kind) -> Option<usize> {
    match kind {
        Kind::Paths => Some(0),
        Kind::State | Kind::Dense | Kind::Sparse => Some(1),
        Kind::Repair => Some(2),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn message(kind: Kind, sequence: u64) -> Message {
        Message { kind, sequence, bytes: ZBytes::from(vec![0; 24]) }
    }

    #[test]
    fn newest_of_each_sort_is_sent_again_paths_before_their_correction_and_ever_more_rarely() {
        let mut unacknowledged = Unacknowledged::default();
        let now = Instant::now();
        for (kind, sequence) in [(Kind::Sparse, 1), (Kind::Repair, 2), (Kind::Paths, 3), (Kind::Sparse, 4)] {
            unacknowledged.keep(message(kind, sequence), now);
        }
        assert!(unacknowledged.take_lost(5, now + SECOND).is_none(), "not yet");
        let at = now + 3 * SECOND;
        let again: Vec<Kind> =
            (5..9).map_while(|sequence| unacknowledged.take_lost(sequence, at)).map(|message| message.kind).collect();
        assert_eq!(again, [Kind::Paths, Kind::Sparse, Kind::Repair]);
        assert!(unacknowledged.take_lost(9, at + 3 * SECOND).is_none(), "twice as long as the first time");
        unacknowledged.acknowledge(6);
        let left = unacknowledged.take_lost(9, at + 5 * SECOND).map(|message| (message.kind, message.sequence));
        assert_eq!(left, Some((Kind::Repair, 9)));
    }

    #[test]
    fn what_came_or_was_overtaken_is_not_sent_again() {
        let mut unacknowledged = Unacknowledged::default();
        let now = Instant::now();
        unacknowledged.keep(message(Kind::State, 1), now);
        unacknowledged.keep(message(Kind::State, 2), now);
        unacknowledged.acknowledge(1);
        assert!(unacknowledged.0[1].is_some());
        unacknowledged.acknowledge(2);
        assert!(unacknowledged.take_lost(3, now + 9 * SECOND).is_none());
    }
}
