//! A simulated shot: two skirts over each other on a body that sways and turns, by the example host's solver.
//!
//! In a few lapses the solver forgets all contact, as one does that is given too few iterations: layers and body pass
//! through each other. Afterwards its contact is on again, and the untangler's forces bring them apart in its own
//! steps, so that a tangle grows and shrinks over several frames.

use std::{ops::Range, sync::Arc};

use untangle::{
    frame::Frame,
    settings::{Response, Settings},
    untangler::Untangler,
};
use untangled_publisher::{
    mesh::{Cloth, Vec3},
    solver::{Help, Parameters, Solver},
};
use untangled_testkit::generate::{Sheet, mirrored::Knowledge};

use crate::{
    Failure,
    gallery::{self, Gallery},
    host::{DT_S, Taken, mesh_of},
};

/// Steps before the first frame, in which the skirts come to hang.
const NUM_STEPS_BEFORE: u32 = 60;
/// Distance of the layers at the start, in metres.
const GAP_M: f64 = 0.012;

/// What is simulated.
#[derive(Clone, Debug)]
pub struct SimulatedShot {
    /// Frames, a step each.
    pub num_frames: u32,
    /// Length of an edge of the skirts in metres.
    pub edge_m: f64,
    /// Frames in which there is no contact.
    pub lapses: Vec<Range<u32>>,
}

impl SimulatedShot {
    /// 240 frames of 8,000 triangles.
    #[must_use]
    pub fn large() -> Self {
        Self { num_frames: 240, edge_m: 0.0154, lapses: vec![40..46, 95..101, 150..156, 205..211] }
    }

    /// Simulates it: the skirts and the body of each frame. A skirt's mesh is followed by that of the other.
    ///
    /// # Errors
    /// That of the library, for a state that it does not take.
    pub fn simulate(&self) -> Result<[Vec<Sheet>; 2], Failure> {
        let Gallery { cloth, piece } = gallery::skirts(self.edge_m, GAP_M, |_, _, _| 0.0);
        let num_body = piece.iter().filter(|&&piece| piece == 0).count();
        let start = cloth.positions.clone();
        let parameters =
            Parameters { thickness_m: 0.2 * self.edge_m, friction: 0.3, ..Parameters::of_cloth(&cloth, 9.81) };
        let mut solver = Solver::new(cloth, parameters);
        let mesh = Arc::new(mesh_of(solver.cloth(), solver.masses_kg(), Knowledge::Rest)?);
        let settings = Settings { response: Response::Rbf, ..Settings::default() };
        let mut untangler = Untangler::new(mesh, settings)?;
        untangler.set_labelled(true);
        let mut taken = Taken::default();
        let nowhere = vec![true; start.len()];
        let mut frames = [Vec::new(), Vec::new()];
        for step in 0..NUM_STEPS_BEFORE + self.num_frames {
            let frame = step.checked_sub(NUM_STEPS_BEFORE);
            let places: Vec<Vec3> = start.iter().map(|&place| self.moved(place, frame.unwrap_or(0))).collect();
            solver.carry(&places);
            if frame.is_some_and(|frame| self.lapses.iter().any(|lapse| lapse.contains(&frame))) {
                solver.step(DT_S, Help { no_contact: &nowhere, ..Help::NONE });
            } else {
                let state = Frame::new(untangler.mesh(), &solver.cloth().points())?;
                let corrections = untangler.process(&state, &mut ()).corrections;
                taken.take_values(corrections, solver.masses_kg(), Response::Rbf);
                taken.take_labels(corrections);
                solver.step(DT_S, taken.help());
            }
            if frame.is_some() {
                let pieces = split(solver.cloth(), num_body);
                frames.iter_mut().zip(pieces).for_each(|(frames, sheet)| frames.push(sheet));
            }
        }
        Ok(frames)
    }

    /// Where a place of the body is in a frame: it sways, and turns about its axis, from rest and back to it.
    fn moved(&self, place: Vec3, frame: u32) -> Vec3 {
        use std::f64::consts::{PI, TAU};
        let time = f64::from(frame);
        let calm = (PI * time / f64::from(self.num_frames)).sin();
        let angle = 0.45 * calm * (TAU * time / 90.0).sin();
        let sway = 0.06 * calm * (TAU * time / 80.0).cos();
        let (sin, cos) = angle.sin_cos();
        Vec3::new(cos * place.x - sin * place.y + sway, sin * place.x + cos * place.y, place.z)
    }
}

/// The skirts, then the body.
fn split(cloth: &Cloth, num_body: usize) -> [Sheet; 2] {
    let points = cloth.points();
    let first = u32::try_from(num_body).unwrap_or(u32::MAX);
    let (body, skirts): (Vec<[u32; 3]>, Vec<[u32; 3]>) = cloth.triangles.iter().partition(|corners| corners[0] < first);
    let skirts = skirts.iter().map(|corners| corners.map(|corner| corner - first)).collect();
    [
        Sheet { positions: points[num_body..].to_vec(), faces: skirts, ..Sheet::default() },
        Sheet { positions: points[..num_body].to_vec(), faces: body, ..Sheet::default() },
    ]
}
