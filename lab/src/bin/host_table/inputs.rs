//! What is simulated: generated scenes, and files whose faces are split so that the same tangle has finer and finer
//! triangles.

use std::{collections::HashMap, error::Error, path::Path};

use untangled_publisher::{
    mesh::{Cloth, Vec3},
    obj,
    scenes::Scene,
};

/// Edges of the generated scenes at the coarsest level, in metres.
const EDGE_M: f64 = 0.025;

/// Part of the extent along z in which vertices are pinned, from above.
const PINNED: f64 = 0.02;

/// How files are held and drawn; scenes have pins and gravity of their own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Surroundings {
    pub(crate) gravity_m_s2: f64,
    /// Whether the uppermost vertices are pinned.
    pub(crate) is_pinned: bool,
}

/// A tangle at one fineness.
pub(crate) struct Input {
    pub(crate) name: String,
    pub(crate) cloth: Cloth,
    pub(crate) gravity_m_s2: f64,
}

/// The input with a name, a scene or a file (OBJ), with edges of 1, 1/2, 1/4, ... of the coarsest.
///
/// # Errors
/// No such scene and no such file.
pub(crate) fn input(name: &str, level: u32, surroundings: Surroundings) -> Result<Input, Box<dyn Error>> {
    if let Ok(scene) = name.parse::<Scene>() {
        let cloth = scene.build(1, EDGE_M / f64::from(1 << level));
        return Ok(Input { name: name.into(), cloth, gravity_m_s2: 9.81 });
    }
    let path = Path::new(name);
    let mut cloth = obj::read(path)?;
    for _ in 0..level {
        cloth = split(&cloth);
    }
    cloth.round_to_f32();
    cloth.rest_positions.clone_from(&cloth.positions);
    if surroundings.is_pinned {
        cloth.pins = uppermost(&cloth.positions);
    }
    let name = path.file_stem().map_or_else(|| name.into(), |stem| stem.to_string_lossy().replace("_coarse", ""));
    Ok(Input { name, cloth, gravity_m_s2: surroundings.gravity_m_s2 })
}

fn uppermost(positions: &[Vec3]) -> Vec<u32> {
    let heights = || positions.iter().map(|position| position.z);
    let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    let least = high - PINNED * (high - low);
    (0..).zip(heights()).filter(|&(_, height)| height >= least).map(|(vertex, _)| vertex).collect()
}

/// The same surface with each triangle split in four at the middles of its sides.
fn split(cloth: &Cloth) -> Cloth {
    let mut fine = cloth.clone();
    fine.triangles = split_faces(&cloth.triangles, &mut fine.positions, |a: Vec3, b| (a + b) * 0.5);
    if let Some(uvs) = &mut fine.uvs {
        let corners = std::mem::take(&mut uvs.corners);
        let middle = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [0.5 * (a + c), 0.5 * (b + d)];
        uvs.corners = split_faces(&corners, &mut uvs.coordinates, middle);
    }
    fine
}

fn split_faces<T: Copy>(faces: &[[u32; 3]], points: &mut Vec<T>, half_way: impl Fn(T, T) -> T) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            points.push(half_way(points[a as usize], points[b as usize]));
            u32::try_from(points.len() - 1).unwrap_or(u32::MAX)
        })
    };
    let mut finer = Vec::with_capacity(4 * faces.len());
    for &[a, b, c] in faces {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    finer
}
