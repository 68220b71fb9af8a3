//! Certificates and access: who may use a daemon end that is open to the network.

use std::{fs, net::SocketAddr, path::Path, time::Duration};

use untangled_bridge_lab::{
    certificates::Authority,
    cloth::Sheets,
    ends::{self, PATIENCE, Process, TestDomain},
};
use untangled_client::{Client, ClientOptions, StepTime};

fn start(end: &str, config: &Path, domain: &TestDomain) -> Process {
    Process::start(ends::bridge(&[end, "--config", config.to_str().unwrap(), "--domain", domain.name()]))
}

fn can_connect(domain: &TestDomain, timeout: Duration) -> bool {
    Client::connect(ClientOptions { domain: Some(domain.name().to_owned()), timeout }).is_ok()
}

#[test]
fn hosts_with_a_listed_certificate_are_served_and_all_others_are_not() {
    let (Some(authority), Some(stranger)) = (Authority::new("studio"), Authority::new("stranger")) else { return };
    let near_daemon = TestDomain::new();
    let _daemon = ends::serve(&near_daemon);
    let address = ends::free_address();
    let own = authority.certificate();
    let far = authority.config("far", &format!("listen = ['{address}']"), "[limits]\nhosts = ['ws1', 'ws2']", &own);
    let far = start("daemon", &far, &near_daemon);
    assert_eq!(fs::read_to_string(format!("/proc/{}/comm", far.id())).unwrap(), "untangled-bridg\n", "15 characters");
    // Zenoh's TLS links are sound on one thread only, and only the environment says on how many.
    let environment = fs::read(format!("/proc/{}/environ", far.id())).unwrap();
    assert!(
        String::from_utf8_lossy(&environment).contains("ZENOH_RUNTIME=(rx: (handover: tx), tx: (worker_threads: 1))")
    );
    let connect = format!("connect = ['{address}']");
    let sheets = Sheets::new(6);
    let mut allowed = Vec::new();
    for name in ["ws1", "ws2"] {
        let domain = TestDomain::new();
        let end = start("host", &authority.config(name, &connect, "", &own), &domain);
        let mut session = domain.connect().register(sheets.registration()).unwrap();
        let step = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };
        for frame in 1..=20 {
            let positions = sheets.positions_f32(frame);
            let answer = session.exchange(step, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap();
            assert_eq!(answer.header().frame, frame);
        }
        allowed.push((session, end, domain));
    }
    assert_refused(&authority, &stranger, &near_daemon, address);
}

/// Hosts and a daemon end that must not be talked to.
fn assert_refused(authority: &Authority, stranger: &Authority, near_daemon: &TestDomain, address: SocketAddr) {
    let own = authority.certificate();
    let connect = format!("connect = ['{address}']");
    let silent = Duration::from_secs(3);
    // A certificate of the same authority under a name that is not listed.
    let domain = TestDomain::new();
    let _end = start("host", &authority.config("ws3", &connect, "", &own), &domain);
    assert!(!can_connect(&domain, silent), "a host that is not listed");
    // One that claims another name than its certificate's.
    let domain = TestDomain::new();
    let config = authority.config("ws4", &connect, "", &own);
    fs::write(&config, fs::read_to_string(&config).unwrap().replace("name = 'ws4'", "name = 'ws1'")).unwrap();
    let _end = start("host", &config, &domain);
    assert!(!can_connect(&domain, silent), "a host under a false name");
    // A certificate of another authority, and none at all.
    let domain = TestDomain::new();
    let _end = start("host", &stranger.config("ws2", &connect, "", &own), &domain);
    assert!(!can_connect(&domain, silent), "a host of another authority");
    let domain = TestDomain::new();
    let _end = ends::host_end(&domain, "ws1", &[address]);
    assert!(!can_connect(&domain, silent), "a host without a certificate");
    // A daemon end of another authority is not trusted by hosts.
    let other = ends::free_address();
    let false_daemon = stranger.config("far", &format!("listen = ['{other}']"), "", &stranger.certificate());
    let _false_daemon = start("daemon", &false_daemon, near_daemon);
    let domain = TestDomain::new();
    let _end = start("host", &authority.config("ws5", &format!("connect = ['{other}']"), "", &own), &domain);
    assert!(!can_connect(&domain, silent), "a daemon of another authority");
}
