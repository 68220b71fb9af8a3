//! Ends, daemons and hosts that go away.

use std::time::{Duration, Instant};

use untangled_client::{ExchangeError, PublishError, Session, StepTime, WaitError};

use untangled_bridge_lab::{
    cloth::Sheets,
    ends::{self, Bridged, PATIENCE, TestDomain},
    proxy::Proxy,
};

const DEADLINE: Duration = Duration::from_millis(500);

fn exchange(session: &mut Session, sheets: &Sheets) -> Result<u64, ExchangeError> {
    let positions = sheets.positions_f32(session.frame() + 1);
    let step = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };
    let begin = Instant::now();
    let answer = session.exchange(step, DEADLINE, |to| to.copy_from_slice(&positions));
    assert!(begin.elapsed() < DEADLINE + Duration::from_millis(500), "blocked for {:?}", begin.elapsed());
    answer.map(|correction| correction.header().frame)
}

/// Exchanges until it works; gives back how long that took, and that all errors on the way were those of a daemon that
/// went away.
#[track_caller]
fn until_back(session: &mut Session, sheets: &Sheets) -> Duration {
    let begin = Instant::now();
    loop {
        match exchange(session, sheets) {
            Ok(frame) => {
                assert_eq!(frame, session.frame());
                return begin.elapsed();
            }
            Err(
                ExchangeError::Publish(PublishError::Reconnecting)
                | ExchangeError::Wait(WaitError::DaemonLost { .. } | WaitError::Timeout { .. }),
            ) => {}
            Err(error) => panic!("{error}"),
        }
        assert!(begin.elapsed() < PATIENCE, "it does not come back");
    }
}

#[test]
fn session_goes_on_after_each_part_of_the_way_was_killed() {
    let mut bridged = Bridged::start();
    let sheets = Sheets::new(8);
    let mut session = bridged.near_host.connect().register(sheets.registration()).unwrap();
    assert_eq!(exchange(&mut session, &sheets).unwrap(), 1);
    bridged.daemon.kill();
    assert!(exchange(&mut session, &sheets).is_err());
    bridged.daemon = ends::serve(&bridged.near_daemon);
    let daemon = until_back(&mut session, &sheets);
    bridged.daemon_end.kill();
    assert!(exchange(&mut session, &sheets).is_err());
    bridged.daemon_end = ends::daemon_end(&bridged.near_daemon, "far", bridged.address);
    let daemon_end = until_back(&mut session, &sheets);
    bridged.host_end.kill();
    bridged.host_end = ends::host_end(&bridged.near_host, "near", &[bridged.address]);
    let host_end = until_back(&mut session, &sheets);
    assert_eq!(session.num_registrations(), 4);
    println!("back after the daemon was killed {daemon:?}, the daemon end {daemon_end:?}, the host end {host_end:?}");
    let begin = Instant::now();
    while bridged.near_daemon.connect().status().unwrap()["sessions"].as_array().unwrap().len() != 1 {
        assert!(begin.elapsed() < PATIENCE, "sessions of ends that are gone stay");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// A registration may reach a daemon end between two runs of its daemon, too short for hosts to find none at all.
#[test]
fn registration_during_a_restart_of_the_daemon_is_answered_by_its_next_run() {
    let mut bridged = Bridged::start();
    let sheets = Sheets::new(8);
    let mut session = bridged.near_host.connect().register(sheets.registration()).unwrap();
    for _ in 0..10 {
        bridged.daemon.kill();
        bridged.daemon = ends::serve(&bridged.near_daemon);
        let back = until_back(&mut session, &sheets);
        assert!(back < PATIENCE / 3, "the request was dropped, and the host waited {back:?} for its reply");
    }
}

#[test]
fn sessions_spread_over_daemons_and_move_when_theirs_is_gone() {
    let near_host = TestDomain::new();
    let far: Vec<_> = (0..2)
        .map(|k| {
            let (domain, address) = (TestDomain::new(), ends::free_address());
            let daemon = ends::serve(&domain);
            let end = ends::daemon_end(&domain, &format!("far-{k}"), address);
            (Some(daemon), end, domain, address)
        })
        .collect();
    let mut far = far;
    let _host_end = ends::host_end(&near_host, "near", &[far[0].3, far[1].3]);
    let client = near_host.connect();
    // Both must have been heard of.
    let begin = Instant::now();
    while client.status().unwrap()["bridge"]["daemons"].as_array().unwrap().len() < 2 {
        assert!(begin.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(50));
    }
    let sheets = Sheets::new(8);
    let mut sessions: Vec<Session> = (0..4).map(|_| client.register(sheets.registration()).unwrap()).collect();
    for session in &mut sessions {
        assert_eq!(exchange(session, &sheets).unwrap(), 1);
    }
    let count = |domain: &TestDomain| domain.connect().status().unwrap()["sessions"].as_array().unwrap().len();
    assert_eq!([count(&far[0].2), count(&far[1].2)], [2, 2]);
    far[0].0.take();
    for session in &mut sessions {
        until_back(session, &sheets);
    }
    assert_eq!(count(&far[1].2), 4);
    let registrations: u32 = sessions.iter().map(Session::num_registrations).sum();
    assert_eq!(registrations, 6, "those of the other daemon were not disturbed");
}

#[test]
fn nothing_is_left_after_all_have_ended() {
    let bridged = Bridged::start();
    let sheets = Sheets::new(8);
    let client = bridged.near_host.connect();
    let mut session = client.register(sheets.registration()).unwrap();
    exchange(&mut session, &sheets).unwrap();
    let (near_host, near_daemon) = (bridged.near_host, bridged.near_daemon);
    bridged.host_end.stop();
    drop(session);
    drop(client);
    bridged.daemon_end.stop();
    bridged.daemon.stop();
    assert_eq!(near_host.shared_memory(), Vec::<String>::new());
    assert_eq!(near_daemon.shared_memory(), Vec::<String>::new());
}

/// All of it, with a proxy between both ends.
fn bridged_by_proxy() -> (Bridged, Proxy) {
    let mut proxy = None;
    let bridged = Bridged::start_by(|address| proxy.insert(Proxy::start(address)).address);
    (bridged, proxy.expect("the host end was given its address"))
}

#[test]
fn session_is_back_within_two_seconds_after_a_partition_and_gets_no_wrong_answer() {
    let (bridged, proxy) = bridged_by_proxy();
    let Bridged { near_host, near_daemon, .. } = &bridged;
    let sheets = Sheets::new(8);
    let mut own = near_daemon.connect().register(sheets.registration()).unwrap();
    let mut session = near_host.connect().register(sheets.registration()).unwrap();
    let step = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };
    for partition_ms in [300, 1000, 2000, 4000] {
        proxy.cut(true);
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_millis(partition_ms) {
            // States that are published meanwhile are lost, or arrive when they were overtaken.
            let _ = exchange(&mut session, &sheets);
        }
        proxy.cut(false);
        let back = until_back(&mut session, &sheets);
        println!("back {back:?} after a partition of {partition_ms} ms");
        assert!(back < Duration::from_secs(2), "back after {back:?}");
        let positions = sheets.positions_f32(session.frame() + 1);
        let [own, far] = [&mut own, &mut session].map(|session| {
            session.exchange(step, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap().vertices().to_vec()
        });
        assert_eq!(own, far);
    }
}

/// The host asks once and waits: what a broken connection had on its way must be sent again by the ends themselves.
#[test]
fn frame_that_was_lost_with_its_connection_is_answered_without_being_asked_again() {
    let (bridged, proxy) = bridged_by_proxy();
    let near_host = &bridged.near_host;
    let sheets = Sheets::new(8);
    let mut session = near_host.connect().register(sheets.registration()).unwrap();
    assert_eq!(exchange(&mut session, &sheets).unwrap(), 1);
    let num_sent_again = || near_host.connect().status().unwrap()["bridge"]["num_sent_again"].as_u64().unwrap();
    // The state is lost on its way, or its answer on the way back.
    for cut in [Proxy::cut, Proxy::cut_back, Proxy::cut] {
        let before = num_sent_again();
        let mut num_frames = 0;
        // Where the machine is busy the connection may break before anything is on its way: that shows nothing.
        while num_sent_again() == before {
            assert!(num_frames < 20, "no frame was lost");
            exchange_while_it_breaks(&mut session, &sheets, &proxy, cut);
            num_frames += 1;
        }
        println!("{num_frames} frames, {} sent again", num_sent_again() - before);
    }
    assert_eq!(session.num_registrations(), 1, "the session was never given up");
}

/// Exchanges a frame whose connection breaks after a way of it was cut.
fn exchange_while_it_breaks(session: &mut Session, sheets: &Sheets, proxy: &Proxy, cut: fn(&Proxy, bool)) {
    let step = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };
    let positions = sheets.positions_f32(session.frame() + 1);
    cut(proxy, true);
    let frame = std::thread::scope(|scope| {
        scope.spawn(|| {
            // Long enough for the state to reach the proxy, short enough for the ends not to give up each other.
            std::thread::sleep(Duration::from_millis(300));
            proxy.break_off();
            proxy.cut(false);
        });
        let answer = session.exchange(step, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap();
        answer.header().frame
    });
    assert_eq!(frame, session.frame());
}
