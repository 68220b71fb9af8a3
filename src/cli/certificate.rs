//! The certificate: what readers of a file find in it, decided by a judge that shares no code with the library.
//!
//! A reader need not see what the file says to the bit: many keep positions in single precision, and each splits
//! polygons into triangles by a rule of its own. A cloth is certified if none of them finds a crossing.

use std::{
    collections::BTreeSet,
    fmt::{self, Display, Formatter},
    ops::Range,
};

use serde::{Deserialize, Serialize};

use untangle::{mesh::VertexId, sides::Layers};
use untangled_checker::{
    CheckError, PolygonRef, fan_crossings, polygon_crossings, vertices_behind_layers, vertices_inside,
};
use untangled_mesh_io::MeshFile;

use super::{input::Input, roles::Roles, wording::Counted};

/// Crossings by reader. Touching is no crossing.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Certificate {
    /// Pairs of triangles that cross, in double precision, polygons split as `check` splits them.
    pub num_crossings: usize,
    /// The same with positions rounded to single precision; nothing where they are beyond it.
    pub num_crossings_single: Option<usize>,
    /// The same with each polygon split into the fan of its first corner, as most readers do. A fan of more than 16
    /// corners that crosses itself counts once.
    pub num_crossings_first_corner: usize,
    /// Pairs of polygons that cross in some way to split them, in double precision.
    pub num_polygon_pairs: usize,
    /// The same in single precision.
    pub num_polygon_pairs_single: Option<usize>,
    /// Vertices of the cloth inside of a body, in double precision; nothing without bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_vertices_inside_body: Option<usize>,
    /// The same in single precision.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_vertices_inside_body_single: Option<usize>,
    /// Vertices of the cloth behind a layer that lies further in, in double precision; nothing without layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_vertices_behind: Option<usize>,
    /// The same in single precision.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_vertices_behind_single: Option<usize>,
}

impl Certificate {
    /// Judges the world of `files` and bodies. What bodies cross of themselves is left out. What is outwards of layers
    /// is what the input says, or what it looks like in the input.
    pub(super) fn of(files: &[MeshFile], roles: &Roles, input: &Input) -> Self {
        let surface = Surface::new(files, roles, input);
        let single = surface.in_single_precision();
        let inside = |surface: &Surface| (!roles.has_no_body()).then(|| surface.num_vertices_inside());
        Self {
            num_vertices_inside_body: inside(&surface),
            num_vertices_inside_body_single: single.as_ref().and_then(inside),
            num_vertices_behind: surface.num_vertices_behind(),
            num_vertices_behind_single: single.as_ref().and_then(Surface::num_vertices_behind),
            ..Self::of_crossings(&surface, single.as_ref())
        }
    }

    fn of_crossings(surface: &Surface, single: Option<&Surface>) -> Self {
        let count = |surface: &Surface| surface.num_crossings(false);
        let num_crossings_single = single.map(count);
        let num_crossings = count(surface);
        if !surface.has_polygons() {
            return Self {
                num_crossings,
                num_crossings_single,
                num_polygon_pairs_single: single.map(|_| 0),
                ..Self::default()
            };
        }
        Self {
            num_crossings,
            num_crossings_single,
            num_crossings_first_corner: surface.num_crossings(true),
            num_polygon_pairs: surface.polygon_pairs().len(),
            num_polygon_pairs_single: single.map(|single| single.polygon_pairs().len()),
            ..Self::default()
        }
    }

    /// Whether no reader finds a crossing.
    pub(super) fn is_clean(&self) -> bool {
        self.total() == 0
    }

    /// Whether rounding to single precision alone brings crossings, or vertices to the wrong side.
    pub(super) fn is_tangled_by_rounding(&self) -> bool {
        let [double, single] = self.num_wrong();
        let is_clean = self.num_crossings == 0 && double == 0;
        is_clean && (self.num_crossings_single.is_some_and(|count| count > 0) || single > 0)
    }

    /// Vertices on the wrong side of a body or a layer, in double precision and in single precision.
    pub(super) fn num_wrong(&self) -> [usize; 2] {
        let double = [self.num_vertices_inside_body, self.num_vertices_behind];
        let single = [self.num_vertices_inside_body_single, self.num_vertices_behind_single];
        [double, single].map(|counts| counts.into_iter().flatten().sum())
    }

    /// All crossings together, to compare two states by.
    pub(super) fn total(&self) -> usize {
        self.num_crossings
            + self.num_crossings_single.unwrap_or(0)
            + self.num_crossings_first_corner
            + self.num_polygon_pairs
            + self.num_polygon_pairs_single.unwrap_or(0)
            + self.num_wrong().iter().sum::<usize>()
    }
}

impl Display for Certificate {
    /// A line for each kind of reader that finds more than the file says.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let single = self.num_crossings_single.unwrap_or(0);
        if single > self.num_crossings {
            writeln!(f, "  rounded to single precision: {}", Counted(single, "crossing face pair"))?;
        }
        if self.num_crossings_first_corner > self.num_crossings {
            let count = Counted(self.num_crossings_first_corner, "crossing face pair");
            writeln!(f, "  polygons split from their first corner, as most readers do: {count}")?;
        }
        let pairs = self.num_polygon_pairs.max(self.num_polygon_pairs_single.unwrap_or(0));
        if pairs > self.num_crossings {
            writeln!(f, "  polygons split along any diagonals: {}", Counted(pairs, "crossing polygon pair"))?;
        }
        for (single, double, place) in [
            (self.num_vertices_inside_body_single, self.num_vertices_inside_body, "inside of a body"),
            (self.num_vertices_behind_single, self.num_vertices_behind, "behind an inner layer"),
        ] {
            let single = single.unwrap_or(0);
            if single > double.unwrap_or(0) {
                writeln!(f, "  rounded to single precision: {} {place}", Counted(single, "vertex"))?;
            }
        }
        Ok(())
    }
}

/// Polygons with positions, by vertices of all files.
pub(super) struct Surface {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) corners: Vec<u32>,
    /// The corners and the triangles of each polygon.
    pub(super) polygons: Vec<[Range<usize>; 2]>,
    /// The first polygon and triangle of bodies.
    first_of_bodies: [usize; 2],
    layers: Option<SurfaceLayers>,
}

/// What layers the cloth of a surface is in.
#[derive(Clone)]
struct SurfaceLayers {
    /// Triangles of the cloth by welded vertices: no layer ends at a seam.
    cloth: Vec<[u32; 3]>,
    /// The layer of each vertex.
    numbers: Vec<u32>,
    /// For each triangle of the cloth whether it points outwards.
    are_outwards: Vec<bool>,
}

impl SurfaceLayers {
    /// Nothing where the cloth is in no layers; `cloth` are its triangles.
    fn of(Input { weld, mesh, frame, positions }: &Input, cloth: &[[u32; 3]]) -> Option<Self> {
        let numbers = mesh.layers()?;
        let decided = mesh.outwards().is_none().then(|| Layers::decide(mesh.clone(), frame));
        let are_outwards = decided.as_ref().unwrap_or(mesh).outwards()?.iter().take(cloth.len()).copied().collect();
        let of_mesh = |vertex: usize| weld.of(VertexId::from_index(vertex).0);
        Some(Self {
            cloth: cloth.iter().map(|corners| corners.map(|vertex| weld.first(weld.of(vertex)))).collect(),
            numbers: (0..positions.len()).map(|vertex| numbers[of_mesh(vertex).index()]).collect(),
            are_outwards,
        })
    }
}

impl Surface {
    pub(super) fn new(files: &[MeshFile], roles: &Roles, input: &Input) -> Self {
        let Input { weld, positions, .. } = input;
        let (mut triangles, mut corners, mut polygons) = (Vec::new(), Vec::new(), Vec::new());
        let mut first = 0;
        // Vertices that are welded within a distance are judged as one, in one place. Those in exactly one place need
        // no weld here: to touch is not to cross.
        let places = weld.gather(positions);
        let (name, positions): (Box<dyn Fn(u32) -> u32>, _) = if weld.is_exact() {
            (Box::new(|vertex| vertex), positions.clone())
        } else {
            let place = |&welded: &u32| places[welded as usize];
            (Box::new(|vertex| weld.first(weld.of(vertex))), weld.welded_vertices().iter().map(place).collect())
        };
        let mut first_of_bodies = [0; 2];
        for (number, file) in files.iter().chain(&roles.bodies).enumerate() {
            let of_world = |vertex: &u32| name(vertex + first);
            let own = file.polygons();
            let mut start = triangles.len();
            triangles.extend(file.faces().iter().map(|face| face.map(|vertex| of_world(&vertex))));
            for polygon in 0..own.len() {
                let from = corners.len();
                corners.extend(own.corners(polygon).iter().map(of_world));
                let end = start + own.corners(polygon).len().saturating_sub(2);
                polygons.push([from..corners.len(), start..end]);
                start = end;
            }
            first += u32::try_from(file.positions().len()).unwrap_or(u32::MAX);
            if number < files.len() {
                first_of_bodies = [polygons.len(), triangles.len()];
            }
        }
        let layers = SurfaceLayers::of(input, &triangles[..first_of_bodies[1]]);
        Self { positions, triangles, corners, polygons, first_of_bodies, layers }
    }

    /// The same as a reader of single precision sees it, unless a coordinate is beyond that.
    pub(super) fn in_single_precision(&self) -> Option<Self> {
        let positions: Vec<[f64; 3]> = self.positions.iter().map(|position| position.map(single)).collect();
        let is_finite = positions.iter().flatten().all(|value| value.is_finite());
        is_finite.then(|| Self {
            positions,
            triangles: self.triangles.clone(),
            corners: self.corners.clone(),
            polygons: self.polygons.clone(),
            first_of_bodies: self.first_of_bodies,
            layers: self.layers.clone(),
        })
    }

    fn has_polygons(&self) -> bool {
        self.polygons.iter().any(|[corners, _]| corners.len() > 3)
    }

    /// Pairs of triangles that cross, polygons split as given or from their first corner.
    fn num_crossings(&self, from_first_corner: bool) -> usize {
        sure(polygon_crossings(&self.positions, self.polygon_refs(), from_first_corner)).pairs.len()
    }

    /// Pairs of polygons that cross in some way to split them.
    pub(super) fn polygon_pairs(&self) -> Vec<[u32; 2]> {
        sure(fan_crossings(&self.positions, self.polygon_refs())).pairs
    }

    /// Vertices of the cloth that are inside of a body.
    fn num_vertices_inside(&self) -> usize {
        let (cloth, body) = self.triangles.split_at(self.first_of_bodies[1]);
        let vertices: BTreeSet<u32> = cloth.iter().flatten().copied().collect();
        sure(vertices_inside(&self.positions, vertices, body)).len()
    }

    /// Vertices of the cloth that are behind a layer further in; nothing without layers.
    fn num_vertices_behind(&self) -> Option<usize> {
        let SurfaceLayers { cloth, numbers, are_outwards } = self.layers.as_ref()?;
        Some(sure(vertices_behind_layers(&self.positions, cloth, numbers, are_outwards)).len())
    }

    fn polygon_refs(&self) -> impl Iterator<Item = PolygonRef<'_>> {
        self.polygons.iter().enumerate().map(|(number, [corners, triangles])| PolygonRef {
            is_body: number >= self.first_of_bodies[0],
            corners: &self.corners[corners.clone()],
            triangles: &self.triangles[triangles.clone()],
        })
    }
}

fn sure<T>(found: Result<T, CheckError>) -> T {
    found.unwrap_or_else(|error| unreachable!("files have finite positions and valid faces: {error}"))
}

/// A coordinate rounded to single precision.
pub(super) fn single(value: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding is the purpose")]
    let rounded = value as f32;
    f64::from(rounded)
}
