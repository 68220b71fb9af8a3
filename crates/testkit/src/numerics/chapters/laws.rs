//! The force law at its limits: stiffness, largest step and masses.

use std::sync::Arc;

use nalgebra::{Point3, Vector3};
use untangle::{
    mesh::Mesh,
    respond::{Corrections, VertexFlags},
    settings::{Response, Settings},
};

use super::time;
use crate::numerics::{
    answer::{RESPONSES, answer, frame, sheets, spread, with_masses},
    case::{Case, Chapter, Effort, Seen, ensure},
};

const SHEETS: u64 = 24;
const STIFFNESSES: [f64; 7] = [0.0, 1e-12, 1e-3, 0.5, 1.0, 1e6, 1e12];
const LARGEST: [f64; 6] = [0.0, 1e-12, 0.2, 1.0, 1e12, f64::INFINITY];

pub(super) fn chapter() -> Chapter {
    let cases = vec![
        Case::new(
            "`stiffness_per_step2` 0 to 1e12 with `max_step_edge_lengths` 0 to infinity, forces by targets and by \
             length",
            "finite; no vertex moves by more than 3 f_max of the longest edge, none at f_max = 0; with f_max infinite, \
             forces that are f_max (down the gradient of the length) are left out, and the others balance to 1e-10",
            laws,
        ),
        Case::new(
            "without a limit, `stiffness_per_step2` times 1e12",
            "corrections grow by 1e12, relative error below 1e-9",
            linear,
        ),
        Case::new(
            "masses spread evenly over 12 decades, 1e-6 to 1e6 kg, from vertex to vertex",
            "finite; force and torque left over below 1e-10 of their sums; displacements within the limit",
            |effort| masses(effort, 12.0, false),
        ),
        Case::new(
            "the same, one vertex in seven without mass",
            "finite; no force on a vertex without mass; force and torque left over below 1e-10 of their sums",
            |effort| masses(effort, 12.0, true),
        ),
        Case::new("masses spread evenly over 600 decades", "finite", |effort| masses(effort, 600.0, false)),
        Case::new(
            "`dt_s` 1e-9 to 1, masses 1e-6 to 1e6 kg, each kind of correction on the wire, of a cloth as it is, 1e-40 \
             and 1e25 times as large",
            "right to single precision (6e-8) within its range; below it rounded by up to 7e-46; above it zero, and \
             flagged as clamped",
            time::wire,
        ),
        Case::new(
            "the example host's solver with `dt_s` 1e-9 to 1, pushed by 1 km/s in each step",
            "positions stay finite",
            time::host,
        ),
    ];
    Chapter {
        title: "Forces, masses and time",
        text: "A force is in kg m / step^2; `dt_s` enters only where it is put on the wire \
               (`src/service/session/publish.rs`). `dt_s` below 1e-9 or above 1e9 is refused.",
        cases,
    }
}

fn longest_edge(mesh: &Mesh, positions: &[[f64; 3]]) -> f64 {
    let length = |edge| {
        let [a, b] = mesh.edge(edge).map(|vertex| Vector3::from(positions[vertex.index()]));
        (a - b).norm()
    };
    mesh.edge_ids().map(length).fold(0.0, f64::max)
}

fn laws(effort: Effort) -> Seen {
    let (mut count, mut longest, mut clamped) = (0, 0.0f64, 0);
    for sheet in sheets(effort.choose(6, SHEETS)) {
        let mesh = Arc::new(sheet.mesh());
        let frame = frame(&mesh, &sheet.positions)?;
        let edge = longest_edge(&mesh, &sheet.positions);
        for response in [Response::Rbf, Response::Contour] {
            for stiffness_per_step2 in STIFFNESSES {
                for max_step_edge_lengths in LARGEST {
                    let settings =
                        Settings { response, stiffness_per_step2, max_step_edge_lengths, ..Settings::default() };
                    let corrections = answer(&mesh, &frame, settings)?.corrections;
                    let moved = corrections.max_displacement_m;
                    ensure(moved <= 3.0 * max_step_edge_lengths * edge * (1.0 + 1e-12), || {
                        format!("k = {stiffness_per_step2:e}, f_max = {max_step_edge_lengths:e}: moved by {moved:e} m")
                    })?;
                    if max_step_edge_lengths.is_infinite() {
                        let left = sum_of(&corrections.forces);
                        ensure(left < 1e-10, || {
                            format!("k = {stiffness_per_step2:e}: {left:e} of the forces left over")
                        })?;
                    }
                    longest = longest.max(moved / edge);
                    let is_clamped = |flags: &&VertexFlags| flags.contains(VertexFlags::CLAMPED);
                    clamped += corrections.flags.iter().filter(is_clamped).count();
                    count += 1;
                }
            }
        }
    }
    Ok(format!("held {count} times; longest displacement {longest:.0e} edges; {clamped} corrections clamped"))
}

fn linear(effort: Effort) -> Seen {
    let (mut worst, mut count) = (0.0f64, 0);
    for sheet in sheets(effort.choose(6, SHEETS)) {
        let mesh = Arc::new(sheet.mesh());
        let frame = frame(&mesh, &sheet.positions)?;
        let with = |stiffness_per_step2| {
            let settings =
                Settings { stiffness_per_step2, max_step_edge_lengths: f64::INFINITY, ..Settings::default() };
            answer(&mesh, &frame, settings)
        };
        let (soft, stiff) = (with(1.0)?, with(1e12)?);
        let moves = soft.corrections.forces.iter().any(|force| force.norm() > 0.0);
        worst = worst.max(stiff.difference(&soft, 1e12));
        count += usize::from(moves);
    }
    ensure(count > 0 && worst < 1e-9, || format!("{worst:e} apart on {count} sheets"))?;
    Ok(format!("{worst:.0e} apart on {count} sheets with forces"))
}

fn masses(effort: Effort, decades: f64, with_zeros: bool) -> Seen {
    let (mut worst, mut count) = ([0.0f64; 2], 0);
    for sheet in sheets(effort.choose(6, SHEETS)) {
        let masses = spread(sheet.positions.len(), decades, with_zeros);
        let mesh = with_masses(sheet.faces.clone(), &masses);
        let frame = frame(&mesh, &sheet.positions)?;
        let edge = longest_edge(&mesh, &sheet.positions);
        for response in RESPONSES {
            // The limit by edges is what can be said without the depth.
            let settings = Settings { response, steps_to_clean: f64::INFINITY, ..Settings::default() };
            let corrections = answer(&mesh, &frame, settings)?.corrections;
            count += 1;
            if !matches!(response, Response::Rbf | Response::Contour) || decades > 100.0 {
                continue;
            }
            let on_nothing = masses.iter().zip(&corrections.forces).filter(|(mass, _)| **mass <= 0.0);
            ensure(on_nothing.into_iter().all(|(_, force)| force.norm() <= 0.0), || "a force on no mass".into())?;
            ensure(corrections.max_displacement_m <= 0.6 * edge * (1.0 + 1e-12), || "beyond the limit".into())?;
            let left = residuals(&frame, &corrections);
            worst = [0, 1].map(|k| worst[k].max(left[k]));
        }
    }
    ensure(worst.iter().all(|&left| left < 1e-10), || format!("{worst:?} left over"))?;
    let left = format!(", {:.0e} of the forces and {:.0e} of the torques left over", worst[0], worst[1]);
    Ok(format!("held {count} times{}", if decades > 100.0 { String::new() } else { left }))
}

/// The net force and the net torque, as parts of the sums of magnitudes.
fn residuals(frame: &untangle::frame::Frame, corrections: &Corrections) -> [f64; 2] {
    let sum: Vector3<f64> = frame.positions().iter().map(|position| position.coords).sum();
    let centre = Point3::from(sum / frame.positions().len() as f64);
    let forces: f64 = corrections.forces.iter().map(Vector3::norm).sum();
    let pairs = frame.positions().iter().zip(&corrections.forces);
    let moments: f64 = pairs.map(|(position, force)| (position - centre).norm() * force.norm()).sum();
    let part = |left: Vector3<f64>, all: f64| if all > 0.0 { left.norm() / all } else { 0.0 };
    [part(corrections.net_force, forces), part(corrections.net_torque, moments)]
}

/// The sum of forces, as a part of the sum of their lengths.
fn sum_of(forces: &[Vector3<f64>]) -> f64 {
    let lengths: f64 = forces.iter().map(Vector3::norm).sum();
    if lengths > 0.0 { forces.iter().sum::<Vector3<f64>>().norm() / lengths } else { 0.0 }
}
