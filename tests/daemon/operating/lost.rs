//! A request that is never replied to, as was seen on an overloaded machine while other clients were killed.

use std::{
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{Sender, channel},
    },
    thread,
    time::Duration,
};

use iceoryx2::prelude::{EventId, SignalHandlingMode};
use untangled_client::Client;
use untangled_proto::{
    ICEORYX2_VERSION, LIBRARY_VERSION, PROTOCOL_VERSION, PayloadLayout, ReplyHeader, Status, control::Hello, names,
};
use untangled_testkit::process::TestDomain;
use untangled_transport::{Domain, node, services};

/// Answers greetings as a daemon does, but for the first ones, until it shall end; the number of all that came.
fn greet_all_but_first(domain: &Domain, num_lost: u32, ready: Sender<()>, ends: &AtomicBool) -> u32 {
    domain.create_folders().unwrap();
    let node = node::create(&domain.config().unwrap(), SignalHandlingMode::Disabled).unwrap();
    let _control = services::create_shared_event(&node, names::CONTROL).unwrap();
    let replies = services::create_shared_event(&node, names::REPLY).unwrap();
    let notifier = replies.notifier_builder().create().unwrap();
    let requests = services::create_requests(&node, PayloadLayout::Packed).unwrap();
    let server = requests.server_builder().initial_max_slice_len(1024).create().unwrap();
    std::fs::write(domain.lock_path(), "announced").unwrap();
    ready.send(()).unwrap();
    drop(ready);
    let hello = Hello {
        protocol_version: PROTOCOL_VERSION,
        library_version: LIBRARY_VERSION.to_owned(),
        iceoryx2_version: ICEORYX2_VERSION.to_owned(),
        pid: std::process::id(),
        features: Vec::new(),
    };
    let payload = serde_json::to_vec(&hello).unwrap();
    let mut num_received = 0;
    while !ends.load(Ordering::Acquire) {
        thread::sleep(Duration::from_millis(1));
        let Some(request) = server.receive().unwrap() else { continue };
        num_received += 1;
        if num_received <= num_lost {
            continue;
        }
        let mut reply = request.loan_slice_uninit(payload.len()).unwrap();
        *reply.user_header_mut() = ReplyHeader {
            protocol_version: PROTOCOL_VERSION,
            status: Status::Ok.code(),
            token: request.user_header().token,
            ..ReplyHeader::default()
        };
        reply.write_from_slice(&payload).send().unwrap();
        notifier.notify_with_custom_event_id(EventId::new(names::EVENT_REPLY)).unwrap();
    }
    num_received
}

#[test]
fn greeting_that_is_lost_is_sent_again() {
    let domain = TestDomain::new();
    let ends = AtomicBool::new(false);
    let (ready, is_ready) = channel();
    let (connected, num_received) = thread::scope(|scope| {
        let ends = &ends;
        let daemon = scope.spawn(|| greet_all_but_first(&domain.0, 1, ready, ends));
        is_ready.recv().unwrap();
        let connected = Client::connect(domain.options());
        ends.store(true, Ordering::Release);
        (connected, daemon.join().unwrap())
    });
    assert_eq!(connected.unwrap().daemon().pid, std::process::id());
    assert!(num_received >= 2, "{num_received}");
}
