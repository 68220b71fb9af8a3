//! One thread against two, by the clock on the wall.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use untangle::{frame::Frame, settings::Settings, untangler::Untangler};

use crate::{Failure, bent, header, later, milliseconds, sheet};

pub(crate) fn table(resolutions: &[u32]) -> Result<(), Failure> {
    println!("\n## Two threads, and frames in a second\n");
    println!(
        "Whole frames of an untangled sheet by the clock on the wall, which says little where others use the processors: `cold`, and `coherent` as above. The last \
         column is for two threads.\n"
    );
    header(&[
        "triangles",
        "cold, one ms",
        "cold, two ms",
        "one / two",
        "coherent, one ms",
        "coherent, two ms",
        "frames in a second",
    ]);
    for resolution in resolutions.iter().copied().filter(|&resolution| resolution >= 125).map(|resolution| {
        // A million triangles instead of two.
        if resolution == 1000 { 707 } else { resolution }
    }) {
        let sheet = sheet::crumpled(11, resolution);
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
                let mut untangler = Untangler::new(mesh.clone(), Settings::default())?;
                pool.install(|| {
                    for frame in frames.iter().chain(&frames) {
                        let start = Instant::now();
                        untangler.process(frame, &mut ());
                        best[0] = best[0].min(start.elapsed());
                    }
                    for (number, frame) in slow.iter().enumerate() {
                        let start = Instant::now();
                        untangler.process(frame, &mut ());
                        if number >= 3 {
                            best[1] = best[1].min(start.elapsed());
                        }
                    }
                });
            }
        }
        let [[cold_one, slow_one], [cold_two, slow_two]] = best.map(|times| times.map(milliseconds));
        println!(
            "| {} | {cold_one:.2} | {cold_two:.2} | {:.2} | {slow_one:.2} | {slow_two:.2} | {:.0} |",
            mesh.num_faces(),
            cold_one / cold_two,
            1e3 / slow_two,
        );
    }
    Ok(())
}
