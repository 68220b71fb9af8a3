//! Memory: what a session takes is what the formulas say, and an operator can limit it.

use std::time::{Duration, Instant};

use untangled_client::{RegisterError, Registration, RequestError, Status};
use untangled_proto::{PayloadLayout, Precision, SessionOptions, memory};
use untangled_testkit::process::{Daemon, KnownCloth, PATIENCE, STEP, TestDomain, eventually, fill_flat, serve, sheet};

use super::super::machine::busy;

#[test]
fn session_takes_the_shared_memory_that_the_formula_says() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    for (side, repairs) in [(3, false), (199, false), (199, true)] {
        let cloth = Registration { repairs, ..sheet(side) };
        let num_vertices = cloth.num_vertices;
        let options = if repairs { SessionOptions::REPAIR } else { SessionOptions::default() };
        let mut session = client.register(cloth).unwrap();
        session.exchange(STEP, PATIENCE, fill_flat).unwrap();
        // Until the request's resources are gone on both sides.
        let formula = memory::session_bytes(num_vertices, Precision::F32, PayloadLayout::Packed, options);
        let with = settled(&domain);
        drop(session);
        let without = settled(&domain);
        let taken = with - without;
        println!("{num_vertices} vertices: {taken} bytes taken, {formula} by the formula; {without} without");
        assert!(taken <= formula && formula - taken < 1 << 18, "{num_vertices} vertices took {taken}, not {formula}");
        assert!(without < 4 << 20, "a daemon without sessions has taken {without} bytes");
    }
}

/// Bytes of shared memory that the domain has taken, once they have not changed for half a second.
fn settled(domain: &TestDomain) -> u64 {
    let (mut bytes, mut since) = (domain.shared_bytes(), Instant::now());
    while since.elapsed() < Duration::from_millis(500) {
        std::thread::sleep(Duration::from_millis(20));
        let now = domain.shared_bytes();
        if now != bytes {
            (bytes, since) = (now, Instant::now());
        }
    }
    bytes
}

#[test]
fn daemon_takes_the_memory_of_a_session_that_it_estimates() {
    let _guard = busy();
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    let idle = daemon.memory();
    let cloth = KnownCloth::new(100_000);
    let registration = cloth.registration();
    let (num_vertices, num_faces) = (registration.num_vertices, registration.triangles.len());
    let mut session = client.register(registration).unwrap();
    for _ in 0..4 {
        cloth.exchange(&mut session, PATIENCE).unwrap();
    }
    let taken = daemon.memory() - idle;
    let estimate = untangled::service::session::memory_bytes(
        num_vertices,
        num_faces,
        Precision::F32,
        PayloadLayout::Packed,
        SessionOptions::default(),
    );
    println!("{num_vertices} vertices, {num_faces} faces: {taken} bytes taken, {estimate} estimated");
    assert!(taken < estimate && 2 * estimate < 5 * taken, "{taken} bytes taken, {estimate} estimated");
}

#[test]
fn daemon_takes_the_memory_of_a_repair_that_it_estimates() {
    let _guard = busy();
    let domain = TestDomain::new();
    let daemon = Daemon::start(&domain);
    let client = domain.connect();
    let idle = daemon.memory();
    let cloth = KnownCloth::new(6_000);
    let registration = Registration { repairs: true, ..cloth.registration() };
    let (num_vertices, num_faces) = (registration.num_vertices, registration.triangles.len());
    let mut session = client.register(registration).unwrap();
    session.ask_for_repair(None);
    session.publish(STEP, |slots| slots.copy_from_slice(cloth.positions(7))).unwrap();
    let mut most = 0;
    eventually("the repair is done", || {
        most = most.max(daemon.memory());
        session.poll_repair().unwrap().is_some_and(|repair| repair.is_certified())
    });
    let (taken, options) = (most - idle, SessionOptions::REPAIR);
    let layout = PayloadLayout::Packed;
    let estimate = untangled::service::session::memory_bytes(num_vertices, num_faces, Precision::F32, layout, options);
    println!("{num_vertices} vertices, {num_faces} faces: {taken} bytes taken, {estimate} estimated");
    assert!(taken < estimate && estimate < 8 * taken, "{taken} bytes taken, {estimate} estimated");
}

#[test]
fn session_beyond_the_memory_limit_is_refused_in_words() {
    let domain = TestDomain::new();
    let mut command = serve(&domain);
    command.env("UNTANGLED_LIMITS__MAX_SESSION_MEMORY_MB", "10");
    let _daemon = Daemon::start_as(command);
    let client = domain.connect();
    client.register(sheet(10)).unwrap().exchange(STEP, PATIENCE, fill_flat).unwrap();
    match client.register(sheet(200)) {
        Err(RegisterError::Request(RequestError::Refused { status: Status::TooLarge, message })) => {
            assert!(message.contains("at most 10 MB") && message.contains("limits.max_session_memory_mb"), "{message}");
        }
        other => panic!("{other:?}"),
    }
}
