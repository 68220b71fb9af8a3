//! What an observer asks for, and what the daemon says of it.

use std::process::Command;

use serde_json::Value;
use untangled_client::observe::{MAX_OBSERVERS, ObserveError, Observer, ObserverOptions, sessions};
use untangled_proto::{
    RequestHeader, RequestKind, Status,
    limits::MAX_NAME_BYTES,
    sections::{SectionWriter, id},
};
use untangled_testkit::process::{
    Daemon, PATIENCE, RawPeer, STEP, TestDomain, eventually, fill_flat, header, sheet, untangled,
};

use super::{observe, options};

#[test]
fn status_names_the_observers_of_each_session() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let session = client.register(sheet(4)).unwrap();
    let _other = client.register(sheet(5)).unwrap();
    let found = sessions(&options(&domain)).unwrap();
    assert_eq!(found[0].observers, []);
    assert_eq!(found[0].host.as_ref().unwrap().pid, std::process::id());
    let named = ObserverOptions { name: Some("a page".to_owned()), ..options(&domain) };
    let observer = Observer::open(named, found[0].session).unwrap();
    assert_eq!(observer.session().num_vertices, 25);
    let observers = || sessions(&options(&domain)).unwrap().remove(0).observers;
    let seen = observers();
    assert_eq!((seen.len(), seen[0].pid, seen[0].name.as_str()), (1, std::process::id(), "a page"));
    let run = |arguments: &[&str]| {
        let mut status = Command::new(untangled());
        let output = status.args(["status", "--domain", domain.name()]).args(arguments).output().unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let json: Value = serde_json::from_str(&run(&["--json"])).unwrap();
    assert_eq!(json["sessions"][0]["observers"][0]["name"], "a page");
    assert_eq!(json["sessions"][1]["observers"], Value::Array(Vec::new()));
    let line = format!("session 1 is watched by a page (process {})", std::process::id());
    let table = run(&[]);
    assert!(table.lines().any(|other| other == line), "{table}");
    drop(observer);
    eventually("the observer is gone", || observers().is_empty());
    assert!(!run(&[]).contains("watched"));
    drop(session);
}

#[test]
fn more_observers_than_may_watch_are_refused_in_words_until_one_leaves() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut session = domain.connect().register(sheet(4)).unwrap();
    let mut observers: Vec<_> = (0..MAX_OBSERVERS).map(|_| observe(&domain)).collect();
    let refused = Observer::open(options(&domain), observers[0].session().session).unwrap_err();
    assert!(matches!(refused, ObserveError::TooMany { .. }), "{refused}");
    assert_eq!(refused.to_string(), "session 1 is watched by 16 observers already, and by no more at a time");
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    for observer in &mut observers {
        assert_eq!(observer.latest(PATIENCE).unwrap().unwrap().frame(), 1);
    }
    observers.pop();
    observers.push(observe(&domain));
    session.exchange(STEP, PATIENCE, fill_flat).unwrap();
    for observer in &mut observers {
        assert_eq!(observer.latest(PATIENCE).unwrap().unwrap().frame(), 2);
    }
}

#[test]
fn requests_that_are_wrong_are_refused_in_words() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let session = domain.connect().register(sheet(4)).unwrap();
    let peer = RawPeer::new(&domain);
    let with = |name: &[u8]| {
        let mut writer = SectionWriter::default();
        writer.bytes(id::NAME, name.to_vec()).finish()
    };
    let kind = RequestKind::Observe as u32;
    let ask = |change: &dyn Fn(&mut RequestHeader), name: &[u8]| {
        let (payload, num_sections) = with(name);
        let mut header = RequestHeader { session: 1, ..header(kind, num_sections) };
        change(&mut header);
        peer.request(header, &payload).expect("a reply")
    };
    type Change<'a> = &'a dyn Fn(&mut RequestHeader);
    let refusals: [(Change<'_>, Vec<u8>, Status, &str); 5] = [
        (&|header| header.protocol_version = 2, vec![], Status::UnsupportedProtocol, "protocol 2, this daemon 1"),
        (&|header| header.session = 7, vec![], Status::UnknownSession, "there is no session 7"),
        (&|_| {}, vec![b'x'; MAX_NAME_BYTES + 1], Status::BadRequest, "has 65 bytes; at most 64 are allowed"),
        (&|_| {}, vec![0xff], Status::BadRequest, "must be UTF-8 without control characters"),
        (&|_| {}, b"a\nb".to_vec(), Status::BadRequest, "must be UTF-8 without control characters"),
    ];
    for (change, name, status, words) in refusals {
        let (reply, said) = ask(change, &name);
        let said = String::from_utf8(said).unwrap();
        assert_eq!(reply.status, status.code(), "{said}");
        assert!(said.contains(words), "{said}");
        assert_eq!(reply.num_bytes, 0);
    }
    let (reply, mesh) = ask(&|_| {}, b"x");
    // Two sections, of 25 vertices and 32 triangles.
    assert_eq!((reply.status, reply.num_bytes), (0, mesh.len() as u64));
    assert_eq!((mesh.len(), mesh[0]), (8 + 2 * 24 + 32 + 32 * 12, 2));
    let number = |from: u64| from.to_le_bytes().to_vec();
    for (from, length) in [(number(400), Some(72)), (number(473), None), (vec![0; 4], None)] {
        let (payload, num_sections) = SectionWriter::default().bytes(id::FROM, from).finish();
        let (reply, part) = peer.request(RequestHeader { session: 1, ..header(kind, num_sections) }, &payload).unwrap();
        if let Some(length) = length {
            assert_eq!((reply.status, reply.num_bytes, part.len()), (0, 472, length));
        } else {
            let said = String::from_utf8(part).unwrap();
            assert_eq!(reply.status, Status::BadRequest.code());
            assert_eq!(said, "section 13 (from) must be a number of 8 bytes, at most 472");
        }
    }
    assert!(matches!(
        Observer::open(options(&domain), 9).unwrap_err(),
        ObserveError::Request(error) if error.to_string().contains("there is no session 9")
    ));
    drop(session);
}
