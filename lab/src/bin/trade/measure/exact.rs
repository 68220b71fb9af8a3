//! What exact signs cost: one sign, and the search of a frame, from generic to degenerate.

use std::{error::Error, hint::black_box, time::Duration};

use cpu_time::ThreadTime;
use nalgebra::{Point3, Rotation3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, MeshDescription},
    predicates::{Site, side_of_plane},
};

/// How four points, or two sheets, lie to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Position {
    /// In general position: rounded arithmetic suffices.
    Generic,
    /// In a plane but for rounding: the filter gives up, expansions decide.
    Rounded,
    /// Exactly in a plane: the perturbation decides.
    Degenerate,
}

pub(crate) const POSITIONS: [(Position, &str); 3] = [
    (Position::Generic, "generic"),
    (Position::Rounded, "in a plane but for rounding"),
    (Position::Degenerate, "exactly in a plane"),
];

/// What a position costs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cost {
    /// Nanoseconds of one sign.
    pub(crate) sign_ns: f64,
    pub(crate) num_triangles: usize,
    /// Edge-face intersections of the two sheets.
    pub(crate) num_edge_face: usize,
    /// Milliseconds of a cold search.
    pub(crate) search_ms: f64,
}

/// Measures signs, and a search of two sheets of `2 n^2` triangles each that cross in a line of cells.
///
/// # Errors
/// None for an `n` that is not zero.
pub(crate) fn measure(position: Position, n: u32) -> Result<Cost, Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let queries = queries(position);
    let rounds = 20;
    let signs = least(|| {
        for _ in 0..rounds {
            for &[a, b, c, d] in &queries {
                black_box(side_of_plane(a, b, c, d));
            }
        }
    });
    let (mesh, frame) = crossed_sheets(position, n)?;
    let (mut intersector, mut found) = (Intersector::default(), Intersections::default());
    let search = pool.install(|| {
        least(|| {
            intersector.clear_cache();
            intersector.intersect(&mesh, &frame, &mut found);
        })
    });
    Ok(Cost {
        sign_ns: 1e9 * signs.as_secs_f64() / (rounds * queries.len()) as f64,
        num_triangles: mesh.num_faces(),
        num_edge_face: found.edge_face.len(),
        search_ms: 1e3 * search.as_secs_f64(),
    })
}

fn least(mut work: impl FnMut()) -> Duration {
    let timed = |_| {
        let start = ThreadTime::now();
        work();
        start.elapsed()
    };
    (0..15).map(timed).min().unwrap_or_default()
}

fn queries(position: Position) -> Vec<[Site; 4]> {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut query = || {
        let mut point = || -> [f64; 3] { std::array::from_fn(|_| rng.random_range(-1.0..1.0)) };
        let mut points: [[f64; 3]; 4] = std::array::from_fn(|_| point());
        match position {
            Position::Generic => {}
            Position::Rounded => {
                let [a, b, c] = [points[0], points[1], points[2]];
                points[3] = std::array::from_fn(|axis| a[axis] + 0.3 * (b[axis] - a[axis]) + 0.4 * (c[axis] - a[axis]));
            }
            Position::Degenerate => points.iter_mut().for_each(|point| point[2] = 0.25),
        }
        let mut index = 0;
        points.map(|position| {
            index += 1;
            Site { position, index }
        })
    };
    (0..1000).map(|_| query()).collect()
}

/// A level sheet and an upright one through the lines of its grid, both turned out of the axes or not; or shifted to
/// general position.
fn crossed_sheets(position: Position, n: u32) -> Result<(Mesh, Frame), Box<dyn Error>> {
    let turn = match position {
        Position::Degenerate => Rotation3::identity(),
        Position::Generic | Position::Rounded => Rotation3::from_euler_angles(0.3, 0.5, 0.7),
    };
    let aside = if position == Position::Generic { Vector3::new(0.37, 0.41, 0.29) } else { Vector3::zeros() };
    let (mut points, mut faces): (Vec<[f64; 3]>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    for upright in [false, true] {
        let first = u32::try_from(points.len())?;
        for row in 0..=n {
            for column in 0..=n {
                let (u, v) = (f64::from(column), f64::from(row));
                let half = f64::from(n / 2);
                let point = if upright { Point3::new(u, half, v - half) + aside } else { Point3::new(u, v, 0.0) };
                points.push((turn * point).into());
                if row < n && column < n {
                    let a = first + row * (n + 1) + column;
                    let d = a + n + 1;
                    faces.extend([[a, a + 1, d + 1], [a, d + 1, d]]);
                }
            }
        }
    }
    let mesh = Mesh::new(MeshDescription { num_vertices: points.len(), faces, ..MeshDescription::default() })?;
    let frame = Frame::new(&mesh, &points)?;
    Ok((mesh, frame))
}
