//! Small cloths of every degenerate kind.

pub mod small;

use super::{Sheet, folded};

fn flat(x: f64, y: f64) -> [f64; 3] {
    [x, y, 0.0]
}

/// Two level sheets in one plane, one over the other.
fn coplanar() -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([0.0, 4.0], [0.0, 4.0], [4, 4], flat);
    sheet.add_grid([1.0, 5.0], [1.5, 4.5], [4, 3], flat);
    sheet
}

/// Two sheets that pass through each other in the lines of both grids.
fn grid_aligned() -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([-2.0, 2.0], [-2.0, 2.0], [4, 4], flat);
    sheet.add_grid([-2.0, 2.0], [-2.0, 2.0], [4, 4], |x, z| [x, 0.0, z]);
    sheet
}

/// The tip of a strip stands on a face, on an edge or on a vertex of a sheet.
fn tip_at(x: f64, y: f64) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([-2.0, 2.0], [-2.0, 2.0], [4, 4], flat);
    let tip = u32::try_from(sheet.positions.len()).unwrap();
    sheet.positions.extend([[x, y, 0.0], [x - 0.5, y, 1.0], [x + 0.5, y, 1.0]]);
    sheet.uvs.extend([[0.0; 2]; 3]);
    sheet.faces.push([tip, tip + 1, tip + 2]);
    sheet
}

/// Two sheets that touch along a whole edge.
fn edge_touch() -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([0.0, 2.0], [0.0, 2.0], [2, 2], flat);
    sheet.add_grid([0.25, 1.75], [0.0, 1.0], [3, 2], |x, z| [x, 1.0, z]);
    sheet
}

/// A crossed pair of sheets of which one is there twice: other vertices at the same places.
fn duplicate_positions() -> Sheet {
    let mut sheet = Sheet::default();
    let wall = |x: f64, z: f64| [x, 0.1 * x, z];
    sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [5, 5], |x, y| [x, y, 0.01 * x]);
    sheet.add_grid([-0.5, 0.6], [-0.5, 0.6], [3, 3], wall);
    sheet.add_grid([-0.5, 0.6], [-0.5, 0.6], [3, 3], wall);
    sheet
}

/// The same faces twice over the same vertices.
fn duplicate_faces() -> Sheet {
    let mut sheet = duplicate_positions();
    let twice = sheet.faces.clone();
    sheet.faces.extend(twice.into_iter().take(30).map(|[a, b, c]| [c, a, b]));
    sheet
}

/// Faces that are lines and points, on a crossed pair of sheets.
fn zero_area() -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [5, 5], |x, y| [x, y, 0.01 * x]);
    sheet.add_grid([-0.5, 0.6], [-0.5, 0.6], [3, 3], |x, z| [x, 0.1 * x, z]);
    // A column moved onto the next, and a corner that is a point.
    for row in 0..6 {
        sheet.positions[6 * row + 2] = sheet.positions[6 * row + 1];
    }
    let last = sheet.positions.len() - 1;
    sheet.positions[last - 1] = sheet.positions[last];
    sheet.positions[last - 4] = sheet.positions[last];
    sheet
}

/// Everything in one point, and everything on one line.
fn collapsed(onto_line: bool) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([0.0, 3.0], [0.0, 3.0], [3, 3], |x, y| if onto_line { [x + y, 0.0, 0.0] } else { [1.0; 3] });
    sheet
}

/// A folded sheet whose layers are mirror images: every crossing of one with the other is an edge with an edge.
fn mirrored_fold() -> Sheet {
    let mut sheet = Sheet::default();
    let us: Vec<f64> = (-6..=6).map(|i| f64::from(i) / 8.0).collect();
    let vs: Vec<f64> = (0..=8).map(|j| f64::from(j) / 8.0).collect();
    sheet.add_lines(&us, &vs, folded(|x, v| v - 0.375 - 0.25 * x));
    sheet
}

/// Closed surfaces that touch in single points, edges and faces.
fn stacked_boxes() -> Sheet {
    let mut sheet = Sheet::default();
    for corner in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.5, 0.5]] {
        let first = u32::try_from(sheet.positions.len()).unwrap();
        for k in 0..8u8 {
            let bit = |axis: u8| f64::from(k >> axis & 1);
            sheet.positions.push([corner[0] + bit(0), corner[1] + bit(1), corner[2] + bit(2)]);
            sheet.uvs.push([0.0; 2]);
        }
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            sheet.faces.push([first + a, first + b, first + c]);
            sheet.faces.push([first + a, first + c, first + d]);
        }
    }
    sheet
}

/// A crossed pair of sheets, moved far away or scaled: what was exact is rounded.
fn crossed(map: impl Fn(f64) -> f64) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [7, 6], |x, y| [x, y, 0.013 * x * y]);
    sheet.add_grid([-0.5, 0.4], [-0.3, 1.0], [5, 6], |x, z| [x, 0.07 * x + 0.03 * z, z]);
    sheet.positions.iter_mut().flatten().for_each(|coordinate| *coordinate = map(*coordinate));
    sheet
}

/// Unused vertices and faces that repeat an index, between the others.
fn unused() -> Sheet {
    let mut sheet = crossed(|x| x);
    sheet.positions.push([0.0; 3]);
    sheet.uvs.push([0.0; 2]);
    let faces = std::mem::take(&mut sheet.faces);
    for (k, face) in faces.into_iter().enumerate() {
        if k % 10 == 0 {
            sheet.faces.push([face[0], face[1], face[0]]);
        }
        sheet.faces.push(face);
    }
    sheet
}

/// One sheet of each degenerate kind, with its name.
pub fn all() -> Vec<(&'static str, Sheet)> {
    vec![
        ("coplanar", coplanar()),
        ("grid_aligned", grid_aligned()),
        ("tip_on_face", tip_at(0.25, 0.5)),
        ("tip_on_edge", tip_at(0.5, 0.5)),
        ("tip_on_vertex", tip_at(1.0, 1.0)),
        ("edge_touch", edge_touch()),
        ("duplicate_positions", duplicate_positions()),
        ("duplicate_faces", duplicate_faces()),
        ("zero_area", zero_area()),
        ("one_point", collapsed(false)),
        ("one_line", collapsed(true)),
        ("mirrored_fold", mirrored_fold()),
        ("stacked_boxes", stacked_boxes()),
        ("far_away", crossed(|x| x + 1e6)),
        ("very_far_away", crossed(|x| x + 1e15)),
        ("tiny", crossed(|x| x * 1e-6)),
        ("huge", crossed(|x| x * 1e6)),
        ("dust", crossed(|x| x * 1e-80)),
        ("unused", unused()),
    ]
}
