//! Repairs beside frames: what frames wait for repairs, and repairs for frames and for other programs.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::{Duration, Instant},
};

use untangled_client::{Client, Precision, Registration, Session};
use untangled_publisher::scenes::Scene;
use untangled_testkit::{
    generate::{Sheet, waves::deeply_crumpled},
    process::{ClientProcess, PATIENCE, Programs, STEP, TestDomain},
};

use crate::{
    cost::latencies,
    frames::{median, sheet},
};

/// Repairs of each kind.
const NUM_REPAIRS: usize = 3;
/// Longest time for one.
const LIMIT: Duration = Duration::from_secs(600);

struct Tangle {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Tangle {
    /// All types of paths side by side.
    fn gallery() -> Self {
        let cloth = Scene::Gallery.build(7, 0.06);
        let positions = cloth.positions.iter().map(|&position| position.into()).collect();
        Self { positions, triangles: cloth.triangles }
    }

    /// A crumple whose repair takes longer than anything here.
    fn endless() -> Self {
        let mut sheet = Sheet::default();
        sheet.add_grid([0.0, 1.0], [0.0, 1.0], [60; 2], deeply_crumpled(1, 3.0));
        Self { positions: sheet.positions, triangles: sheet.faces }
    }

    fn register(&self, client: &Client) -> Session {
        let registration = Registration {
            num_vertices: self.positions.len(),
            triangles: self.triangles.clone(),
            precision: Precision::F64,
            repairs: true,
            ..Registration::default()
        };
        client.register(registration).expect("there is room")
    }
}

/// Frame latency of a session of 1,000 vertices alone and beside a repair that never rests; and the time of repairs
/// alone, beside a session of 500,000 triangles that never rests, and beside programs that want all processors.
pub(crate) fn beside_frames(programs: Programs) -> Vec<String> {
    let domain = TestDomain::new();
    let _daemon = programs.start_daemon(&domain);
    let client = domain.connect();
    let mut lines = vec!["| what | beside | median ms | 90 % within ms |".into(), "|---|---|---|---|".into()];
    let mut add = |what: &str, beside: &str, times_ms: Vec<f64>| {
        let (middle, late) = (median(times_ms.clone(), 0.5), median(times_ms, 0.9));
        lines.push(format!("| {what} | {beside} | {middle:.2} | {late:.2} |"));
    };
    let (registration, positions) = sheet(1_000);
    let mut session = client.register(registration).expect("there is room");
    let frames = |session: &mut Session| latencies(session, &positions).iter().map(|us| us / 1e3).collect();
    let frame = "frame of 1,000 vertices";
    add(frame, "nothing", frames(&mut session));
    {
        let cloth = Tangle::endless();
        let mut tangled = cloth.register(&client);
        tangled.ask_for_repair(None);
        let number = tangled.publish_f64(STEP, |slots| slots.copy_from_slice(&cloth.positions)).expect("a state");
        tangled.wait(number, PATIENCE).expect("an answer");
        add(frame, "a repair of 7,200 triangles", frames(&mut session));
    }
    drop(session);
    let cloth = Tangle::gallery();
    let what = format!("repair of {} triangles", cloth.triangles.len());
    let mut session = cloth.register(&client);
    let mut repairs = || -> Vec<f64> { (0..NUM_REPAIRS).map(|_| repair_ms(&mut session, &cloth)).collect() };
    add(&what, "nothing", repairs());
    let mut huge = ClientProcess::start(programs, &domain, "huge");
    huge.wait_for("at frame");
    add(&what, "frames of 500,000 triangles without a pause", repairs());
    huge.kill();
    let num_others = 2 * std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let ending = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..num_others {
            scope.spawn(|| {
                while !ending.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        add(&what, &format!("{num_others} busy threads of another program"), repairs());
        ending.store(true, Ordering::Relaxed);
    });
    lines
}

/// The time from the state to its repair, as a host sees it.
fn repair_ms(session: &mut Session, cloth: &Tangle) -> f64 {
    let begin = Instant::now();
    let fill = |slots: &mut [[f64; 3]]| slots.copy_from_slice(&cloth.positions);
    let is_certified = session.repair_f64(STEP, LIMIT, fill).expect("a repair").is_certified();
    assert!(is_certified, "the repair is certified");
    1e3 * begin.elapsed().as_secs_f64()
}
