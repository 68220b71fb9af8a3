//! What single precision inside the thin-plate fit would cost in error: its systems, solved by the same factorisation
//! in either precision.
//!
//! An experiment beside the library, which has no such mode.

use std::f64::consts::TAU;

use faer::{Mat, linalg::solvers::Solve, traits::RealField};
use nalgebra::Point2;

/// What the figures mean.
pub const TEXT: &str = "\
Single precision is used where it can change no answer: the broad phase compares boxes in f32, mapped so that boxes \
that overlap still do; then pairs of faces and vertex stars are proven apart in f32 as far as they are farther apart \
than the map and the arithmetic can be wrong (`crates/untangle/src/intersect`); the remaining pairs go on in f64 and \
to the exact signs (`tests/analysis/oracle`). `docs/results/speed.md` has what it gains, and from which ratio of the \
whole to an edge on it gains nothing. Everything after it is f64, at every quality.\n\n\
The rest of this page is about \
a thin-plate fit in f32, which the library does not have: the same systems, solved by the same factorisation in both \
precisions. Errors are distances from the f64 images near the centres at worst, in distances from centre to centre, \
which are about edges of the mesh: with all in f32; with f64 weights, but images computed in f32; and with all in f64, \
but centres and values rounded to f32, which is what the wire costs near the origin. Below a condition of 1e6 single \
precision would cost less than a hundredth of an edge; at the 1e8 of centres that nearly coincide, whole edges. For \
that it would make the factorisation alone, a part of the time of targets, faster by the last column: too little for a \
mode of its own.";

/// Centres, and the values that they go to.
#[derive(Debug)]
pub struct Problem {
    /// What it is, for tables.
    pub name: String,
    centres: Vec<Point2<f64>>,
    values: Vec<Point2<f64>>,
    /// From centre to centre.
    spacing: f64,
}

/// What became of a fit in single precision.
#[derive(Clone, Copy, Debug)]
pub struct Loss {
    /// Largest to smallest pivot.
    pub condition: f64,
    /// With all in single precision.
    pub all: f64,
    /// With images in single precision.
    pub images: f64,
    /// With centres and values of single precision.
    pub input: f64,
}

/// Circles, lines with centres beside them, bare arcs, and pairs of centres.
pub fn problems(largest: u32) -> Vec<Problem> {
    let mut problems = Vec::new();
    for count in [10, 30, 100, 300, 1000].into_iter().filter(|&count| count <= largest) {
        let centres = (0..count).map(|k| on_circle(TAU * f64::from(k) / f64::from(count))).collect();
        problems.push(Problem::new(format!("{count} on a circle"), centres, TAU / f64::from(count)));
    }
    for count in [10, 30, 100, 300].into_iter().filter(|&count| 3 * count <= largest) {
        let step = 2.0 / f64::from(count);
        let beside = |k: u32| [0.0, 0.5, -0.5].map(|side| Point2::new(-1.0 + step * (f64::from(k) + 0.5), side * step));
        let centres = (0..count).flat_map(beside).collect();
        problems.push(Problem::new(format!("{count} on a line, and as many on either side"), centres, step));
    }
    for angle in [1e-1, 1e-2, 1e-3] {
        // As long as a circle is wide, and without the centres on either side that the library adds.
        let arc = |k: u32| {
            let along = f64::from(k) / 14.5 - 1.0;
            Point2::new(along, 0.25 * angle * along * along)
        };
        problems.push(Problem::new(format!("30 on an arc of {angle:e} rad"), (0..30).map(arc).collect(), 1.0 / 14.5));
    }
    for gap in [1e-1, 1e-2, 1e-4, 1e-6] {
        let spacing = TAU / 15.0;
        let pairs = (0..15).flat_map(|k| [0.0, gap].map(|shift| on_circle(spacing * (f64::from(k) + shift))));
        problems.push(Problem::new(
            format!("15 pairs on a circle, {gap:e} of the way apart"),
            pairs.collect(),
            spacing,
        ));
    }
    problems
}

fn on_circle(angle: f64) -> Point2<f64> {
    Point2::new(angle.cos(), angle.sin())
}

impl Problem {
    fn new(name: String, centres: Vec<Point2<f64>>, spacing: f64) -> Self {
        // A reflection that bends, and as jagged as where a path goes from face to face.
        let jag = |k: usize, phase: f64| 0.02 * spacing * (12.9898 * k as f64 + phase).sin();
        let value = |(k, p): (usize, &Point2<f64>)| {
            Point2::new(-p.x + 0.2 * p.y * p.y + jag(k, 0.0), p.y + 0.1 * p.x * p.y + jag(k, 1.0))
        };
        Self { name, values: centres.iter().enumerate().map(value).collect(), centres, spacing }
    }

    /// Fits in double or in single precision and returns the condition number: for time measurements.
    pub fn fit(&self, single: bool) -> f64 {
        if single {
            Plate::<f32>::fit(&self.centres, &self.values).condition
        } else {
            Plate::<f64>::fit(&self.centres, &self.values).condition
        }
    }

    /// What single precision costs.
    pub fn loss(&self) -> Loss {
        let (centres, values) = (&self.centres, &self.values);
        let double = Plate::<f64>::fit(centres, values);
        let single = Plate::<f32>::fit(centres, values);
        let rounded =
            |points: &[Point2<f64>]| points.iter().map(|p| p.map(|x| f64::from(x as f32))).collect::<Vec<_>>();
        let from_single = Plate::<f64>::fit(&rounded(centres), &rounded(values));
        let images = Plate::<f32> {
            centres: centres.iter().map(|p| p.map(|x| x as f32)).collect(),
            unknowns: double.unknowns.iter().map(|both| both.map(|x| x as f32)).collect(),
            condition: double.condition,
        };
        let apart = |image: &dyn Fn(Point2<f64>) -> Point2<f64>| {
            // Near the path, where points inside are.
            let places = centres.iter().flat_map(|&p| [1.0, 0.9, 0.5].map(|part| Point2::from(p.coords * part)));
            places.map(|p| (image(p) - double.image(p)).norm() / self.spacing).fold(0.0, f64::max)
        };
        Loss {
            condition: double.condition,
            all: apart(&|p| single.image(p)),
            images: apart(&|p| images.image(p)),
            input: apart(&|p| from_single.image(p)),
        }
    }
}

/// Single or double precision.
trait Number: RealField + nalgebra::Scalar + Copy {
    fn of(value: f64) -> Self;
    fn wide(self) -> f64;
    fn natural_log(self) -> Self;
}

impl Number for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
    fn natural_log(self) -> Self {
        self.ln()
    }
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn wide(self) -> f64 {
        self
    }
    fn natural_log(self) -> Self {
        self.ln()
    }
}

/// A thin-plate map in one precision.
struct Plate<T: Number> {
    centres: Vec<Point2<T>>,
    unknowns: Vec<[T; 2]>,
    condition: f64,
}

impl<T: Number> Plate<T> {
    fn fit(centres: &[Point2<f64>], values: &[Point2<f64>]) -> Self {
        let count = centres.len();
        let centres: Vec<Point2<T>> = centres.iter().map(|p| p.map(T::of)).collect();
        let matrix = Mat::<T>::from_fn(count + 3, count + 3, |row, column| match (row < count, column < count) {
            (true, true) => kernel(&centres[row], &centres[column]),
            (true, false) => monomial(&centres[row], column - count),
            (false, true) => monomial(&centres[column], row - count),
            (false, false) => T::of(0.0),
        });
        let factors = matrix.col_piv_qr();
        let mut sides =
            Mat::from_fn(count + 3, 2, |row, column| T::of(values.get(row).map_or(0.0, |value| value[column])));
        factors.solve_in_place(&mut sides);
        let pivot = |k: usize| factors.R()[(k, k)].wide().abs();
        let unknowns = (0..count + 3).map(|row| [sides[(row, 0)], sides[(row, 1)]]).collect();
        Self { centres, unknowns, condition: pivot(0) / pivot(count + 2) }
    }

    fn image(&self, place: Point2<f64>) -> Point2<f64> {
        let place = place.map(T::of);
        let (weights, affine) = self.unknowns.split_at(self.centres.len());
        let terms = (0..3).map(|k| (affine[k], monomial(&place, k)));
        let bent = weights.iter().zip(&self.centres).map(|(weight, centre)| (*weight, kernel(&place, centre)));
        let mut sum = [T::of(0.0); 2];
        for (both, factor) in terms.chain(bent) {
            for (sum, weight) in sum.iter_mut().zip(both) {
                *sum += weight * factor;
            }
        }
        Point2::from(sum.map(T::wide))
    }
}

/// `r^2 log r`.
fn kernel<T: Number>(a: &Point2<T>, b: &Point2<T>) -> T {
    let (x, y) = (a.x - b.x, a.y - b.y);
    let squared = x * x + y * y;
    if squared > T::of(0.0) { T::of(0.5) * squared * squared.natural_log() } else { T::of(0.0) }
}

fn monomial<T: Number>(p: &Point2<T>, index: usize) -> T {
    match index {
        0 => T::of(1.0),
        1 => p.x,
        _ => p.y,
    }
}
