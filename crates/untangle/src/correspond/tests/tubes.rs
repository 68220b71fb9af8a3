//! Targets on tubes: paths from hem to hem, and paths that wind round.

use std::f64::consts::TAU;

use super::samples::tube_faces;
use crate::{
    analysis::{Analyser, Analysis, analyse},
    correspond::Correspondent,
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    paths::PairType,
    respond::Responder,
    settings::{InsideChoice, Settings},
};

/// Columns, rows, and the position at an angle in 0..TAU and a height in 0..=1.
type Tube<'a> = (u32, u32, &'a dyn Fn(f64, f64) -> [f64; 3]);

/// A tube or several.
fn tubes(parts: &[Tube<'_>]) -> (Mesh, Frame) {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for &(columns, rows, at) in parts {
        let first = u32::try_from(positions.len()).unwrap();
        faces.extend(tube_faces(columns, rows).into_iter().map(|face| face.map(|corner| corner + first)));
        for row in 0..=rows {
            for column in 0..columns {
                positions.push(at(f64::from(column) / f64::from(columns) * TAU, f64::from(row) / f64::from(rows)));
            }
        }
    }
    let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() }).unwrap();
    let frame = Frame::new(&mesh, &positions).unwrap();
    (mesh, frame)
}

/// The place in the cross-section at which a column stands: more of them in the one lobe than in the other.
fn around(angle: f64) -> f64 {
    angle + 0.05 + 0.4 * angle.cos()
}

/// A tube whose cross-section is an eight, with hems that don't meet at the crossing: one BI/BI pair from hem to hem.
fn eight() -> (Mesh, Frame) {
    tubes(&[(40, 12, &|angle, height| {
        let s = around(angle);
        [s.sin(), 0.3 * (2.0 * s).sin(), height + 0.02 * s.cos() + 0.003 * (3.0 * s).sin()]
    })])
}

/// A straight tube in a cone that crosses it all round at the height `crossing`, with `rows` of its own.
fn tube_in_cone(crossing: f64, rows: u32) -> (Mesh, Frame, Analysis) {
    let tube = |angle: f64, height: f64| [0.5 * angle.cos(), 0.5 * angle.sin(), height];
    let cone = move |angle: f64, height: f64| {
        let (angle, height) = (angle + 0.05, 0.013 + 0.98 * height);
        let radius = 0.5 + 0.4 * (height - crossing) + 0.01 * angle.sin();
        [radius * angle.cos(), radius * angle.sin(), height]
    };
    let (mesh, frame) = tubes(&[(24, 10, &tube), (26, rows, &cone)]);
    // Both sheets are to say the same of which side is inside.
    let settings = Settings { inside: InsideChoice::Work, ..Settings::default() };
    let mut analyser = Analyser::default();
    let analysis = analyser.analyse(&mesh, &frame, &settings, &mut ()).clone();
    assert_eq!(analysis.paths.pairs.len(), 1);
    assert_eq!(analysis.paths.pairs[0].pair_type, PairType::Closed);
    (mesh, frame, analysis)
}

#[test]
fn targets_of_pair_from_hem_to_hem_lie_in_the_joint_inside() {
    let (mesh, frame) = eight();
    let analysis = analyse(&mesh, &frame);
    let pairs: Vec<_> = analysis.paths.pairs.iter().map(|pair| pair.pair_type).collect();
    assert_eq!(pairs, [PairType::BoundaryInside]);
    let regions = &analysis.regions;
    assert!(
        regions.by_copy.iter().all(|region| region.as_ref().is_some_and(|region| region.partitioning && region.joint))
    );
    let inside = regions.vertices_of(0);
    assert!(inside.len() > 100 && inside.len() < mesh.num_vertices() / 2, "{}", inside.len());
    assert!(regions.vertices_of(1).is_empty());
    let mut correspondent = Correspondent::default();
    let found = correspondent.find(&mesh, &frame, &analysis, &Settings::default(), &mut ());
    assert_eq!(found.paths.len(), 1);
    assert_eq!(found.attractions.len(), inside.len());
    // The other layer of the same lobe, at the same height, up to where the hems differ.
    let mut errors: Vec<f64> = found
        .attractions
        .iter()
        .map(|attraction| {
            let (from, to) = (attraction.source.position(&frame), attraction.target.position(&frame));
            (to.x - from.x).hypot(to.y + from.y)
        })
        .collect();
    errors.sort_unstable_by(f64::total_cmp);
    let (median, edge) = (errors[errors.len() / 2], found.paths[0].edge_length_m);
    println!("median {median:.3} m, edges of {edge:.3} m");
    assert!(median < 0.5 * edge, "{median} of {edge}");
}

#[test]
fn inside_by_work_of_two_tubes_lies_on_the_same_side_of_both() {
    // The smaller side of the tube is the lower one for a crossing below the middle; that of the cone by its own rows.
    for crossing in [0.41, 0.59] {
        for rows in [8, 14] {
            let (_, frame, analysis) = tube_in_cone(crossing, rows);
            let below = [0, 1].map(|copy| {
                let inside = analysis.regions.vertices_of(copy);
                assert!(!inside.is_empty());
                // The path itself goes up and down by 0.025.
                let beyond =
                    |sign: f64| inside.iter().any(|&vertex| sign * (frame.position(vertex).z - crossing) > 0.05);
                assert_ne!(beyond(-1.0), beyond(1.0), "one side of the path");
                beyond(-1.0)
            });
            assert_eq!(below[0], below[1]);
        }
    }
}

#[test]
fn forces_on_tube_in_cone_run_along_the_axis() {
    let (mesh, frame, analysis) = tube_in_cone(0.41, 9);
    let settings = Settings::default();
    let mut responder = Responder::default();
    let forces = responder.respond(&mesh, &frame, &analysis, &settings, &mut ()).forces.clone();
    let found = responder.correspondences();
    assert!(found.paths.len() == 2 && found.paths.iter().all(|path| path.round && path.own_chart.cut));
    let tube = 24 * 11;
    let along: f64 = forces[..tube].iter().map(|force| force.z).sum();
    let across: f64 = forces[..tube].iter().map(|force| force.x.hypot(force.y)).sum();
    assert!(along.abs() > 0.1 && across < 0.5 * along.abs(), "{along} along, {across} across");
    assert!(responder.corrections().net_force.norm() < 1e-12);
}
