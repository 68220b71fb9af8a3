//! What there is below the distance.

use std::fmt::{self, Display, Formatter};

use serde::{Serialize, Serializer, ser::SerializeMap};
use thiserror::Error;

use untangle::{
    mesh::VertexId,
    proximity::{Primitives, ProximityEnd, ProximityPair, ProximitySearch},
};

use super::{args::Asked, judge::GapCertificate, places::InfeasibleReport, presets::Preset, side::Side};
use crate::cli::{input::Input, owners::Owners, wording::Counted};

/// Most pairs that are counted: each takes a hundred bytes or two.
const MAX_PAIRS: usize = 10_000_000;

/// Most places of which people are told; all are in the JSON document.
const MOST_PLACES: usize = 10;

/// Why distances can't be counted.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GapError {
    /// The gap is far larger than the elements.
    #[error("more than {MAX_PAIRS} pairs of primitives are nearer than {0} m; a smaller gap is needed")]
    TooManyPairs(f64),
}

/// The distances of a state; its fields are the JSON object `gap`.
#[derive(Clone, Debug, Serialize)]
pub struct GapReport {
    /// The distance that was asked for, in metres.
    pub asked_m: f64,
    /// The tool that needs it.
    #[serde(rename = "for", skip_serializing_if = "Option::is_none", serialize_with = "by_name")]
    pub preset: Option<Preset>,
    /// The least distance of two primitives without a common vertex, in metres; nothing where there are none.
    pub min_distance_m: Option<f64>,
    /// Pairs that are nearer than asked for, exactly.
    pub num_pairs_below: usize,
    /// The nearest pair.
    pub nearest: Option<NearestPair>,
    /// Of `fix`: pairs below it in the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub num_pairs_below_before: Option<usize>,
    /// Of `fix`: pairs below it in the output, by the judge.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificate: Option<GapCertificate>,
    /// Of `fix`: where pairs could not be set apart, the nearest first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub infeasible: Option<Vec<InfeasibleReport>>,
}

/// A pair of primitives as a reader of the files finds it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NearestPair {
    /// `vertex-face` or `edge-edge`.
    pub kind: &'static str,
    /// Both primitives.
    pub sides: [Side; 2],
}

/// A tool by its name, with its numbers by theirs.
fn by_name<S: Serializer>(preset: &Option<Preset>, serializer: S) -> Result<S::Ok, S::Error> {
    let Some(Preset { tool, numbers, .. }) = preset else { return serializer.serialize_none() };
    let mut map = serializer.serialize_map(None)?;
    map.serialize_entry("tool", tool)?;
    for (name, metres) in numbers {
        map.serialize_entry(&format!("{name}_m"), metres)?;
    }
    map.end()
}

impl GapReport {
    /// Whether nobody finds a pair that is nearer than asked for.
    #[must_use]
    pub fn is_kept(&self) -> bool {
        self.num_pairs_below == 0 && self.certificate.is_none_or(|certificate| certificate.is_kept())
    }

    /// Counts the pairs of a state that are nearer than asked for, and finds the nearest one.
    ///
    /// # Errors
    /// [`GapError`].
    pub(in crate::cli) fn of(asked: &Asked, input: &Input, owners: &Owners<'_>) -> Result<Self, GapError> {
        let Input { weld, mesh, frame, .. } = input;
        let (mut search, mut found) = (ProximitySearch::default(), Vec::new());
        if search.find(mesh, frame, asked.distance_m, MAX_PAIRS, &mut found) == ProximityEnd::TooManyPairs {
            return Err(GapError::TooManyPairs(asked.distance_m));
        }
        let nearest = found.iter().copied().min_by(|a, b| a.distance_m.total_cmp(&b.distance_m)).or_else(|| {
            let nearest = search.nearest(mesh, frame)?;
            // Rounding must not contradict the exact answer.
            Some(ProximityPair { distance_m: nearest.distance_m.max(asked.distance_m), ..nearest })
        });
        let in_files = |pair: ProximityPair| {
            let vertices: Vec<u32> =
                pair.primitives.vertices(mesh).map(|vertex: VertexId| weld.first(vertex)).collect();
            NearestPair::new(pair.primitives, &vertices, owners)
        };
        Ok(Self {
            asked_m: asked.distance_m,
            preset: asked.preset.clone(),
            min_distance_m: nearest.map(|pair| pair.distance_m),
            num_pairs_below: found.len(),
            nearest: nearest.map(in_files),
            num_pairs_below_before: None,
            certificate: None,
            infeasible: None,
        })
    }
}

impl NearestPair {
    fn new(primitives: Primitives, vertices: &[u32], owners: &Owners<'_>) -> Self {
        let (kind, num_first) = match primitives {
            Primitives::VertexFace { .. } => ("vertex-face", 1),
            Primitives::EdgeEdge { .. } => ("edge-edge", 2),
        };
        let (first, second) = vertices.split_at(num_first);
        Self { kind, sides: [first, second].map(|vertices| Side::new(vertices, owners)) }
    }
}

impl Display for GapReport {
    /// The lines for people.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { asked_m, num_pairs_below, min_distance_m, nearest, .. } = self;
        let (Some(least), Some(NearestPair { sides: [first, second], .. })) = (min_distance_m, nearest) else {
            return writeln!(f, "  gap of {asked_m} m: there are no two primitives without a common vertex");
        };
        let are = if *num_pairs_below == 1 { "is" } else { "are" };
        let pairs = Counted(*num_pairs_below, "primitive pair");
        let before = self.num_pairs_below_before.map_or(String::new(), |count| format!(", {count} before"));
        if *num_pairs_below == 0 {
            writeln!(f, "  gap of {asked_m} m: kept{before}")?;
        } else {
            writeln!(f, "  gap of {asked_m} m: {pairs} {are} nearer{before}")?;
        }
        let single = self.certificate.and_then(|certificate| certificate.num_pairs_below_single).unwrap_or(0);
        if single > *num_pairs_below {
            writeln!(f, "  rounded to single precision: {}", Counted(single, "primitive pair"))?;
        }
        writeln!(f, "  nearest, at {least:e} m: {first}, and {second} (vertices count from 0)")?;
        let places = self.infeasible.as_deref().unwrap_or_default();
        for place in places.iter().take(MOST_PLACES) {
            writeln!(f, "  too close: {place}")?;
        }
        if places.len() > MOST_PLACES {
            let more = Counted(places.len() - MOST_PLACES, "further place");
            writeln!(f, "  too close: {more}; --json and --report list all")?;
        }
        Ok(())
    }
}
