//! Crumpled sheets: a flat sheet under a random smooth displacement, fixed or growing until the sheet intersects
//! itself.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::intersect::{Intersections, Intersector};

use super::{Sheet, squares};

/// One wave of the displacement.
struct Wave {
    direction: [f64; 3],
    frequency: [f64; 2],
    phase: f64,
}

/// A sheet of `resolution x resolution` squares of side 1 / `resolution` metres that has just begun to intersect
/// itself, or somewhat later.
pub fn crumpled(seed: u64, resolution: u32) -> Sheet {
    crumpled_further(seed, resolution, 1.5, 0)
}

/// The same with waves of up to `frequency` over the sheet, and so many steps further than the first contact.
pub fn crumpled_further(seed: u64, resolution: u32, frequency: f64, further: u32) -> Sheet {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let (faces, uvs) = squares(resolution, &mut rng);
    let waves: Vec<Wave> = (0..6)
        .map(|_| Wave {
            direction: std::array::from_fn(|_| rng.random_range(-1.0..1.0)),
            frequency: std::array::from_fn(|_| rng.random_range(-frequency..frequency)),
            phase: rng.random_range(0.0..std::f64::consts::TAU),
        })
        .collect();
    let mut sheet = Sheet { positions: vec![[0.0; 3]; uvs.len()], faces, uvs };
    let mesh = sheet.mesh();
    let mut amplitude = 0.1;
    let (mut found, mut intersector) = (Intersections::default(), Intersector::default());
    // A little beyond the first contact, so that more than one type of path is met.
    let mut steps_beyond = rng.random_range(1..5) + further;
    while steps_beyond > 0 {
        amplitude *= 1.15;
        assert!(amplitude < 1e3, "seed {seed} never intersects itself");
        sheet.positions = sheet.uvs.iter().map(|&uv| displaced(uv, &waves, amplitude)).collect();
        intersector.intersect(&mesh, &sheet.frame(&mesh), &mut found);
        if !found.segments.is_empty() {
            steps_beyond -= 1;
        }
    }
    sheet
}

fn displaced([u, v]: [f64; 2], waves: &[Wave], amplitude: f64) -> [f64; 3] {
    let mut position = [u, v, 0.0];
    for wave in waves {
        let angle = std::f64::consts::TAU * (wave.frequency[0] * u + wave.frequency[1] * v) + wave.phase;
        for (coordinate, direction) in position.iter_mut().zip(wave.direction) {
            *coordinate += amplitude * direction * angle.sin();
        }
    }
    position
}

/// Places the vertices of a unit square so that it is crumpled far beyond its first contact, by eight waves of up to
/// `frequency` periods.
pub fn deeply_crumpled(seed: u64, frequency: f64) -> impl Fn(f64, f64) -> [f64; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let waves: Vec<([f64; 3], [f64; 2], f64)> = (0..8)
        .map(|_| {
            let mut unit = || rng.random_range(-1.0..1.0);
            ([unit(), unit(), unit()], [frequency * unit(), frequency * unit()], std::f64::consts::PI * unit())
        })
        .collect();
    move |u, v| {
        let mut place = [u, v, 0.0];
        for (direction, frequency, phase) in &waves {
            let wave = (std::f64::consts::TAU * (frequency[0] * u + frequency[1] * v) + phase).sin();
            for (value, part) in place.iter_mut().zip(direction) {
                *value += 0.2 * part * wave;
            }
        }
        place
    }
}
