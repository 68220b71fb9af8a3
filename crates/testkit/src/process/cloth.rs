//! A flat sheet to register and to send.

use untangled_client::{Registration, StepTime};

/// The step of every frame.
pub const STEP: StepTime = StepTime { simulated_s: 0.0, dt_s: 0.01 };

/// A flat sheet of `n x n` squares with masses.
pub fn sheet(n: u32) -> Registration {
    let side = n + 1;
    let corner = |i: u32, j: u32| i * side + j;
    let square = |i, j| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let num_vertices = (side * side) as usize;
    Registration {
        num_vertices,
        triangles: (0..n).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect(),
        masses_kg: Some(vec![0.01; num_vertices]),
        ..Registration::default()
    }
}

/// Writes the positions of a flat sheet of `(n + 1)^2` vertices.
pub fn fill_flat<T: From<f32> + Copy>(positions: &mut [[T; 3]]) {
    let side = positions.len().isqrt();
    for (k, position) in positions.iter_mut().enumerate() {
        let coordinate = |k: usize| T::from(u16::try_from(k).map(f32::from).unwrap() * 0.01);
        *position = [coordinate(k / side), coordinate(k % side), T::from(0.0)];
    }
}
