//! A state as a page shows it.

use serde::Serialize;

use untangle::{
    analysis::Analysis,
    sides::{Layers, Sides, WrongSide, clusters},
    weld::Weld,
};

use super::{
    lines::{LineData, relative},
    numbers::singles,
};
use crate::cli::{check::pairs::PairReport, input::Input};

/// Positions, and what was found at them.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct StateData {
    /// `check`, `before` or `after`.
    name: &'static str,
    /// `num_vertices x 3`, singles, relative to the centre of the page, in metres.
    positions: String,
    #[serde(flatten)]
    found: FoundData,
}

/// Intersection paths, and vertices on the wrong side.
#[derive(Clone, Debug, Serialize)]
pub(super) struct FoundData {
    /// The pairs, where the report does not list them.
    #[serde(skip_serializing_if = "Option::is_none")]
    paths: Option<Vec<PairReport>>,
    #[serde(flatten)]
    lines: LineData,
    wrong_sides: Vec<WrongData>,
}

/// Vertices inside of a body, or behind an inner layer.
#[derive(Clone, Debug, Serialize)]
struct WrongData {
    /// `body` or `layer`.
    kind: &'static str,
    /// Of welded vertices all.
    vertices: Vec<u32>,
    /// Of each the distance to the way out, in metres.
    depths_m: Vec<f64>,
    /// Vertices joined by edges, the deepest of each, of a welded one the lowest index.
    clusters: Vec<ClusterData>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct ClusterData {
    vertex: u32,
    num_vertices: usize,
    depth_m: f64,
}

impl StateData {
    /// `lists_paths` where the report of the command has no list of the paths of this state.
    pub(in crate::cli) fn new(
        name: &'static str,
        input: &Input,
        analysis: &Analysis,
        centre: [f64; 3],
        lists_paths: bool,
    ) -> Self {
        let positions = singles(relative(&input.positions, centre));
        Self { name, positions, found: FoundData::new(input, analysis, centre, lists_paths) }
    }
}

impl FoundData {
    pub(super) fn new(input: &Input, analysis: &Analysis, centre: [f64; 3], lists_paths: bool) -> Self {
        Self {
            paths: lists_paths.then(|| PairReport::of_all(&input.weld, analysis)),
            lines: LineData::new(&analysis.paths, centre),
            wrong_sides: WrongData::of(input),
        }
    }
}

impl WrongData {
    fn of(input @ Input { mesh, frame, .. }: &Input) -> Vec<Self> {
        let sides = Sides::of(mesh, frame);
        let inside = sides.as_ref().map(|sides| sides.wrong_vertices(mesh, frame)).unwrap_or_default();
        let layers = Layers::of(mesh, frame, sides.as_ref());
        let behind = layers.map(|layers| layers.behind(mesh, frame.positions())).unwrap_or_default();
        let found = [("body", inside), ("layer", behind)];
        let found = found.into_iter().filter(|(_, wrong)| !wrong.is_empty());
        found.map(|(kind, wrong)| Self::new(kind, &wrong, input)).collect()
    }

    fn new(kind: &'static str, wrong: &[WrongSide], Input { weld, mesh, .. }: &Input) -> Self {
        let copies = |side: &WrongSide| copies(weld, side);
        let (vertices, depths_m) = wrong.iter().flat_map(copies).unzip();
        let cluster = |cluster: untangle::sides::WrongCluster| ClusterData {
            vertex: weld.first(cluster.vertex),
            num_vertices: cluster.num_vertices,
            depth_m: cluster.depth_m,
        };
        Self { kind, vertices, depths_m, clusters: clusters(mesh, wrong).into_iter().map(cluster).collect() }
    }
}

fn copies(weld: &Weld, side: &WrongSide) -> Vec<(u32, f64)> {
    weld.copies(side.vertex).iter().map(|&vertex| (vertex, side.way.depth_m)).collect()
}

/// The centre of the box round positions.
pub(super) fn centre_of(positions: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|axis| {
        let values = positions.iter().map(|position| position[axis]);
        let ends = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        if ends[0] <= ends[1] { f64::midpoint(ends[0], ends[1]) } else { 0.0 }
    })
}
