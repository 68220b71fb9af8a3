//! Inputs that are the same bits on every machine.

use untangle::mesh::MeshDescription;

use crate::generate::{
    Sheet, crumpled_further, degenerate, fan,
    furrows::{self, Furrows},
    knots::Knot,
    outfits::{Outfit, Pose},
};

/// A mesh with positions.
#[derive(Clone, Debug)]
pub struct World {
    /// What it is.
    pub name: &'static str,
    /// Its connectivity, layers and bodies.
    pub description: MeshDescription,
    /// In metres.
    pub positions: Vec<[f64; 3]>,
}

/// The degenerate kinds that are taken.
const DEGENERATE: [&str; 6] =
    ["coplanar", "grid_aligned", "duplicate_positions", "stacked_boxes", "zero_area", "very_far_away"];

/// A dozen inputs: crumpled, folded, knotted and degenerate cloth, and an outfit on a body.
///
/// Sines of the system may differ in their last bit: coordinates of what was made with any are rounded to whole
/// multiples of 2^-20.
pub fn worlds() -> Vec<World> {
    let furrows = Furrows { rows: 3, columns: 4, along: 3.0, across: 1.5 };
    let sheets = [
        ("crumpled", crumpled_further(3, 20, 1.5, 2)),
        ("deeply crumpled", crumpled_further(5, 24, 3.0, 4)),
        ("furrows", furrows::folded(2, 32, furrows)),
        ("fan", fan(3, 24)),
    ];
    let tubes = [("trefoil", Knot::Torus(2.0, 3.0)), ("figure eight", Knot::FigureEight)].map(|(name, knot)| {
        let (faces, positions) = knot.tube(8, 0.25);
        World { name, description: bare(positions.len(), faces), positions }
    });
    let (description, positions) = Outfit::new(Pose::ALL[3], 16).world();
    let outfit = World { name: "outfit", description, positions };
    let rounded = sheets.map(|(name, sheet)| world(name, sheet)).into_iter().chain(tubes).chain([outfit]).map(round);
    let degenerate = degenerate::all().into_iter().filter(|(name, _)| DEGENERATE.contains(name));
    rounded.chain(degenerate.map(|(name, sheet)| world(name, sheet))).collect()
}

fn world(name: &'static str, sheet: Sheet) -> World {
    World { name, description: sheet.description(), positions: sheet.positions }
}

fn bare(num_vertices: usize, faces: Vec<[u32; 3]>) -> MeshDescription {
    MeshDescription { num_vertices, faces, ..MeshDescription::default() }
}

fn round(mut world: World) -> World {
    let round = |value: f64| (value * 1_048_576.0).round() / 1_048_576.0;
    world.positions.iter_mut().flatten().for_each(|value| *value = round(*value));
    if let Some(uvs) = &mut world.description.uvs {
        uvs.coordinates.iter_mut().flatten().for_each(|value| *value = round(*value));
    }
    world
}
