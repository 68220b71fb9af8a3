//! The messages between the two ends of a bridge.

use std::fmt::Debug;

use untangled_bridge_wire::{
    beacon::{self, DaemonBeacon, HostBeacon, Versions},
    element::Element,
    elements::Pins,
    message::{Envelope, Kind},
    plain,
    request::{Reply, Request, Services},
};
use untangled_proto::{PositionF32, PositionF64, ReplyHeader, RequestHeader, VertexCorrection};
use untangled_testkit::fuzz::bytes::ByteTarget;

/// What crosses the network; the first byte says what the others are taken for.
pub(crate) const TARGET: ByteTarget = ByteTarget { name: "bridge", read, seeds };

const ENVELOPE: u8 = 0;
const REQUEST: u8 = 1;
const REPLY: u8 = 2;
const DAEMON_BEACON: u8 = 3;
const HOST_BEACON: u8 = 4;
const CORRECTIONS: u8 = 5;
const SINGLES: u8 = 6;
const DOUBLES: u8 = 7;

fn read(bytes: &[u8]) -> bool {
    let Some((&kind, bytes)) = bytes.split_first() else { return false };
    match kind % 8 {
        ENVELOPE => envelope(bytes),
        REQUEST => comes_back(bytes, Request::read(bytes), |request| request.to_bytes(), &(2..8)),
        REPLY => reply(bytes),
        DAEMON_BEACON => beacon::<DaemonBeacon>(bytes),
        HOST_BEACON => beacon::<HostBeacon>(bytes),
        CORRECTIONS => elements::<VertexCorrection>(bytes),
        SINGLES => elements::<PositionF32>(bytes),
        _ => elements::<PositionF64>(bytes),
    }
}

/// What was read, written, has the same bytes, but for those that say nothing.
fn comes_back<T>(bytes: &[u8], read: Option<T>, write: impl Fn(&T) -> Vec<u8>, zeros: &std::ops::Range<usize>) -> bool {
    let Some(read) = read else { return false };
    let mut meant = bytes.to_vec();
    meant[zeros.clone()].fill(0);
    assert_eq!(write(&read), meant, "what was read is written back");
    true
}

fn envelope(bytes: &[u8]) -> bool {
    let write = |(envelope, body): &(Envelope, &[u8])| {
        let mut written = envelope.begin(body.len());
        written.extend_from_slice(body);
        written
    };
    comes_back(bytes, Envelope::read(bytes), write, &(4..8))
}

/// A reply is read again as it was read: words may have been mended, services of a refusal say nothing.
fn reply(bytes: &[u8]) -> bool {
    let Some(reply) = Reply::read(bytes) else { return false };
    let written = reply.to_bytes();
    let again = Reply::read(&written).expect("what was written is read");
    // As bytes: a number in a header may be none.
    assert_eq!(again.to_bytes(), written, "a reply comes back");
    if matches!(reply, Reply::Answered { .. }) {
        comes_back(bytes, Some(reply), Reply::to_bytes, &(8..16));
    }
    true
}

fn beacon<B: serde::Serialize + for<'a> serde::Deserialize<'a> + PartialEq + Debug>(bytes: &[u8]) -> bool {
    let Some(read) = beacon::from_bytes::<B>(bytes) else { return false };
    let written = beacon::to_bytes(&read);
    // Unknown fields are left out; escapes in text may be longer than what they stand for.
    if written.len() <= beacon::MAX_BYTES {
        assert_eq!(beacon::from_bytes::<B>(&written).as_ref(), Some(&read), "a beacon comes back");
    }
    true
}

/// Number of elements, length of a first message of the same link, and that message and a second one. What is accepted
/// has indices in range, and crosses again with the same result.
fn elements<E: Element + Debug>(bytes: &[u8]) -> bool {
    let Some((&[num_elements, length], rest)) = bytes.split_first_chunk::<2>() else { return false };
    let num_elements = usize::from(num_elements % 40);
    let (first, second) = rest.split_at(usize::from(length).min(rest.len()));
    let mut pins = Pins::default();
    let (mut from, mut to) = (Pins::default(), Pins::default());
    let mut is_accepted = false;
    for message in [first, second] {
        let Some(all) = all_elements::<E>(&mut pins, message, num_elements) else { continue };
        is_accepted = true;
        let mut written = Vec::new();
        from.write(&all, &mut written);
        let again = all_elements::<E>(&mut to, &written, num_elements).expect("what was written is read");
        assert_eq!(plain::bytes_of(&again), plain::bytes_of(&all), "elements come back to the bit");
        assert!(written.len() <= 16 + size_of_val(all.as_slice()), "no form is longer than all elements");
    }
    is_accepted
}

fn all_elements<E: Element>(pins: &mut Pins, message: &[u8], num_elements: usize) -> Option<Vec<E>> {
    let read = pins.read::<E>(message, num_elements).ok()?;
    let mut all: Vec<E> = (0..num_elements).map(|index| pins.rest(&read, index)).collect();
    for (index, element) in read.entries() {
        all[index] = element;
    }
    Some(all)
}

fn seeds() -> Vec<Vec<u8>> {
    let tagged = |tag: u8, bytes: Vec<u8>| [vec![tag], bytes].concat();
    let envelope = Envelope { kind: Kind::Sparse, link: 0x0123_4567_89ab_cdef, sequence: 7 };
    let request = Request { link: 7, header: RequestHeader { kind: 2, ..RequestHeader::default() }, payload: &[9; 5] };
    let services = Services::default().with(Services::SPARSE, true);
    let replies = [
        Reply::Answered { services, header: ReplyHeader::default(), payload: b"words".to_vec() },
        Reply::NoDaemon("none".into()),
        Reply::Refused("too many".into()),
    ];
    let versions = Versions::own();
    let daemon = DaemonBeacon { versions: versions.clone(), run: 1, instance: 2, num_faces: 3, num_workers: 4 };
    let host = HostBeacon { versions, run: u64::MAX, links: vec![1, u64::MAX] };
    let mut all = vec![
        tagged(ENVELOPE, envelope.begin(0)),
        tagged(REQUEST, request.to_bytes()),
        tagged(DAEMON_BEACON, beacon::to_bytes(&daemon)),
        tagged(HOST_BEACON, beacon::to_bytes(&host)),
    ];
    all.extend(replies.iter().map(|reply| tagged(REPLY, reply.to_bytes())));
    let rest = VertexCorrection::default();
    let pinned = VertexCorrection { flags: 8, ..rest };
    let moved = VertexCorrection { value: [-0.0, 1.0, f32::NAN], flags: 9 };
    all.push(tagged(CORRECTIONS, two_messages(&[pinned, rest, moved, pinned, pinned, pinned, pinned, pinned, rest])));
    all.push(tagged(CORRECTIONS, two_messages(&[moved; 3])));
    all.push(tagged(SINGLES, two_messages(&[PositionF32([0.0; 3]), PositionF32([1.0, 2.0, -0.0])])));
    all.push(tagged(DOUBLES, two_messages(&[PositionF64([0.0; 3]), PositionF64([1.0, 2.0, -0.0])])));
    all
}

fn two_messages<E: Element>(elements: &[E]) -> Vec<u8> {
    let mut pins = Pins::default();
    let mut first = Vec::new();
    pins.write(elements, &mut first);
    let mut bytes = vec![u8::try_from(elements.len()).unwrap_or(0), u8::try_from(first.len()).unwrap_or(0)];
    bytes.append(&mut first);
    pins.write(elements, &mut bytes);
    bytes
}
