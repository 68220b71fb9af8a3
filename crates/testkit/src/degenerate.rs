//! Small cloths of every degenerate kind, made here.

use super::{
    scene::{Scene, folded},
    sheet::Sheet,
};

fn sheet(scene: Scene) -> Sheet {
    Sheet { faces: scene.faces, uvs: scene.uvs, positions: scene.positions }
}

fn flat(x: f64, y: f64) -> [f64; 3] {
    [x, y, 0.0]
}

/// Two level sheets in one plane, one over the other.
fn coplanar() -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([0.0, 4.0], [0.0, 4.0], [4, 4], flat);
    scene.add_grid([1.0, 5.0], [1.5, 4.5], [4, 3], flat);
    scene
}

/// Two sheets that pass through each other in the lines of both grids.
fn grid_aligned() -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([-2.0, 2.0], [-2.0, 2.0], [4, 4], flat);
    scene.add_grid([-2.0, 2.0], [-2.0, 2.0], [4, 4], |x, z| [x, 0.0, z]);
    scene
}

/// The tip of a strip stands on a face, on an edge or on a vertex of a sheet.
fn tip_at(x: f64, y: f64) -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([-2.0, 2.0], [-2.0, 2.0], [4, 4], flat);
    let tip = u32::try_from(scene.positions.len()).unwrap();
    scene.positions.extend([[x, y, 0.0], [x - 0.5, y, 1.0], [x + 0.5, y, 1.0]]);
    scene.uvs.extend([[0.0; 2]; 3]);
    scene.faces.push([tip, tip + 1, tip + 2]);
    scene
}

/// Two sheets that touch along a whole edge.
fn edge_touch() -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([0.0, 2.0], [0.0, 2.0], [2, 2], flat);
    scene.add_grid([0.25, 1.75], [0.0, 1.0], [3, 2], |x, z| [x, 1.0, z]);
    scene
}

/// A crossed pair of sheets of which one is there twice: other vertices at the same places.
fn duplicate_positions() -> Scene {
    let mut scene = Scene::default();
    let wall = |x: f64, z: f64| [x, 0.1 * x, z];
    scene.add_grid([-1.0, 1.0], [-1.0, 1.0], [5, 5], |x, y| [x, y, 0.01 * x]);
    scene.add_grid([-0.5, 0.6], [-0.5, 0.6], [3, 3], wall);
    scene.add_grid([-0.5, 0.6], [-0.5, 0.6], [3, 3], wall);
    scene
}

/// The same faces twice over the same vertices.
fn duplicate_faces() -> Scene {
    let mut scene = duplicate_positions();
    let twice = scene.faces.clone();
    scene.faces.extend(twice.into_iter().take(30).map(|[a, b, c]| [c, a, b]));
    scene
}

/// Faces that are lines and points, on a crossed pair of sheets.
fn zero_area() -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([-1.0, 1.0], [-1.0, 1.0], [5, 5], |x, y| [x, y, 0.01 * x]);
    scene.add_grid([-0.5, 0.6], [-0.5, 0.6], [3, 3], |x, z| [x, 0.1 * x, z]);
    // A column pulled onto the next, and a corner that is a point.
    for row in 0..6 {
        scene.positions[6 * row + 2] = scene.positions[6 * row + 1];
    }
    let last = scene.positions.len() - 1;
    scene.positions[last - 1] = scene.positions[last];
    scene.positions[last - 4] = scene.positions[last];
    scene
}

/// Everything in one point, and everything on one line.
fn collapsed(onto_line: bool) -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([0.0, 3.0], [0.0, 3.0], [3, 3], |x, y| if onto_line { [x + y, 0.0, 0.0] } else { [1.0; 3] });
    scene
}

/// A folded sheet whose layers are mirror images: every crossing of one with the other is an edge with an edge.
fn mirrored_fold() -> Scene {
    let mut scene = Scene::default();
    let us: Vec<f64> = (-6..=6).map(|i| f64::from(i) / 8.0).collect();
    let vs: Vec<f64> = (0..=8).map(|j| f64::from(j) / 8.0).collect();
    scene.add_lines(&us, &vs, folded(|x, v| v - 0.375 - 0.25 * x));
    scene
}

/// Closed surfaces that touch in single points, edges and faces.
fn stacked_boxes() -> Scene {
    let mut scene = Scene::default();
    for corner in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.5, 0.5]] {
        let first = u32::try_from(scene.positions.len()).unwrap();
        for k in 0..8u8 {
            let bit = |axis: u8| f64::from(k >> axis & 1);
            scene.positions.push([corner[0] + bit(0), corner[1] + bit(1), corner[2] + bit(2)]);
            scene.uvs.push([0.0; 2]);
        }
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            scene.faces.push([first + a, first + b, first + c]);
            scene.faces.push([first + a, first + c, first + d]);
        }
    }
    scene
}

/// A crossed pair of sheets, moved far away or scaled: what was exact is rounded.
fn crossed(map: impl Fn(f64) -> f64) -> Scene {
    let mut scene = Scene::default();
    scene.add_grid([-1.0, 1.0], [-1.0, 1.0], [7, 6], |x, y| [x, y, 0.013 * x * y]);
    scene.add_grid([-0.5, 0.4], [-0.3, 1.0], [5, 6], |x, z| [x, 0.07 * x + 0.03 * z, z]);
    scene.positions.iter_mut().flatten().for_each(|coordinate| *coordinate = map(*coordinate));
    scene
}

/// Unused vertices and faces that repeat an index, between the others.
fn unused() -> Scene {
    let mut scene = crossed(|x| x);
    scene.positions.push([0.0; 3]);
    scene.uvs.push([0.0; 2]);
    let faces = std::mem::take(&mut scene.faces);
    for (k, face) in faces.into_iter().enumerate() {
        if k % 10 == 0 {
            scene.faces.push([face[0], face[1], face[0]]);
        }
        scene.faces.push(face);
    }
    scene
}

/// All kinds, by name.
pub(crate) fn all() -> Vec<(&'static str, Sheet)> {
    let scenes = vec![
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
    ];
    scenes.into_iter().map(|(name, scene)| (name, sheet(scene))).collect()
}
