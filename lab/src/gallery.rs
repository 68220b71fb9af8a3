//! Pieces of cloth that lie on each other and on a body.

use std::f64::consts::{PI, TAU};

use untangled_publisher::{
    mesh::{Cloth, Vec3},
    scenes::Sheet,
};

/// A scene: pieces of cloth, and for each vertex the number of its piece.
#[derive(Clone, Debug, Default)]
pub struct Gallery {
    /// All of them.
    pub cloth: Cloth,
    /// `num_vertices`.
    pub piece: Vec<usize>,
}

impl Gallery {
    /// Adds a piece.
    pub fn add(&mut self, cloth: Cloth) {
        let piece = self.piece.last().map_or(0, |last| last + 1);
        self.piece.extend(cloth.positions.iter().map(|_| piece));
        self.cloth.append(Cloth { uvs: None, ..cloth }, Vec3::zeros());
        self.cloth.uvs = None;
    }

    /// Adds a pinned level square round the origin.
    pub fn add_ground(&mut self, side_m: f64, edge_m: f64) {
        let level = |u: f64, v: f64| Vec3::new(u - 0.5 * side_m, v - 0.5 * side_m, 0.0);
        self.add(pinned(Sheet::new(side_m, side_m, 2.0 * edge_m).build(99, level)));
    }
}

/// The same cloth with all of its vertices pinned.
#[must_use]
pub fn pinned(cloth: Cloth) -> Cloth {
    Cloth { pins: (0..).take(cloth.positions.len()).collect(), ..cloth }
}

/// 1 in the middle of a bump, 0 beyond its radius, smooth.
#[must_use]
pub fn bump(distance_m: f64, radius_m: f64) -> f64 {
    if distance_m < radius_m { (0.5 * PI * distance_m / radius_m).cos().powi(2) } else { 0.0 }
}

/// A closed grid round the axis of z: `radius` by angle and height.
#[must_use]
pub fn tube([top, bottom]: [f64; 2], edge_m: f64, radius: impl Fn(f64, f64) -> f64) -> Cloth {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few hundred cells")]
    let cells = |length_m: f64| (length_m / edge_m).round().max(3.0) as u32;
    let (columns, rows) = (cells(TAU * 0.2), cells(top - bottom));
    let mut cloth = Cloth::default();
    for row in 0..=rows {
        for column in 0..columns {
            let z = top + (bottom - top) * f64::from(row) / f64::from(rows);
            let angle = TAU * (f64::from(column) + 0.5 * f64::from(row % 2)) / f64::from(columns);
            let r = radius(angle, z);
            cloth.positions.push(Vec3::new(r * angle.cos(), r * angle.sin(), z));
            if row < rows {
                let next = (column + 1) % columns;
                let at = |row: u32, column: u32| row * columns + column;
                let [a, b, c, d] = [at(row, column), at(row, next), at(row + 1, column), at(row + 1, next)];
                let halves = if row % 2 == 0 { [[a, c, b], [b, c, d]] } else { [[a, c, d], [a, d, b]] };
                cloth.triangles.extend(halves);
            }
        }
    }
    cloth.rest_positions.clone_from(&cloth.positions);
    cloth
}

/// Two skirts over each other on a body with hips, which is pinned, as is their waist. `depth` says how far a place of
/// layer 1 or 2 lies inwards of where it should, in metres, by angle and height. Layers are `gap_m` from each other.
#[must_use]
pub fn skirts(edge_m: f64, gap_m: f64, depth: impl Fn(u8, f64, f64) -> f64) -> Gallery {
    let hips = |z: f64| 0.15 + 0.05 * (-((z - 0.32) / 0.1).powi(2)).exp();
    let mut gallery = Gallery::default();
    gallery.add(pinned(tube([0.55, 0.0], 1.5 * edge_m, |_, z| hips(z))));
    for layer in 1..=2_u8 {
        let out = 0.8 * gap_m * f64::from(layer);
        let radius = |angle: f64, z: f64| {
            // Below the hips the skirts hang freely, in waves.
            let free = if z < 0.32 { 0.2 + 0.08 * (0.32 - z) * (1.0 + 0.5 * (6.0 * angle).cos()) } else { hips(z) };
            hips(z).max(free) + out - depth(layer, angle, z)
        };
        let mut skirt = tube([0.5, 0.12], edge_m, radius);
        let waist = skirt.positions.iter().filter(|position| position.z > 0.4999).count();
        skirt.pins = (0..).take(waist).collect();
        gallery.add(skirt);
    }
    gallery
}
