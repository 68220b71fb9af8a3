//! Reading binary STL: a header of 80 bytes, the number of facets, and 50 bytes for each.

use crate::{
    error::ReadErrorKind,
    formats::{
        mesh_data::MeshData,
        stl::{
            facet::{FACET, Facets, HEADER, position},
            write::StlDocument,
        },
    },
};

/// Whether a file is binary: the number of facets that it names fits its length, or it does not begin as text does.
/// Some programs write `solid` into the header of binary files as well.
pub(super) fn is_binary(source: &[u8]) -> bool {
    num_facets(source).is_some_and(|facets| facets.saturating_mul(FACET) == source.len() - HEADER)
        || !source.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

fn num_facets(source: &[u8]) -> Option<usize> {
    let bytes = source.get(HEADER - 4..HEADER)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(bytes)).ok()
}

/// Parses a whole file.
pub(super) fn parse(source: Vec<u8>) -> Result<(MeshData, StlDocument), ReadErrorKind> {
    let truncated = |element: String| ReadErrorKind::Truncated { element };
    let num_facets = num_facets(&source).ok_or_else(|| truncated("the header".into()))?;
    let held = (source.len() - HEADER) / FACET;
    if held < num_facets {
        return Err(truncated(format!("facet {held} of {num_facets}")));
    }
    let mut facets = Facets::default();
    for (facet, bytes) in source[HEADER..].chunks_exact(FACET).take(num_facets).enumerate() {
        let corners = [0, 1, 2].map(|corner| position(bytes, 12 * (corner + 1)));
        if let Some(&value) = corners.as_flattened().iter().find(|value| !value.is_finite()) {
            return Err(ReadErrorKind::NotFinite { element: format!("facet {facet}"), value });
        }
        facets.push(corners);
    }
    Ok(StlDocument::new(source, None, facets))
}
