//! Vertices behind a layer.

use crate::{Point, vertices_behind};

/// A tent with four sides over a square, whose faces point upwards.
fn tent() -> (Vec<Point>, Vec<[u32; 3]>) {
    let positions = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    (positions, vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
}

#[test]
fn vertices_behind_a_tent_are_those_below_it_at_faces_edges_and_its_top_and_none_beyond_its_hem() {
    let (mut positions, faces) = tent();
    let above = [[0.0, 0.0, 1.1], [0.0, -0.6, 0.6], [0.52, 0.52, 0.6], [0.0, 0.0, 4.0]];
    let below = [[0.0, 0.0, 0.9], [0.0, -0.4, 0.4], [0.5, 0.5, 0.4], [0.0, 0.0, 0.5]];
    let beyond = [[0.0, -1.5, -0.2], [1.4, 1.4, -0.1], [0.0, 0.0, -3.0]];
    let first = u32::try_from(positions.len()).unwrap();
    positions.extend(above.iter().chain(&below).chain(&beyond));
    let vertices = first..u32::try_from(positions.len()).unwrap();
    let expected: Vec<u32> = (first + 4..first + 8).collect();
    assert_eq!(vertices_behind(&positions, vertices.clone(), &faces, 1.0).unwrap(), expected);
    // Turned round, the other side is behind; what is out of reach is not over it.
    let turned: Vec<[u32; 3]> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let expected: Vec<u32> = (first..first + 3).collect();
    assert_eq!(vertices_behind(&positions, vertices, &turned, 1.0).unwrap(), expected);
}
