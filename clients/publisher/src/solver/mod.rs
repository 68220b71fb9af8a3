//! The simulator of this host: extended position-based dynamics (XPBD) with small steps.
//!
//! Sources: Müller, Heidelberger, Hennix and Ratcliff 2007 (position-based dynamics), Macklin, Müller and Chentanez
//! 2016 (compliance), Macklin et al. 2019 (small steps: many substeps of one iteration each). Edges resist stretch,
//! hinges resist bending, and self-contact keeps each vertex on the side where it is, right or wrong, as in most
//! simulators. Contacts are searched on all processors, all else runs sequentially, and the order is fixed, so the same
//! input gives the same motion.

mod bend;
mod closest;
mod contact;
mod stretch;
#[cfg(test)]
mod tests;
mod tree;

use untangled_client::ContactFilter;

use crate::mesh::{Cloth, Vec3};

use bend::Bend;
use contact::{Contacts, Off};
use stretch::Stretch;

/// Material of the cloth and forces on it. SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    /// Gravity in m/s^2.
    pub gravity_m_s2: Vec3,
    /// Mass of the cloth in kg/m^2.
    pub density_kg_m2: f64,
    /// Stiffness of an edge in N/m.
    pub stretch_n_m: f64,
    /// Bending stiffness in N m.
    pub bending_n_m: f64,
    /// Rate at which air takes away velocity, in 1/s.
    pub drag_1_s: f64,
    /// Distance that self-contact keeps, in metres.
    pub thickness_m: f64,
    /// Coefficient of friction of self-contact; zero for none.
    pub friction: f64,
    /// Substeps of one step.
    pub num_substeps: u32,
    /// Whether positions are rounded to single precision after each step, so that the wire carries the state exactly.
    pub single_precision: bool,
}

impl Parameters {
    /// Light cloth that drapes: the defaults of the command line.
    #[must_use]
    pub fn of_cloth(cloth: &Cloth, gravity_m_s2: f64) -> Self {
        Self {
            gravity_m_s2: Vec3::new(0.0, 0.0, -gravity_m_s2),
            density_kg_m2: 0.2,
            stretch_n_m: 1e3,
            bending_n_m: 1e-4,
            drag_1_s: 8.0,
            thickness_m: 0.2 * cloth.mean_edge_length_m(),
            friction: 0.0,
            num_substeps: 8,
            single_precision: true,
        }
    }
}

/// The correction of the untangler for one step, in the terms of this solver.
#[derive(Clone, Copy, Debug)]
pub struct Help<'a> {
    /// Velocity that each vertex gains over the step, in m/s; empty for none.
    pub velocity_change_m_s: &'a [Vec3],
    /// Displacement of each vertex at the start of the step, in metres; empty for none. It adds no velocity.
    pub displacement_m: &'a [Vec3],
    /// Vertices whose self-contact is off; empty for none.
    pub no_contact: &'a [bool],
    /// Says which contacts are off beside these.
    pub contact_filter: Option<&'a ContactFilter>,
}

impl Help<'_> {
    /// Whether some contact of a vertex is off.
    fn is_off(&self, vertex: usize) -> bool {
        let is_labelled = |filter: &ContactFilter| u32::try_from(vertex).is_ok_and(|vertex| filter.has_labels(vertex));
        self.no_contact.get(vertex).is_some_and(|&is_off| is_off) || self.contact_filter.is_some_and(is_labelled)
    }

    /// No help at all.
    pub const NONE: Self =
        Help { velocity_change_m_s: &[], displacement_m: &[], no_contact: &[], contact_filter: None };
}

/// A simulated cloth.
#[derive(Clone, Debug)]
pub struct Solver {
    cloth: Cloth,
    parameters: Parameters,
    velocities: Vec<Vec3>,
    /// Positions at the start of the substep.
    previous: Vec<Vec3>,
    masses_kg: Vec<f64>,
    /// 1/kg; zero for a pinned vertex.
    inverse_masses: Vec<f64>,
    stretch: Stretch,
    bend: Bend,
    contacts: Contacts,
    /// Positions at which contact was looked for last.
    searched: Vec<Vec3>,
    /// How far each pinned vertex goes in the next step; empty where they stay.
    carried: Vec<(u32, Vec3)>,
    /// Largest displacement of a vertex in a substep, in metres; contact looks that far ahead, and again before one
    /// goes farther. A limit for a whole step would hold finer meshes back, however hard they are pushed.
    reach_m: f64,
}

impl Solver {
    /// A cloth at rest (zero velocity) where it is now.
    #[must_use]
    pub fn new(mut cloth: Cloth, parameters: Parameters) -> Self {
        if parameters.single_precision {
            cloth.round_to_f32();
        }
        let masses_kg = cloth.masses_kg(parameters.density_kg_m2);
        let mut inverse_masses: Vec<f64> = masses_kg.iter().map(|mass| mass.recip()).collect();
        for &pin in &cloth.pins {
            inverse_masses[pin as usize] = 0.0;
        }
        let reach_m = 0.5 * cloth.mean_edge_length_m();
        Self {
            velocities: vec![Vec3::zeros(); cloth.positions.len()],
            previous: cloth.positions.clone(),
            searched: cloth.positions.clone(),
            masses_kg,
            inverse_masses,
            stretch: Stretch::new(&cloth, parameters.stretch_n_m),
            bend: Bend::new(&cloth, parameters.bending_n_m),
            contacts: Contacts::new(&cloth, parameters.thickness_m, parameters.friction, reach_m),
            carried: Vec::new(),
            reach_m,
            cloth,
            parameters,
        }
    }

    /// The cloth as it is now. Its positions are single-precision numbers unless the parameters say otherwise.
    #[must_use]
    pub fn cloth(&self) -> &Cloth {
        &self.cloth
    }

    /// Mass of each vertex in kilograms, `num_vertices`.
    #[must_use]
    pub fn masses_kg(&self) -> &[f64] {
        &self.masses_kg
    }

    /// Puts the cloth to other positions, `num_vertices x 3` in metres. Its velocities stay.
    pub fn place(&mut self, positions: &[Vec3]) {
        for ((position, &place), inverse_mass) in
            self.cloth.positions.iter_mut().zip(positions).zip(&self.inverse_masses)
        {
            if *inverse_mass > 0.0 {
                *position = place;
            }
        }
    }

    /// Says where pinned vertices are at the end of the next step, `num_vertices x 3` in metres: a body that an
    /// animation moves. They get there evenly, and push and drag what touches them; the places of others count for
    /// nothing. In one substep they should go no farther than half an edge, beyond which contact does not look.
    pub fn carry(&mut self, places: &[Vec3]) {
        let Cloth { positions, pins, .. } = &self.cloth;
        let way = |&pin: &u32| (pin, places[pin as usize] - positions[pin as usize]);
        self.carried.clear();
        self.carried.extend(pins.iter().map(way));
    }

    fn look_for_contact(&mut self, help: &Help<'_>) {
        self.contacts.find(&self.cloth, Off { masked: help.no_contact, filter: help.contact_filter });
        self.searched.clone_from(&self.cloth.positions);
    }

    /// Whether some vertex may come farther in a substep than contact has looked.
    fn may_leave_reach(&self, substep_s: f64) -> bool {
        let Self { cloth, searched, velocities, reach_m, .. } = self;
        let mut ways = cloth.positions.iter().zip(searched).zip(velocities);
        ways.any(|((now, then), velocity)| (now - then).norm() + velocity.norm() * substep_s > *reach_m)
    }

    /// Holds vertices back where contact, which is on there, was looked for no farther.
    fn hold_within_reach(&mut self, help: &Help<'_>) {
        let Self { cloth, searched, inverse_masses, reach_m, .. } = self;
        for (vertex, (now, then)) in cloth.positions.iter_mut().zip(searched).enumerate() {
            let way = *now - *then;
            let length_m = way.norm();
            if length_m > *reach_m && inverse_masses[vertex] > 0.0 && !help.is_off(vertex) {
                *now = *then + way * (*reach_m / length_m);
            }
        }
    }

    /// Moves the cloth on by `dt_s` seconds.
    pub fn step(&mut self, dt_s: f64, help: Help<'_>) {
        let free = |vertex: usize, inverse_masses: &[f64]| inverse_masses[vertex] > 0.0;
        for (vertex, &displacement) in help.displacement_m.iter().enumerate() {
            if free(vertex, &self.inverse_masses) {
                self.cloth.positions[vertex] += displacement;
            }
        }
        self.look_for_contact(&help);

        let substep_s = dt_s / f64::from(self.parameters.num_substeps);
        let kept = (-self.parameters.drag_1_s * substep_s).exp();
        for _ in 0..self.parameters.num_substeps {
            if self.may_leave_reach(substep_s) {
                self.look_for_contact(&help);
            }
            for vertex in 0..self.cloth.positions.len() {
                self.previous[vertex] = self.cloth.positions[vertex];
                if !free(vertex, &self.inverse_masses) {
                    continue;
                }
                let pushed = help.velocity_change_m_s.get(vertex).copied().unwrap_or_default() * (substep_s / dt_s);
                let velocity = &mut self.velocities[vertex];
                *velocity = (*velocity + self.parameters.gravity_m_s2 * substep_s + pushed) * kept;
                self.cloth.positions[vertex] += *velocity * substep_s;
            }
            for &(pin, way) in &self.carried {
                self.cloth.positions[pin as usize] += way / f64::from(self.parameters.num_substeps);
            }
            self.stretch.project(&mut self.cloth.positions, &self.inverse_masses, substep_s);
            self.bend.project(&mut self.cloth.positions, &self.inverse_masses, substep_s);
            self.hold_within_reach(&help);
            let positions = &mut self.cloth.positions;
            self.contacts.project(positions, &self.previous, &self.inverse_masses);
            for (velocity, (now, before)) in self.velocities.iter_mut().zip(positions.iter().zip(&self.previous)) {
                *velocity = (now - before) / substep_s;
            }
        }
        self.carried.clear();
        if self.parameters.single_precision {
            self.cloth.round_to_f32();
        }
    }
}
