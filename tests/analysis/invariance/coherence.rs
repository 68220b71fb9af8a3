//! An analyser that has seen other frames, with its certificates and trees, gives the same bytes as a cold one.

use untangle::{
    analysis::{Analyser, analyse},
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    settings::Settings,
};
use untangled_testkit::{
    files::{npz::Sequence, shared},
    generate::{Sheet, crumpled},
};

/// Runs a sequence with one analyser and with a new one for each frame.
fn check(mesh: &Mesh, frames: impl IntoIterator<Item = Vec<[f64; 3]>>) -> [usize; 2] {
    let mut analyser = Analyser::default();
    let mut counts = [0; 2];
    for (number, positions) in frames.into_iter().enumerate() {
        let frame = Frame::new(mesh, &positions).unwrap();
        let kept = analyser.analyse(mesh, &frame, &Settings::default(), &mut ());
        let cold = analyse(mesh, &frame);
        assert_eq!(kept.intersections.segments.len(), cold.intersections.segments.len(), "frame {number}");
        assert_eq!(format!("{kept:?}"), format!("{cold:?}"), "frame {number}");
        counts[usize::from(!cold.intersections.segments.is_empty())] += 1;
    }
    counts
}

/// A sheet that crumples, slowly or by leaps, while all of it, or a corner of it, moves.
fn sequence(sheet: &Sheet, pace: f64, drift: f64, flutter: f64) -> impl Iterator<Item = Vec<[f64; 3]>> {
    (0..60).map(move |number| {
        let time = f64::from(number);
        // Past the first contact and back.
        let amount = 0.9 + 0.1 * (pace * time).sin();
        let bent = |(&[u, v], position): (&[f64; 2], &[f64; 3])| {
            let flat = [u, v, 0.0];
            let mut point: [f64; 3] =
                std::array::from_fn(|axis| flat[axis] + amount * (position[axis] - flat[axis]) + drift * time);
            if u + v < 0.1 {
                point[2] += flutter * time.sin();
            }
            point
        };
        sheet.uvs.iter().zip(&sheet.positions).map(bent).collect()
    })
}

#[test]
fn warm_analyser_on_generated_sequences_equals_cold_analysis() {
    for (seed, pace, drift, flutter) in [
        (1, 0.002, 0.0, 0.0),
        (2, 0.01, 0.3, 0.0),
        (3, 0.05, -100.0, 0.0),
        (4, 0.02, 0.001, 0.01),
        (5, 0.5, 0.0, 0.2),
        (6, 0.0, 1e5, 0.0),
    ] {
        let sheet = crumpled(seed, 24);
        let counts = check(&sheet.mesh(), sequence(&sheet, pace, drift, flutter));
        println!("seed {seed}: {counts:?} frames without and with intersections");
    }
}

#[test]
fn warm_analyser_on_approaching_sheets_equals_cold_analysis() {
    // Two sheets, the upper one of which sinks through the lower one by a fraction of an edge each frame.
    let sheet = crumpled(3, 12);
    let count = u32::try_from(sheet.uvs.len()).unwrap();
    let upper = sheet.faces.iter().map(|face| face.map(|corner| corner + count));
    let faces: Vec<[u32; 3]> = sheet.faces.iter().copied().chain(upper).collect();
    let num_vertices = 2 * sheet.uvs.len();
    let mesh = Mesh::new(MeshDescription { num_vertices, faces, ..Default::default() }).unwrap();
    let counts = check(
        &mesh,
        (0..200).map(|number| {
            let height = 0.1 - 0.001 * f64::from(number);
            let lower = sheet.uvs.iter().map(|&[u, v]| [u, v, 0.02 * (9.0 * u).sin()]);
            let upper =
                sheet.uvs.iter().map(|&[u, v]| [u, v + 0.001 * f64::from(number), height + 0.02 * (9.0 * v).sin()]);
            lower.chain(upper).collect()
        }),
    );
    println!("{counts:?} frames without and with intersections");
    assert!(counts.iter().all(|&count| count > 50));
}

#[test]
fn warm_analyser_on_a_simulated_fall_equals_cold_analysis() {
    let Some(path) = shared("data/sheet31k_fall30.npz") else { return };
    let Sequence { frames, faces } = Sequence::read(&path).unwrap();
    let mesh = Mesh::new(MeshDescription { num_vertices: frames[0].len(), faces, ..Default::default() }).unwrap();
    // As it is, and with frames in between: slow enough for much to be kept.
    let between = frames.windows(2).take(12).flat_map(|pair| {
        (0..6).map(|step| {
            let part = f64::from(step) / 600.0;
            let mix = |(from, to): (&[f32; 3], &[f32; 3])| {
                std::array::from_fn(|axis| f64::from(from[axis]) + part * f64::from(to[axis] - from[axis]))
            };
            pair[0].iter().zip(&pair[1]).map(mix).collect()
        })
    });
    println!("{:?}", check(&mesh, frames.iter().map(|frame| frame.iter().map(|point| point.map(f64::from)).collect())));
    println!("{:?}", check(&mesh, between));
}
