//! Places for sessions: who drops a session, or ends, keeps nobody out.

use std::{
    sync::OnceLock,
    time::{Duration, Instant},
};

use untangled_client::{RegisterError, RequestError, Status};
use untangled_proto::{
    RegisterParams, RequestKind,
    limits::MAX_SESSIONS,
    sections::{SectionWriter, id},
};
use untangled_testkit::process::{
    Daemon, PATIENCE, RawPeer, STEP, TestDomain, eventually, fill_flat, header, serve, sheet,
};

fn open_sessions(domain: &TestDomain) -> usize {
    domain.connect().status().unwrap()["sessions"].as_array().unwrap().len()
}

/// Asks for a session and never makes its ports.
fn register_only(peer: &RawPeer) -> (Status, String) {
    let params = RegisterParams { num_vertices: 3, precision: 0, correction: 3, ..RegisterParams::default() };
    let mut writer = SectionWriter::default();
    writer.bytes(id::PARAMS, params.to_bytes().to_vec()).u32s(id::TRIANGLES, &[[0, 1, 2]]);
    let (payload, num_sections) = writer.finish();
    let (reply, words) = peer.expect_reply(header(RequestKind::Register as u32, num_sections), &payload);
    (Status::from_code(reply.status).unwrap(), words)
}

#[test]
fn sessions_that_are_dropped_at_once_free_their_places() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    // Where they did not, the 65th would be refused.
    for _ in 0..2 * MAX_SESSIONS {
        drop(client.register(sheet(1)).unwrap());
    }
    client.register(sheet(1)).unwrap().exchange(STEP, PATIENCE, fill_flat).unwrap();
    eventually("no session is left", || open_sessions(&domain) == 0);
}

#[test]
fn client_that_registers_without_end_keeps_no_other_out() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let peer = RawPeer::new(&domain);
    let (opened, refused): (Vec<_>, Vec<_>) =
        (0..MAX_SESSIONS).map(|_| register_only(&peer)).partition(|(status, _)| *status == Status::Ok);
    assert!(opened.len() < MAX_SESSIONS / 2 && !refused.is_empty(), "{} were opened", opened.len());
    let (status, words) = &refused[0];
    assert_eq!(*status, Status::TooManySessions);
    assert!(words.contains("of this client") && words.contains("state publisher"), "{words}");
}

/// The client is a process of its own, which is killed.
#[test]
fn sessions_of_a_client_that_ends_before_its_first_state_are_closed() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let mut other = untangled_testkit::process::this_test(module_path!(), "registering_process");
    assert!(other.env("PLACES_TEST_DOMAIN", domain.name()).status().unwrap().success());
    let begin = Instant::now();
    eventually("its sessions are closed", || open_sessions(&domain) == 0);
    assert!(begin.elapsed() < Duration::from_secs(5), "{:?}", begin.elapsed());
}

/// Does nothing where it is run as a test.
#[test]
#[ignore = "run as a process of its own by another test"]
fn registering_process() {
    let Ok(name) = std::env::var("PLACES_TEST_DOMAIN") else { return };
    // Not to be cleaned up: it is that of the other process.
    static DOMAIN: OnceLock<TestDomain> = OnceLock::new();
    let domain = DOMAIN.get_or_init(|| TestDomain(untangled_transport::Domain::locate(Some(&name)).unwrap()));
    let peer = RawPeer::new(domain);
    (0..5).for_each(|_| assert_eq!(register_only(&peer).0, Status::Ok));
}

#[test]
fn sessions_beyond_the_limit_of_a_client_are_refused_in_words() {
    let domain = TestDomain::new();
    let mut command = serve(&domain);
    command.env("UNTANGLED_LIMITS__MAX_SESSIONS_PER_CLIENT", "2");
    let _daemon = Daemon::start_as(command);
    let client = domain.connect();
    let _two = [client.register(sheet(1)).unwrap(), client.register(sheet(1)).unwrap()];
    match client.register(sheet(1)) {
        Err(RegisterError::Request(RequestError::Refused { status: Status::TooManySessions, message })) => {
            assert_eq!(message, "2 sessions of this client are open already");
        }
        other => panic!("{other:?}"),
    }
}
