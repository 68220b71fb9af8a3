//! Which vertices of a layer are behind one that lies further in: on the inner side of the nearest point of it.
//!
//! The side is that of the normal at the nearest point: of its triangle, the sum of those of both at an edge, and the
//! sum of all, each by its angle, at a corner, which is right for every point whose nearest point that is (Baerentzen
//! and Aanaes 2005). A point whose nearest point is on the boundary lies beyond the layer, not over it. Unlike the
//! other decisions of this crate it is one of rounded numbers: it is asked of layers that are apart.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::{CheckError, distance::Boxes, primitive::Point, tree::Extent, validate};

/// Layers lie over each other within this part of the diagonal of the box round the inner one.
const REACH: f64 = 0.1;

/// The vertices of a cloth in layers that are behind a layer further in, ascending, each once. `numbers` are the layers
/// of all vertices, the innermost the lowest, and `are_outwards` says of each triangle whether it points outwards as it
/// is given. Layers lie over each other within a tenth of the diagonal of the box round the inner one.
///
/// Cost: O(n log n) for each layer.
///
/// # Errors
/// [`CheckError`], naming the vertex or triangle at fault.
///
/// # Panics
/// If there are less numbers than vertices that triangles name.
pub fn vertices_behind_layers(
    positions: &[Point],
    cloth: &[[u32; 3]],
    numbers: &[u32],
    are_outwards: &[bool],
) -> Result<Vec<u32>, CheckError> {
    validate(positions, cloth)?;
    let mut layers: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for (&[a, b, c], &is_outwards) in cloth.iter().zip(are_outwards).filter(|([a, b, c], _)| a != b && b != c && c != a)
    {
        let turned = if is_outwards { [a, b, c] } else { [a, c, b] };
        layers.entry(numbers[a as usize]).or_default().push(turned);
    }
    let vertices: BTreeSet<u32> = layers.values().flatten().flatten().copied().collect();
    let mut behind = BTreeSet::new();
    for (&number, inner) in &layers {
        let Extent { low, high } = Extent::of(inner.iter().flatten().map(|&vertex| positions[vertex as usize]));
        let diagonal = sub(high, low);
        let reach_m = REACH * dot(diagonal, diagonal).sqrt();
        let outer = vertices.iter().copied().filter(|&vertex| numbers[vertex as usize] > number);
        behind.extend(vertices_behind(positions, outer, inner, reach_m)?);
    }
    Ok(behind.into_iter().collect())
}

/// Those of some vertices that are behind an inner layer, in their order. The triangles of the layer point outwards.
/// Points that are farther from it than `reach_m` are not over it.
///
/// Cost: O(n log n) in the triangles and vertices.
///
/// # Errors
/// [`CheckError`], naming the vertex or triangle at fault.
pub fn vertices_behind(
    positions: &[Point],
    vertices: impl IntoIterator<Item = u32>,
    inner: &[[u32; 3]],
    reach_m: f64,
) -> Result<Vec<u32>, CheckError> {
    validate(positions, inner)?;
    let layer = Surface::of(positions, inner);
    let is_behind = |vertex: &u32| layer.is_behind(positions, positions[*vertex as usize], reach_m);
    Ok(vertices.into_iter().filter(is_behind).collect())
}

/// A layer with the normals of its edges and corners; none for those on the boundary.
struct Surface<'a> {
    triangles: &'a [[u32; 3]],
    boxes: Boxes,
    at_edges: HashMap<[u32; 2], Option<Point>>,
    at_corners: HashMap<u32, Option<Point>>,
}

impl<'a> Surface<'a> {
    fn of(positions: &[Point], triangles: &'a [[u32; 3]]) -> Self {
        let mut edges: HashMap<[u32; 2], (usize, Point)> = HashMap::new();
        let mut corners: HashMap<u32, Point> = HashMap::new();
        for triangle in triangles {
            let normal = unit(normal_of(triangle.map(|vertex| positions[vertex as usize])));
            for k in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|step| triangle[(k + step) % 3]);
                let [at, to, from] = [a, b, c].map(|vertex| positions[vertex as usize]);
                let angle = dot(unit(sub(to, at)), unit(sub(from, at))).clamp(-1.0, 1.0).acos();
                add(corners.entry(a).or_default(), normal, angle);
                let (count, sum) = edges.entry([a.min(b), a.max(b)]).or_default();
                *count += 1;
                add(sum, normal, 1.0);
            }
        }
        let mut at_corners: HashMap<u32, Option<Point>> =
            corners.into_iter().map(|(vertex, normal)| (vertex, Some(normal))).collect();
        for (ends, _) in edges.iter().filter(|(_, (count, _))| *count == 1) {
            for end in ends {
                at_corners.insert(*end, None);
            }
        }
        let normal = |(count, sum): (usize, Point)| (count > 1).then_some(sum);
        let boxes = Boxes::new(triangles.iter().map(|triangle| triangle.map(|vertex| positions[vertex as usize])));
        let at_edges = edges.into_iter().map(|(ends, sum)| (ends, normal(sum))).collect();
        Self { triangles, boxes, at_edges, at_corners }
    }

    fn is_behind(&self, positions: &[Point], at: Point, reach_m: f64) -> bool {
        let corners = |index: usize| self.triangles[index].map(|vertex| positions[vertex as usize]);
        let from = |index: usize| {
            let (corners, weights) = (corners(index), nearest_weights(at, corners(index)));
            sub(at, [0, 1, 2].map(|axis| (0..3).map(|k| weights[k] * corners[k][axis]).sum()))
        };
        let nearest = self.boxes.nearest(at, reach_m * reach_m, |index| dot(from(index), from(index)));
        let Some(nearest) = nearest else { return false };
        let (triangle, weights, from) = (self.triangles[nearest], nearest_weights(at, corners(nearest)), from(nearest));
        let on: Vec<u32> = (0..3).filter(|&k| weights[k] > 0.0).map(|k| triangle[k]).collect();
        let normal = match on[..] {
            [corner] => self.at_corners[&corner],
            [a, b] => self.at_edges[&[a.min(b), a.max(b)]],
            _ => Some(normal_of(corners(nearest))),
        };
        normal.is_some_and(|normal| dot(from, normal) < 0.0)
    }
}

/// The nearest point of a triangle, as weights of its corners; those of corners that it does not depend on are zero
/// (Ericson 2005, 5.1.5).
fn nearest_weights(at: Point, [a, b, c]: [Point; 3]) -> [f64; 3] {
    let (ab, ac) = (sub(b, a), sub(c, a));
    let [to_a, to_b, to_c] = [a, b, c].map(|corner| sub(at, corner));
    let [d1, d2] = [dot(ab, to_a), dot(ac, to_a)];
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let [d3, d4] = [dot(ab, to_b), dot(ac, to_b)];
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let [d5, d6] = [dot(ab, to_c), dot(ac, to_c)];
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let [of_a, of_b, of_c] = [d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2];
    if of_c <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let part = d1 / (d1 - d3);
        return [1.0 - part, part, 0.0];
    }
    if of_b <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let part = d2 / (d2 - d6);
        return [1.0 - part, 0.0, part];
    }
    let [along, against] = [d4 - d3, d5 - d6];
    if of_a <= 0.0 && along >= 0.0 && against >= 0.0 {
        let part = along / (along + against);
        return [0.0, 1.0 - part, part];
    }
    let sum = of_a + of_b + of_c;
    [of_a / sum, of_b / sum, of_c / sum]
}

fn normal_of([a, b, c]: [Point; 3]) -> Point {
    let (u, v) = (sub(b, a), sub(c, a));
    [0, 1, 2].map(|k| {
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        u[next] * v[last] - u[last] * v[next]
    })
}

/// A vector of length 1, or of none.
fn unit(vector: Point) -> Point {
    let length = dot(vector, vector).sqrt();
    vector.map(|value| if length > 0.0 { value / length } else { 0.0 })
}

fn add(sum: &mut Point, vector: Point, weight: f64) {
    (0..3).for_each(|axis| sum[axis] += weight * vector[axis]);
}

fn sub(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
