//! Frames to exchange, and what is said of their times.

use untangled_client::Registration;

/// A sheet in slight waves of some `num_vertices` vertices, without any contact, and its positions.
pub(crate) fn sheet(num_vertices: usize) -> (Registration, Vec<[f32; 3]>) {
    let side = num_vertices.isqrt();
    let at = |k: usize| {
        let [x, y] = [(k % side) as f32 * 0.01, (k / side) as f32 * 0.01];
        [x, y, 0.05 * (2.0 * x).sin() * (3.0 * y).cos()]
    };
    let positions: Vec<[f32; 3]> = (0..side * side).map(at).collect();
    let squares = (0..(side - 1) * (side - 1)).map(|k| (k / (side - 1) * side + k % (side - 1)) as u32);
    let triangles = squares.flat_map(|a| {
        let c = a + side as u32;
        [[a, a + 1, c], [c, a + 1, c + 1]]
    });
    let registration =
        Registration { num_vertices: side * side, triangles: triangles.collect(), ..Registration::default() };
    (registration, positions)
}

/// The value below which a part of them lies.
pub(crate) fn median(mut times: Vec<f64>, part: f64) -> f64 {
    times.sort_by(f64::total_cmp);
    times[((times.len() - 1) as f64 * part) as usize]
}
