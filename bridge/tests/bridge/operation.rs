//! Words, status and limits of the program.

use std::{
    process::{Command, Output},
    time::{Duration, Instant},
};

use zenoh::Wait;

use untangled_bridge_lab::{
    cloth::Sheets,
    ends::{self, Bridged, PATIENCE, TestDomain},
};
use untangled_client::observe::{self, Observer, ObserverOptions};

fn run(arguments: &[&str]) -> Output {
    ends::bridge(arguments).output().unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn ends_refuse_addresses_beyond_the_machine_and_domains_that_are_served() {
    let output = run(&["daemon", "--listen", "0.0.0.0:7460"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(words(&output).contains("leaves this machine"), "{}", words(&output));
    let output = run(&["host", "--discovery"]);
    assert!(words(&output).contains("discovery"), "{}", words(&output));
    let domain = TestDomain::new();
    let _daemon = ends::serve(&domain);
    let output = run(&["host", "--domain", domain.name()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(words(&output).contains("another daemon"), "{}", words(&output));
    let address = ends::free_address().to_string();
    let _end = ends::daemon_end(&domain, "far", address.parse().unwrap());
    let output = run(&["daemon", "--domain", domain.name(), "--listen", &address]);
    assert_eq!(output.status.code(), Some(2));
    assert!(words(&output).contains(&address), "{}", words(&output));
}

#[test]
fn status_and_config_say_what_an_end_does() {
    let (near_daemon, near_host) = (TestDomain::new(), TestDomain::new());
    let (address, metrics) = (ends::free_address(), ends::free_address().to_string());
    let _daemon = ends::serve(&near_daemon);
    let _daemon_end = ends::daemon_end(&near_daemon, "far", address);
    let arguments = [
        "host",
        "--domain",
        near_host.name(),
        "--name",
        "near",
        "--connect",
        &address.to_string(),
        "--metrics",
        &metrics,
    ];
    let _host_end = ends::Process::start(ends::bridge(&arguments));
    let client = near_host.connect();
    let session = client.register(Sheets::new(4).registration()).unwrap();
    let output = run(&["status", "--metrics", &metrics]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("daemon `far` serves") && text.contains("session 1 at `far`, 36 triangles"), "{text}");
    let config = String::from_utf8(run(&["config", "--name", "x"]).stdout).unwrap();
    assert!(config.contains("name = \"x\"") && config.contains("# Where a daemon end listens"), "{config}");
    drop(session);
}

/// The command line's own clients of the daemon, unchanged.
#[test]
fn status_command_and_example_host_work_through_the_bridge() {
    let bridged = Bridged::start();
    drop(bridged.near_host.connect());
    let output =
        Command::new(ends::untangled()).args(["status", "--domain", bridged.near_host.name()]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains(&format!("on domain `{}`", bridged.near_daemon.name())), "{text} {}", words(&output));
}

#[test]
fn sessions_are_watched_near_their_daemon_and_the_bridge_says_so() {
    let bridged = Bridged::start();
    let client = bridged.near_host.connect();
    let _session = client.register(Sheets::new(4).registration()).unwrap();
    let watch = |domain: &TestDomain| {
        let options = ObserverOptions {
            domain: Some(domain.name().to_owned()),
            timeout: PATIENCE,
            name: Some("test".to_owned()),
        };
        let known = observe::sessions(&options).unwrap();
        Observer::open(options, known[0].session)
    };
    let refusal = watch(&bridged.near_host).map(drop).unwrap_err().to_string();
    assert!(refusal.contains("watch it on the machine of its daemon"), "{refusal}");
    assert_eq!(watch(&bridged.near_daemon).unwrap().mesh().triangles.len(), 36);
}

#[test]
fn idle_ends_stay_small_and_do_not_grow_with_sessions_that_come_and_go() {
    let bridged = Bridged::start();
    let client = bridged.near_host.connect();
    let sheets = Sheets::new(12);
    let mut sizes = Vec::new();
    for round in 0..60 {
        drop(client.register(sheets.registration()).unwrap());
        if round % 20 == 19 {
            std::thread::sleep(Duration::from_millis(600));
            sizes.push([bridged.host_end.memory(), bridged.daemon_end.memory()]);
        }
    }
    println!("resident bytes of the ends after 20, 40 and 60 sessions: {sizes:?}");
    for end in 0..2 {
        assert!(sizes[2][end] < sizes[1][end] + 4_000_000, "{sizes:?}");
    }
    let begin = Instant::now();
    while !bridged.near_daemon.connect().status().unwrap()["sessions"].as_array().unwrap().is_empty() {
        assert!(begin.elapsed() < PATIENCE, "sessions stay");
        std::thread::sleep(Duration::from_millis(100));
    }
    assert!(bridged.daemon.id() > 0);
}

/// Zenoh as a router between two sites, as `zenohd` is one.
#[test]
fn session_works_through_a_router_to_which_both_ends_connect() {
    let address = ends::free_address().to_string();
    let mut config = zenoh::Config::default();
    let locator = format!("[\"tcp/{address}\"]");
    for (key, value) in
        [("mode", "\"router\""), ("listen/endpoints", &locator), ("scouting/multicast/enabled", "false")]
    {
        config.insert_json5(key, value).unwrap();
    }
    let _router = zenoh::open(config).wait().unwrap();
    let (near_daemon, near_host) = (TestDomain::new(), TestDomain::new());
    let file = std::env::temp_dir().join(format!("bridge-router-{}.toml", std::process::id()));
    std::fs::write(&file, format!("connect = ['{address}']\nthrough_router = true\n")).unwrap();
    let file_name = file.to_str().unwrap();
    let _daemon = ends::serve(&near_daemon);
    let start = |end, name, domain: &TestDomain| {
        ends::Process::start(ends::bridge(&[end, "--config", file_name, "--name", name, "--domain", domain.name()]))
    };
    let _daemon_end = start("daemon", "far", &near_daemon);
    let _host_end = start("host", "near", &near_host);
    let sheets = Sheets::new(6);
    let mut session = near_host.connect().register(sheets.registration()).unwrap();
    for frame in 1..=20 {
        let step = untangled_client::StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };
        let positions = sheets.positions_f32(frame);
        let answer = session.exchange(step, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap();
        assert_eq!(answer.header().frame, frame);
    }
    std::fs::remove_file(&file).unwrap();
}
