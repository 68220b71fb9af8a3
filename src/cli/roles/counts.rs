//! What cloth and bodies have with each other.

use std::fmt::{self, Formatter};

use serde::Serialize;

use untangle::{intersect::Intersections, sides::Sides};

use super::BodyReport;
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
