//! One exchange from a tangled cloth to one that is certified clean, through the daemon.
//!
//! ```sh
//! untangled serve &
//! cargo run --release --example repair_frame
//! ```
//!
//! The first half waits for the repair. The second half goes on meanwhile, as a simulator with a frame rate would.

use std::{error::Error, time::Duration};

use untangled_client::{Client, ClientOptions, Registration, Session, StepTime};

const STEP: StepTime = StepTime { simulated_s: 0.0, dt_s: 1.0 / 60.0 };

fn main() -> Result<(), Box<dyn Error>> {
    let (tangled, triangles) = scene();
    let client = Client::connect(ClientOptions::default())?;
    let num_vertices = tangled.len();
    let mut session = client.register(Registration { num_vertices, triangles, repairs: true, ..Default::default() })?;

    let mut cloth = tangled.clone();
    let repair = session.repair(STEP, Duration::from_secs(60), |shared| shared.copy_from_slice(&cloth))?;
    print(&format!("certified: {}, {} vertices moved", repair.is_certified(), repair.header().num_moved));
    add(&mut cloth, repair.displacements_f32().unwrap_or_default());
    // A session lends one repair at a time.
    drop(repair);
    print(&format!("{} edges pierce a face", intersections(&mut session, &cloth)?));

    cloth.clone_from(&tangled);
    session.ask_for_repair(None);
    for step in 0..100_000 {
        let left = intersections(&mut session, &cloth)?;
        if left == 0 {
            print(&format!("clean in step {step}"));
            return Ok(());
        }
        if let Some(repair) = session.poll_repair()? {
            // Of an earlier frame: its displacements are added to the positions of now.
            add(&mut cloth, repair.displacements_f32().unwrap_or_default());
        }
    }
    Err("still tangled".into())
}

fn intersections(session: &mut Session, cloth: &[[f32; 3]]) -> Result<u64, Box<dyn Error>> {
    let deadline = session.default_deadline();
    let correction = session.exchange(STEP, deadline, |shared| shared.copy_from_slice(cloth))?;
    // A real host uses value and mask while it waits: see `host.rs`.
    Ok(correction.header().num_edge_face_intersections)
}

/// In single precision, as the cloth was sent: then these are the bits that were checked.
fn add(cloth: &mut [[f32; 3]], displacements: &[[f32; 3]]) {
    for (value, step) in cloth.as_flattened_mut().iter_mut().zip(displacements.as_flattened()) {
        *value += step;
    }
}

/// A level sheet, and one that stands and has its lower rows through it.
fn scene() -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
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
    (positions, triangles)
}

#[expect(clippy::print_stdout, reason = "an example prints what it does")]
fn print(line: &str) {
    println!("{line}");
}
