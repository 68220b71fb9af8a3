//! Cloth with known answers: a sheet, and a strip that dips through it at a depth that changes from frame to frame.

use std::{sync::Arc, time::Duration};

use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    settings::Settings,
    untangler::Untangler,
};
use untangled_client::{Correction, ExchangeError, Registration, Session, VertexCorrection};

use super::STEP;

/// Different states of a cloth.
const NUM_STATES: usize = 8;
const MASS_KG: f64 = 0.01;

/// A mesh, some states of it, and the library's correction of each.
#[derive(Debug)]
pub struct KnownCloth {
    faces: Vec<[u32; 3]>,
    states: Vec<Vec<[f32; 3]>>,
    answers: Vec<Vec<VertexCorrection>>,
}

impl KnownCloth {
    /// A cloth of some `num_vertices` vertices, at least 8.
    pub fn new(num_vertices: usize) -> Self {
        let strip = if num_vertices > 200 { 8 } else { 1 };
        let sheet =
            (1..).take_while(|n| (n + 1) * (n + 1) + (strip + 1) * (strip + 1) <= num_vertices).last().unwrap_or(1);
        let mut faces = Vec::new();
        let mut states = vec![Vec::new(); NUM_STATES];
        add_sheet(&mut faces, &mut states, sheet, |_, x, y| [x - 0.5, y - 0.5, 0.01 * (9.0 * x + 4.0 * y).sin()]);
        add_sheet(&mut faces, &mut states, strip, |state, x, y| {
            // One state in which nothing intersects, the others ever deeper.
            let depth = if state == 0 { -0.1 } else { 0.03 * state as f64 };
            [0.2 * (x - 0.51), 0.013 + 0.02 * x * x + 0.03 * y, 0.6 * y - depth]
        });
        let description = MeshDescription {
            num_vertices: states[0].len(),
            faces: faces.clone(),
            masses_kg: Some(vec![MASS_KG; states[0].len()]),
            ..MeshDescription::default()
        };
        let mesh = Arc::new(Mesh::new(description).expect("it is a mesh"));
        let mut untangler = Untangler::new(Arc::clone(&mesh), Settings::default()).expect("defaults are valid");
        let answers = states.iter().map(|positions| answer(&mesh, &mut untangler, positions)).collect();
        Self { faces, states, answers }
    }

    /// Number of vertices.
    pub fn num_vertices(&self) -> usize {
        self.states[0].len()
    }

    /// Its registration, for displacements.
    pub fn registration(&self) -> Registration {
        Registration {
            num_vertices: self.num_vertices(),
            triangles: self.faces.clone(),
            masses_kg: Some(vec![MASS_KG; self.num_vertices()]),
            ..Registration::default()
        }
    }

    /// The positions of a frame.
    pub fn positions(&self, frame: u64) -> &[[f32; 3]] {
        &self.states[frame as usize % NUM_STATES]
    }

    /// Exchanges the next frame of a session.
    ///
    /// # Errors
    /// Those of [`Session::exchange`].
    pub fn exchange(&self, session: &mut Session, deadline: Duration) -> Result<Correction, ExchangeError> {
        let frame = session.frame() + 1;
        session.exchange(STEP, deadline, |positions| positions.copy_from_slice(self.positions(frame)))
    }

    /// Whether a correction is, bit for bit, the one for the frame that it names.
    pub fn is_right(&self, correction: &Correction) -> bool {
        let bits = |vertex: &VertexCorrection| (vertex.value.map(f32::to_bits), vertex.flags);
        let expected = &self.answers[correction.frame() as usize % NUM_STATES];
        expected.len() == correction.vertices().len()
            && expected.iter().zip(correction.vertices()).all(|(a, b)| bits(a) == bits(b))
    }
}

fn add_sheet(
    faces: &mut Vec<[u32; 3]>,
    states: &mut [Vec<[f32; 3]>],
    n: usize,
    at: impl Fn(usize, f64, f64) -> [f64; 3],
) {
    let first = states[0].len();
    for (state, positions) in states.iter_mut().enumerate() {
        for k in 0..(n + 1) * (n + 1) {
            let coordinate = |k: usize| k as f64 / n as f64;
            positions.push(at(state, coordinate(k % (n + 1)), coordinate(k / (n + 1))).map(|x| x as f32));
        }
    }
    for k in 0..n * n {
        let a = u32::try_from(first + k / n * (n + 1) + k % n).expect("cloths are small");
        let c = a + n as u32 + 1;
        faces.extend([[a, a + 1, c], [c, a + 1, c + 1]]);
    }
}

fn answer(mesh: &Arc<Mesh>, untangler: &mut Untangler, positions: &[[f32; 3]]) -> Vec<VertexCorrection> {
    let positions: Vec<[f64; 3]> = positions.iter().map(|position| position.map(f64::from)).collect();
    let frame = Frame::new(mesh, &positions).expect("positions are finite");
    let corrections = untangler.process(&frame, &mut ()).corrections;
    let displacements = corrections.forces.iter().map(|force| (force * (1.0 / MASS_KG)).map(|x| x as f32).into());
    displacements.zip(&corrections.flags).map(|(value, flags)| VertexCorrection { value, flags: flags.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_have_different_answers() {
        for num_vertices in [8, 100, 1000] {
            let cloth = KnownCloth::new(num_vertices);
            let mut distinct: Vec<Vec<_>> = Vec::new();
            for answer in &cloth.answers {
                let bits: Vec<_> = answer.iter().map(|vertex| vertex.value.map(f32::to_bits)).collect();
                if !distinct.contains(&bits) {
                    distinct.push(bits);
                }
            }
            assert!(distinct.len() > NUM_STATES / 2, "{num_vertices}: {} answers", distinct.len());
        }
    }
}
