//! The relaxation behind `untangled fix`, on generated scenes; judged by the exact checker of the example host.

#![allow(clippy::unwrap_used, reason = "a test")]
#![cfg(feature = "daemon")]

mod support;

use std::ops::ControlFlow;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use support::scene::Scene;
use untangle::{mesh::{Mesh, MeshDescription}, relax::{Effort, Method, RelaxSettings, Relaxation, relax}};
use untangled_publisher::check::count_edge_face;

/// One scene for each kind of path, with the most iterations that it may take.
fn scenes() -> Vec<(&'static str, Scene)> {
    let flat = |scene: &mut Scene| {
        scene.add_grid([-1.0, 1.0], [-1.0, 1.0], [20, 20], |u, v| [u, v, 0.01 * (9.0 * u + 4.0 * v).sin()])
    };
    let mut bump = Scene::default();
    flat(&mut bump);
    bump.add_grid([-0.9, 0.9], [-0.9, 0.9], [18, 18], |u, v| [u, v, 0.2 - 0.5 * (-6.0 * (u * u + v * v)).exp()]);
    let mut strip = Scene::default();
    flat(&mut strip);
    strip.add_grid([-0.3, 0.31], [-0.43, 0.6], [6, 10], |u, v| [u, 0.02 + 0.1 * u + 0.05 * v, v]);
    let mut corner = Scene::default();
    flat(&mut corner);
    corner.add_grid([0.62, 1.43], [-0.43, 0.6], [8, 10], |u, v| [u, 0.02 + 0.1 * u + 0.05 * v, v]);
    let circle = |x: f64, v: f64| 0.12 - (x * x + (v - 0.5) * (v - 0.5));
    let drop = |x: f64, v: f64| 0.3 * x - 0.6 * x * x - (v - 0.5) * (v - 0.5);
    vec![
        ("CLOSED", bump),
        ("BB/II", strip),
        ("BI/BI", corner),
        ("LL", Scene::fold([-1.0, 0.97], [30, 31], circle)),
        ("BLI", Scene::fold([-1.0, 0.8], [30, 31], |x, v| v - 0.4 - 0.2 * x)),
        ("EIGHT", Scene::fold([-1.0, 1.0], [30, 36], drop)),
    ]
}

fn run(scene: &Scene, settings: &RelaxSettings) -> Relaxation {
    let mesh = Mesh::new(scene.description()).unwrap();
    relax(&mesh, &scene.positions, settings, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn every_kind_of_path_comes_apart_without_crushing_the_cloth() {
    for (name, scene) in scenes() {
        let before = count_edge_face(&scene.positions, &scene.faces).unwrap();
        let relaxation = run(&scene, &RelaxSettings::default());
        let after = count_edge_face(&relaxation.positions, &scene.faces).unwrap();
        println!("{name}: {before} to {after} in {} iterations", relaxation.history.len());
        assert!(before > 0 && after == 0 && relaxation.blocked.is_empty(), "{name}: {before} {after}");
        assert_eq!(relaxation.history.last().unwrap().num_edge_face_intersections, 0);
        for &[a, b, c] in &scene.faces {
            let area = |positions: &[[f64; 3]]| {
                let [a, b, c] = [a, b, c].map(|vertex| nalgebra::Point3::from(positions[vertex as usize]));
                (b - a).cross(&(c - a)).norm()
            };
            assert!(area(&relaxation.positions) >= 0.05 * area(&scene.positions), "{name}");
        }
    }
}

/// A sheet crumpled so much that no motion of its paths helps.
fn crumple() -> Scene {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let waves: Vec<([f64; 3], [f64; 2], f64)> = (0..8)
        .map(|_| {
            let mut unit = || random.random_range(-1.0..1.0);
            ([unit(), unit(), unit()], [2.2 * unit(), 2.2 * unit()], std::f64::consts::PI * unit())
        })
        .collect();
    let mut scene = Scene::default();
    scene.add_grid([0.0, 1.0], [0.0, 1.0], [20, 20], |u, v| {
        let mut place = [u, v, 0.0];
        for (direction, frequency, phase) in &waves {
            let wave = (std::f64::consts::TAU * (frequency[0] * u + frequency[1] * v) + phase).sin();
            for (value, part) in place.iter_mut().zip(direction) {
                *value += 0.2 * part * wave;
            }
        }
        place
    });
    scene
}

#[test]
fn where_nothing_else_helps_the_cloth_is_straightened() {
    let scene = crumple();
    assert!(count_edge_face(&scene.positions, &scene.faces).unwrap() > 200);
    let relaxation = run(&scene, &RelaxSettings::default());
    assert_eq!(count_edge_face(&relaxation.positions, &scene.faces), Ok(0));
    assert!(relaxation.history.iter().any(|step| step.method == Method::Flatten));
    let length = |positions: &[[f64; 3]], a: u32, b: u32| {
        let [a, b] = [a, b].map(|vertex| nalgebra::Point3::from(positions[vertex as usize]));
        (b - a).norm()
    };
    for [a, b] in scene.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]) {
        let ratio = length(&relaxation.positions, a, b) / length(&scene.positions, a, b);
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
    }
}

#[test]
fn a_clean_cloth_is_left_alone_bit_for_bit() {
    let mut scene = Scene::default();
    scene.add_grid([0.0, 1.0], [0.0, 1.0], [10, 10], |u, v| [u / 3.0, v / 7.0, (u * v).sin()]);
    let relaxation = run(&scene, &RelaxSettings::default());
    assert!(relaxation.history.is_empty() && relaxation.blocked.is_empty());
    let bits = |positions: &[[f64; 3]]| positions.iter().flatten().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&relaxation.positions), bits(&scene.positions));
}

#[test]
fn the_same_input_gives_the_same_bits_on_any_number_of_threads() {
    let scene = &scenes()[1].1;
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(scene, &RelaxSettings::default()))
    };
    let one = on(1);
    assert!(!one.history.is_empty());
    assert_eq!(one, on(3));
}

#[test]
fn pins_hold_and_what_they_hold_is_blocked_with_a_reason() {
    let scene = &scenes()[1].1;
    let all = (0..u32::try_from(scene.positions.len()).unwrap()).collect::<Vec<_>>();
    let flat = all[..21 * 21].to_vec();
    let with_pins = |pins: Vec<u32>| {
        let mesh = Mesh::new(MeshDescription { pins, ..scene.description() }).unwrap();
        relax(&mesh, &scene.positions, &RelaxSettings::default(), &mut |_| ControlFlow::Continue(())).unwrap()
    };
    let held = with_pins(flat);
    assert_eq!(held.positions[..21 * 21], scene.positions[..21 * 21]);
    assert_eq!(count_edge_face(&held.positions, &scene.faces), Ok(0));
    let stuck = with_pins(all);
    assert_eq!(stuck.positions, scene.positions);
    assert!(!stuck.blocked.is_empty() && !stuck.blocked[0].reason.is_empty());
}

#[test]
fn single_precision_is_kept_in_each_state() {
    let mut scene = scenes().swap_remove(1).1;
    #[expect(clippy::cast_possible_truncation, reason = "the purpose")]
    let rounded = |value: f64| f64::from(value as f32);
    scene.positions.iter_mut().flatten().for_each(|value| *value = rounded(*value));
    let settings = RelaxSettings { single_precision: true, effort: Effort::Fast, ..RelaxSettings::default() };
    let relaxation = run(&scene, &settings);
    assert!(relaxation.positions.iter().flatten().all(|&value| value.to_bits() == rounded(value).to_bits()));
    assert_eq!(count_edge_face(&relaxation.positions, &scene.faces), Ok(0));
}

#[test]
fn an_interruption_keeps_the_best_state() {
    let scene = &scenes()[3].1;
    let mesh = Mesh::new(scene.description()).unwrap();
    let settings = RelaxSettings::default();
    let mut calls = 0;
    let relaxation = relax(&mesh, &scene.positions, &settings, &mut |_| {
        calls += 1;
        ControlFlow::Break(())
    })
    .unwrap();
    assert!(relaxation.interrupted && calls == 1 && relaxation.history.len() == 1);
    let none = RelaxSettings { max_iterations: 0, ..settings };
    let relaxation = relax(&mesh, &scene.positions, &none, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(relaxation.positions, scene.positions);
    assert!(!relaxation.blocked.is_empty());
}
