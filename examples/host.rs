//! A simulator's side of the daemon: connect, register, and exchange each step's positions for corrections.
//!
//! ```sh
//! cargo run --release -- serve &
//! cargo run --release --example host
//! ```
//!
//! `clients/publisher/src/host.rs` does the same for a whole cloth simulator.

use std::{error::Error, time::Duration};

use untangled_client::{Client, ClientOptions, ExchangeError, Registration, StepTime, flags};

fn main() -> Result<(), Box<dyn Error>> {
    let (triangles, mut cloth) = crossed_sheets();
    let client = Client::connect(ClientOptions::default())?;
    // What doesn't change from step to step. By default, corrections are displacements in metres.
    let mut session =
        client.register(Registration { num_vertices: cloth.len(), triangles, ..Registration::default() })?;

    for step in 0..500 {
        let time = StepTime { simulated_s: f64::from(step) / 60.0, dt_s: 1.0 / 60.0 };
        let correction =
            match session.exchange(time, Duration::from_millis(50), |shared| shared.copy_from_slice(&cloth)) {
                Ok(correction) => correction,
                // Late, or the daemon restarts: this step goes without corrections, and the next one asks again.
                Err(ExchangeError::Publish(_) | ExchangeError::Wait(_)) => continue,
            };
        let num_pierced = correction.header().num_edge_face_intersections;
        let num_masked = correction.vertices().iter().filter(|vertex| vertex.flags & flags::MASK != 0).count();
        print(&format!("step {step}: {num_pierced} edges pierce a face; no self-collision at {num_masked} vertices"));
        if num_pierced == 0 {
            return Ok(());
        }
        // A solver steps here. Where the mask is set it leaves out self-collisions, which would hold the tangle
        // together.
        for (position, vertex) in cloth.iter_mut().zip(correction.vertices()) {
            for (coordinate, part) in position.iter_mut().zip(vertex.value) {
                *coordinate += part;
            }
        }
    }
    Err("still tangled".into())
}

/// Triangles and positions in metres of a level sheet, and of an upright one whose lower rows are through it.
fn crossed_sheets() -> (Vec<[u32; 3]>, Vec<[f32; 3]>) {
    let (mut triangles, mut positions) = (Vec::new(), Vec::new());
    for sheet in 0..2 {
        for k in 0..400u16 {
            let (u, v) = (0.02 * f32::from(k / 20), 0.02 * f32::from(k % 20));
            positions.push(if sheet == 0 { [u, v, 0.01 * (9.0 * u).sin()] } else { [u, 0.193 + 0.1 * u, v - 0.051] });
            if k / 20 < 19 && k % 20 < 19 {
                let a = 400 * sheet + u32::from(k);
                triangles.extend([[a, a + 20, a + 21], [a, a + 21, a + 1]]);
            }
        }
    }
    (triangles, positions)
}

#[expect(clippy::print_stdout, reason = "an example prints what it does")]
fn print(line: &str) {
    println!("{line}");
}
