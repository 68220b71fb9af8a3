//! Outfits of four layers on a body in poses, as `docs/results/outfits.md`.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin outfits_table -- [POSES] > docs/results/outfits.md
//! cargo run --release -p untangled-lab --bin outfits_table -- write FOLDER    # the first pose as OBJ files
//! ```
//!
//! POSES (all) are so many of the poses. Everything is judged by the checker, whose code the repair has no part in. The
//! daemon of the animated outfits is a process of this program.

#![allow(clippy::print_stdout, clippy::cast_possible_truncation, reason = "prints a document; single precision")]

use std::{
    ops::ControlFlow,
    path::Path,
    time::{Duration, Instant},
};

use rustix::process::Signal;
use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    relax::{RelaxSettings, open_gap, relax},
    sides::Layers,
};
use untangled_checker::{PolygonRef, near_pairs, polygon_crossings, vertices_behind_layers, vertices_inside};
use untangled_client::{CorrectionKind, Precision, Registration};
use untangled_lab::{
    Failure,
    daemon::{daemon, serve},
    table::{print_header, print_text},
};
use untangled_testkit::{
    files::formats::obj,
    generate::outfits::{GARMENTS, Outfit, Pose},
    process::{Programs, STEP, TestDomain},
};

/// Vertices round the torso of the garments.
const RESOLUTIONS: [u32; 2] = [28, 40];
const GAP_M: f64 = 0.002;
/// Frames of an animation, and by how much limbs turn in each, in radians.
const FRAMES: u32 = 8;
const TURN: f64 = 0.02;
const LONG: Duration = Duration::from_secs(600);

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, role, domain] = &arguments[..]
        && role == "daemon"
    {
        serve(domain);
        return Ok(());
    }
    if let [_, role, folder] = &arguments[..]
        && role == "write"
    {
        return write_files(Path::new(folder));
    }
    let num_poses = arguments.get(1).map_or(Ok(Pose::ALL.len()), |count| count.parse())?;
    let poses = &Pose::ALL[..num_poses.min(Pose::ALL.len())];
    print_still(poses)?;
    print_animated(poses)
}

/// Writes the body and the garments in the first pose, each as a file.
fn write_files(folder: &Path) -> Result<(), Failure> {
    let outfit = Outfit::new(Pose::ALL[0], RESOLUTIONS[1]);
    std::fs::create_dir_all(folder)?;
    for (name, sheet) in GARMENTS.into_iter().zip(&outfit.layers).chain([("body", &outfit.body)]) {
        std::fs::write(folder.join(name).with_extension("obj"), obj(sheet, false))?;
    }
    Ok(())
}

fn print_still(poses: &[Pose]) -> Result<(), Failure> {
    print_text(
        "# Outfits\n\n\
         A generated body with arms and legs, whose parts overlap, and on it a shirt, trousers, a jacket and a belt, \
         each through those below it, cut below the armpits, in ten poses: sleeves from against the torso to \
         overhead, legs from nearly touching to apart. Made by\n\n\
         ```sh\n\
         cargo run --release -p untangled-lab --bin outfits_table > docs/results/outfits.md\n\
         ```\n\n\
         on a busy machine of two processors. Everything is judged by the checker, whose code the repair has no part \
         in: `pairs` of triangles that cross, vertices `inside` of the body, vertices `behind` an inner layer, pairs \
         of primitives nearer than the gap. Edges are least and largest ratios to the input, displacements parts of \
         the mean edge of the cloth.\n\n\
         ## Still\n\n\
         Untangled, then set apart to a gap of 2 mm.\n",
    );
    print_header(&[
        "pose",
        "#Tri",
        "pairs before",
        "inside",
        "behind",
        "pairs after",
        "inside",
        "behind",
        "below the gap",
        "edges",
        "mean move",
        "farthest",
        "s",
    ]);
    for around in RESOLUTIONS {
        for (number, pose) in (1..).zip(poses) {
            println!("| {number} | {}", still(*pose, around)?);
        }
    }
    Ok(())
}

fn print_animated(poses: &[Pose]) -> Result<(), Failure> {
    print_text(
        "\n## Animated through the daemon\n\n\
         The body turns all its limbs by 0.02 rad in each frame, and carries the cloth; the first frame is tangled. \
         Each of 8 frames is repaired, in single precision, and the host goes on from there. Counts are the worst of \
         all frames but for those of the first one before its repair; edges are beside the first frame.\n",
    );
    print_header(&[
        "pose",
        "#Tri",
        "pairs before",
        "behind",
        "certified",
        "pairs after",
        "inside",
        "behind",
        "edges",
        "first repair, s",
        "others, s",
    ]);
    let domain = TestDomain::new();
    let client_role = |_: &str, _: &str| unreachable!("no client is a process of this program");
    let running = Programs { daemon, client: client_role }.start_daemon(&domain);
    for (number, pose) in (1..).zip(poses) {
        println!("| {number} | {}", animated(&domain, *pose, RESOLUTIONS[0])?);
    }
    assert!(running.stop(Signal::TERM).success());
    Ok(())
}

/// What the checker counts.
#[derive(Clone, Copy, Default)]
struct Verdict {
    num_pairs: usize,
    num_inside: usize,
    num_behind: usize,
}

impl Verdict {
    fn of(world: &MeshDescription, positions: &[[f64; 3]]) -> Result<Self, Failure> {
        let first_body = world.body.first().copied().unwrap_or(u32::MAX);
        let polygons = world.faces.iter().map(|corners| PolygonRef {
            corners,
            triangles: std::slice::from_ref(corners),
            is_body: corners[0] >= first_body,
        });
        let (body, cloth): (Vec<[u32; 3]>, Vec<[u32; 3]>) =
            world.faces.iter().partition(|corners| corners[0] >= first_body);
        let numbers = world.layers.as_deref().unwrap_or_default();
        // All faces point outwards.
        let behind = vertices_behind_layers(positions, &cloth, numbers, &vec![true; cloth.len()])?;
        Ok(Self {
            num_pairs: polygon_crossings(positions, polygons, false)?.pairs.len(),
            num_inside: vertices_inside(positions, 0..first_body, &body)?.len(),
            num_behind: behind.len(),
        })
    }

    fn worst(self, other: Self) -> Self {
        Self {
            num_pairs: self.num_pairs.max(other.num_pairs),
            num_inside: self.num_inside.max(other.num_inside),
            num_behind: self.num_behind.max(other.num_behind),
        }
    }
}

/// The cells of an outfit that does not move, but for that of the pose.
fn still(pose: Pose, around: u32) -> Result<String, Failure> {
    let (world, start) = Outfit::new(pose, around).world();
    let before = Verdict::of(&world, &start)?;
    let clock = Instant::now();
    let mesh = Mesh::new(world.clone())?;
    let mesh = Layers::decide(mesh.clone(), &Frame::new(&mesh, &start)?);
    let settings = RelaxSettings::default();
    let relaxed = relax(&mesh, &start, &settings, &mut |_| ControlFlow::Continue(()))?;
    let opened = open_gap(&mesh, &relaxed.positions, GAP_M, &settings, &mut |_| ControlFlow::Continue(()), &|| false)?;
    let seconds = clock.elapsed().as_secs_f64();
    let after = Verdict::of(&world, &opened.positions)?;
    let num_cloth_faces = world.faces.iter().filter(|corners| corners[0] < world.body[0]).count();
    let near = near_pairs(&opened.positions, &world.faces, num_cloth_faces, GAP_M)?;
    let Change { edges: [least, largest], mean, farthest } = Change::of(&world, &start, &opened.positions);
    Ok(format!(
        "{} | {} | {} | {} | {} | {} | {} | {} | {least:.2} to {largest:.2} | {mean:.3} | {farthest:.2} | \
         {seconds:.1} |",
        world.faces.len(),
        before.num_pairs,
        before.num_inside,
        before.num_behind,
        after.num_pairs,
        after.num_inside,
        after.num_behind,
        near.total(),
    ))
}

/// How cloth changed.
struct Change {
    edges: [f64; 2],
    mean: f64,
    farthest: f64,
}

impl Change {
    fn of(world: &MeshDescription, before: &[[f64; 3]], after: &[[f64; 3]]) -> Self {
        let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        let (mut edges, mut sum, mut count) = ([f64::INFINITY, 0.0_f64], 0.0, 0.0);
        for corners in world.faces.iter().filter(|corners| corners[0] < world.body[0]) {
            for k in 0..3 {
                let [a, b] = [corners[k], corners[(k + 1) % 3]].map(|vertex| vertex as usize);
                let (then, now) = (distance(before[a], before[b]), distance(after[a], after[b]));
                edges = [edges[0].min(now / then), edges[1].max(now / then)];
                sum += then;
                count += 1.0;
            }
        }
        let moves = before.iter().zip(after).take(world.body[0] as usize).map(|(a, b)| distance(*a, *b));
        let edge = sum / count;
        Self {
            edges,
            mean: moves.clone().sum::<f64>() / f64::from(world.body[0]) / edge,
            farthest: moves.fold(0.0, f64::max) / edge,
        }
    }
}

/// The pose in a frame.
fn turned(pose: Pose, frame: u32) -> Pose {
    let turn = TURN * f64::from(frame);
    Pose { arms: pose.arms.map(|angle| angle + turn), legs: pose.legs.map(|angle| angle + turn) }
}

/// The cells of an outfit that a daemon repairs frame by frame, but for that of the pose.
fn animated(domain: &TestDomain, pose: Pose, around: u32) -> Result<String, Failure> {
    let (world, start) = Outfit::new(pose, around).world();
    let registration = Registration {
        num_vertices: world.num_vertices,
        triangles: world.faces.clone(),
        layers: world.layers.clone(),
        body: world.body.clone(),
        precision: Precision::F32,
        correction: CorrectionKind::Displacement,
        repairs: true,
        ..Registration::default()
    };
    let client = domain.connect();
    let mut session = client.register(registration).map_err(|error| error.to_string())?;
    let before = Verdict::of(&world, &start)?;
    let mut positions: Vec<[f32; 3]> = start.iter().map(|at| at.map(|value| value as f32)).collect();
    let (mut num_certified, mut after, mut seconds) = (0, Verdict::default(), [0.0; 2]);
    let mut carried = start.clone();
    for frame in 0..FRAMES {
        let next = Outfit::cut_for(pose, turned(pose, frame), around).world().1;
        for (at, (from, to)) in positions.iter_mut().zip(carried.iter().zip(&next)) {
            *at = std::array::from_fn(|k| (f64::from(at[k]) + (to[k] - from[k])) as f32);
        }
        carried = next;
        let clock = Instant::now();
        let repair = session.repair(STEP, LONG, |slots| slots.copy_from_slice(&positions))?;
        seconds[usize::from(frame > 0)] += clock.elapsed().as_secs_f64();
        num_certified += usize::from(repair.is_certified());
        let steps = repair.displacements_f32().ok_or("a session in single precision")?;
        for (at, step) in positions.iter_mut().zip(steps) {
            *at = std::array::from_fn(|k| at[k] + step[k]);
        }
        drop(repair);
        let reached: Vec<[f64; 3]> = positions.iter().map(|at| at.map(f64::from)).collect();
        after = after.worst(Verdict::of(&world, &reached)?);
    }
    let reached: Vec<[f64; 3]> = positions.iter().map(|at| at.map(f64::from)).collect();
    let [least, largest] = Change::of(&world, &start, &reached).edges;
    Ok(format!(
        "{} | {} | {} | {num_certified} of {FRAMES} | {} | {} | {} | {least:.2} to {largest:.2} | {:.1} | {:.1} |",
        world.faces.len(),
        before.num_pairs,
        before.num_behind,
        after.num_pairs,
        after.num_inside,
        after.num_behind,
        seconds[0],
        seconds[1] / f64::from(FRAMES - 1),
    ))
}
