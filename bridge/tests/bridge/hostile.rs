//! What a peer on the network may send: other lengths, counts, kinds and names, and floods of them.

use std::time::{Duration, Instant};

use untangled_bridge::{
    net::{Endpoint, Network, Side, open},
    wire::{
        keys,
        message::{Envelope, Kind},
        plain,
        request::{Reply, Request},
    },
};
use untangled_bridge_lab::{
    cloth::Sheets,
    ends::{Bridged, PATIENCE},
};
use untangled_client::{Session, StepTime};
use untangled_proto::{PROTOCOL_VERSION, RequestHeader, RequestKind, StateHeader};
use zenoh::Wait;

/// Numbers that are the same in each run (xorshift, Marsaglia 2003).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn bytes(&mut self, most: u64) -> Vec<u8> {
        let length = self.next() % (most + 1);
        (0..length).map(|_| self.next() as u8).collect()
    }
}

fn peer(bridged: &Bridged, name: &str) -> zenoh::Session {
    let network = Network {
        side: Side::Host,
        name: name.to_owned(),
        listen: Vec::new(),
        connect: vec![Endpoint::parse(&bridged.address.to_string()).unwrap()],
        through_router: false,
        discovery: false,
        tls: None,
        hosts: Vec::new(),
        compression: false,
        max_message_bytes: 1 << 30,
    };
    let session = open(&network).unwrap();
    // Connected, and told who listens to what.
    let begin = Instant::now();
    while ask(&session, name, &hello(), Duration::from_secs(1)).is_none() {
        assert!(begin.elapsed() < PATIENCE, "the peer can't connect");
    }
    session
}

fn hello() -> Request<'static> {
    let header = RequestHeader {
        protocol_version: PROTOCOL_VERSION,
        kind: RequestKind::Hello as u32,
        ..RequestHeader::default()
    };
    Request { link: 0, header, payload: &[] }
}

fn ask(session: &zenoh::Session, host: &str, request: &Request<'_>, time: Duration) -> Option<Reply> {
    ask_bytes(session, host, request.to_bytes(), time)
}

fn ask_bytes(session: &zenoh::Session, host: &str, bytes: Vec<u8>, time: Duration) -> Option<Reply> {
    let replies = session.get(keys::requests("far", host)).payload(bytes).timeout(time).wait().unwrap();
    Reply::read(&replies.recv().ok()?.into_result().ok()?.payload().to_bytes())
}

fn exchange(session: &mut Session, sheets: &Sheets) -> Vec<[u32; 4]> {
    let positions = sheets.positions_f32(session.frame() + 1);
    let step = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };
    let answer = session.exchange(step, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap();
    let bits = |value: f32| value.to_bits();
    answer.vertices().iter().map(|v| [bits(v.value[0]), bits(v.value[1]), bits(v.value[2]), v.flags]).collect()
}

/// A message that no end of a bridge sends, and where it goes.
fn message(random: &mut Random) -> (String, Vec<u8>) {
    let key = match random.next() % 4 {
        0 => keys::host_beacon("far", "mallory"),
        1 => keys::up("far", "mallory", &keys::link(random.next() % 3)),
        // In the name of another host, which only certificates can hinder: it does not know the link.
        2 => keys::up("far", "near", &keys::link(random.next())),
        _ => keys::daemon_beacon("mallory"),
    };
    let mut bytes = match random.next() % 3 {
        0 => random.bytes(200),
        1 => Envelope { kind: Kind::State, link: random.next() % 3, sequence: random.next() }.begin(0),
        _ => br#"{"versions":{"bridge":1,"protocol":1,"library":"x","iceoryx2":"x"},"run":1,"instance":1}"#.to_vec(),
    };
    bytes.extend(random.bytes(100));
    (key, bytes)
}

#[test]
fn malformed_messages_and_requests_of_a_peer_change_nothing_for_others() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(8);
    let [mut own, mut far] = [&bridged.near_daemon, &bridged.near_host]
        .map(|domain| domain.connect().register(sheets.registration()).unwrap());
    let network = peer(&bridged, "mallory");
    let link = bridged.near_host.connect().status().unwrap()["bridge"]["sessions"][0]["link"].as_u64();
    assert_eq!(link, None, "links are not told");
    let mut random = Random(0x1234_5678_9abc_def1);
    let mut num_refused = 0;
    for round in 0..40 {
        for _ in 0..50 {
            let (key, bytes) = message(&mut random);
            network.put(key, bytes).wait().unwrap();
        }
        // A request with a field at its limits or beyond.
        let header = RequestHeader {
            protocol_version: if random.next().is_multiple_of(4) { random.next() as u32 } else { PROTOCOL_VERSION },
            kind: (random.next() % 8) as u32,
            session: 1 + random.next() % 2,
            num_sections: (random.next() % 40) as u32,
            ..RequestHeader::default()
        };
        let payload = random.bytes(300);
        let reply = ask(&network, "mallory", &Request { link: random.next(), header, payload: &payload }, PATIENCE);
        num_refused += u64::from(!matches!(&reply, Some(Reply::Answered { header, .. }) if header.status == 0));
        assert!(reply.is_some(), "each request gets one reply");
        assert!(ask_bytes(&network, "mallory", random.bytes(90), PATIENCE).is_some());
        assert_eq!(exchange(&mut own, &sheets), exchange(&mut far, &sheets), "round {round}");
    }
    println!("{num_refused} of 40 requests refused");
    assert!(num_refused > 20);
}

#[test]
fn another_host_can_not_close_a_session_nor_send_its_states() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(8);
    let mut session = bridged.near_host.connect().register(sheets.registration()).unwrap();
    exchange(&mut session, &sheets);
    let network = peer(&bridged, "mallory");
    for kind in [RequestKind::Close, RequestKind::UpdateSettings] {
        let header = RequestHeader { kind: kind as u32, session: 1, ..hello().header };
        let reply = ask(&network, "mallory", &Request { link: 7, header, payload: &[] }, PATIENCE);
        assert!(matches!(&reply, Some(Reply::Refused(words)) if words.contains("no session 1")), "{reply:?}");
    }
    let header = StateHeader { frame: 99, dt_s: 1.0, num_vertices: 128, ..StateHeader::default() };
    for link in 0..100 {
        let mut message = Envelope { kind: Kind::State, link, sequence: u64::MAX }.begin(0);
        message.extend_from_slice(plain::bytes_of(&[header]));
        network.put(keys::up("far", "near", &keys::link(link)), message).wait().unwrap();
    }
    exchange(&mut session, &sheets);
    assert_eq!(session.num_registrations(), 1);
}

#[test]
fn flood_of_requests_and_states_is_refused_and_takes_no_memory() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(8);
    let mut session = bridged.near_host.connect().register(sheets.registration()).unwrap();
    let network = peer(&bridged, "mallory");
    let before = bridged.daemon_end.memory();
    let (sender, receiver) = std::sync::mpsc::channel();
    for _ in 0..2000 {
        let sender = sender.clone();
        let header = RequestHeader { kind: RequestKind::Status as u32, ..hello().header };
        network
            .get(keys::requests("far", "mallory"))
            .payload(Request { header, ..hello() }.to_bytes())
            .callback(move |reply| {
                let bytes = reply.into_result().map(|sample| sample.payload().to_bytes().into_owned());
                let _ = sender.send(bytes.ok().and_then(|bytes| Reply::read(&bytes)));
            })
            .wait()
            .unwrap();
    }
    drop(sender);
    let (mut answered, mut refused) = (0, 0);
    for reply in receiver {
        match reply {
            Some(Reply::Refused(words)) => {
                assert!(words.contains("requests of this host"), "{words}");
                refused += 1;
            }
            _ => answered += 1,
        }
    }
    let begin = Instant::now();
    exchange(&mut session, &sheets);
    println!("{answered} answered, {refused} refused; a frame beside it took {:?}", begin.elapsed());
    assert!(answered > 0 && refused > 0);
    let junk = vec![0; 1 << 16];
    for _ in 0..500 {
        network.put(keys::up("far", "mallory", &keys::link(1)), junk.clone()).wait().unwrap();
    }
    exchange(&mut session, &sheets);
    let grown = bridged.daemon_end.memory().saturating_sub(before);
    println!("the daemon end has grown by {grown} bytes");
    assert!(grown < 64_000_000, "{grown}");
}

#[test]
fn duplicates_and_late_messages_are_dropped() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(8);
    let [mut own, mut far] = [&bridged.near_daemon, &bridged.near_host]
        .map(|domain| domain.connect().register(sheets.registration()).unwrap());
    let network = peer(&bridged, "echo");
    // Sends all that a host end sends to the daemon end a second time, as a broken network might.
    let repeated = network.clone();
    let _states = network
        .declare_subscriber(keys::up("far", "near", "*"))
        .callback(move |sample| {
            let _ = repeated.put(sample.key_expr().clone(), sample.payload().clone()).wait();
        })
        .wait()
        .unwrap();
    for _ in 0..100 {
        assert_eq!(exchange(&mut own, &sheets), exchange(&mut far, &sheets));
    }
}
