//! Breaks what lies between a host and its daemon, and compares every answer with the daemon's own, byte for byte.
//! `faults [ROW]...`, rows by their first word; `FAULTS_SCALE=0.1` does a tenth of each.
//!
//! Run it as root for network namespaces: loss and partitions are those of packets then. Without them loss is skipped,
//! and partitions are those of a proxy that holds back all bytes.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a measurement, which fails by panicking")]

use std::{
    collections::HashMap,
    process::Command,
    time::{Duration, Instant},
};

use untangled_bridge_lab::{
    cloth::Sheets,
    ends::{self, PATIENCE, Process, TestDomain},
    network::{Namespaces, Shape},
    proxy::Proxy,
    times::Times,
};
use untangled_client::{ExchangeError, PublishError, Session, StepTime, WaitError};

const DEADLINE: Duration = Duration::from_millis(250);
/// How much later than its deadline a call may return on a busy machine.
const SLACK: Duration = Duration::from_millis(250);
const STEP: StepTime = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };
/// Frames have the positions of one of so many, whose answers are known.
const NUM_STATES: u64 = 64;

/// What lies between host and daemon.
enum Way {
    Packets(Namespaces),
    Bytes(Proxy),
}

impl Way {
    fn cut(&self, is_cut: bool) {
        match self {
            Self::Packets(namespaces) => namespaces.lose(if is_cut { 100 } else { 0 }).unwrap(),
            Self::Bytes(proxy) => proxy.cut(is_cut),
        }
    }
}

/// Everything that runs. Fields are dropped in order.
struct World {
    host_end: Option<Process>,
    daemon_end: Option<Process>,
    daemon: Option<Process>,
    near_host: TestDomain,
    near_daemon: TestDomain,
    address: String,
    listen: String,
    way: Way,
    known: HashMap<u64, Vec<[u32; 4]>>,
    sheets: Sheets,
}

/// What a row counts.
#[derive(Default)]
struct Counts {
    compared: u64,
    wrong: u64,
    lost: u64,
    late_calls: u64,
    back: Times,
}

impl World {
    fn new(with_packets: bool) -> Result<Self, String> {
        let (way, address, listen) = if with_packets {
            let namespaces = Namespaces::new(1, Some(Shape::exact("1gbit")))?;
            let address = namespaces.address(0);
            (Way::Packets(namespaces), address.clone(), address)
        } else {
            let listen = ends::free_address();
            let proxy = Proxy::start(listen);
            (Way::Bytes(proxy), String::new(), listen.to_string())
        };
        let address = match &way {
            Way::Bytes(proxy) => proxy.address.to_string(),
            Way::Packets(_) => address,
        };
        let (near_host, near_daemon) = (TestDomain::new(), TestDomain::new());
        let sheets = Sheets::new(12);
        let daemon = Some(ends::serve(&near_daemon));
        let mut own = near_daemon.connect().register(sheets.registration()).unwrap();
        let known =
            (0..NUM_STATES).map(|state| (state, answer(&mut own, &sheets, state, PATIENCE).unwrap().1)).collect();
        drop(own);
        let mut world = Self {
            host_end: None,
            daemon_end: None,
            daemon,
            near_host,
            near_daemon,
            address,
            listen,
            way,
            known,
            sheets,
        };
        world.start_daemon_end();
        world.start_host_end();
        Ok(world)
    }

    fn start(&self, is_host: bool, command: &Command) -> Process {
        Process::start(match &self.way {
            Way::Packets(namespaces) if is_host => namespaces.in_host(command),
            Way::Packets(namespaces) => namespaces.in_daemon(0, command),
            Way::Bytes(_) => {
                let mut same = Command::new(command.get_program());
                same.args(command.get_args()).env("XDG_CONFIG_HOME", "/nonexistent");
                same
            }
        })
    }

    fn start_daemon_end(&mut self) {
        let domain = self.near_daemon.name().to_owned();
        let arguments = ["daemon", "--domain", &domain, "--name", "far", "--listen", &self.listen, "--insecure"];
        self.daemon_end = Some(self.start(false, &ends::bridge(&arguments)));
    }

    fn start_host_end(&mut self) {
        let domain = self.near_host.name().to_owned();
        let arguments = ["host", "--domain", &domain, "--name", "near", "--connect", &self.address, "--insecure"];
        self.host_end = Some(self.start(true, &ends::bridge(&arguments)));
    }

    fn register(&self) -> Session {
        self.near_host.connect().register(self.sheets.registration()).unwrap()
    }

    /// One frame; whether it was answered.
    fn exchange(&self, session: &mut Session, counts: &mut Counts) -> bool {
        let state = session.frame() % NUM_STATES;
        let begin = Instant::now();
        let result = answer(session, &self.sheets, state, DEADLINE);
        counts.late_calls += u64::from(begin.elapsed() > DEADLINE + SLACK);
        match result {
            Ok((frame, bits)) => {
                counts.compared += 1;
                counts.wrong += u64::from(bits != self.known[&state] || frame != session.frame());
                true
            }
            Err(
                ExchangeError::Publish(PublishError::Reconnecting)
                | ExchangeError::Wait(WaitError::DaemonLost { .. } | WaitError::Timeout { .. }),
            ) => {
                counts.lost += 1;
                false
            }
            Err(error) => panic!("{error}"),
        }
    }

    /// Some frames while nothing is broken.
    fn exchange_some(&self, session: &mut Session, counts: &mut Counts) {
        for _ in 0..20 {
            self.exchange(session, counts);
        }
    }

    /// Exchanges until a frame is answered.
    fn until_back(&self, session: &mut Session, counts: &mut Counts) {
        let begin = Instant::now();
        while !self.exchange(session, counts) {
            assert!(begin.elapsed() < PATIENCE, "it does not come back");
        }
        counts.back.add(begin.elapsed());
    }
}

fn answer(
    session: &mut Session,
    sheets: &Sheets,
    state: u64,
    time: Duration,
) -> Result<(u64, Vec<[u32; 4]>), ExchangeError> {
    let positions = sheets.positions_f32(state);
    let answer = session.exchange(STEP, time, |to| to.copy_from_slice(&positions))?;
    let bits = answer.vertices().iter().map(|vertex| {
        let [x, y, z] = vertex.value.map(f32::to_bits);
        [x, y, z, vertex.flags]
    });
    Ok((answer.header().frame, bits.collect()))
}

/// A row: its name, how often at scale 1, and what is done once.
type Row = (&'static str, u64, fn(&mut World, &mut Session, &mut Counts));

const ROWS: [Row; 8] = [
    ("partition of 2.5 s", 100, |world, session, counts| {
        world.way.cut(true);
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_millis(2500) {
            world.exchange(session, counts);
        }
        world.way.cut(false);
        world.until_back(session, counts);
        world.exchange_some(session, counts);
    }),
    ("daemon killed and restarted", 200, |world, session, counts| {
        world.daemon = None;
        world.daemon = Some(ends::serve(&world.near_daemon));
        world.until_back(session, counts);
        world.exchange_some(session, counts);
    }),
    ("daemon-end killed and restarted", 200, |world, session, counts| {
        world.daemon_end = None;
        world.start_daemon_end();
        world.until_back(session, counts);
        world.exchange_some(session, counts);
    }),
    ("host-end killed and restarted", 200, |world, session, counts| {
        world.host_end = None;
        world.start_host_end();
        world.until_back(session, counts);
        world.exchange_some(session, counts);
    }),
    ("loss-1 of 100 packets", 2000, |world, session, counts| lossy(world, session, counts, 1)),
    ("loss-10 of 100 packets", 2000, |world, session, counts| lossy(world, session, counts, 10)),
    ("delay of 50 ms each way", 200, |world, session, counts| {
        if let Way::Bytes(proxy) = &world.way {
            proxy.delay(Duration::from_millis(50));
        }
        world.exchange(session, counts);
    }),
    ("nothing", 2000, |world, session, counts| {
        world.exchange(session, counts);
    }),
];

fn lossy(world: &World, session: &mut Session, counts: &mut Counts, percent: u32) {
    if let Way::Packets(namespaces) = &world.way
        && counts.compared + counts.lost == 0
    {
        namespaces.lose(percent).unwrap();
    }
    world.exchange(session, counts);
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let scale: f64 = std::env::var("FAULTS_SCALE").map_or(1.0, |scale| scale.parse().unwrap());
    println!("| fault | tried | frames compared | wrong | lost | late calls | back after ms: half, 99 %, longest |");
    println!("|---|---|---|---|---|---|---|");
    for (name, times, break_once) in ROWS {
        let first = name.split(' ').next().unwrap_or(name);
        if !asked.is_empty() && !asked.iter().any(|row| row == first) {
            continue;
        }
        let needs_packets = first.starts_with("loss");
        let world = match World::new(first != "delay") {
            Err(reason) if needs_packets => Err(reason),
            Err(_) => World::new(false),
            world => world,
        };
        let mut world = match world {
            Ok(world) => world,
            Err(reason) => {
                println!("| {name} | skipped: {reason} |");
                continue;
            }
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "a count"
        )]
        let times = ((times as f64 * scale).round() as u64).max(1);
        let mut session = world.register();
        let mut counts = Counts::default();
        for _ in 0..times {
            break_once(&mut world, &mut session, &mut counts);
        }
        let way = match &world.way {
            Way::Packets(_) => "packets",
            Way::Bytes(_) => "bytes of a proxy",
        };
        let [half, most, longest] = [0.5, 0.99, 1.0].map(|part| counts.back.quantile_ms(part));
        let back = if counts.back.is_empty() { "-".to_owned() } else { format!("{half:.0}, {most:.0}, {longest:.0}") };
        let Counts { compared, wrong, lost, late_calls, .. } = counts;
        println!("| {name} ({way}) | {times} | {compared} | {wrong} | {lost} | {late_calls} | {back} |");
    }
}
