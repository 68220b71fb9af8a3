//! The repair with substitutes for the solver.

#![expect(clippy::float_cmp, reason = "coordinates must come back as the same bits")]

use std::{fs, ops::ControlFlow};

use untangle::{
    frame::Frame,
    mesh::Mesh,
    relax::{BlockedPath, Effort, Iteration, Method, RelaxSettings, Relaxation},
    weld::Weld,
};
use untangled_mesh_io::read_mesh;

use crate::cli::{gap::GapArgs, input::Input, weld::WeldArg, world::WorldArgs};

use super::{Blocked, Distortion, FixArgs, QualityArg, fix, terminal::Interrupt};

const FLOOR: &str = "v 0 0 1\nv 4 0 1\nv 0 4 1\nf 1 2 3\n";
const SPIKE: &str = "v 1 1 0.5\nv 1 1.5 3\nv 1.5 1 3\nf 1 2 3\n";
/// Both of them in single precision; the floor rises by one last place.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 1\n4 0 1\n0 4 1.00000011920928955\n\
1 1 0.5\n1 1.5 3\n1.5 1 3\n3 0 1 2\n3 3 4 5\n";

const STEP: Iteration =
    Iteration { num_edge_face_intersections: 1, path_length_m: 0.5, method: Method::Push, num_pairs_below: None };

fn result(positions: Vec<[f64; 3]>) -> Relaxation {
    Relaxation { positions, history: vec![STEP], blocked: Vec::new(), interrupted: false }
}

/// A folder with files, and arguments that read `inputs` of them and write `out`.
fn set_up(files: &[(&str, &str)], inputs: &[&str], out: &str) -> (tempfile::TempDir, FixArgs) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let args = FixArgs {
        world: WorldArgs {
            files: inputs.iter().map(|name| folder.path().join(name)).collect(),
            weld: WeldArg::Exact,
            roles: Default::default(),
            gap: GapArgs::default(),
            max_face_pairs: 10,
            sequence: crate::cli::sequence::args::CacheArgs::default(),
        },
        out: folder.path().join(out),
        json: false,
        report: None,
        html: None,
        max_iterations: 10,
        time_limit: None,
        quality: QualityArg::Balanced,
        pin: None,
        overwrite: false,
    };
    (folder, args)
}

fn names(folder: &tempfile::TempDir) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Lifts the tip, which is vertex 3, to a height.
fn lift(positions: &[[f64; 3]], z: f64) -> Relaxation {
    let mut positions = positions.to_vec();
    positions[3][2] = z;
    result(positions)
}

#[test]
fn fix_of_more_intersections_than_the_limit_writes_nothing_and_names_the_flag() {
    let (folder, args) = set_up(&[("a.obj", FLOOR), ("b.obj", SPIKE)], &["a.obj", "b.obj"], "out.obj");
    let args = FixArgs { world: WorldArgs { max_face_pairs: 0, ..args.world.clone() }, ..args };
    let mut solver = |_: &Mesh,
                      _: &[[f64; 3]],
                      _: &RelaxSettings,
                      _: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
                      _: &(dyn Fn() -> bool + Sync)| panic!("nothing is untangled");
    let error = fix(&args, &mut solver, &Interrupt::default()).unwrap_err().to_string();
    assert!(
        error.contains("more than 0 pairs of triangles intersect") && error.contains("--max-face-pairs"),
        "{error}"
    );
    assert_eq!(names(&folder), ["a.obj", "b.obj"]);
}

#[test]
fn fix_of_a_solved_state_writes_and_reports_it() {
    let (folder, mut args) =
        set_up(&[("floor.obj", FLOOR), ("spike.obj", SPIKE)], &["floor.obj", "spike.obj"], "out.obj");
    args.report = Some(folder.path().join("report.json"));
    args.quality = QualityArg::Accurate;
    let mut solver = |_: &Mesh,
                      positions: &[[f64; 3]],
                      settings: &RelaxSettings,
                      progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
                      _: &(dyn Fn() -> bool + Sync)| {
        let expected = RelaxSettings {
            effort: Effort::Accurate,
            max_iterations: 10,
            single_precision: false,
            other_attempts: true,
        };
        assert_eq!(*settings, expected);
        assert!(progress(&STEP).is_continue());
        Ok(lift(positions, 1.25))
    };
    let report = fix(&args, &mut solver, &Interrupt::default()).unwrap().report;
    assert!(report.clean && !report.before.is_clean() && report.after.is_clean());
    assert_eq!((report.num_iterations, report.history.as_slice()), (1, [STEP].as_slice()));
    assert_eq!(report.distortion.max_displacement_m, 0.75);
    assert_eq!(report.distortion.mean_displacement_m, 0.125);
    let length = |z: f64| (0.25 + (3.0 - z) * (3.0 - z)).sqrt();
    let ratio = length(1.25) / length(0.5);
    assert!((report.distortion.max_edge_stretch - ratio).abs() < 1e-12);
    assert!((report.distortion.mean_edge_stretch - (4.0 + 2.0 * ratio) / 6.0).abs() < 1e-12);
    let text = fs::read_to_string(&args.out).unwrap();
    assert_eq!(text, format!("{FLOOR}o spike\n{}f 4 5 6\n", SPIKE.replace("0.5\n", "1.25\n").replace("f 1 2 3\n", "")));
    assert_eq!(fs::read_to_string(args.report.unwrap()).unwrap(), report.to_json());
    assert_eq!(names(&folder), ["floor.obj", "out.obj", "report.json", "spike.obj"]);
    let lines = report.to_string();
    assert!(lines.contains("clean: 1 intersecting face pair became 0, 2 edge-face intersections became 0"), "{lines}");
    assert!(lines.contains("1 iteration in ") && lines.contains(": push 1"), "{lines}");
}

#[test]
fn fix_of_a_state_that_rounding_tangles_relaxes_again() {
    let (_folder, args) = set_up(&[("in.ply", PLY)], &["in.ply"], "out.ply");
    let mut rounds = Vec::new();
    let mut solver = |_: &Mesh,
                      positions: &[[f64; 3]],
                      settings: &RelaxSettings,
                      _: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
                      _: &(dyn Fn() -> bool + Sync)| {
        assert!(settings.single_precision);
        rounds.push((positions[3][2], settings.max_iterations));
        // A third of the last place above the floor is clean, but a single can't hold it.
        let height = if rounds.len() < 3 { 1.0 + 0.33 * f64::from(f32::EPSILON) } else { 1.125 };
        Ok(lift(positions, height))
    };
    let report = fix(&args, &mut solver, &Interrupt::default()).unwrap().report;
    assert!(report.clean);
    assert_eq!(rounds, [(0.5, 10), (1.0, 9), (1.0, 8)]);
    assert_eq!((report.num_iterations, report.history.len()), (3, 3));
    assert_eq!(read_mesh(&args.out).unwrap().positions()[3], [1.0, 1.0, 1.125]);

    // The rounds end when the iterations are used up.
    let (_folder, mut args) = set_up(&[("in.ply", PLY)], &["in.ply"], "out.ply");
    args.max_iterations = 2;
    let mut never =
        |_: &Mesh,
         positions: &[[f64; 3]],
         _: &RelaxSettings,
         _: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
         _: &(dyn Fn() -> bool + Sync)| { Ok(lift(positions, 1.0 + 0.33 * f64::from(f32::EPSILON))) };
    let report = fix(&args, &mut never, &Interrupt::default()).unwrap().report;
    assert!(!report.clean && report.num_iterations == 2);
    assert_eq!(report.blocked[0].reason, "not resolved within 2 iterations");
    assert!(args.out.exists());
}

#[test]
fn fix_of_a_blocked_state_writes_it_unless_it_is_worse_than_the_input() {
    let files = [("floor.obj", FLOOR), ("spike.obj", SPIKE)];
    let (_folder, args) = set_up(&files, &["floor.obj", "spike.obj"], "out.obj");
    let reason = BlockedPath {
        pair_type: untangle::paths::PairType::BoundaryInside,
        vertex: 3,
        length_m: 0.5,
        reason: "pinned".into(),
    };
    let mut blocked = |_: &Mesh,
                       positions: &[[f64; 3]],
                       _: &RelaxSettings,
                       _: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
                       _: &(dyn Fn() -> bool + Sync)| {
        Ok(Relaxation { blocked: vec![reason.clone()], ..lift(positions, 0.25) })
    };
    let report = fix(&args, &mut blocked, &Interrupt::default()).unwrap().report;
    assert!(!report.clean && report.after == report.before);
    let mut expected = Blocked::from(reason.clone());
    (expected.file, expected.vertex_in_file) = (args.world.files[1].display().to_string(), 0);
    assert_eq!(report.blocked, [expected]);
    let line = format!("left: BI/BI of 0.50000 m at vertex 0 of {}: pinned", args.world.files[1].display());
    assert!(report.to_string().contains(&line), "{report}");
    assert!(fs::read_to_string(&args.out).unwrap().contains("v 1 1 0.25"));

    let third = [("floor.obj", FLOOR), ("spike.obj", SPIKE), ("far.obj", "v 1 1 9\nv 2 1 9\nv 1 2 9\nf 1 2 3\n")];
    let (folder, mut args) = set_up(&third, &["floor.obj", "spike.obj", "far.obj"], "");
    args.out = folder.path().join("out");
    fs::create_dir(&args.out).unwrap();
    let mut worse = |_: &Mesh,
                     positions: &[[f64; 3]],
                     _: &RelaxSettings,
                     _: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
                     _: &(dyn Fn() -> bool + Sync)| {
        let mut positions = positions.to_vec();
        // The third triangle goes through the second.
        for position in &mut positions[6..] {
            position[2] = 2.0;
        }
        Ok(result(positions))
    };
    let report = fix(&args, &mut worse, &Interrupt::default()).unwrap().report;
    assert_eq!((report.after, report.distortion.max_displacement_m), (report.before, 0.0));
    assert_eq!(report.blocked[0].reason, "not resolved");
    for (name, text) in third {
        assert_eq!(fs::read_to_string(args.out.join(name)).unwrap(), text);
    }
}

#[test]
fn fix_when_interrupted_writes_nothing() {
    let (folder, args) = set_up(&[("in.ply", PLY)], &["in.ply"], "out.ply");
    let interrupt = Interrupt::default();
    let flag = interrupt.flag();
    let mut solver = |_: &Mesh,
                      positions: &[[f64; 3]],
                      _: &RelaxSettings,
                      progress: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
                      _: &(dyn Fn() -> bool + Sync)| {
        assert!(progress(&STEP).is_continue());
        flag.store(true, std::sync::atomic::Ordering::Relaxed);
        assert!(progress(&STEP).is_break());
        Ok(Relaxation { interrupted: true, ..lift(positions, 1.25) })
    };
    let error = fix(&args, &mut solver, &interrupt).unwrap_err();
    assert_eq!(error.to_string(), "interrupted; nothing was written");
    assert_eq!(names(&folder), ["in.ply"]);
}

#[test]
fn fix_of_fixed_vertices_requires_them_to_be_pinned() {
    let text = PLY.replace("float", "int").replace("1.00000011920928955", "1").replace("0.5", "0").replace("1.5", "2");
    let (folder, mut args) = set_up(&[("in.ply", &text), ("pins.txt", "0 1 2\n3 4 5")], &["in.ply"], "out.ply");
    let mut calls = 0;
    let mut solver = |mesh: &Mesh,
                      positions: &[[f64; 3]],
                      _: &RelaxSettings,
                      _: &mut dyn FnMut(&Iteration) -> ControlFlow<()>,
                      _: &(dyn Fn() -> bool + Sync)| {
        calls += 1;
        assert!(mesh.vertex_ids().all(|vertex| mesh.is_pinned(vertex)));
        Ok(result(positions.to_vec()))
    };
    let error = fix(&args, &mut solver, &Interrupt::default()).unwrap_err().to_string();
    let expected = "out.ply: vertices 0 to 5 can't be moved: its coordinates are integers; \
                    write .obj or .ply, or pin these vertices";
    assert!(error.ends_with(expected), "{error}");
    args.pin = Some(folder.path().join("pins.txt"));
    let report = fix(&args, &mut solver, &Interrupt::default()).unwrap().report;
    assert!(!report.clean && calls == 1);
    assert_eq!(fs::read_to_string(&args.out).unwrap(), text);
}

#[test]
fn distortion_of_edges_without_length_has_no_ratio() {
    let faces = vec![[0, 1, 2]];
    let mesh = Mesh::new(untangle::mesh::MeshDescription { num_vertices: 3, faces, ..Default::default() }).unwrap();
    let point = [[0.0; 3], [0.0; 3], [1.0, 0.0, 0.0]];
    let opened = [[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let input = |positions: &[[f64; 3]]| Input {
        weld: Weld::none(3),
        mesh: mesh.clone(),
        positions: positions.to_vec(),
        frame: Frame::new(&mesh, positions).unwrap(),
    };
    let distortion = Distortion::new(&input(&point), &opened);
    assert_eq!(
        (distortion.max_edge_stretch, distortion.mean_edge_stretch),
        (2.0f64.sqrt(), (1.0 + 2.0f64.sqrt()) / 2.0)
    );
    let closed = Distortion::new(&input(&opened), &point);
    assert_eq!(closed.max_edge_stretch, 0.0);
    assert!(closed.mean_edge_stretch.is_finite());
    assert_eq!(Distortion::new(&input(&[[0.0; 3]; 3]), &opened).max_edge_stretch, 1.0);
}
