//! What cloth and bodies have with each other, and what is behind an inner layer.

use std::fmt::{self, Formatter};

use serde::Serialize;

use untangle::{
    intersect::Intersections,
    sides::{Layers, Sides},
};

use super::{BodyReport, Roles};
use crate::cli::{input::Input, wording::Counted};

/// Numbers of a state with bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct BodyCounts {
    /// Intersecting pairs of a triangle of the cloth and one of a body.
    pub num_body_face_pairs: usize,
    /// Vertices of the cloth inside of a body.
    pub num_vertices_inside_body: usize,
}

impl BodyCounts {
    /// Nothing where there is no body.
    pub(in crate::cli) fn of(Input { weld, mesh, frame, .. }: &Input, found: &Intersections) -> Option<Self> {
        let sides = Sides::of(mesh, frame)?;
        let meets_body =
            found.segments.iter().filter(|segment| segment.faces.iter().any(|&face| mesh.is_body_face(face)));
        let wrong = sides.wrong_vertices(mesh, frame);
        Some(Self {
            num_body_face_pairs: meets_body.count(),
            num_vertices_inside_body: wrong.iter().map(|wrong| weld.copies(wrong.vertex).len()).sum(),
        })
    }
}

/// A line for each body that intersects itself, for people.
pub(in crate::cli) fn say_bodies(f: &mut Formatter<'_>, bodies: Option<&[BodyReport]>) -> fmt::Result {
    for BodyReport { file, num_own_face_pairs } in bodies.into_iter().flatten() {
        write!(f, "  body {file}")?;
        if *num_own_face_pairs > 0 {
            let pairs = Counted(*num_own_face_pairs, "intersecting face pair");
            write!(f, ": {pairs} of its own, which do not count")?;
        }
        writeln!(f)?;
    }
    Ok(())
}

/// A layer and what of it is behind a layer that lies further in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LayerReport {
    /// The file as it was named; bytes that are not UTF-8 are replaced.
    pub file: String,
    /// Its vertices that are behind a layer before it.
    pub num_vertices_behind: usize,
}

impl LayerReport {
    /// One entry for each file; nothing without layers.
    pub(in crate::cli) fn of(roles: &Roles, Input { weld, mesh, frame, .. }: &Input) -> Option<Vec<Self>> {
        let numbers = mesh.layers()?;
        let report = |(file, _): &(String, usize)| Self { file: file.clone(), num_vertices_behind: 0 };
        let mut reports: Vec<Self> = roles.layers.iter().map(report).collect();
        if let Some(layers) = Layers::of(mesh, frame, Sides::of(mesh, frame).as_ref()) {
            for wrong in layers.behind(mesh, frame.positions()) {
                if let Some(report) = reports.get_mut(numbers[wrong.vertex.index()] as usize) {
                    report.num_vertices_behind += weld.copies(wrong.vertex).len();
                }
            }
        }
        Some(reports)
    }
}

/// All vertices that are behind an inner layer.
pub(in crate::cli) fn num_behind(layers: Option<&[LayerReport]>) -> usize {
    layers.into_iter().flatten().map(|layer| layer.num_vertices_behind).sum()
}

/// A line for each layer but the innermost, for people.
pub(in crate::cli) fn say_layers(f: &mut Formatter<'_>, layers: Option<&[LayerReport]>) -> fmt::Result {
    for LayerReport { file, num_vertices_behind } in layers.into_iter().flatten().skip(1) {
        writeln!(f, "  layer {file}: {} behind the layers before it", Counted(*num_vertices_behind, "vertex"))?;
    }
    Ok(())
}
