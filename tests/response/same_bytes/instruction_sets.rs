//! Corrections and relaxations are the same bytes with any instruction set.

use std::{ops::ControlFlow, sync::Arc};

use untangle::{
    frame::Frame,
    relax::{RelaxSettings, relax},
    settings::{InsideChoice, Response, Settings},
    untangler::Untangler,
};
use untangled_publisher::scenes::Scene;

use super::{with_best, with_portable};
use crate::allocations::meshes;

/// What a computation gives with the best instructions of this processor, and with those that every processor has.
fn with_both<T>(compute: impl Fn() -> T) -> [T; 2] {
    [with_best(&compute), with_portable(&compute)]
}

fn bits(vectors: impl Iterator<Item = [f64; 3]>) -> Vec<[u64; 3]> {
    vectors.map(|vector| vector.map(f64::to_bits)).collect()
}

#[test]
fn corrections_with_any_instruction_set_are_the_same_bytes() {
    let mut num_corrected = 0;
    for name in ["gallery", "curtains"] {
        let cloth = name.parse::<Scene>().unwrap().build(1, 0.03);
        for mesh in meshes(&cloth) {
            let mesh = Arc::new(mesh);
            let frame = Frame::new(&mesh, &cloth.points()).unwrap();
            for response in [Response::Rbf, Response::Contour, Response::Displacement, Response::Coupled] {
                let settings = Settings { response, inside: InsideChoice::Work, ..Settings::default() };
                let [best, portable] = with_both(|| {
                    let mut untangler = Untangler::new(Arc::clone(&mesh), settings.clone()).unwrap();
                    let corrections = untangler.process(&frame, &mut ()).corrections;
                    bits(corrections.forces.iter().map(|force| (*force).into()))
                });
                assert!(best == portable, "{name}, {response:?}");
                num_corrected += best.iter().filter(|vector| vector.iter().any(|bits| bits << 1 != 0)).count();
            }
        }
    }
    assert!(num_corrected > 1_000, "{num_corrected} vertices");
}

#[test]
fn relaxation_with_any_instruction_set_gives_the_same_bytes() {
    for name in ["gallery", "curtains"] {
        let cloth = name.parse::<Scene>().unwrap().build(1, 0.08);
        for mesh in meshes(&cloth) {
            let [best, portable] = with_both(|| {
                let settings = RelaxSettings { max_iterations: 6, ..RelaxSettings::default() };
                relax(&mesh, &cloth.points(), &settings, &mut |_| ControlFlow::Continue(())).unwrap()
            });
            assert!(!best.history.is_empty(), "{name}");
            assert_eq!(bits(best.positions.into_iter()), bits(portable.positions.into_iter()), "{name}");
        }
    }
}
