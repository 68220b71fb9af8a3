//! A simulated fall as a sequence, where its file is.

use std::time::Duration;

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, MeshDescription},
};
use untangled_lab::{
    Failure,
    clock::{milliseconds, timed},
    table::{print_header, print_text},
};
use untangled_testkit::files::{npz::Sequence, shared};

/// Steps from one frame of the file to the next, and how many frames of the file are gone through.
const PACES: [(usize, usize); 4] = [(1, 30), (16, 6), (128, 1), (512, 1)];

pub(crate) fn table() -> Result<(), Failure> {
    println!("\n## A simulated fall\n");
    let Some(file) = shared("data/sheet31k_fall30.npz") else {
        println!("Left out: there is no ../shared/data/sheet31k_fall30.npz beside the checkout.");
        return Ok(());
    };
    let Sequence { frames, faces } = Sequence::read(&file)?;
    print_text(
        "The frames of `sheet31k_fall30.npz`, a sheet that falls onto itself, in so many steps from one to the next, \
         in a straight line: total of the search on one thread, each frame by a cold search, and frame after frame. In \
         the file itself some vertices move by three to five edges from frame to frame: nothing is kept where it is \
         more than a sixty-fourth of one.\n",
    );
    print_header(&["steps", "frames", "pairs", "cold ms", "in sequence ms", "cold / in sequence"]);
    let mesh = Mesh::new(MeshDescription { num_vertices: frames[0].len(), faces, ..MeshDescription::default() })?;
    for (steps, num_frames) in PACES {
        row(&mesh, &frames, steps, num_frames)?;
    }
    Ok(())
}

fn row(mesh: &Mesh, frames: &[Vec<[f32; 3]>], steps: usize, num_frames: usize) -> Result<(), Failure> {
    let (mut cold, mut kept) = (Intersector::default(), Intersector::default());
    let mut found = Intersections::default();
    let (mut total, mut count, mut num_pairs) = ([Duration::ZERO; 2], 0, 0);
    for pair in frames.windows(2).take(num_frames) {
        for step in 0..steps {
            let part = step as f64 / steps as f64;
            let mix = |(from, to): (&[f32; 3], &[f32; 3])| -> [f64; 3] {
                std::array::from_fn(|axis| f64::from(from[axis]) * (1.0 - part) + f64::from(to[axis]) * part)
            };
            let positions: Vec<[f64; 3]> = pair[0].iter().zip(&pair[1]).map(mix).collect();
            let frame = Frame::new(mesh, &positions)?;
            cold.clear_cache();
            let times = [
                timed(|| cold.intersect(mesh, &frame, &mut found)),
                timed(|| kept.intersect(mesh, &frame, &mut found)),
            ];
            // Both sort the faces into a tree in the first frame.
            if count > 0 {
                total = [total[0] + times[0], total[1] + times[1]];
            }
            count += 1;
            num_pairs += found.segments.len();
        }
    }
    let [cold, kept] = total.map(milliseconds);
    println!("| {steps} | {count} | {num_pairs} | {cold:.1} | {kept:.1} | {:.1} |", cold / kept);
    Ok(())
}
