//! Garments that nobody put in order, and that ended in the order in which most of each was.

use std::{
    fmt::{self, Formatter},
    iter,
};

use serde::Serialize;
use untangle::{
    intersect::Intersections,
    mesh::FaceId,
    sides::{ImpliedLayers, Layers},
};

use crate::cli::{
    input::Input,
    owners::{OwnedVertex, Owners},
};

/// Most pairs of which people are told; all are in the JSON document.
const MOST: usize = 10;

/// Two pieces of cloth that intersected, of which one lies outside of the other one now, as most of it did before.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct ImpliedOrder {
    /// The inner piece: its file and object, or a vertex of it.
    pub inner: String,
    /// The outer one.
    pub outer: String,
}

impl ImpliedOrder {
    /// The order that a state shows, where `after` has it too.
    pub(in crate::cli::fix) fn of(
        before: &Input,
        found: &Intersections,
        after: &Input,
        owners: &Owners<'_>,
    ) -> Vec<Self> {
        let is_kept = |implied: &ImpliedLayers| {
            let layers = Layers::of(&implied.mesh, &before.frame, None);
            layers.is_some_and(|layers| layers.behind(&implied.mesh, after.frame.positions()).is_empty())
        };
        let implied = ImpliedLayers::of(&before.mesh, &before.frame, found).filter(is_kept);
        let orders = implied.map(|implied| implied.orders).unwrap_or_default();
        let mut named: Vec<Self> = orders.iter().map(|&order| Self::named(before, order, owners)).collect();
        // A garment of several pieces has one name.
        named.sort();
        named.dedup();
        named
    }

    fn named(input: &Input, faces: [FaceId; 2], owners: &Owners<'_>) -> Self {
        let [inner, outer] = match faces.map(|face| owners.of_face(face.0)) {
            [Some(inner), Some(outer)] if inner != outer => [inner, outer],
            _ => faces.map(|face| {
                let vertex = input.weld.first(input.mesh.face(face)[0]);
                match owners.of_vertices(iter::once(vertex)).pop().flatten() {
                    Some(OwnedVertex { file, vertex_in_file, .. }) => {
                        format!("the piece with vertex {vertex_in_file} of {file}")
                    }
                    None => format!("the piece with vertex {vertex}"),
                }
            }),
        };
        Self { inner, outer }
    }
}

/// A line for each pair.
pub(super) fn say_order(f: &mut Formatter<'_>, orders: &[ImpliedOrder]) -> fmt::Result {
    for ImpliedOrder { inner, outer } in orders.iter().take(MOST) {
        writeln!(f, "  {outer} ends outside of {inner}, as most of it was before")?;
    }
    if orders.len() > MOST {
        writeln!(f, "  and so on: --json and --report list all {} pairs", orders.len())?;
    }
    if orders.is_empty() { Ok(()) } else { writeln!(f, "  --layers says another order") }
}
