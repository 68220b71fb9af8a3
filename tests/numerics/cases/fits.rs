//! Thin-plate fits with few centres and many, on lines, on flat arcs and side by side: condition numbers and what they do to targets.
//!
//! The fit itself, on centres that contradict each other too, is held by `crates/untangle/src/correspond/fit/tests.rs`.

use std::{f64::consts::TAU, sync::Arc};

use nalgebra::{Point2, Vector2};
use untangle::{correspond::Correspondences, mesh::Mesh, settings::Settings, untangler::Untangler};

use super::{Case, Chapter, Effort, Seen, answer::frame, ensure};
use crate::support::{
    scene::{Scene, folded},
    sheet::Sheet,
};

const FINITE: &str =
    "full rank or said to be short of it; finite; the fit takes the path to its partner within 0.2 edges";

pub(super) fn chapter() -> Chapter {
    let mut cases = Vec::new();
    for count in [3, 5, 10, 30, 100, 300, 1000] {
        cases.push(Case::new(
            format!("{count} centres on a closed path and on an LL path of a folded sheet"),
            if count < 10 { "finite; targets within 3 edges" } else { "full rank; finite; targets within 2 edges" },
            move |effort| folds(effort, count),
        ));
    }
    for (what, angle) in [
        ("on a line", 0.0),
        ("on an arc of 1e-2 rad", 1e-2),
        ("on an arc of 1e-4 rad", 1e-4),
        ("on an arc of 1e-6 rad", 1e-6),
        ("on an arc of 1e-9 rad", 1e-9),
    ] {
        cases.push(Case::new(format!("centres {what}: a strip through a sheet"), FINITE, move |effort| {
            strips(effort, angle)
        }));
    }
    for thickness in [1e-2, 1e-4, 1e-6, 1e-9, 1e-12] {
        cases.push(Case::new(
            format!("centres that nearly coincide: round a blade {thickness:e} times as thick as wide"),
            "finite; where both sides of the loop are one place and belong to two, the residual says so: at most twice the girth of the blade",
            move |_| blade(thickness),
        ));
    }
    Chapter {
        title: "Centres of the fits",
        text: "*Condition* is the ratio of the largest to the smallest pivot of a fit, both sides of which are scaled to unit size, as \
               `PathCorrespondence::condition` says it; *short* the sum of `rank_deficiency` over all fits; *residual* by how much a fit misses its path at \
               worst, and *targets* how far targets lie from the true ones at worst, both in edge lengths. `min_centres` and `max_centres` are both set to the \
               count; a path that is nearly straight has centres beside it, inside, too, and an LL path those of its partner. The fit itself, on centres that \
               contradict each other too, is held by the unit tests of `crates/untangle/src/correspond/fit/tests.rs`.",
        cases,
    }
}

/// What the fits of a scene are like.
#[derive(Default)]
struct Fits {
    count: usize,
    centres: usize,
    short: usize,
    condition: f64,
    residual: f64,
    residual_m: f64,
}

impl Fits {
    fn add(&mut self, found: &Correspondences) -> Result<(), String> {
        for fit in &found.paths {
            self.count += 1;
            self.centres = self.centres.max(fit.num_centres);
            self.short += fit.rank_deficiency;
            self.condition = self.condition.max(fit.condition);
            self.residual_m = self.residual_m.max(fit.residual_m);
            self.residual = self.residual.max(fit.residual_m / fit.edge_length_m);
            ensure(fit.condition.is_finite() && fit.residual_m.is_finite(), || "a fit is not finite".into())?;
        }
        let places = found.attractions.iter().flat_map(|pull| [pull.source, pull.target]);
        let weights = places
            .flat_map(|point| point.weights)
            .chain(found.separations.iter().flat_map(|part| part.direction.data.0[0]));
        ensure(weights.into_iter().all(f64::is_finite), || "a target is not finite".into())
    }

    fn words(&self) -> String {
        let Self { count, centres, short, condition, residual, .. } = self;
        format!(
            "{count} fits of up to {centres} centres: condition {condition:.0e}, short {short}, residual {residual:.0e}"
        )
    }
}

/// The correspondences of a scene with so many centres.
fn fitted<T>(
    mesh: Mesh,
    positions: &[[f64; 3]],
    centres: Option<usize>,
    look: impl FnOnce(&Correspondences) -> Result<T, String>,
) -> Result<T, String> {
    let mesh = Arc::new(mesh);
    let mut settings = Settings::default();
    if let Some(count) = centres {
        (settings.min_centres, settings.max_centres) = (count, count);
    }
    let mut untangler = Untangler::new(mesh.clone(), settings).map_err(|error| error.to_string())?;
    let outcome = untangler.process(&frame(&mesh, positions)?, &mut ());
    let forces = &outcome.corrections.forces;
    ensure(forces.iter().flat_map(|force| force.iter()).all(|x| x.is_finite()), || "a force is not finite".into())?;
    look(outcome.correspondences)
}

fn with_uvs(scene: &Scene) -> Mesh {
    Mesh::new(scene.description()).unwrap()
}

/// Folded sheets, of which the point that belongs to (u, v) is (-u, v).
fn folds(effort: Effort, count: usize) -> Seen {
    if count > effort.choose(100, 1000) {
        return Ok("not tried".into());
    }
    let (mut fits, mut worst) = (Fits::default(), 0.0f64);
    let ellipse = |x: f64, v: f64| ((x - 0.3) / 0.2).powi(2) + ((v - 0.51) / 0.31).powi(2) - 1.0;
    let half = |x: f64, v: f64| (x / 0.41).powi(2) + ((v - 0.49) / 0.3).powi(2) - 1.0;
    for level in [&ellipse as &dyn Fn(f64, f64) -> f64, &half] {
        let mut scene = Scene::default();
        let steps = |low: f64, high: f64, count: u32, shift: f64| -> Vec<f64> {
            // Not evenly, so that no two lines of the layers lie over each other.
            let even = |k: u32| low + (high - low) * f64::from(k) / f64::from(count);
            (0..=count).map(|k| even(k) + shift * (7.3 * f64::from(k)).sin()).collect()
        };
        let place = folded(level);
        scene.add_lines(&steps(-0.93, 0.89, 31, 0.007), &steps(0.0, 1.0, 18, 0.007), place);
        worst = worst.max(fitted(with_uvs(&scene), &scene.positions, Some(count), |found| {
            fits.add(found)?;
            let at = |point: &untangle::correspond::MaterialPoint| -> Vector2<f64> {
                let weighted = point.vertices.iter().zip(point.weights);
                weighted.map(|(vertex, weight)| Vector2::from(scene.uvs[vertex.index()]) * weight).sum()
            };
            let edge = 1.0 / 18.0;
            let miss = |pull: &untangle::correspond::Attraction| {
                let ([u, v], target) = (at(&pull.source).into(), at(&pull.target));
                (target - Vector2::new(-u, v)).norm() / edge
            };
            Ok(found.attractions.iter().map(miss).fold(0.0, f64::max))
        })?);
    }
    ensure(fits.count >= 2, || format!("only {} fits", fits.count))?;
    ensure(count < 10 || fits.short == 0, || fits.words())?;
    ensure(worst < if count < 10 { 3.0 } else { 2.0 }, || format!("{}, targets {worst:.2}", fits.words()))?;
    Ok(format!("{}, targets {worst:.2}", fits.words()))
}

/// A flat strip through a sheet that is bent to an arc over it, so that the path on the strip is one.
fn strips(effort: Effort, angle: f64) -> Seen {
    let mut fits = Fits::default();
    for count in [None, Some(3), Some(30), Some(effort.choose(50, 300))] {
        let mut scene = Scene::default();
        // An arc of length 1 over a chord from -0.5 to 0.5.
        let bend = |x: f64| if angle > 0.0 { ((1.0 / angle).powi(2) - x * x).sqrt() - (1.0 / angle) } else { 0.0 };
        scene.add_grid([-0.83, 0.87], [-0.9, 0.9], [21, 17], |x, y| [x, y, bend(x)]);
        scene.add_grid([-0.5, 0.5], [-0.31, 0.69], [12, 12], |x, z| [x, 0.013, z]);
        fitted(with_uvs(&scene), &scene.positions, count, |found| fits.add(found))?;
    }
    ensure(fits.count >= 4, || format!("only {} fits", fits.count))?;
    ensure(fits.residual < 0.2, || fits.words())?;
    Ok(fits.words())
}

/// A flattened tube through a sheet.
fn blade(thickness: f64) -> Seen {
    let mut fits = Fits::default();
    for count in [None, Some(10), Some(30), Some(100)] {
        let mut scene = Scene::default();
        scene.add_grid([-0.71, 0.73], [-0.69, 0.7], [16, 15], |x, y| [x, y, 0.003 * x]);
        let (first, columns, rows) = (u32::try_from(scene.positions.len()).unwrap(), 24, 8);
        for row in 0..=rows {
            for column in 0..columns {
                let (angle, height) =
                    (TAU * (f64::from(column) + 0.3) / f64::from(columns), f64::from(row) / f64::from(rows));
                let at = Point2::new(0.3 * angle.cos(), 0.3 * thickness * angle.sin());
                scene.positions.push([at.x, at.y + 0.017, height - 0.31]);
                scene.uvs.push([0.0; 2]);
            }
        }
        let at = |row: u32, column: u32| first + row * columns + column % columns;
        for row in 0..rows {
            for column in 0..columns {
                scene.faces.push([at(row, column), at(row, column + 1), at(row + 1, column)]);
                scene.faces.push([at(row + 1, column), at(row, column + 1), at(row + 1, column + 1)]);
            }
        }
        let sheet = Sheet { faces: scene.faces, uvs: scene.uvs, positions: scene.positions };
        fitted(sheet.bare_mesh(), &sheet.positions, count, |found| fits.add(found))?;
    }
    ensure(fits.count >= 4, || format!("only {} fits", fits.count))?;
    ensure(fits.residual_m < 2.4, || format!("{}, {} m", fits.words(), fits.residual_m))?;
    Ok(fits.words())
}
