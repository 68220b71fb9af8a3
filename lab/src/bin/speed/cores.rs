//! One thread against two, by the clock on the wall.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use untangle::{frame::Frame, mesh::Mesh, settings::Settings, untangler::Untangler};
use untangled_lab::{
    Failure,
    clock::milliseconds,
    states::{bent, later},
    table::{print_header, print_text},
};
use untangled_testkit::generate::crumpled;

pub(crate) fn table(resolutions: &[u32]) -> Result<(), Failure> {
    println!("\n## Two threads, and frames in a second\n");
    print_text(
        "Whole frames of an untangled sheet by the clock on the wall, which says little where others use the \
         processors: `cold`, and `coherent` as above. The last column is for two threads.\n",
    );
    print_header(&[
        "triangles",
        "cold, one ms",
        "cold, two ms",
        "one / two",
        "coherent, one ms",
        "coherent, two ms",
        "frames in a second",
    ]);
    for resolution in resolutions.iter().copied().filter(|&resolution| resolution >= 125) {
        // A million triangles instead of two.
        row(if resolution == 1000 { 707 } else { resolution })?;
    }
    Ok(())
}

fn row(resolution: u32) -> Result<(), Failure> {
    let sheet = crumpled(11, resolution);
    let positions = bent(&sheet);
    let mesh = Arc::new(sheet.mesh());
    let [first, twice] = [1.0, 2.0]
        .map(|size| Frame::new(&mesh, &positions.iter().map(|point| point.map(|x| size * x)).collect::<Vec<_>>()));
    let frames = [first?, twice?];
    let slow: Result<Vec<Frame>, _> =
        (0..10).map(|number| Frame::new(&mesh, &later(&sheet, &positions, resolution, number))).collect();
    let slow = slow?;
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build());
    let mut best = [[Duration::MAX; 2]; 2];
    for _ in 0..4 {
        for (pool, best) in pools.iter().zip(&mut best) {
            let pool = pool.as_ref().map_err(ToString::to_string)?;
            let times = pool.install(|| frame_times(&mesh, &frames, &slow))?;
            *best = [best[0].min(times[0]), best[1].min(times[1])];
        }
    }
    let [[cold_one, slow_one], [cold_two, slow_two]] = best.map(|times| times.map(milliseconds));
    println!(
        "| {} | {cold_one:.2} | {cold_two:.2} | {:.2} | {slow_one:.2} | {slow_two:.2} | {:.0} |",
        mesh.num_faces(),
        cold_one / cold_two,
        1e3 / slow_two,
    );
    Ok(())
}

/// Least times of a frame after one that is far away, and of one after others that are near.
fn frame_times(mesh: &Arc<Mesh>, frames: &[Frame; 2], slow: &[Frame]) -> Result<[Duration; 2], Failure> {
    let mut untangler = Untangler::new(mesh.clone(), Settings::default())?;
    let mut time = |frame: &Frame| {
        let start = Instant::now();
        untangler.process(frame, &mut ());
        start.elapsed()
    };
    let cold = frames.iter().chain(frames).map(&mut time).fold(Duration::MAX, Duration::min);
    let times: Vec<Duration> = slow.iter().map(time).collect();
    Ok([cold, times[3..].iter().copied().fold(Duration::MAX, Duration::min)])
}
