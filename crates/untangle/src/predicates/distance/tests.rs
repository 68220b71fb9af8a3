//! The decisions against exact rational distances, from random, degenerate and tied primitives.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

/// A number from a coarse grid, so that primitives degenerate and distances tie, or from a fine one.
fn number(random: &mut ChaCha8Rng, coarse: bool) -> f64 {
    if coarse { f64::from(random.random_range(-2_i32..=2)) } else { random.random_range(-1.0..1.0) }
}

fn point(random: &mut ChaCha8Rng, coarse: bool, scale: f64) -> Point {
    std::array::from_fn(|_| number(random, coarse) * scale)
}

/// The smallest integer-coordinate squared distance of a point and a triangle, times the denominators: a comparison by
/// fractions of 128 bits, feature by feature, for whole coordinates up to 4.
mod fractions {
    type Vector = [i128; 3];

    fn sub(a: Vector, b: Vector) -> Vector {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }
    fn dot(a: Vector, b: Vector) -> i128 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    /// The squared distance of a point and the plane part of a triangle by a search over its Voronoi regions.
    pub(super) fn point_segment(p: Vector, a: Vector, b: Vector) -> (i128, i128) {
        let (along, offset) = (sub(b, a), sub(p, a));
        let length = dot(along, along);
        let product = dot(offset, along).clamp(0, length);
        if length == 0 {
            return (dot(offset, offset), 1);
        }
        // |offset length - along product|^2 / length^2
        let scaled: Vector = std::array::from_fn(|axis| offset[axis] * length - along[axis] * product);
        (dot(scaled, scaled), length * length)
    }

    pub(super) fn least(fractions: impl IntoIterator<Item = (i128, i128)>) -> (i128, i128) {
        fractions
            .into_iter()
            .reduce(|best, other| if other.0 * best.1 < best.0 * other.1 { other } else { best })
            .unwrap()
    }

    /// By the barycentric coordinates of the projection, from Cramer's rule.
    pub(super) fn point_triangle(p: Vector, [a, b, c]: [Vector; 3]) -> (i128, i128) {
        let sides = [point_segment(p, a, b), point_segment(p, b, c), point_segment(p, c, a)];
        let (u, v, w) = (sub(b, a), sub(c, a), sub(p, a));
        let (uu, uv, vv, wu, wv) = (dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v));
        let determinant = uu * vv - uv * uv;
        let (s, t) = (vv * wu - uv * wv, uu * wv - uv * wu);
        if determinant > 0 && s >= 0 && t >= 0 && s + t <= determinant {
            let rest: Vector = std::array::from_fn(|axis| w[axis] * determinant - u[axis] * s - v[axis] * t);
            return least(sides.into_iter().chain([(dot(rest, rest), determinant * determinant)]));
        }
        least(sides)
    }

    pub(super) fn segment_segment([a, b]: [Vector; 2], [c, d]: [Vector; 2]) -> (i128, i128) {
        let ends = [point_segment(a, c, d), point_segment(b, c, d), point_segment(c, a, b), point_segment(d, a, b)];
        let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
        let (uu, uv, vv, wu, wv) = (dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v));
        let determinant = uu * vv - uv * uv;
        let (s, t) = (vv * wu - uv * wv, uv * wu - uu * wv);
        if determinant > 0 && s >= 0 && t >= 0 && s <= determinant && t <= determinant {
            let rest: Vector = std::array::from_fn(|axis| w[axis] * determinant - u[axis] * s + v[axis] * t);
            return least(ends.into_iter().chain([(dot(rest, rest), determinant * determinant)]));
        }
        least(ends)
    }
}

/// Whether a fraction is less than the square of a multiple of one half.
fn is_less((numerator, denominator): (i128, i128), halves: i128) -> bool {
    4 * numerator < halves * halves * denominator
}

#[test]
fn decisions_on_whole_coordinates_are_those_of_fractions_ties_included() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let (mut ties, mut nearer) = (0, 0);
    for _ in 0..40_000 {
        let whole: [[i128; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| random.random_range(-2_i128..=2)));
        #[expect(clippy::cast_precision_loss, reason = "small numbers")]
        let points = whole.map(|point| point.map(|value| value as f64));
        let halves: i128 = random.random_range(1..=8);
        for scale in [1.0, f64::from_bits((1023 - 20) << 52), f64::from_bits((1023 + 20) << 52)] {
            let [p, a, b, c] = points.map(|point| point.map(|value| value * scale));
            #[expect(clippy::cast_precision_loss, reason = "small numbers")]
            let distance = 0.5 * halves as f64 * scale;
            let face = fractions::point_triangle(whole[0], [whole[1], whole[2], whole[3]]);
            let edges = fractions::segment_segment([whole[0], whole[1]], [whole[2], whole[3]]);
            assert_eq!(is_vertex_nearer(p, [a, b, c], distance), is_less(face, halves), "{whole:?} {halves}");
            assert_eq!(are_edges_nearer([p, a], [b, c], distance), is_less(edges, halves), "{whole:?} {halves}");
            ties += usize::from(4 * face.0 == halves * halves * face.1);
            nearer += usize::from(is_less(face, halves));
        }
    }
    assert!(ties > 1_000 && nearer > 10_000 && nearer < 110_000, "{ties} {nearer}");
}

#[test]
fn filter_never_contradicts_the_exact_answer() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let (mut open, mut decided) = (0, [0, 0]);
    for _ in 0..20_000 {
        let coarse = random.random_range(0..4) == 0;
        let scale = [1e-6, 1e-3, 1.0, 1e3, 1e6][random.random_range(0..5)];
        let mut points: [Point; 4] = std::array::from_fn(|_| point(&mut random, coarse, scale));
        if random.random_range(0..3) == 0 {
            // A sliver, or a nearly parallel edge.
            let along = random.random_range(-1.0..2.0);
            points[3] = std::array::from_fn(|axis| {
                points[2][axis] + along * (points[1][axis] - points[0][axis]) * (1.0 + 1e-14 * along)
            });
        }
        let [p, a, b, c] = points;
        let own = [vertex_face_distance(p, [a, b, c]), edge_edge_distance([p, a], [b, c])];
        for distance in own.into_iter().flat_map(|own| [own, own.next_up(), own.next_down(), own * 1.1, own * 0.9]) {
            if distance <= 0.0 {
                continue;
            }
            let differences = [a, b, c].map(|corner| difference(p, corner));
            let face = decide(&differences, vertex_face_weights(p, [a, b, c]), distance);
            let edges = decide(&edge_differences([p, a], [b, c]), edge_weights([p, a], [b, c]), distance);
            let exact =
                [exact::is_vertex_nearer(p, [a, b, c], distance), exact::are_edges_nearer([p, a], [b, c], distance)];
            let differences = edge_differences([p, a], [b, c]);
            assert!(!(are_middles_apart(&differences, distance) && exact[1]), "{points:?} {distance:e}");
            for (answer, exact) in [face, edges].into_iter().zip(exact) {
                match answer {
                    Some(answer) => {
                        assert_eq!(answer, exact, "{points:?} {distance:e}");
                        decided[usize::from(answer)] += 1;
                    }
                    None => open += 1,
                }
            }
        }
    }
    assert!(open > 1_000 && decided.iter().all(|&count| count > 10_000), "{open} {decided:?}");
}

#[test]
fn touching_is_nearer_than_the_smallest_distance_and_a_tie_is_not_nearer() {
    let face = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let least = f64::from_bits(1);
    assert!(is_vertex_nearer([0.25, 0.25, 0.0], face, least));
    assert!(!is_vertex_nearer([0.25, 0.25, 0.5], face, 0.5));
    assert!(is_vertex_nearer([0.25, 0.25, 0.5], face, 0.5_f64.next_up()));
    // sqrt(2) is no double: those on both sides of it decide.
    let beside = |distance| is_vertex_nearer([-1.0, -1.0, 0.0], face, distance);
    assert!(!beside(std::f64::consts::SQRT_2.next_down()) && beside(std::f64::consts::SQRT_2));
    assert!(are_edges_nearer([face[0], face[1]], [[0.5, 0.0, 0.0], [0.5, 1.0, 1.0]], least));
    assert!(!are_edges_nearer([face[0], face[1]], [[0.0, 0.1, 0.0], [1.0, 0.1, 0.0]], 0.1));
    // A point and a point.
    assert!(!are_edges_nearer([face[0]; 2], [[3.0, 4.0, 0.0]; 2], 5.0));
    assert!(is_vertex_nearer([3.0, 4.0, 0.0], [[0.0; 3]; 3], 5.0_f64.next_up()));
}

#[test]
fn decisions_at_the_ends_of_the_range_of_frames_are_exact() {
    let (small, large) = (f64::from_bits((1023 - 250) << 52), f64::from_bits((1023 + 250) << 52));
    for size in [small, large] {
        let face = [[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0]];
        assert!(!is_vertex_nearer([0.0, 0.0, size], face, size));
        assert!(is_vertex_nearer([0.0, 0.0, size], face, size.next_up()));
        assert!(is_vertex_nearer([0.0, 0.0, size], face, f64::MAX));
    }
}

#[test]
fn distances_of_faces_with_corners_in_one_place_are_those_of_their_edges() {
    let (a, b) = ([0.0; 3], [2.0, 0.0, 0.0]);
    for size in [1.0, f64::from_bits((1023 - 248) << 52), f64::from_bits((1023 + 247) << 52)] {
        let at = |place: Point| place.map(|value| value * size);
        for face in [[a, a, b], [a, b, b], [a, b, a], [b, a, [1.0, 0.0, 0.0]]] {
            let distance = vertex_face_distance(at([1.5, 3.0, 0.0]), face.map(at));
            assert_eq!(distance.to_bits(), (3.0 * size).to_bits(), "{face:?}");
        }
        // The nearest point lies within the long side of a needle.
        let needle = [[0.0, 0.0, 1e-45], [2.0, 0.0, 2.0], [0.0, 1e-45, 0.0]].map(at);
        let distance = vertex_face_distance(at([0.0, 1.0, 1.0]), needle) / size;
        assert!((distance - 1.5_f64.sqrt()).abs() < 1e-15, "{distance}");
        // Within a face of which a product of areas underflows.
        let face = [a, b, [0.0, 2.0, 0.0]].map(at);
        let distance = vertex_face_distance(at([0.5, 0.5, 0.25]), face);
        assert_eq!(distance.to_bits(), (0.25 * size).to_bits());
    }
}

#[test]
fn distances_of_slivers_and_nearly_parallel_edges_are_off_by_little() {
    // The tip of a sliver, above which rounding takes the point to be over its longest side.
    for width in [1e-3, 1e-6, 1e-8, 1e-9, 1e-12, 1e-15] {
        let (tip, above) = ([0.5, width, 0.0], [0.5, 1.0, 0.0]);
        let distance = vertex_face_distance(above, [[0.0; 3], [1.0, 0.0, 0.0], tip]);
        assert!((distance - (1.0 - width)).abs() < 1e-15, "{width:e}: {distance}");
        let crossed = edge_edge_distance([[0.0; 3], [1.0, 0.0, 0.0]], [[0.0, -width, 0.5], [1.0, width, 0.5]]);
        assert!((crossed - 0.5).abs() < 1e-15, "{width:e}: {crossed}");
    }
}
