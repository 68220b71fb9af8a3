//! Checks of a description: the only place where input is doubted.

use super::{Mesh, MeshDescription, MeshError};

impl MeshDescription {
    /// Checks what [`Mesh::new`] checks, and makes no mesh.
    ///
    /// # Errors
    /// [`MeshError`], naming the element at fault.
    pub fn validate(&self) -> Result<(), MeshError> {
        validate(self)
    }

    /// For each vertex whether it belongs to a body; empty where none does. Indices must be valid.
    pub(super) fn are_body_vertices(&self) -> Vec<bool> {
        let mut is_body = vec![false; if self.body.is_empty() { 0 } else { self.num_vertices }];
        for &vertex in &self.body {
            is_body[vertex as usize] = true;
        }
        is_body
    }
}

/// Checks a description in the order faces, texture coordinates, rest positions, masses, layers, pins, bodies.
///
/// # Errors
/// [`MeshError`] with the first fault found.
pub(super) fn validate(description: &MeshDescription) -> Result<(), MeshError> {
    let num_vertices = description.num_vertices;
    let num_faces = description.faces.len();
    if num_vertices == 0 || num_faces == 0 {
        return Err(MeshError::Empty { num_vertices, num_faces });
    }
    for (what, count) in [("vertices", num_vertices), ("faces", num_faces)] {
        // Three times as many edges and corners must fit 32 bits too.
        let limit = Mesh::MAX_ELEMENTS / 4;
        if count > limit {
            return Err(MeshError::TooLarge { what, count, limit });
        }
    }
    for (face, corners) in description.faces.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&index| index as usize >= num_vertices) {
            return Err(MeshError::VertexIndex { face, index, num_vertices });
        }
    }
    if !description.faces.iter().any(|corners| is_usable(*corners)) {
        return Err(MeshError::NoUsableFace { num_faces });
    }
    validate_sections(description)
}

fn validate_sections(description: &MeshDescription) -> Result<(), MeshError> {
    let num_vertices = description.num_vertices;
    if let Some(uvs) = &description.uvs {
        check_length("uv_corners", uvs.corners.len(), description.faces.len())?;
        for (entry, corners) in uvs.corners.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|&&index| index as usize >= uvs.coordinates.len()) {
                return Err(MeshError::SectionIndex {
                    section: "uv_corners",
                    entry,
                    index,
                    limit: uvs.coordinates.len(),
                });
            }
        }
        check_finite("uv_coordinates", &uvs.coordinates)?;
    }
    if let Some(rest) = &description.rest_positions {
        check_length("rest_positions", rest.len(), num_vertices)?;
        check_finite("rest_positions", rest)?;
    }
    if let Some(masses) = &description.masses_kg {
        check_length("masses", masses.len(), num_vertices)?;
        for (entry, &value) in masses.iter().enumerate() {
            if !(value.is_finite() && value >= 0.0) {
                return Err(MeshError::SectionValue {
                    section: "masses",
                    entry,
                    value,
                    expected: "finite and not negative",
                });
            }
        }
    }
    if let Some(layers) = &description.layers {
        check_length("layers", layers.len(), num_vertices)?;
    }
    for (entry, &index) in description.pins.iter().enumerate() {
        if index as usize >= num_vertices {
            return Err(MeshError::SectionIndex { section: "pins", entry, index, limit: num_vertices });
        }
    }
    validate_body(description)
}

fn validate_body(description: &MeshDescription) -> Result<(), MeshError> {
    let limit = description.num_vertices;
    for (entry, &index) in description.body.iter().enumerate() {
        if index as usize >= limit {
            return Err(MeshError::SectionIndex { section: "body", entry, index, limit });
        }
    }
    if description.body.is_empty() {
        return Ok(());
    }
    let is_body = description.are_body_vertices();
    let is_mixed = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|corner| is_body[corner as usize]);
        a != b || b != c
    };
    match description.faces.iter().position(is_mixed) {
        Some(face) => Err(MeshError::MixedFace { face }),
        None => Ok(()),
    }
}

fn check_length(section: &'static str, given: usize, expected: usize) -> Result<(), MeshError> {
    if given == expected { Ok(()) } else { Err(MeshError::SectionLength { section, given, expected }) }
}

fn check_finite<const N: usize>(section: &'static str, rows: &[[f64; N]]) -> Result<(), MeshError> {
    for (entry, row) in rows.iter().enumerate() {
        if let Some(&value) = row.iter().find(|value| !value.is_finite()) {
            return Err(MeshError::SectionValue { section, entry, value, expected: "finite" });
        }
    }
    Ok(())
}

/// Whether the three corners of a face differ.
pub(crate) fn is_usable([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn validate_names_the_element_at_fault() {
        let error = |description: MeshDescription| validate(&description).unwrap_err();
        assert_eq!(error(MeshDescription::default()), MeshError::Empty { num_vertices: 0, num_faces: 0 });
        let faces = vec![[0, 1, 2], [0, 7, 1]];
        let description = MeshDescription { num_vertices: 3, faces, ..Default::default() };
        assert_eq!(error(description), MeshError::VertexIndex { face: 1, index: 7, num_vertices: 3 });
        let description = MeshDescription { num_vertices: 3, faces: vec![[0, 0, 1]], ..Default::default() };
        assert_eq!(error(description), MeshError::NoUsableFace { num_faces: 1 });
        let good = MeshDescription { num_vertices: 3, faces: vec![[0, 1, 2]], ..Default::default() };
        let description = MeshDescription { masses_kg: Some(vec![1.0]), ..good.clone() };
        assert_eq!(error(description), MeshError::SectionLength { section: "masses", given: 1, expected: 3 });
        let description = MeshDescription { pins: vec![3], ..good.clone() };
        assert_eq!(error(description), MeshError::SectionIndex { section: "pins", entry: 0, index: 3, limit: 3 });
        let description = MeshDescription { body: vec![0, 2], ..good.clone() };
        assert_eq!(error(description), MeshError::MixedFace { face: 0 });
        let description = MeshDescription { body: vec![0, 1, 2, 3], ..good.clone() };
        assert_eq!(error(description), MeshError::SectionIndex { section: "body", entry: 3, index: 3, limit: 3 });
        let description = MeshDescription { masses_kg: Some(vec![1.0, -1.0, 1.0]), ..good };
        assert!(matches!(error(description), MeshError::SectionValue { entry: 1, .. }));
    }
}
