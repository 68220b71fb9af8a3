//! Frames that run out of time serve the longest paths first, and report the pairs that they leave out.

use std::sync::Arc;

use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    respond::{LeftOut, VertexFlags},
    settings::{Response, Settings},
    stage::{Stage, StageObserver},
    untangler::Untangler,
};

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

fn add_sheet(
    description: &mut MeshDescription,
    positions: &mut Vec<[f64; 3]>,
    n: u32,
    at: impl Fn(f64, f64) -> [f64; 3],
) {
    let first = u32::try_from(positions.len()).unwrap();
    for row in 0..=n {
        for column in 0..=n {
            positions.push(at(f64::from(column) / f64::from(n), f64::from(row) / f64::from(n)));
            if row < n && column < n {
                let a = first + row * (n + 1) + column;
                let c = a + n + 1;
                description.faces.extend([[a, a + 1, c], [c, a + 1, c + 1]]);
            }
        }
    }
    description.num_vertices = positions.len();
}

/// A sheet of 1 m, and three strips of 0.1, 0.3 and 0.2 m that dip through it.
fn scene() -> (Arc<Mesh>, Frame) {
    let (mut description, mut positions) = (MeshDescription::default(), Vec::new());
    add_sheet(&mut description, &mut positions, 20, |x, y| [x - 0.5, y - 0.5, 0.01 * (9.0 * x + 4.0 * y).sin()]);
    for (width, place) in [(0.1, -0.3), (0.3, 0.013), (0.2, 0.31)] {
        add_sheet(&mut description, &mut positions, 8, |x, y| {
            [width * (x - 0.51), place + 0.02 * x * x + 0.03 * y, 0.6 * y - 0.15]
        });
    }
    let mesh = Mesh::new(description).unwrap();
    let frame = Frame::new(&mesh, &positions).unwrap();
    (Arc::new(mesh), frame)
}

/// The strips with forces, the first strip as bit 1, and the pairs that were left out.
fn answer(response: Response, questions: usize) -> (u32, LeftOut, usize) {
    let (mesh, frame) = scene();
    let settings = Settings { response, ..Settings::default() };
    let mut untangler = Untangler::new(mesh, settings).unwrap();
    let outcome = untangler.process(&frame, &mut Questions(questions));
    assert_eq!(outcome.analysis.paths.pairs.len(), 3);
    let corrections = outcome.corrections;
    let mut strips = 0;
    for strip in 0..3 {
        let vertices = 441 + 81 * strip..441 + 81 * (strip + 1);
        let moved = corrections.forces[vertices.clone()].iter().any(|force| force.norm() > 0.0);
        strips |= u32::from(moved) << strip;
        let near = |flags: &VertexFlags| flags.contains(VertexFlags::NEAR_PATH);
        assert!(corrections.flags[vertices].iter().any(near), "the mask holds for paths that were left out as well");
    }
    let near = corrections.flags.iter().filter(|flags| flags.contains(VertexFlags::NEAR_PATH)).count();
    (strips, corrections.left_out, near)
}

#[test]
fn untangler_out_of_time_serves_the_longest_paths_first() {
    const ALL: usize = usize::MAX;
    let (all, nothing, near) = answer(Response::Rbf, ALL);
    assert_eq!((all, nothing), (0b111, LeftOut::default()));
    // Three questions for regions, then one for each pair's correspondence.
    for (questions, strips, num_pairs) in
        [(6, 0b111, 0), (5, 0b110, 1), (4, 0b010, 2), (3, 0b000, 3), (2, 0b000, 3), (0, 0b000, 3)]
    {
        let (moved, left_out, still_near) = answer(Response::Rbf, questions);
        assert_eq!((moved, left_out.num_pairs), (strips, num_pairs), "{questions} questions");
        assert_eq!(still_near, near);
    }
    let lengths: Vec<f64> = [5, 4, 3].map(|questions| answer(Response::Rbf, questions).1.length_m).to_vec();
    assert!(0.05 < lengths[0] && lengths[0] < 0.15, "the shortest path is as long as its strip is wide: {lengths:?}");
    assert!(lengths[0] < lengths[1] && lengths[1] < lengths[2], "{lengths:?}");
}

#[test]
fn untangler_out_of_time_leaves_out_pairs_with_every_response() {
    assert_eq!(answer(Response::Contour, 4).0, 0b010);
    assert_eq!(answer(Response::Contour, 4).1.num_pairs, 2);
    for (questions, strips) in [(6, 0b111), (5, 0b110), (4, 0b010), (3, 0b000), (0, 0b000)] {
        assert_eq!(answer(Response::Coupled, questions).0, strips, "{questions} questions");
    }
    assert_eq!(answer(Response::Mask, 2).1.num_pairs, 1);
    assert_eq!(answer(Response::Mask, 3).1.num_pairs, 0);
}
