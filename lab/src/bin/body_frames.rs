//! What a body costs in the frames of a session: times of the stages in the daemon, as a table in Markdown.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin body_frames -- [FRAMES]
//! ```
//!
//! A ball of 100,000 triangles, and an open tube of 30,000 round it that is clean, an edge away from the ball or half
//! its radius, or of which a tenth of the vertices is inside. The cloth moves a little in each frame, or slowly, so
//! that certificates last; the body stays, or moves with it, or is not there. The daemon is a process of this program;
//! times are means of FRAMES (60) frames after ten others.

#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::cast_precision_loss, reason = "prints a table of means")]

use std::time::Instant;

use rustix::process::Signal;
use untangled_client::{Precision, Registration};
use untangled_lab::{
    daemon::{daemon, serve},
    table::{print_header, print_text},
};
use untangled_proto::correction::stage;
use untangled_testkit::{
    generate::Sheet,
    process::{PATIENCE, Programs, STEP, TestDomain},
};

const RADIUS: f64 = 1.0;
/// Of the tube.
const HEIGHT: f64 = 0.2;
const AROUND: u32 = 300;
const ROWS: u32 = 50;
const BODY_RINGS: u32 = 159;
/// Frames that are not counted.
const WARM: usize = 10;

/// Of the tube, and of one that is far from the ball.
const NEAR_RADIUS: f64 = 1.02 * RADIUS;
const FAR_RADIUS: f64 = 1.5 * RADIUS;
/// How high the wave through the cloth is, in its edges: so far that no certificate lasts, and so little that most do.
const FAST: f64 = 0.05;
const SLOW: f64 = 0.001;

/// What stands beside the cloth.
#[derive(Clone, Copy, PartialEq)]
enum Body {
    Missing,
    Still,
    Moving,
}

/// What is measured.
#[derive(Clone, Copy)]
struct Case {
    body: Body,
    is_inside: bool,
    radius: f64,
    wave_edges: f64,
}

const CASES: [(Case, &str); 10] = {
    const fn case(body: Body, radius: f64, wave_edges: f64) -> Case {
        Case { body, is_inside: false, radius, wave_edges }
    }
    const fn inside(body: Body) -> Case {
        Case { is_inside: true, ..case(body, NEAR_RADIUS, FAST) }
    }
    [
        (case(Body::Missing, NEAR_RADIUS, FAST), "no body"),
        (case(Body::Missing, FAR_RADIUS, FAST), "no body, a wider tube"),
        (case(Body::Still, FAR_RADIUS, FAST), "clean, far from a body that stays"),
        (case(Body::Still, NEAR_RADIUS, FAST), "clean, round a body that stays"),
        (case(Body::Moving, NEAR_RADIUS, FAST), "clean, round a body that moves"),
        (inside(Body::Still), "a tenth inside, a body that stays"),
        (inside(Body::Moving), "a tenth inside, a body that moves"),
        (case(Body::Missing, NEAR_RADIUS, SLOW), "slow, no body"),
        (case(Body::Still, NEAR_RADIUS, SLOW), "slow, clean, round a body that stays"),
        (case(Body::Moving, NEAR_RADIUS, SLOW), "slow, clean, round a body that moves"),
    ]
};

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, role, domain] = &arguments[..]
        && role == "daemon"
    {
        return serve(domain);
    }
    let num_frames: usize = arguments.get(1).map_or(60, |count| count.parse().unwrap());
    let domain = TestDomain::new();
    let client_role = |_: &str, _: &str| unreachable!("no client is a process of this program");
    let daemon = Programs { daemon, client: client_role }.start_daemon(&domain);
    let rows: Vec<(&str, [f64; 9])> =
        CASES.into_iter().map(|(case, name)| (name, means(&domain, case, num_frames))).collect();
    assert!(daemon.stop(Signal::TERM).success());
    print_text("Milliseconds of a frame, means\n");
    let names: Vec<String> = stage::NAMES.iter().map(|name| (*name).to_owned()).collect();
    let columns: Vec<&str> = ["scene"].into_iter().chain(names.iter().map(String::as_str)).collect();
    print_header(&[&columns[..], &["round trip", "frames a second"]].concat());
    for (name, means) in rows {
        let cells: Vec<String> = means.iter().map(|mean| format!("{mean:.2}")).collect();
        println!("| {name} | {} | {:.0} |", cells.join(" | "), 1e3 / means[8]);
    }
}

/// Mean times of the stages, in milliseconds, and last that of the whole exchange.
fn means(domain: &TestDomain, case: Case, num_frames: usize) -> [f64; 9] {
    let Case { body, is_inside, .. } = case;
    let scene = scene(case);
    let registration = Registration {
        num_vertices: scene.sheet.positions.len(),
        triangles: scene.sheet.faces.clone(),
        body: (0..scene.num_body).collect(),
        precision: Precision::F32,
        sparse: true,
        ..Registration::default()
    };
    let client = domain.connect();
    let mut session = client.register(registration).unwrap();
    let mut sums = [0.0; 9];
    for frame in 0..WARM + num_frames {
        let positions = scene.frame(frame, body == Body::Moving, case.wave_edges);
        let start = Instant::now();
        let correction = session.exchange(STEP, PATIENCE, |slots| slots.copy_from_slice(&positions)).unwrap();
        let round_trip_ms = 1e3 * start.elapsed().as_secs_f64();
        let header = correction.header();
        assert!((header.num_edge_face_intersections > 0) == is_inside);
        if frame >= WARM {
            let times = header.stage_ns.iter().map(|&ns| ns as f64 / 1e6).chain([round_trip_ms]);
            sums.iter_mut().zip(times).for_each(|(sum, time)| *sum += time);
        }
    }
    sums.map(|sum| sum / num_frames as f64)
}

struct Scene {
    sheet: Sheet,
    num_body: u32,
}

/// The tube alone, or round the ball: outside of it, or with a tenth inside.
fn scene(Case { body, is_inside, radius, .. }: Case) -> Scene {
    let mut sheet = Sheet::default();
    if body != Body::Missing {
        sheet.add_ball([0.0; 3], RADIUS, BODY_RINGS);
    }
    let num_body = u32::try_from(sheet.positions.len()).unwrap();
    let first = sheet.positions.len();
    // Far from round the ball, so that a tenth of it is inside.
    let part_inside = |shift: f64| {
        let mut tube = Sheet::default();
        tube.add_tube(radius, [-HEIGHT, HEIGHT], [AROUND, ROWS], |_, _| [shift, 0.001, 0.0]);
        let inside = tube.positions.iter().filter(|at| at.iter().map(|value| value * value).sum::<f64>() < 1.0).count();
        inside as f64 / tube.positions.len() as f64
    };
    let least = if is_inside { 0.1 } else { 0.0 };
    let shift = (0..400).map(|step| f64::from(step) * 1e-4).find(|&shift| part_inside(shift) >= least).unwrap();
    sheet.add_tube(radius, [-HEIGHT, HEIGHT], [AROUND, ROWS], |_, _| [shift, 0.001, 0.0]);
    let num_cloth = sheet.positions.len() - first;
    eprintln!("{} body vertices, {num_cloth} of cloth, {} triangles", num_body, sheet.faces.len());
    Scene { sheet, num_body }
}

impl Scene {
    /// Positions of a frame: a wave of so many edges runs through what moves.
    #[expect(clippy::cast_possible_truncation, reason = "the session is in single precision")]
    fn frame(&self, frame: usize, body_moves: bool, wave_edges: f64) -> Vec<[f32; 3]> {
        let edge = std::f64::consts::TAU * RADIUS / f64::from(AROUND);
        let wave = |at: f64| wave_edges * edge * (0.3 * frame as f64 + 9.0 * at).sin();
        let places = self.sheet.positions.iter().zip(0u32..);
        let moved = places.map(|(at, vertex)| {
            let moves = vertex >= self.num_body || body_moves;
            let step = if moves { wave(at[1]) } else { 0.0 };
            [at[0] + step, at[1], at[2] + 0.5 * step].map(|value| value as f32)
        });
        moved.collect()
    }
}
