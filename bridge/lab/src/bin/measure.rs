//! What the bridge costs, and how much it carries. `measure lockstep|rate|same|capacity`, each with numbers.
//!
//! Run it as root for network namespaces; without them it says so and measures over loopback.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a measurement, which fails by panicking")]
#![allow(clippy::cast_precision_loss, reason = "times and counts")]

use std::{
    process::Command,
    time::{Duration, Instant},
};

use untangled_bridge_lab::{
    cloth::Fold,
    ends::{self, PATIENCE, Process, TestDomain},
    network::Namespaces,
    times::Times,
};
use untangled_client::{CorrectionHeader, Registration, Session, StepTime};
use untangled_proto::correction::stage;

/// A sheet of 31,250 triangles.
const LARGE: Fold = Fold::new(126);
/// A sheet of 7,938 triangles.
const SMALL: Fold = Fold::new(64);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: u64| arguments.get(k).map_or(default, |text| text.parse().unwrap());
    match arguments.first().map(String::as_str) {
        Some("lockstep") => lockstep(number(1, 1000)),
        Some("rate") => rate(number(1, 30)),
        Some("same") => same(number(1, 10_000)),
        Some("capacity") => {
            let rate = arguments.get(3).map_or("1gbit", String::as_str);
            capacity(usize::try_from(number(1, 1)).unwrap(), number(2, 16), rate);
        }
        _ => println!(
            "measure lockstep [FRAMES] | rate [SECONDS] | same [FRAMES] | capacity [DAEMONS] [SESSIONS] [RATE]"
        ),
    }
}

/// Daemons, a bridge to them, and what joins them. Fields are dropped in order: processes before namespaces.
struct Setting {
    /// The daemon ends, then the host end.
    ends: Vec<Process>,
    _daemons: Vec<Process>,
    near_host: TestDomain,
    near_daemons: Vec<TestDomain>,
    _namespaces: Option<Namespaces>,
    words: String,
}

impl Setting {
    fn start(num_daemons: usize, rate: &str) -> Self {
        let (namespaces, words) = match Namespaces::new(num_daemons, Some(rate)) {
            Ok(made) => (Some(made), format!("namespaces, veth, {rate}")),
            Err(reason) => (None, format!("loopback (no namespaces: {reason})")),
        };
        let near_host = TestDomain::new();
        let near_daemons: Vec<TestDomain> = (0..num_daemons).map(|_| TestDomain::new()).collect();
        let _daemons = near_daemons.iter().map(ends::serve).collect();
        let mut started = Vec::new();
        let mut addresses = Vec::new();
        for (k, domain) in near_daemons.iter().enumerate() {
            let free = ends::free_address().to_string();
            let address = namespaces.as_ref().map_or(free, |made| made.address(k));
            let name = format!("far-{k}");
            let command = ends::bridge(&[
                "daemon",
                "--domain",
                domain.name(),
                "--name",
                &name,
                "--listen",
                &address,
                "--insecure",
            ]);
            started.push(Process::start(
                namespaces.as_ref().map_or_else(|| same_command(&command), |made| made.in_daemon(k, &command)),
            ));
            addresses.push(address);
        }
        let mut command = ends::bridge(&["host", "--domain", near_host.name(), "--name", "near", "--insecure"]);
        for address in &addresses {
            command.args(["--connect", address]);
        }
        started.push(Process::start(
            namespaces.as_ref().map_or_else(|| same_command(&command), |made| made.in_host(&command)),
        ));
        let client = near_host.connect();
        let begin = Instant::now();
        while client.status().unwrap()["bridge"]["daemons"].as_array().unwrap().len() < num_daemons {
            assert!(begin.elapsed() < PATIENCE, "not all daemons are heard of");
            std::thread::sleep(Duration::from_millis(50));
        }
        Self { ends: started, _daemons, near_host, near_daemons, _namespaces: namespaces, words }
    }
}

fn same_command(command: &Command) -> Command {
    let mut same = Command::new(command.get_program());
    same.args(command.get_args()).env("XDG_CONFIG_HOME", "/nonexistent");
    same
}

const STEP: StepTime = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };

/// The round trip of a frame, and what of it is not the daemon's work on the frame.
fn exchange(session: &mut Session, cloth: &Fold) -> [Duration; 2] {
    let positions = cloth.positions_f32(session.frame() + 1);
    let begin = Instant::now();
    let answer = session.exchange(STEP, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap();
    let trip = begin.elapsed();
    [trip, trip.saturating_sub(Duration::from_nanos(answer.header().stage_ns[stage::TOTAL]))]
}

/// Heads of a table of round trips: all of it, and what is not the daemon's work.
const HEADS: &str = "| where | frames | median ms | 99 % within ms | longest ms | without work: median ms | 99 % ms |\n\
                     |---|---|---|---|---|---|---|";

fn row(name: &str, times: &mut [Times; 2]) {
    let [trip, way] = times;
    let [half, most, last] = [0.5, 0.99, 1.0].map(|part| trip.quantile_ms(part));
    let [way_half, way_most] = [0.5, 0.99].map(|part| way.quantile_ms(part));
    println!("| {name} | {} | {half:.2} | {most:.2} | {last:.2} | {way_half:.2} | {way_most:.2} |", trip.len());
}

fn add(times: &mut [Times; 2], [trip, way]: [Duration; 2]) {
    times[0].add(trip);
    times[1].add(way);
}

/// Round trips of a tangled cloth in lock step, beside the daemon and through the bridge, frame by frame in turn.
fn lockstep(frames: u64) {
    println!("{HEADS}");
    for sparse in [false, true] {
        let setting = Setting::start(1, "1gbit");
        let registration = Registration { sparse, ..LARGE.registration() };
        let domains = [&setting.near_daemons[0], &setting.near_host];
        let mut sessions = domains.map(|domain| domain.connect().register(registration.clone()).unwrap());
        let mut times: [[Times; 2]; 2] = Default::default();
        for frame in 0..frames + 20 {
            for (session, times) in sessions.iter_mut().zip(&mut times) {
                let time = exchange(session, &LARGE);
                // The first frames search without separation certificates.
                if frame >= 20 {
                    add(times, time);
                }
            }
        }
        let form = if sparse { "sparse" } else { "all vertices" };
        row(&format!("beside the daemon, {form}"), &mut times[0]);
        row(&format!("through the bridge, {form}: {}", setting.words), &mut times[1]);
        let report = setting.near_host.connect().status().unwrap();
        let bridge = &report["bridge"];
        let each = |bytes: &str, count: &str| bridge[bytes].as_f64().unwrap() / bridge[count].as_f64().unwrap();
        println!(
            "bytes of a frame: up {:.0}, down {:.0}",
            each("bytes_sent", "num_sent"),
            each("bytes_received", "num_received")
        );
    }
}

/// 60 frames a second.
fn rate(seconds: u64) {
    println!("{HEADS}");
    let setting = Setting::start(1, "1gbit");
    for (name, domain) in [("beside the daemon", &setting.near_daemons[0]), ("through the bridge", &setting.near_host)]
    {
        let mut session = domain.connect().register(LARGE.registration()).unwrap();
        for _ in 0..20 {
            exchange(&mut session, &LARGE);
        }
        let (begin, mut times) = (Instant::now(), <[Times; 2]>::default());
        let before: Vec<u64> = setting.ends.iter().map(Process::ticks).collect();
        for frame in 0..60 * seconds {
            let due = begin + Duration::from_micros(frame * 16_667);
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            add(&mut times, exchange(&mut session, &LARGE));
        }
        let ticks = setting.ends.iter().zip(before).map(|(end, before)| end.ticks() - before);
        let cost: Vec<String> =
            ticks.map(|ticks| format!("{:.2}", 10.0 * ticks as f64 / (60 * seconds) as f64)).collect();
        row(&format!("{name}, 60 frames a second: {}", setting.words), &mut times);
        println!("processor time of the ends in ms for each frame, daemon end and host end: {}", cost.join(", "));
    }
}

/// The same bytes beside the daemon and through the bridge.
fn same(frames: u64) {
    let setting = Setting::start(1, "1gbit");
    let domains = [&setting.near_daemons[0], &setting.near_host];
    let mut sessions = domains.map(|domain| domain.connect().register(LARGE.registration()).unwrap());
    let (mut differ, mut tangled) = (0, 0);
    for frame in 1..=frames {
        let positions = LARGE.positions_f32(frame);
        let [own, far] = sessions.each_mut().map(|session| {
            let answer = session.exchange(STEP, PATIENCE, |to| to.copy_from_slice(&positions)).unwrap();
            let header = CorrectionHeader { stage_ns: [0; 8], ..*answer.header() };
            let bits: Vec<_> = answer.vertices().iter().map(|v| (v.value.map(f32::to_bits), v.flags)).collect();
            (header, bits)
        });
        differ += u64::from(own != far);
        tangled += u64::from(own.0.num_face_pairs > 0);
    }
    println!("{frames} frames of 31,250 triangles, {tangled} tangled: {differ} differ ({})", setting.words);
}

/// Sessions of 7,938 triangles at 30 frames a second each, for ten seconds: how many frames came in time.
fn capacity(num_daemons: usize, num_sessions: u64, rate: &str) {
    let setting = Setting::start(num_daemons, rate);
    let registration = Registration { sparse: true, ..SMALL.registration() };
    let begin = Instant::now() + Duration::from_secs(3);
    let threads: Vec<_> = (0..num_sessions)
        .map(|k| {
            let client = setting.near_host.connect();
            let mut session = client.register(registration.clone()).unwrap();
            std::thread::spawn(move || {
                let (mut times, mut late) = (Times::default(), 0u64);
                for frame in 0..300 {
                    // Hosts do not step at the same instant.
                    let due = begin + Duration::from_micros(33_333 * frame + 33_333 * k / num_sessions);
                    std::thread::sleep(due.saturating_duration_since(Instant::now()));
                    let positions = SMALL.positions_f32(frame);
                    let sent = Instant::now();
                    let answer = session.exchange(STEP, Duration::from_millis(33), |to| to.copy_from_slice(&positions));
                    match answer {
                        Ok(_) => times.add(sent.elapsed()),
                        Err(_) => late += 1,
                    }
                }
                (times, late)
            })
        })
        .collect();
    let report = setting.near_host.connect().status().unwrap();
    let places = report["bridge"]["sessions"].as_array().unwrap().iter().map(|session| session["daemon"].to_string());
    let mut places: Vec<String> = places.collect();
    places.sort();
    let shares: Vec<String> = places.chunk_by(|one, next| one == next).map(|chunk| chunk.len().to_string()).collect();
    let (mut times, mut late) = (Times::default(), 0);
    for thread in threads {
        let (own, own_late) = thread.join().unwrap();
        times.append(own);
        late += own_late;
    }
    let all = times.len() as u64 + late;
    let [half, most] = [0.5, 0.99].map(|part| times.quantile_ms(part));
    println!(
        "| {num_daemons} | {rate} | {num_sessions} ({}) | {all} | {late} | {half:.2} | {most:.2} | {} |",
        shares.join(" + "),
        setting.words
    );
}
