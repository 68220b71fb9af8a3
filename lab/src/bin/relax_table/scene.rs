//! One mesh, relaxed by its corrections.

use std::{error::Error, fmt, sync::Arc};

use nalgebra::Vector3;
use untangle::{
    frame::Frame,
    mesh::Mesh,
    settings::Settings,
    untangler::{Outcome, Untangler},
};
use untangled_mesh_io::{concatenate, read_mesh};

use crate::springs::{Spring, edge_lengths, project, springs};

const PROJECTIONS: usize = 4;
/// A scene is held when it stays clean for so many steps.
const HELD: usize = 5;

/// A mesh with the distances that it shall keep.
pub(crate) struct Scene {
    mesh: Arc<Mesh>,
    positions: Vec<[f64; 3]>,
    springs: Vec<Spring>,
}

/// How a run ended.
#[derive(Default)]
pub(crate) struct Run {
    before: usize,
    /// Steps to the first clean state.
    steps: Option<usize>,
    is_broken: bool,
    after: usize,
    stretch: f64,
    /// Greatest net force and net torque, as parts of the sums of magnitudes.
    residuals: [f64; 2],
}

impl fmt::Display for Run {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { before, steps, is_broken, after, stretch, residuals: [force, torque] } = self;
        let (steps, held) = match (steps, is_broken) {
            (None, _) => ("-".into(), ""),
            (Some(steps), false) => (steps.to_string(), "yes"),
            (Some(steps), true) => (steps.to_string(), "no"),
        };
        write!(formatter, "{before:>8} {steps:>6} {held:>6} {after:>6} {stretch:>7.2} {force:>9.1e} {torque:>9.1e}")
    }
}

impl Scene {
    /// Reads a mesh file, with the flat sheet of its texture coordinates or with its own shape at rest; none where it
    /// is no mesh.
    pub(crate) fn read(file: &str, flat: bool, strip_uvs: bool) -> Result<Option<Self>, Box<dyn Error>> {
        let Ok(file) = read_mesh(file) else { return Ok(None) };
        let mut world = concatenate(&[file])?;
        let flat_uvs = if flat { world.description.uvs.clone() } else { None };
        if strip_uvs {
            world.description.uvs = None;
        }
        let (description, positions) = (world.description, world.positions);
        let Ok(mesh) = Mesh::new(description) else { return Ok(None) };
        if Frame::new(&mesh, &positions).is_err() {
            return Ok(None);
        }
        let springs = springs(&mesh, &positions, flat_uvs.as_ref());
        Ok(Some(Self { mesh: Arc::new(mesh), positions, springs }))
    }

    /// Moves by corrections and springs until the mesh stays clean, for at most `most` steps.
    pub(crate) fn run(mut self, settings: &Settings, most: usize, verbose: bool) -> Result<Run, Box<dyn Error>> {
        let mut untangler = Untangler::new(self.mesh.clone(), settings.clone())?;
        let lengths = edge_lengths(&self.mesh, &self.positions);
        let mut run = Run::default();
        for step in 0..=most {
            let frame = Frame::new(&self.mesh, &self.positions)?;
            let outcome = untangler.process(&frame, &mut ());
            if verbose {
                print_step(step, &outcome);
            }
            run.look_at(step, &frame, &outcome);
            if run.steps.is_some_and(|first| step >= first + HELD) {
                break;
            }
            for (position, force) in self.positions.iter_mut().zip(&outcome.corrections.forces) {
                for (value, part) in position.iter_mut().zip(force.iter()) {
                    *value += part;
                }
            }
            (0..PROJECTIONS).for_each(|_| project(&self.springs, &mut self.positions));
        }
        let stretched = edge_lengths(&self.mesh, &self.positions);
        let logarithms = lengths.iter().zip(&stretched).map(|(a, b)| (b / a).ln());
        run.stretch = logarithms.fold(0.0f64, |most, s| if s.abs() > most.abs() { s } else { most }).exp();
        Ok(run)
    }
}

impl Run {
    /// Takes in one step.
    fn look_at(&mut self, step: usize, frame: &Frame, outcome: &Outcome<'_>) {
        self.after = outcome.analysis.intersections.edge_face.len();
        if step == 0 {
            self.before = self.after;
        }
        let (sum, moments) = residual_scale(frame, &outcome.corrections.forces);
        if sum > 0.0 {
            let [force, torque] = self.residuals;
            self.residuals = [
                force.max(outcome.corrections.net_force.norm() / sum),
                torque.max(outcome.corrections.net_torque.norm() / moments),
            ];
        }
        match (self.after, self.steps) {
            (0, None) => self.steps = Some(step),
            (1.., Some(_)) => self.is_broken = true,
            _ => {}
        }
    }
}

fn print_step(step: usize, outcome: &Outcome<'_>) {
    let after = outcome.analysis.intersections.edge_face.len();
    let types: Vec<_> = outcome.analysis.paths.pairs.iter().map(|pair| (pair.pair_type, pair.num_segments)).collect();
    println!("  {step:>3} {after:>5} {:>9.4} {types:?}", outcome.corrections.max_displacement_m);
    for path in &outcome.correspondences.paths {
        println!("        {path:?}");
    }
}

/// Sums of the magnitudes of all forces and of their moments about the centre.
fn residual_scale(frame: &Frame, forces: &[Vector3<f64>]) -> (f64, f64) {
    let mut sum = 0.0;
    let mut moments = 0.0;
    let mut centre = Vector3::zeros();
    let mut count = 0.0;
    for (position, force) in frame.positions().iter().zip(forces) {
        if *force != Vector3::zeros() {
            centre += position.coords;
            count += 1.0;
        }
    }
    for (position, force) in frame.positions().iter().zip(forces) {
        sum += force.norm();
        moments += (position.coords - centre / f64::max(count, 1.0)).norm() * force.norm();
    }
    (sum, moments)
}
