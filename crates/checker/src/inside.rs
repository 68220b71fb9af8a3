//! Which points a body has inside, by a winding number of its own.
//!
//! A vertical ray from the point is crossed by the triangles above it. Each counts 1 where its upper side is its front,
//! else -1, and for closed pieces the sum is the winding number, exactly: more than none is inside. Whether a triangle
//! is crossed is decided edge by edge, so that a ray through an edge or a corner crosses one of the triangles there.
//! Pieces with a boundary are no such surface: there the solid angles of all triangles are summed, and more than half a
//! sphere is inside.

use std::{collections::HashMap, f64::consts::TAU};

use crate::{
    CheckError,
    primitive::{Point, Sign, orient2d, orient3d},
    tree::Extent,
    validate,
};

/// Those of some vertices that are inside of a body, in their order. A vertex on the surface of a closed piece is
/// outside of it. Faces of a closed piece that point inwards, by the sign of its volume, are turned round.
///
/// Cost: O(n log n) in the triangles, and for each vertex within the box round them the triangles above and below it;
/// all triangles, if there are pieces with a boundary.
///
/// # Errors
/// [`CheckError`], naming the vertex or triangle at fault.
pub fn vertices_inside(
    positions: &[Point],
    vertices: impl IntoIterator<Item = u32>,
    body: &[[u32; 3]],
) -> Result<Vec<u32>, CheckError> {
    validate(positions, body)?;
    let Pieces { closed, open } = Pieces::of(positions, body);
    let columns = Columns::new(&closed);
    let all = Extent::of(closed.iter().chain(&open).flatten().copied());
    let is_inside = |vertex: &u32| {
        let at = positions[*vertex as usize];
        if !all.overlaps(&Extent { low: at, high: at }) {
            return false;
        }
        let angles: f64 = open.iter().map(|triangle| part_of_sphere(*triangle, at)).sum();
        // What rounding leaves of a half is none.
        f64::from(columns.winding_number(at)) + angles > 0.5 + 1e-9
    };
    Ok(vertices.into_iter().filter(is_inside).collect())
}

/// Triangles of closed pieces, pointing outwards, and those of the others.
struct Pieces {
    closed: Vec<[Point; 3]>,
    open: Vec<[Point; 3]>,
}

impl Pieces {
    /// Vertices in one place are one: files split them where texture coordinates differ.
    fn of(positions: &[Point], body: &[[u32; 3]]) -> Self {
        let mut names: HashMap<[u64; 3], u32> = HashMap::new();
        let mut name = |vertex: u32| {
            let place = positions[vertex as usize].map(|value| (value + 0.0).to_bits());
            *names.entry(place).or_insert(vertex)
        };
        let faces: Vec<[u32; 3]> = body.iter().map(|corners| corners.map(&mut name)).collect();
        let is_face = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        let mut edges: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        for (face, &[a, b, c]) in faces.iter().enumerate().filter(|(_, face)| is_face(face)) {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                edges.entry([a.min(b), a.max(b)]).or_default().push(face);
            }
        }
        let mut parents: Vec<usize> = (0..faces.len()).collect();
        for around in edges.values() {
            for pair in around.windows(2) {
                let [a, b] = [root(&mut parents, pair[0]), root(&mut parents, pair[1])];
                parents[a.max(b)] = a.min(b);
            }
        }
        let mut is_open = vec![false; faces.len()];
        for around in edges.values().filter(|around| around.len() == 1) {
            is_open[root(&mut parents, around[0])] = true;
        }
        let place = |face: usize| faces[face].map(|vertex| positions[vertex as usize]);
        let mut volumes = vec![0.0; faces.len()];
        for face in 0..faces.len() {
            let piece = root(&mut parents, face);
            let origin = place(piece)[0];
            let [a, b, c] = place(face).map(|point| sub(point, origin));
            volumes[piece] += dot(a, cross(b, c));
        }
        let mut pieces = Self { closed: Vec::new(), open: Vec::new() };
        for face in (0..faces.len()).filter(|&face| is_face(&faces[face])) {
            let (piece, [a, b, c]) = (root(&mut parents, face), place(face));
            if is_open[piece] {
                pieces.open.push([a, b, c]);
            } else {
                pieces.closed.push(if volumes[piece] < 0.0 { [a, c, b] } else { [a, b, c] });
            }
        }
        pieces
    }
}

fn root(parents: &mut [usize], mut face: usize) -> usize {
    while parents[face] != face {
        parents[face] = parents[parents[face]];
        face = parents[face];
    }
    face
}

/// Triangles by the columns of a grid, seen from above.
struct Columns<'a> {
    triangles: &'a [[Point; 3]],
    low: [f64; 2],
    /// Columns to a metre, along both axes.
    density: [f64; 2],
    size: usize,
    cells: Vec<Vec<u32>>,
}

impl<'a> Columns<'a> {
    fn new(triangles: &'a [[Point; 3]]) -> Self {
        let Extent { low, high } = Extent::of(triangles.iter().flatten().copied());
        let size = triangles.len().isqrt().clamp(1, 512);
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let density = [0, 1].map(|axis| {
            let extent = high[axis] - low[axis];
            if extent > 0.0 { size as f64 / extent } else { 0.0 }
        });
        let low = [low[0], low[1]];
        let mut columns = Self { triangles, low, density, size, cells: vec![Vec::new(); size * size] };
        for (index, triangle) in (0..).zip(triangles) {
            let Extent { low, high } = Extent::of(*triangle);
            let [first, last] = [low, high].map(|point| columns.cell(point));
            for row in first[1]..=last[1] {
                for column in first[0]..=last[0] {
                    columns.cells[row * size + column].push(index);
                }
            }
        }
        columns
    }

    /// The cell of a point; monotone, so that a point in a triangle's box is in one of its cells.
    fn cell(&self, at: Point) -> [usize; 2] {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the conversion saturates")]
        [0, 1].map(|axis| (((at[axis] - self.low[axis]) * self.density[axis]) as usize).min(self.size - 1))
    }

    /// How often all triangles wind around a point; those that it lies on do not.
    fn winding_number(&self, at: Point) -> i32 {
        if self.triangles.is_empty() {
            return 0;
        }
        let [column, row] = self.cell(at);
        let mut sum = 0;
        for &index in &self.cells[row * self.size + column] {
            let [a, b, c] = self.triangles[index as usize];
            let turn = turns(a, b, at) + turns(b, c, at) + turns(c, a, at);
            if turn == 0 {
                continue;
            }
            // The fourth point is below a triangle that runs counter-clockwise from above where the sign is positive.
            match orient3d(a, b, c, at) {
                // On the surface is on its outer side: above where the front is, else below.
                Sign::Zero => sum += turn.min(0),
                sign if (sign == Sign::Positive) == (turn > 0) => sum += turn,
                _ => {}
            }
        }
        sum
    }
}

/// Whether an edge crosses the ray from a point along the first axis, seen from above: 1 from below to above it.
fn turns(a: Point, b: Point, at: Point) -> i32 {
    let flat = |point: Point| [point[0], point[1]];
    let [first, second] = [a[1] > at[1], b[1] > at[1]];
    if first == second {
        return 0;
    }
    // From the lower end to the higher one, so that both triangles at an edge decide alike.
    let (low, high, sign) = if second { (a, b, 1) } else { (b, a, -1) };
    if orient2d(flat(low), flat(high), flat(at)) == Sign::Positive { sign } else { 0 }
}

/// The part of a whole sphere that a triangle covers (Van Oosterom and Strackee 1983).
fn part_of_sphere(triangle: [Point; 3], at: Point) -> f64 {
    let [a, b, c] = triangle.map(|corner| sub(corner, at));
    let [p, q, r] = [a, b, c].map(|side| dot(side, side).sqrt());
    let volume = dot(a, cross(b, c));
    if volume.abs() <= 0.0 {
        return 0.0;
    }
    2.0 * volume.atan2(p * q * r + dot(a, b) * r + dot(b, c) * p + dot(c, a) * q) / (2.0 * TAU)
}

fn sub(a: Point, b: Point) -> Point {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
