use std::{error::Error, time::Duration};
use untangled_client::{Client, ClientOptions, CorrectionKind, ExchangeError, Registration, StepTime, flags};

fn main() -> Result<(), Box<dyn Error>> {
    // A level sheet, and one that stands and has its lower rows through it.
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
    let (mass_kg, dt_s) = (0.001f32, 1.0 / 60.0);
    let mut velocities = vec![[0.0f32; 3]; positions.len()];

    let client = Client::connect(ClientOptions::default())?;
    let mut session = client.register(Registration {
        num_vertices: positions.len(),
        triangles,
        masses_kg: Some(vec![f64::from(mass_kg); positions.len()]),
        correction: CorrectionKind::Force,
        ..Registration::default()
    })?;
    for step in 0..500 {
        let time = StepTime { simulated_s: f64::from(step) * dt_s, dt_s };
        let answer = session.exchange(time, Duration::from_secs(1), |shared| shared.copy_from_slice(&positions));
        let correction = match answer {
            Ok(correction) => correction,
            // Late, or the daemon is gone: this step goes without help, and the next one asks again.
            Err(ExchangeError::Publish(_) | ExchangeError::Wait(_)) => continue,
        };
        println!("step {step}: {} edges pierce a face", correction.header().num_edge_face_intersections);
        if correction.header().num_edge_face_intersections == 0 {
            return Ok(());
        }
        for (k, vertex) in correction.vertices().iter().enumerate() {
            let _self_collision_off = vertex.flags & flags::MASK != 0; // for your solver, in this step
            for axis in 0..3 {
                // Your solver: here forces give velocities, drag takes most of them, and positions follow.
                velocities[k][axis] = 0.5 * (velocities[k][axis] + vertex.value[axis] / mass_kg * dt_s as f32);
                positions[k][axis] += velocities[k][axis] * dt_s as f32;
            }
        }
    }
    Err("still tangled".into())
}
