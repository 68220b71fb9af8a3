//! The step of time, which enters where a correction is put on the wire, and what a host makes of it.

use nalgebra::Vector3;
use untangle::{respond::VertexFlags, settings::Settings};
use untangled::service::session::publish;
use untangled_proto::{CorrectionKind, VertexCorrection};
use untangled_publisher::{
    scenes::Scene,
    solver::{Help, Parameters, Solver},
};

use crate::numerics::{
    answer::{answer, frame, sheets, spread, with_masses},
    case::{Effort, Seen, ensure},
};

const KINDS: [CorrectionKind; 4] =
    [CorrectionKind::Force, CorrectionKind::Acceleration, CorrectionKind::VelocityChange, CorrectionKind::Displacement];

/// What a vector became on the wire.
enum Sent {
    /// Right; by how much, as a part of itself, a coordinate is off that single precision holds in full.
    Right(f64),
    /// Zero, and flagged.
    TooLarge,
}

pub(super) fn wire(effort: Effort) -> Seen {
    let (mut worst, mut too_large, mut count) = (0.0f64, 0, 0);
    for sheet in sheets(effort.choose(3, 12)) {
        let masses = spread(sheet.positions.len(), 12.0, false);
        let mesh = with_masses(sheet.faces.clone(), &masses);
        let mut corrections = answer(&mesh, &frame(&mesh, &sheet.positions)?, Settings::default())?.corrections;
        // The cloth as it is, very small, and very large.
        for factor in [1.0, 1e-40, 1e65] {
            corrections.forces.iter_mut().for_each(|force| *force *= factor);
            let steps = (-9..=0).map(|power| 10f64.powi(power));
            for (dt_s, kind) in steps.flat_map(|dt_s| KINDS.map(|kind| (dt_s, kind))) {
                for (index, (force, mass)) in corrections.forces.iter().zip(&masses).enumerate() {
                    let expected = match kind {
                        CorrectionKind::Force => force / (dt_s * dt_s),
                        CorrectionKind::Acceleration => force / (mass * dt_s * dt_s),
                        CorrectionKind::VelocityChange => force / (mass * dt_s),
                        CorrectionKind::Displacement => force / *mass,
                    };
                    match sent(expected, publish::vertex(&mesh, &corrections, kind, dt_s, index))? {
                        Sent::Right(apart) => worst = worst.max(apart),
                        Sent::TooLarge => too_large += 1,
                    }
                    count += 1;
                }
            }
        }
    }
    Ok(format!("{count} vectors, right to {worst:.0e}; {too_large} of them too large"))
}

/// Compares a vector with what was sent of it.
fn sent(expected: Vector3<f64>, correction: VertexCorrection) -> Result<Sent, String> {
    let VertexCorrection { value, flags } = correction;
    if expected.amax() > f64::from(f32::MAX) {
        let is_clamped = VertexFlags(flags).contains(VertexFlags::CLAMPED);
        ensure(value == [0.0; 3] && is_clamped, || format!("{:e} became {value:?}", expected.amax()))?;
        return Ok(Sent::TooLarge);
    }
    let mut worst = 0.0f64;
    for (value, expected) in value.iter().zip(expected.iter()) {
        let apart = (f64::from(*value) - expected).abs();
        ensure(apart <= 6e-8 * expected.abs() + 7.1e-46, || format!("{expected:e} became {value:e}"))?;
        if expected.abs() > f64::from(f32::MIN_POSITIVE) {
            worst = worst.max(apart / expected.abs());
        }
    }
    Ok(Sent::Right(worst))
}

pub(super) fn host(effort: Effort) -> Seen {
    let (mut count, mut fastest) = (0, 0.0f64);
    for dt_s in (-9..=0).map(|power| 10f64.powi(power)) {
        let cloth = Scene::Tongue.build(1, 0.05);
        let num_vertices = cloth.positions.len();
        let reach = 0.5 * cloth.mean_edge_length_m();
        let parameters = Parameters::of_cloth(&cloth, 9.81);
        let mut solver = Solver::new(cloth, parameters);
        let pushed = vec![Vector3::new(0.0, 0.0, 1e3); num_vertices];
        for _ in 0..effort.choose(3, 30) {
            let before = solver.cloth().positions.clone();
            solver.step(dt_s, Help { velocity_change_m_s: &pushed, ..Help::NONE });
            let positions = &solver.cloth().positions;
            ensure(positions.iter().flat_map(|p| p.iter()).all(|x| x.is_finite()), || {
                format!("dt = {dt_s:e}: not finite")
            })?;
            let moved = before.iter().zip(positions).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
            fastest = fastest.max(moved / reach);
            count += 1;
        }
    }
    Ok(format!("{count} steps; no vertex moved farther than {fastest:.2} of what contact looks ahead"))
}
