//! Tangled cloth, and the judgement of what a host makes of a repair.

use untangled_checker::crossings;
use untangled_client::{Precision, Registration, Repair};
use untangled_publisher::{mesh::Cloth, scenes::Scene};
use untangled_testkit::generate::{Sheet, waves::deeply_crumpled};

/// A cloth in double precision.
#[derive(Clone, Debug)]
pub(super) struct Tangle {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) pins: Vec<u32>,
}

impl Tangle {
    /// All types of paths side by side, some of them pinned.
    pub(super) fn gallery() -> Self {
        Self::of(&Scene::Gallery.build(7, 0.06))
    }

    /// A strip through a sheet: little work.
    pub(super) fn small() -> Self {
        Self::of(&Scene::Tongue.build(7, 0.06))
    }

    fn of(Cloth { positions, triangles, pins, .. }: &Cloth) -> Self {
        // Away from the origin, where single precision is coarser than the cloth is fine.
        let moved = |position: [f64; 3]| position.map(|value| value + 3.3);
        Self {
            positions: positions.iter().map(|position| moved((*position).into())).collect(),
            triangles: triangles.clone(),
            pins: pins.clone(),
        }
    }

    /// A sheet of `n x n` squares, crumpled so much that its repair takes long.
    pub(super) fn crumple(n: u32) -> Self {
        let mut sheet = Sheet::default();
        sheet.add_grid([0.0, 1.0], [0.0, 1.0], [n; 2], deeply_crumpled(1, 3.0));
        Self { positions: sheet.positions, triangles: sheet.faces, pins: Vec::new() }
    }

    pub(super) fn registration(&self, precision: Precision) -> Registration {
        Registration {
            num_vertices: self.positions.len(),
            triangles: self.triangles.clone(),
            pins: self.pins.clone(),
            precision,
            repairs: true,
            ..Registration::default()
        }
    }

    /// Writes the positions, rounded to single precision.
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    pub(super) fn positions_f32(&self) -> Vec<[f32; 3]> {
        self.positions.iter().map(|position| position.map(|value| value as f32)).collect()
    }

    /// What a host has that adds a repair in its own precision.
    pub(super) fn repaired(&self, repair: &Repair) -> Vec<[f64; 3]> {
        let add = |position: &[f32; 3], step: &[f32; 3]| std::array::from_fn(|k| f64::from(position[k] + step[k]));
        match (repair.displacements_f32(), repair.displacements_f64()) {
            (Some(steps), None) => self.positions_f32().iter().zip(steps).map(|(at, step)| add(at, step)).collect(),
            (None, Some(steps)) => {
                let sums = self.positions.iter().zip(steps);
                sums.map(|(at, step)| std::array::from_fn(|k| at[k] + step[k])).collect()
            }
            _ => panic!("a repair of no precision"),
        }
    }

    /// Pairs of faces that cross, by the judge.
    pub(super) fn num_crossings(&self, positions: &[[f64; 3]]) -> usize {
        crossings(positions, &self.triangles).unwrap().pairs.len()
    }
}
