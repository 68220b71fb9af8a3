//! The digests of all inputs as lines of text.

use std::{ops::ControlFlow, sync::Arc};

use untangle::{
    frame::Frame,
    mesh::Mesh,
    proximity::ProximitySearch,
    relax::{RelaxSettings, relax},
};

use super::{
    frames::{Session, choices, digest_frames},
    hash::{Digest, Feed},
    worlds::World,
};

/// Rounds of a relaxation: enough for most of what it does.
const ROUNDS: usize = 6;

/// The lines of a world: its name, what was done with it, and one or two digests, with tabs between. The first is that
/// of the input: where it differs the machine makes other inputs, not other answers.
pub fn lines(world: &World, session: Session) -> Vec<String> {
    let World { name, description, positions } = world;
    let mesh = Arc::new(Mesh::new(description.clone()).unwrap());
    let mut lines = vec![format!("{name}\tinput\t{:016x}", digest_of_input(world).0)];
    for (choice, settings) in choices() {
        let [analyses, corrections] = digest_frames(&mesh, positions, &settings, session).unwrap();
        lines.push(format!("{name}\t{choice}\t{:016x}\t{:016x}", analyses.0, corrections.0));
    }
    lines.push(format!("{name}\tgaps\t{:016x}", digest_of_gaps(&mesh, positions, session).0));
    lines.push(format!("{name}\trelax\t{:016x}", digest_of_relaxation(&mesh, positions).0));
    lines
}

fn digest_of_input(world: &World) -> Digest {
    let mut digest = Digest::default();
    world.description.faces.feed(&mut digest);
    world.description.uvs.as_ref().map(|uvs| uvs.coordinates.clone()).feed(&mut digest);
    world.positions.feed(&mut digest);
    digest
}

/// All pairs nearer than a part of the extent, and the nearest one.
fn digest_of_gaps(mesh: &Mesh, positions: &[[f64; 3]], session: Session) -> Digest {
    let (mut search, mut found, mut digest) = (ProximitySearch::default(), Vec::new(), Digest::default());
    let extent = positions.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
    if session == Session::Used {
        let smaller: Vec<[f64; 3]> = positions.iter().map(|place| place.map(|value| 0.5 * value)).collect();
        search.find(mesh, &Frame::new(mesh, &smaller).unwrap(), 0.01 * extent, usize::MAX, &mut found);
    }
    let frame = Frame::new(mesh, positions).unwrap();
    search.find(mesh, &frame, 0.002 * extent, usize::MAX, &mut found);
    found.feed(&mut digest);
    search.nearest(mesh, &frame).feed(&mut digest);
    digest
}

fn digest_of_relaxation(mesh: &Mesh, positions: &[[f64; 3]]) -> Digest {
    let settings = RelaxSettings { max_iterations: ROUNDS, ..RelaxSettings::default() };
    let mut digest = Digest::default();
    match relax(mesh, positions, &settings, &mut |_| ControlFlow::Continue(())) {
        Ok(outcome) => outcome.positions.feed(&mut digest),
        Err(error) => digest.bytes(error.to_string().as_bytes()),
    }
    digest
}
