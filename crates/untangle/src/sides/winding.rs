//! The generalised winding number over a hierarchy (Barill and others 2018).

use std::f64::consts::PI;

use nalgebra::{Point3, Vector3};

use super::solid_angle::part_of_sphere;

/// Triangles in a leaf at most.
const LEAF: usize = 8;
/// A cluster counts as a dipole beyond this many times its radius.
const FAR: f64 = 2.5;
/// Between these the sum is taken over all triangles: there the dipoles could decide what is inside.
const UNSURE: [f64; 2] = [0.25, 0.75];

/// A cluster of triangles.
#[derive(Clone, Copy, Debug)]
struct Node {
    centre: Point3<f64>,
    radius_m: f64,
    /// The sum of the area vectors.
    dipole: Vector3<f64>,
    /// Its triangles.
    first: u32,
    count: u32,
    /// The node that follows where this one counts as a whole; its first child stands next to it.
    skip: u32,
}

/// Triangles in a tree, parents before their children.
#[derive(Debug)]
pub(super) struct WindingTree {
    nodes: Vec<Node>,
    triangles: Vec<[Point3<f64>; 3]>,
}

impl WindingTree {
    /// Cost: O(n log n).
    pub(super) fn new(triangles: &[[Point3<f64>; 3]]) -> Self {
        let mut tree = Self { nodes: Vec::new(), triangles: triangles.to_vec() };
        let mut sorted = triangles.to_vec();
        tree.build(&mut sorted, 0);
        tree.triangles = sorted;
        tree
    }

    fn build(&mut self, triangles: &mut [[Point3<f64>; 3]], first: usize) {
        let index = self.nodes.len();
        self.nodes.push(cluster(triangles, first));
        if triangles.len() > LEAF {
            let axis = longest_axis(triangles);
            let half = triangles.len() / 2;
            triangles.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
            let (left, right) = triangles.split_at_mut(half);
            self.build(left, first);
            self.build(right, first + half);
        }
        self.nodes[index].skip = to_u32(self.nodes.len());
    }

    /// The winding number of all triangles round a point: 1 inside of one closed surface that points outwards, 0
    /// outside.
    ///
    /// Cost: O(log n) away from the triangles; O(n) where the number is not clear, near the rim of an open surface.
    pub(super) fn number(&self, at: Point3<f64>) -> f64 {
        let mut sum = 0.0;
        let mut index = 0;
        while let Some(node) = self.nodes.get(index) {
            let to_centre = node.centre - at;
            let square = to_centre.norm_squared();
            if square > (FAR * node.radius_m) * (FAR * node.radius_m) {
                sum += node.dipole.dot(&to_centre) / (4.0 * PI * square * square.sqrt());
                index = node.skip as usize;
            } else if node.count as usize <= LEAF {
                let first = node.first as usize;
                sum += sum_of(&self.triangles[first..first + node.count as usize], at);
                index = node.skip as usize;
            } else {
                index += 1;
            }
        }
        if sum > UNSURE[0] && sum < UNSURE[1] { sum_of(&self.triangles, at) } else { sum }
    }
}

fn sum_of(triangles: &[[Point3<f64>; 3]], at: Point3<f64>) -> f64 {
    triangles.iter().map(|triangle| part_of_sphere(triangle, at)).sum()
}

/// The dipole of some triangles, at the middle of their area.
fn cluster(triangles: &[[Point3<f64>; 3]], first: usize) -> Node {
    let (mut dipole, mut area, mut weighted, mut plain) =
        (Vector3::zeros(), 0.0, Vector3::zeros(), Vector3::<f64>::zeros());
    for triangle in triangles {
        let [a, b, c] = triangle;
        let vector = 0.5 * (b - a).cross(&(c - a));
        let own = vector.norm();
        dipole += vector;
        area += own;
        weighted += own * middle(triangle).coords;
        plain += middle(triangle).coords;
    }
    #[expect(clippy::cast_precision_loss, reason = "a count of faces")]
    let count = triangles.len() as f64;
    let centre = Point3::from(if area > 0.0 { weighted / area } else { plain / count.max(1.0) });
    let radius_m = triangles.iter().flatten().map(|corner| (corner - centre).norm()).fold(0.0, f64::max);
    Node { centre, radius_m, dipole, first: to_u32(first), count: to_u32(triangles.len()), skip: 0 }
}

fn longest_axis(triangles: &[[Point3<f64>; 3]]) -> usize {
    let (mut low, mut high) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    for triangle in triangles {
        let place = middle(triangle).coords;
        (low, high) = (low.inf(&place), high.sup(&place));
    }
    (high - low).imax()
}

fn middle([a, b, c]: &[Point3<f64>; 3]) -> Point3<f64> {
    Point3::from((a.coords + b.coords + c.coords) / 3.0)
}

fn to_u32(index: usize) -> u32 {
    u32::try_from(index).expect("fewer than two for each face")
}
