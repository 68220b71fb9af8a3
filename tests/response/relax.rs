//! The relaxation behind `untangled fix`, on generated scenes; judged by the exact checker of the example host.

use std::{
    ops::ControlFlow,
    sync::atomic::{AtomicUsize, Ordering},
};

use untangle::{
    mesh::{Mesh, MeshDescription},
    relax::{Effort, Method, RelaxSettings, Relaxation, relax, relax_until},
};
use untangled_checker::count_edge_face;
use untangled_testkit::generate::{Sheet, knots::Knot, waves::deeply_crumpled};

/// One sheet for each kind of path, with the most iterations that it may take.
fn scenes() -> Vec<(&'static str, Sheet)> {
    let flat = |sheet: &mut Sheet| {
        sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [20, 20], |u, v| [u, v, 0.01 * (9.0 * u + 4.0 * v).sin()])
    };
    let mut bump = Sheet::default();
    flat(&mut bump);
    bump.add_grid([-0.9, 0.9], [-0.9, 0.9], [18, 18], |u, v| [u, v, 0.2 - 0.5 * (-6.0 * (u * u + v * v)).exp()]);
    let mut strip = Sheet::default();
    flat(&mut strip);
    strip.add_grid([-0.3, 0.31], [-0.43, 0.6], [6, 10], |u, v| [u, 0.02 + 0.1 * u + 0.05 * v, v]);
    let mut corner = Sheet::default();
    flat(&mut corner);
    corner.add_grid([0.62, 1.43], [-0.43, 0.6], [8, 10], |u, v| [u, 0.02 + 0.1 * u + 0.05 * v, v]);
    let circle = |x: f64, v: f64| 0.12 - (x * x + (v - 0.5) * (v - 0.5));
    let drop = |x: f64, v: f64| 0.3 * x - 0.6 * x * x - (v - 0.5) * (v - 0.5);
    vec![
        ("CLOSED", bump),
        ("BB/II", strip),
        ("BI/BI", corner),
        ("LL", Sheet::fold([-1.0, 0.97], [30, 31], circle)),
        ("BLI", Sheet::fold([-1.0, 0.8], [30, 31], |x, v| v - 0.4 - 0.2 * x)),
        ("EIGHT", Sheet::fold([-1.0, 1.0], [30, 36], drop)),
    ]
}

fn run(sheet: &Sheet, settings: &RelaxSettings) -> Relaxation {
    let mesh = sheet.mesh();
    relax(&mesh, &sheet.positions, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn relax_on_each_path_type_separates_without_crushing_faces() {
    for (name, sheet) in scenes() {
        let before = count_edge_face(&sheet.positions, &sheet.faces).unwrap();
        let relaxation = run(&sheet, &RelaxSettings::default());
        let after = count_edge_face(&relaxation.positions, &sheet.faces).unwrap();
        println!("{name}: {before} to {after} in {} iterations", relaxation.history.len());
        assert!(before > 0 && after == 0 && relaxation.blocked.is_empty(), "{name}: {before} {after}");
        assert_eq!(relaxation.history.last().unwrap().num_edge_face_intersections, 0);
        for &[a, b, c] in &sheet.faces {
            let area = |positions: &[[f64; 3]]| {
                let [a, b, c] = [a, b, c].map(|vertex| nalgebra::Point3::from(positions[vertex as usize]));
                (b - a).cross(&(c - a)).norm()
            };
            assert!(area(&relaxation.positions) >= 0.05 * area(&sheet.positions), "{name}");
        }
    }
}

/// A sheet crumpled so much that no trial displacement helps.
fn crumple() -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([0.0, 1.0], [0.0, 1.0], [20, 20], deeply_crumpled(1, 2.2));
    sheet
}

#[test]
fn relax_on_deeply_crumpled_cloth_straightens_it() {
    let sheet = crumple();
    assert!(count_edge_face(&sheet.positions, &sheet.faces).unwrap() > 200);
    let relaxation = run(&sheet, &RelaxSettings::default());
    assert_eq!(count_edge_face(&relaxation.positions, &sheet.faces), Ok(0));
    assert!(relaxation.history.iter().any(|step| step.method == Method::Flatten));
    let length = |positions: &[[f64; 3]], a: u32, b: u32| {
        let [a, b] = [a, b].map(|vertex| nalgebra::Point3::from(positions[vertex as usize]));
        (b - a).norm()
    };
    for [a, b] in sheet.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]) {
        let ratio = length(&relaxation.positions, a, b) / length(&sheet.positions, a, b);
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
    }
}

#[test]
fn relax_on_clean_cloth_keeps_every_bit() {
    let mut sheet = Sheet::default();
    sheet.add_grid([0.0, 1.0], [0.0, 1.0], [10, 10], |u, v| [u / 3.0, v / 7.0, (u * v).sin()]);
    let relaxation = run(&sheet, &RelaxSettings::default());
    assert!(relaxation.history.is_empty() && relaxation.blocked.is_empty());
    let bits = |positions: &[[f64; 3]]| positions.iter().flatten().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&relaxation.positions), bits(&sheet.positions));
}

#[test]
fn relax_on_any_number_of_threads_gives_the_same_bits() {
    let sheet = &scenes()[1].1;
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(sheet, &RelaxSettings::default()))
    };
    let one = on(1);
    assert!(!one.history.is_empty());
    assert_eq!(one, on(3));
}

#[test]
fn relax_with_pins_keeps_them_and_reports_blocked_paths() {
    let sheet = &scenes()[1].1;
    let all = (0..u32::try_from(sheet.positions.len()).unwrap()).collect::<Vec<_>>();
    let flat = all[..21 * 21].to_vec();
    let with_pins = |pins: Vec<u32>| {
        let mesh = Mesh::new(MeshDescription { pins, ..sheet.description() }).unwrap();
        relax(&mesh, &sheet.positions, &RelaxSettings::default(), &mut |_| ControlFlow::Continue(())).unwrap()
    };
    let held = with_pins(flat);
    assert_eq!(held.positions[..21 * 21], sheet.positions[..21 * 21]);
    assert_eq!(count_edge_face(&held.positions, &sheet.faces), Ok(0));
    let stuck = with_pins(all);
    assert_eq!(stuck.positions, sheet.positions);
    assert!(!stuck.blocked.is_empty() && !stuck.blocked[0].reason.is_empty());
}

#[test]
fn relax_in_single_precision_keeps_positions_representable() {
    let mut sheet = scenes().swap_remove(1).1;
    #[expect(clippy::cast_possible_truncation, reason = "the purpose")]
    let rounded = |value: f64| f64::from(value as f32);
    sheet.positions.iter_mut().flatten().for_each(|value| *value = rounded(*value));
    let settings = RelaxSettings { single_precision: true, effort: Effort::Fast, ..RelaxSettings::default() };
    let relaxation = run(&sheet, &settings);
    assert!(relaxation.positions.iter().flatten().all(|&value| value.to_bits() == rounded(value).to_bits()));
    assert_eq!(count_edge_face(&relaxation.positions, &sheet.faces), Ok(0));
}

#[test]
fn relax_when_interrupted_returns_the_best_state() {
    let sheet = &scenes()[3].1;
    let mesh = sheet.mesh();
    let settings = RelaxSettings::default();
    let mut calls = 0;
    let relaxation = relax(&mesh, &sheet.positions, &settings, &mut |_| {
        calls += 1;
        ControlFlow::Break(())
    })
    .unwrap();
    assert!(relaxation.interrupted && calls == 1 && relaxation.history.len() == 1);
    let none = RelaxSettings { max_iterations: 0, ..settings };
    let relaxation = relax(&mesh, &sheet.positions, &none, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(relaxation.positions, sheet.positions);
    assert!(!relaxation.blocked.is_empty());
}

#[test]
fn relax_on_fold_of_one_ring_opens_it_with_one_push() {
    // Eight triangles round a vertex, of which one pierces another: no shorter path leaves both their areas.
    let ring = [
        [-0.0318, 0.0205, -0.0353],
        [-0.0657, 0.0114, -0.0993],
        [-0.0116, 0.1008, 0.0688],
        [0.0573, -0.0885, -0.1805],
        [-0.0557, 0.1147, 0.0333],
        [0.0523, -0.0627, -0.1627],
        [-0.0700, 0.1135, -0.0122],
        [0.0220, -0.0856, -0.2807],
    ];
    let positions = [vec![[0.0; 3]], ring.to_vec()].concat();
    let quads = [[0, 1, 5, 3], [0, 3, 7, 2], [0, 2, 8, 4], [0, 4, 6, 1]];
    let faces: Vec<[u32; 3]> = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = Mesh::new(MeshDescription { num_vertices: 9, faces: faces.clone(), ..Default::default() }).unwrap();
    assert_eq!(count_edge_face(&positions, &faces), Ok(1));
    let relaxed = |other_attempts: bool| {
        let settings = RelaxSettings { other_attempts, ..Default::default() };
        let relaxation = relax(&mesh, &positions, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(count_edge_face(&relaxation.positions, &faces), Ok(0));
        let methods: Vec<Method> = relaxation.history.iter().map(|step| step.method).collect();
        println!("{methods:?}");
        let moved = relaxation.positions.iter().zip(&positions);
        let sum_m: f64 =
            moved.map(|(now, before)| (nalgebra::Point3::from(*now) - nalgebra::Point3::from(*before)).norm()).sum();
        (methods, sum_m)
    };
    let (methods, first_m) = relaxed(false);
    assert!(methods.iter().all(|method| matches!(method, Method::Push | Method::RecoverShape)));
    let (methods, least_m) = relaxed(true);
    assert!(methods.iter().all(|method| *method != Method::Flatten));
    assert!(least_m <= first_m, "{least_m} m, {first_m} m by the first attempt alone");
}

#[test]
fn relax_on_bodies_that_overlap_waits_for_nothing_there() {
    let mut sheet = scenes().swap_remove(1).1;
    let free = sheet.positions.len();
    // Two bodies, each a sheet on end: they cross each other and nothing else.
    for turn in [0.0, 0.4] {
        sheet.add_grid([-0.5, 0.5], [0.0, 1.0], [6, 6], |u, v| [3.0 + u, turn * u + 0.01, v]);
    }
    let pins: Vec<u32> = (free..sheet.positions.len()).map(|vertex| u32::try_from(vertex).unwrap()).collect();
    let alone = run(&scenes()[1].1, &RelaxSettings::default());
    let relax_with = |pins: Vec<u32>| {
        let mesh = Mesh::new(MeshDescription { pins, ..sheet.description() }).unwrap();
        relax(&mesh, &sheet.positions, &RelaxSettings::default(), &mut |_| ControlFlow::Continue(())).unwrap()
    };
    let relaxation = relax_with(pins.clone());
    assert_eq!(relaxation.history, alone.history);
    assert_eq!(relaxation.positions[..free], alone.positions[..]);
    assert!(!relaxation.blocked.is_empty());
    assert!(relaxation.blocked.iter().all(|path| path.reason == "all its vertices are pinned"));
    // Where nothing else intersects, nothing is tried.
    let all = (0..u32::try_from(sheet.positions.len()).unwrap()).collect();
    assert!(relax_with(all).history.is_empty());
    // One free body moves out of the pinned one.
    assert!(relax_with(pins[49..].to_vec()).blocked.is_empty());
}

#[test]
fn relax_that_moves_other_vertices_keeps_tiny_values_and_signs_of_zeros() {
    let mut sheet = scenes().swap_remove(1).1;
    let first = sheet.positions.len();
    let corner = u32::try_from(first).unwrap();
    sheet.positions.extend([[-0.0, 1e-80, 9.0], [1.0, -1e-300, 9.0], [-0.0, 1.0, 9.0]]);
    sheet.faces.push([corner, corner + 1, corner + 2]);
    let mesh = Mesh::new(sheet.bare_description()).unwrap();
    let settings = RelaxSettings::default();
    let relaxation = relax(&mesh, &sheet.positions, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(!relaxation.history.is_empty());
    let bits = |positions: &[[f64; 3]]| positions[first..].iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&relaxation.positions), bits(&sheet.positions));
}

#[test]
fn relax_until_stopped_at_once_gives_back_the_input_as_interrupted() {
    let sheet = &scenes()[3].1;
    let settings = RelaxSettings::default();
    let mut no_progress = |_: &_| ControlFlow::Continue(());
    let relaxation = relax_until(&sheet.mesh(), &sheet.positions, &settings, &mut no_progress, &|| true).unwrap();
    assert!(relaxation.interrupted && relaxation.history.is_empty() && !relaxation.blocked.is_empty());
    assert_eq!(relaxation.positions, sheet.positions);
    // The end comes within an iteration: it is asked for long before the first one is over.
    let asked = AtomicUsize::new(0);
    let stop = || asked.fetch_add(1, Ordering::Relaxed) > 50;
    let relaxation = relax_until(&sheet.mesh(), &sheet.positions, &settings, &mut no_progress, &stop).unwrap();
    assert!(relaxation.interrupted && relaxation.history.is_empty());
}

/// Round coarse tubes the windows of the sheets hold strands that overlap elsewhere. On fine ones more edges intersect,
/// and a limit on their number would take candidates away that the coarse ones have.
#[test]
fn relax_of_a_knotted_tube_moves_as_little_with_coarse_faces_as_with_fine_ones() {
    let means = [10, 20].map(|around| {
        let (faces, positions) = Knot::Torus(3.0, 4.0).tube(around, 0.2);
        let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }).unwrap();
        let settings = RelaxSettings::default();
        let relaxed = relax(&mesh, &positions, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        let faces: Vec<[u32; 3]> = mesh.face_ids().map(|face| mesh.face(face).map(|vertex| vertex.0)).collect();
        assert_eq!(count_edge_face(&relaxed.positions, &faces).unwrap(), 0, "{around}");
        let moved: f64 = positions
            .iter()
            .zip(&relaxed.positions)
            .map(|(a, b)| (0..3).map(|k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt())
            .sum();
        // The torus has radii of 2 and 1.
        moved / positions.len() as f64 / 6.0
    });
    assert!(means[0] < 0.01 && means[1] < 0.9 * means[0], "{means:?}");
}
