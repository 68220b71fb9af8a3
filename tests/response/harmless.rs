//! No displacement that goes out makes a state worse, and the preset `accurate` ends at least as well as the others.

use std::sync::Arc;

use nalgebra::{Vector3, distance};
use untangle::{
    analysis::analyse,
    frame::Frame,
    intersect::{Segment, SegmentEnd},
    mesh::{FaceId, Mesh, MeshDescription},
    respond::{Corrections, VertexFlags},
    settings::{Quality, Response, Settings},
    stage::{Stage, StageObserver},
    untangler::Untangler,
};
use untangled_checker::count_edge_face;
use untangled_publisher::{
    mesh::{Cloth, Vec3},
    scenes::Scene,
    solver::{Help, Parameters, Solver},
};
use untangled_testkit::generate::{
    Sheet, crumpled_further,
    furrows::{Furrows, folded},
};

const DT_S: f64 = 1.0 / 60.0;
const MOST_STEPS: usize = 24;
/// A run is over when it stays clean for so many steps.
const HELD: usize = 3;

fn of_sheet(sheet: &Sheet) -> Cloth {
    Cloth {
        positions: sheet.positions.iter().map(|&point| point.into()).collect(),
        rest_positions: sheet.uvs.iter().map(|&[u, v]| Vec3::new(u, v, 0.0)).collect(),
        triangles: sheet.faces.clone(),
        flat_hinges: true,
        ..Cloth::default()
    }
}

/// Tangles of all types, alone and many together.
fn cloths() -> Vec<(String, Cloth)> {
    let names = ["bag", "tongue", "curtains", "crease", "twist", "drop", "wedge", "gallery"];
    let build = |name: &str| (name.to_owned(), name.parse::<Scene>().unwrap().build(1, 0.04));
    let mut cloths: Vec<_> = names.into_iter().map(build).collect();
    let furrows = Furrows { rows: 2, columns: 3, along: 2.4, across: 1.5 };
    cloths.push(("folded".into(), of_sheet(&folded(1, 20, furrows))));
    cloths.push(("crumpled".into(), of_sheet(&crumpled_further(1, 20, 1.5, 2))));
    cloths
}

fn mesh_of(solver: &Solver) -> Arc<Mesh> {
    let cloth = solver.cloth();
    let description = MeshDescription {
        num_vertices: cloth.positions.len(),
        faces: cloth.triangles.clone(),
        rest_positions: Some(cloth.rest_positions.iter().map(|&position| position.into()).collect()),
        masses_kg: Some(solver.masses_kg().to_vec()),
        pins: cloth.pins.clone(),
        ..MeshDescription::default()
    };
    Arc::new(Mesh::new(description).unwrap())
}

/// Edge-face intersections, and twice the length of all segments in edges of their faces.
fn merit(mesh: &Mesh, positions: &[[f64; 3]]) -> f64 {
    let frame = Frame::new(mesh, positions).unwrap();
    let found = analyse(mesh, &frame).intersections;
    let end = |end: SegmentEnd| match end {
        SegmentEnd::EdgeFace(index) => found.edge_face[index as usize].position,
        SegmentEnd::LoopVertex(vertex) => frame.position(vertex),
    };
    let edge = |face: FaceId| {
        let [a, b, c] = mesh.face(face).map(|vertex| frame.position(vertex));
        (distance(&a, &b) + distance(&b, &c) + distance(&c, &a)) / 3.0
    };
    let length = |segment: &Segment| {
        let [a, b] = segment.ends.map(end);
        let edges = segment.faces.map(edge);
        2.0 * distance(&a, &b) / (edges[0] + edges[1])
    };
    let count = f64::from(u32::try_from(found.edge_face.len()).unwrap());
    count + 2.0 * found.segments.iter().map(length).sum::<f64>()
}

/// The displacement of each vertex as it is sent, in single precision.
fn sent(corrections: &Corrections, masses_kg: &[f64]) -> Vec<Vec3> {
    #[expect(clippy::cast_possible_truncation, reason = "as on the wire")]
    let round = |value: f64| f64::from(value as f32);
    corrections.forces.iter().zip(masses_kg).map(|(force, mass)| (force * mass.recip()).map(round)).collect()
}

fn is_masked(flags: &VertexFlags) -> bool {
    flags.contains(VertexFlags::INSIDE) || flags.contains(VertexFlags::NEAR_PATH)
}

/// How a run in the example host ended.
#[derive(Debug)]
struct Run {
    /// Edge-face intersections by the exact check.
    before: usize,
    after: usize,
    /// The most by which a displacement raised the merit of a state.
    most_harm: f64,
}

/// Simulates a tangle with corrections and mask, until it stays clean or the steps are over.
fn run(cloth: &Cloth, settings: &Settings, gravity_m_s2: f64) -> Run {
    let parameters = Parameters::of_cloth(cloth, gravity_m_s2);
    let mut solver = Solver::new(cloth.clone(), parameters);
    let is_displacement = matches!(settings.response, Response::Displacement | Response::Coupled);
    let mut untangler = Untangler::new(mesh_of(&solver), settings.clone()).unwrap();
    let mut run = Run { before: 0, after: 0, most_harm: f64::NEG_INFINITY };
    let mut clean_steps = 0;
    for step in 0..=MOST_STEPS {
        let points = solver.cloth().points();
        run.after = count_edge_face(&points, &solver.cloth().triangles).unwrap();
        run.before = if step == 0 { run.after } else { run.before };
        clean_steps = if run.after == 0 { clean_steps + 1 } else { 0 };
        if clean_steps > HELD {
            break;
        }
        let frame = Frame::new(untangler.mesh(), &points).unwrap();
        let mesh = Arc::clone(untangler.mesh());
        let corrections = untangler.process(&frame, &mut ()).corrections;
        let steps = sent(corrections, solver.masses_kg());
        let no_contact: Vec<bool> = corrections.flags.iter().map(is_masked).collect();
        if is_displacement {
            let moved: Vec<[f64; 3]> =
                points.iter().zip(&steps).map(|(&point, step)| (Vector3::from(point) + step).into()).collect();
            run.most_harm = run.most_harm.max(merit(&mesh, &moved) - merit(&mesh, &points));
            solver.step(DT_S, Help { displacement_m: &steps, no_contact: &no_contact, ..Help::NONE });
        } else {
            let changes: Vec<Vec3> = steps.iter().map(|step| step / DT_S).collect();
            solver.step(DT_S, Help { velocity_change_m_s: &changes, no_contact: &no_contact, ..Help::NONE });
        }
    }
    run
}

fn preset(quality: Quality) -> Settings {
    let mut settings = Settings::default();
    quality.apply(&mut settings);
    settings
}

#[test]
fn displacements_of_every_frame_leave_no_state_more_tangled() {
    for (name, cloth) in cloths() {
        for response in [Response::Displacement, Response::Coupled] {
            let run = run(&cloth, &Settings { response, ..Settings::default() }, 0.0);
            println!("{name}, {response:?}: {run:?}");
            assert!(run.before > 0, "{name} is no tangle");
            assert!(run.most_harm <= 0.0, "{name}, {response:?}: {run:?}");
        }
    }
}

#[test]
fn displacements_under_gravity_end_no_worse_than_they_began() {
    for (name, cloth) in cloths() {
        for response in [Response::Displacement, Response::Coupled] {
            let run = run(&cloth, &Settings { response, ..Settings::default() }, 9.81);
            println!("{name}, {response:?}: {run:?}");
            assert!(run.after <= run.before, "{name}, {response:?}: {run:?}");
        }
    }
}

#[test]
fn accurate_on_every_scene_ends_at_least_as_well_as_the_others() {
    for (name, cloth) in cloths() {
        let [fast, balanced, accurate] =
            [Quality::Fast, Quality::Balanced, Quality::Accurate].map(|quality| run(&cloth, &preset(quality), 0.0));
        let displacement = run(&cloth, &Settings { response: Response::Displacement, ..Settings::default() }, 0.0);
        println!("{name}: fast {fast:?}, balanced {balanced:?}, displacement {displacement:?}, accurate {accurate:?}");
        let least = fast.after.min(balanced.after).min(displacement.after);
        assert!(accurate.after <= least, "{name}: {accurate:?}");
    }
}

/// How many vertices a displacement moves, masks and labels, and the intersections that it leaves.
fn displaced(cloth: &Cloth, response: Response, is_displaced: bool) -> ([usize; 3], usize) {
    let solver = Solver::new(cloth.clone(), Parameters::of_cloth(cloth, 0.0));
    let settings = Settings { response, ..Settings::default() };
    let mut untangler = Untangler::new(mesh_of(&solver), settings).unwrap();
    untangler.set_labelled(true);
    untangler.set_displaced(is_displaced);
    let points = solver.cloth().points();
    let frame = Frame::new(untangler.mesh(), &points).unwrap();
    let corrections = untangler.process(&frame, &mut ()).corrections;
    let steps = sent(corrections, solver.masses_kg());
    let moved: Vec<[f64; 3]> = points.iter().zip(&steps).map(|(&at, step)| (Vector3::from(at) + step).into()).collect();
    let num_moved = steps.iter().filter(|step| step.norm() > 0.0).count();
    let num_masked = corrections.flags.iter().filter(|flags| is_masked(flags)).count();
    let left = count_edge_face(&moved, &solver.cloth().triangles).unwrap();
    ([num_moved, num_masked, corrections.labels.len()], left)
}

#[test]
fn displacement_that_leaves_nothing_tangled_leaves_contact_on_where_the_host_adds_it() {
    let mut num_cleared = 0;
    for (name, cloth) in cloths() {
        for response in [Response::Displacement, Response::Coupled] {
            let ([moved, masked, labelled], left) = displaced(&cloth, response, true);
            println!("{name}, {response:?}: {moved} moved, {masked} masked, {labelled} labels, {left} left");
            assert_eq!(left > 0 && moved > 0, masked > 0, "{name}, {response:?}");
            assert_eq!(left > 0 && moved > 0, labelled > 0, "{name}, {response:?}");
            num_cleared += usize::from(left == 0);
            // As velocities or forces it leads there only in time.
            let ([same, masked, labelled], _) = displaced(&cloth, response, false);
            assert!(same == moved && masked > 0 && labelled > 0, "{name}, {response:?}");
        }
    }
    assert!(num_cleared >= 5, "{num_cleared}");
}

/// With contact off and nothing that moves it back, cloth falls farther through what it is tangled with.
#[test]
fn displacement_that_moves_nothing_leaves_contact_on_where_the_host_adds_it() {
    let cloth = "twist".parse::<Scene>().unwrap().build(1, 0.0125);
    let ([moved, masked, labelled], left) = displaced(&cloth, Response::Displacement, true);
    assert!(moved == 0 && left > 0, "{moved} moved, {left} left");
    assert_eq!([masked, labelled], [0, 0]);
}

/// Time for so many questions.
struct Questions(usize);

impl StageObserver for Questions {
    fn begin(&mut self, _: Stage) {}
    fn end(&mut self) {}
    fn is_spent(&mut self) -> bool {
        let spent = self.0 == 0;
        self.0 = self.0.saturating_sub(1);
        spent
    }
}

/// The values of a frame with time for so many questions.
fn answer(cloth: &Cloth, response: Response, questions: usize) -> Vec<Vector3<f64>> {
    let solver = Solver::new(cloth.clone(), Parameters::of_cloth(cloth, 0.0));
    let settings = Settings { response, ..Settings::default() };
    let mut untangler = Untangler::new(mesh_of(&solver), settings).unwrap();
    let frame = Frame::new(untangler.mesh(), &solver.cloth().points()).unwrap();
    untangler.process(&frame, &mut Questions(questions)).corrections.forces.clone()
}

#[test]
fn displacement_without_time_to_judge_it_is_that_of_the_forces() {
    let cloth = "twist".parse::<Scene>().unwrap().build(1, 0.04);
    let moves = |values: &[Vector3<f64>]| values.iter().any(|value| value.norm() > 0.0);
    // Time for the pairs of paths, and none after that.
    let questions = (0..40).find(|&questions| moves(&answer(&cloth, Response::Rbf, questions))).unwrap();
    let forces = answer(&cloth, Response::Rbf, questions);
    for response in [Response::Displacement, Response::Coupled] {
        assert!(answer(&cloth, response, questions) == forces, "{response:?}");
        assert!(answer(&cloth, response, usize::MAX) != forces, "{response:?}");
    }
}
