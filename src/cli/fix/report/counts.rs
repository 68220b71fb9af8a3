//! Numbers of intersections of a state, and of what is on the wrong side.

use std::collections::BTreeMap;

use serde::Serialize;

use untangle::{analysis::Analysis, paths::PairType};

use crate::cli::{
    certificate::Certificate,
    input::Input,
    roles::{BodyCounts, LayerReport, Roles, num_behind},
    wording::count_path_pairs,
};

/// What of a layer is behind the layers before it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LayerChange {
    /// The file as it was named.
    pub file: String,
    /// Vertices behind, before and after.
    pub num_vertices_behind: Change,
}

/// A count before and after.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// In the inputs.
    pub before: usize,
    /// In the outputs, read back.
    pub after: usize,
}

impl LayerChange {
    /// The layers of two states; nothing without any.
    pub(in crate::cli::fix) fn of(before: &Counts, after: &Counts) -> Option<Vec<Self>> {
        let pairs = before.layers.as_ref()?.iter().zip(after.layers.as_ref()?);
        let change = |(before, after): (&LayerReport, &LayerReport)| Self {
            file: before.file.clone(),
            num_vertices_behind: Change { before: before.num_vertices_behind, after: after.num_vertices_behind },
        };
        Some(pairs.map(change).collect())
    }
}

/// Numbers of intersections of a state.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Edges that pierce faces.
    pub num_edge_face_intersections: usize,
    /// Intersecting pairs of triangles.
    pub num_face_pairs: usize,
    /// Number of path pairs by type.
    pub path_pairs: BTreeMap<PairType, usize>,
    /// What cloth and bodies have with each other; nothing without bodies.
    #[serde(flatten)]
    pub bodies: Option<BodyCounts>,
    /// The layers, if the files are layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<LayerReport>>,
    /// What readers of the files find, by the judge.
    pub certificate: Certificate,
}

impl Counts {
    pub(in crate::cli) fn new(analysis: &Analysis, roles: &Roles, input: &Input, certificate: Certificate) -> Self {
        Self {
            num_edge_face_intersections: analysis.intersections.edge_face.len(),
            num_face_pairs: analysis.intersections.segments.len(),
            path_pairs: count_path_pairs(analysis),
            bodies: BodyCounts::of(input, &analysis.intersections),
            layers: LayerReport::of(roles, input),
            certificate,
        }
    }

    /// Whether there is no intersection in the files as they are, and no vertex on the wrong side.
    pub(in crate::cli) fn is_clean(&self) -> bool {
        self.num_face_pairs == 0 && self.num_wrong() == 0
    }

    /// Vertices of the cloth inside of a body, or behind an inner layer.
    pub(in crate::cli::fix) fn num_wrong(&self) -> usize {
        let num_inside = self.bodies.map_or(0, |bodies| bodies.num_vertices_inside_body);
        num_inside + num_behind(self.layers.as_deref())
    }

    /// Whether no reader of the files finds an intersection.
    pub(in crate::cli) fn is_certified(&self) -> bool {
        self.is_clean() && self.certificate.is_clean()
    }
}
