//! What a host does with a correction, with the untangler in the same process.

use nalgebra::Vector3;
use untangle::{
    mesh::{Mesh, MeshDescription, MeshError, Uvs},
    respond::{Corrections, VertexFlags},
    settings::Response,
};
use untangled_client::ContactFilter;
use untangled_publisher::{
    mesh::{Cloth, Vec3},
    solver::Help,
};
use untangled_testkit::generate::mirrored::Knowledge;

/// Length of a step in seconds.
pub const DT_S: f64 = 1.0 / 60.0;

/// A cloth as it is registered: with masses and pins.
///
/// # Errors
/// [`MeshError`].
pub fn mesh_of(cloth: &Cloth, masses_kg: &[f64], knowledge: Knowledge) -> Result<Mesh, MeshError> {
    let uvs =
        || cloth.uvs.as_ref().map(|uvs| Uvs { coordinates: uvs.coordinates.clone(), corners: uvs.corners.clone() });
    let rest = || cloth.rest_positions.iter().map(|&position| position.into()).collect();
    Mesh::new(MeshDescription {
        num_vertices: cloth.positions.len(),
        faces: cloth.triangles.clone(),
        uvs: if knowledge == Knowledge::Uvs { uvs() } else { None },
        rest_positions: (knowledge != Knowledge::Nothing).then(rest),
        masses_kg: Some(masses_kg.to_vec()),
        pins: cloth.pins.clone(),
        ..MeshDescription::default()
    })
}

/// What a host has taken from a correction, as its solver wants it.
#[derive(Clone, Debug, Default)]
pub struct Taken {
    velocity_change_m_s: Vec<Vec3>,
    displacement_m: Vec<Vec3>,
    no_contact: Vec<bool>,
    filter: ContactFilter,
    is_labelled: bool,
}

impl Taken {
    /// Takes the values: forces as velocity changes of one step, displacements as such.
    pub fn take_values(&mut self, corrections: &Corrections, masses_kg: &[f64], response: Response) {
        self.drop_values();
        // Forces are those of one step: divided by the mass, they are its displacement.
        let steps = corrections.forces.iter().zip(masses_kg).map(|(force, mass)| force / *mass);
        match response {
            Response::Displacement | Response::Coupled => self.displacement_m.extend(steps),
            Response::Rbf | Response::Contour => {
                self.velocity_change_m_s.extend(steps.map(|step: Vector3<f64>| step / DT_S));
            }
            Response::Mask => {}
        }
    }

    /// Takes the mask: self-contact is off where it is set.
    pub fn take_mask(&mut self, corrections: &Corrections) {
        let mask = |flags: &VertexFlags| flags.contains(VertexFlags::INSIDE) || flags.contains(VertexFlags::NEAR_PATH);
        self.no_contact.clear();
        self.no_contact.extend(corrections.flags.iter().map(mask));
    }

    /// Takes the labels: contacts between the two sides of one tangle are off.
    pub fn take_labels(&mut self, corrections: &Corrections) {
        if !self.is_labelled {
            self.filter = ContactFilter::new(corrections.flags.len());
            self.is_labelled = true;
        }
        self.filter.set(corrections.labels.iter().map(|label| (label.vertex.0, label.label)));
    }

    /// Clears the values.
    pub fn drop_values(&mut self) {
        self.velocity_change_m_s.clear();
        self.displacement_m.clear();
    }

    /// Clears the mask: contacts are on everywhere.
    pub fn drop_mask(&mut self) {
        self.no_contact.clear();
    }

    /// For the solver's next step.
    #[must_use]
    pub fn help(&self) -> Help<'_> {
        Help {
            velocity_change_m_s: &self.velocity_change_m_s,
            displacement_m: &self.displacement_m,
            no_contact: &self.no_contact,
            contact_filter: self.is_labelled.then_some(&self.filter),
        }
    }
}
