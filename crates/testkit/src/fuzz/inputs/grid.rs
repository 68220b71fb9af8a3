//! Faces of a small grid.

/// Triangles of `n x n` squares over `(n + 1)^2` vertices.
pub(in crate::fuzz) fn grid(n: u32) -> Vec<[u32; 3]> {
    let squares = (0..n * n).map(move |k| k / n * (n + 1) + k % n);
    squares.flat_map(|a| [[a, a + 1, a + n + 1], [a + n + 1, a + 1, a + n + 2]]).collect()
}
