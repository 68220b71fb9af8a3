//! Which settings a world is processed with, and the frames of each.

use std::{error::Error, sync::Arc};

use untangle::{
    frame::Frame,
    mesh::Mesh,
    respond::Corrections,
    settings::{InsideChoice, Quality, Response, Settings},
    untangler::Untangler,
};

use super::hash::{Digest, Feed};

/// Frames of each world.
pub const FRAMES: usize = 3;

/// Errors that may pass from a thread to another.
type BoxedError = Box<dyn Error + Send + Sync>;

/// Settings that decide which code runs, named as in a settings file.
pub fn choices() -> Vec<(&'static str, Settings)> {
    let responses = [
        ("response=rbf", Response::Rbf),
        ("response=contour", Response::Contour),
        ("response=displacement", Response::Displacement),
        ("response=coupled", Response::Coupled),
        ("response=mask", Response::Mask),
    ];
    let qualities = [
        ("quality=fast", Quality::Fast),
        ("quality=balanced", Quality::Balanced),
        ("quality=accurate", Quality::Accurate),
    ];
    let sides = [("inside=area", InsideChoice::Area), ("inside=work", InsideChoice::Work)];
    let of_quality = |quality: Quality| {
        let mut settings = Settings::default();
        quality.apply(&mut settings);
        settings
    };
    let responses = responses.map(|(name, response)| (name, Settings { response, ..Settings::default() }));
    let qualities = qualities.map(|(name, quality)| (name, of_quality(quality)));
    let sides = sides.map(|(name, inside)| (name, Settings { inside, ..Settings::default() }));
    let winding = [("winding=true", Settings { winding: true, ..Settings::default() })];
    responses.into_iter().chain(qualities).chain(sides).chain(winding).collect()
}

/// What a session has seen before the frames that count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Session {
    /// Nothing.
    Fresh,
    /// Other frames of the same mesh.
    Used,
}

/// Digests of the analyses and of the corrections of [`FRAMES`] frames, each the one before it with its corrections
/// applied. A first frame that is refused is an error; a later one that is refused ends the sequence.
///
/// # Errors
/// What the library has against the settings or the positions.
pub fn digest_frames(
    mesh: &Arc<Mesh>,
    positions: &[[f64; 3]],
    settings: &Settings,
    session: Session,
) -> Result<[Digest; 2], BoxedError> {
    let mut untangler = Untangler::new(mesh.clone(), settings.clone())?;
    let mut frame = Frame::new(mesh, positions)?;
    if session == Session::Used {
        // Seen from another side, and nearly where they are: memory, order of trees and certificates differ.
        let turned: Vec<[f64; 3]> = positions.iter().map(|&[x, y, z]| [0.5 * z, x, -y]).collect();
        let nearly: Vec<[f64; 3]> = positions.iter().map(|place| place.map(|value| value * 0.999_999)).collect();
        for other in [turned, nearly] {
            untangler.process(&Frame::new(mesh, &other)?, &mut ());
        }
    }
    let [mut analyses, mut corrections] = [Digest::default(); 2];
    for _ in 0..FRAMES {
        let outcome = untangler.process(&frame, &mut ());
        outcome.analysis.feed(&mut analyses);
        outcome.corrections.feed(&mut corrections);
        let next = corrected(mesh, &frame, outcome.corrections);
        let Ok(next) = Frame::new(mesh, &next) else { break };
        frame = next;
    }
    Ok([analyses, corrections])
}

/// Positions after one step along the forces, in metres; vertices weigh 1 kg where no masses are given.
fn corrected(mesh: &Mesh, frame: &Frame, corrections: &Corrections) -> Vec<[f64; 3]> {
    let mass_kg = |vertex: usize| mesh.masses_kg().map_or(1.0, |masses| masses[vertex]);
    let moved = frame.positions().iter().zip(&corrections.forces).enumerate();
    moved.map(|(vertex, (position, force))| (position + force / mass_kg(vertex)).into()).collect()
}
