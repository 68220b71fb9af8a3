//! One scene in the example host's solver with one kind of help.

use std::{collections::BTreeSet, error::Error, sync::Arc};

use untangle::{
    frame::Frame,
    settings::{Response, Settings},
    untangler::Untangler,
};
use untangled_checker::edge_face_hits;
use untangled_lab::{
    gallery::Gallery,
    host::{DT_S, Taken, mesh_of},
};
use untangled_publisher::{
    mesh::{Cloth, Vec3},
    solver::{Parameters, Solver},
};
use untangled_testkit::generate::mirrored::Knowledge;

/// Which contacts a host switches off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Off {
    Nothing,
    Mask(u32),
    Labels,
}

/// What a host does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Help {
    pub(crate) name: &'static str,
    pub(crate) response: Response,
    pub(crate) off: Off,
}

/// How one run went.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Run {
    /// Hits at the start.
    pub(crate) before: usize,
    /// Steps after which it stays clean to the end.
    pub(crate) steps: Option<usize>,
    /// Hits at the end.
    pub(crate) after: usize,
    /// Most hits of a step between pieces that had none at the start.
    pub(crate) most_elsewhere: usize,
    /// Most hits of a step.
    pub(crate) most: usize,
    pub(crate) stretch: f64,
}

fn parameters(cloth: &Cloth, edge_m: f64) -> Parameters {
    Parameters {
        gravity_m_s2: Vec3::new(0.0, 0.0, -9.81),
        // Less than the distance of the layers at the start.
        thickness_m: 0.2 * edge_m,
        friction: 0.3,
        ..Parameters::of_cloth(cloth, 9.81)
    }
}

/// Pieces that meet, the lower number first, and how often.
fn meetings(cloth: &Cloth, piece: &[usize]) -> Result<Vec<[usize; 2]>, Box<dyn Error>> {
    let hits = edge_face_hits(&cloth.points(), &cloth.triangles)?;
    let of = |hit: &untangled_checker::EdgeFaceHit| {
        let [a, b] = [hit.edge[0], cloth.triangles[hit.triangle as usize][0]].map(|vertex| piece[vertex as usize]);
        [a.min(b), a.max(b)]
    };
    Ok(hits.iter().map(of).collect())
}

/// Runs a scene.
pub(crate) fn run(
    gallery: Gallery,
    edge_m: f64,
    help: Help,
    num_steps: usize,
    verbose: bool,
) -> Result<Run, Box<dyn Error>> {
    let Gallery { cloth, piece } = gallery;
    let parameters = parameters(&cloth, edge_m);
    let mut solver = Solver::new(cloth, parameters);
    let mesh = Arc::new(mesh_of(solver.cloth(), solver.masses_kg(), Knowledge::Rest)?);
    let mut settings = Settings { response: help.response, ..Settings::default() };
    if let Off::Mask(rings) = help.off {
        settings.path_rings = rings;
    }
    let mut untangler = Untangler::new(mesh, settings)?;
    untangler.set_labelled(help.off == Off::Labels);
    let (mut run, mut taken) = (Run::default(), Taken::default());
    let mut tangled: BTreeSet<[usize; 2]> = BTreeSet::new();
    for step in 0..=num_steps {
        let met = meetings(solver.cloth(), &piece)?;
        if step == 0 {
            run.before = met.len();
            tangled.extend(&met);
        }
        run.after = met.len();
        run.most = run.most.max(met.len());
        let elsewhere = met.iter().filter(|pieces| !tangled.contains(*pieces)).count();
        run.most_elsewhere = run.most_elsewhere.max(elsewhere);
        run.steps = if met.is_empty() { run.steps.or(Some(step)) } else { None };
        if verbose && step % 10 == 0 {
            println!("  {step:>4} {:>5} {elsewhere:>5}", met.len());
        }
        if step == num_steps {
            break;
        }
        let frame = Frame::new(untangler.mesh(), &solver.cloth().points())?;
        let corrections = untangler.process(&frame, &mut ()).corrections;
        taken.take_values(corrections, solver.masses_kg(), help.response);
        match help.off {
            Off::Nothing => {}
            Off::Mask(_) => taken.take_mask(corrections),
            Off::Labels => taken.take_labels(corrections),
        }
        solver.step(DT_S, taken.help());
    }
    run.stretch = solver.cloth().worst_edge_ratio();
    Ok(run)
}
