//! Fills of strips.

use super::{FillRules, Flood, Partition};
use crate::mesh::{EdgeId, Mesh, MeshDescription, VertexId};

const ALL: FillRules<'_> = FillRules { allowed: &|_| true, weight: &|_| 1.0, tie_weight: &|_| 0.0, left: &|_| None };

/// A strip of `n` quads, two vertices a column.
fn strip(n: u32) -> Mesh {
    let faces = (0..n).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 2, 2 * i + 1, 2 * i + 3]]).collect();
    Mesh::new(MeshDescription { num_vertices: 2 * n as usize + 2, faces, ..Default::default() }).unwrap()
}

fn edge(mesh: &Mesh, a: u32, b: u32) -> EdgeId {
    mesh.edge_between(VertexId(a), VertexId(b)).unwrap()
}

#[test]
fn fill_of_cut_strip_completes_the_smaller_side_only() {
    let mesh = strip(50);
    let mut flood = Flood::default();
    flood.reset(&mesh);
    for (a, b) in [(4, 6), (5, 6), (5, 7)] {
        flood.cross(edge(&mesh, a, b));
    }
    assert_eq!(flood.fill(&mesh, &ALL), Partition::TwoSides);
    assert_eq!(flood.side(flood.smaller()), [0, 1, 2, 3, 4, 5].map(VertexId));
    // Most of the larger side was not visited.
    assert!(flood.sides[1 - flood.smaller].len() < 16);
}

#[test]
fn fill_ignores_edges_crossed_an_even_number_of_times() {
    let mesh = strip(4);
    let mut flood = Flood::default();
    flood.reset(&mesh);
    for _ in 0..2 {
        flood.cross(edge(&mesh, 4, 6));
    }
    assert_eq!(flood.fill(&mesh, &ALL), Partition::TwoSides);
    assert!(flood.side(flood.smaller()).is_empty());
    flood.reset(&mesh);
    for _ in 0..3 {
        flood.cross(edge(&mesh, 4, 6));
    }
    // One edge alone does not separate.
    assert_eq!(flood.fill(&mesh, &ALL), Partition::Connected);
}

#[test]
fn fill_does_not_pass_through_removed_vertices() {
    let mesh = strip(4);
    let mut flood = Flood::default();
    flood.reset(&mesh);
    flood.remove(VertexId(4));
    flood.cross(edge(&mesh, 5, 7));
    flood.cross(edge(&mesh, 5, 6));
    assert_eq!(flood.fill(&mesh, &ALL), Partition::TwoSides);
    assert_eq!(flood.side(flood.smaller()), [6, 7, 8, 9].map(VertexId));
}

#[test]
fn reach_of_a_vertex_of_the_larger_side_colours_it_and_not_the_whole_side() {
    let mesh = strip(500);
    let mut flood = Flood::default();
    flood.reset(&mesh);
    for (a, b) in [(4, 6), (5, 6), (5, 7)] {
        flood.cross(edge(&mesh, a, b));
    }
    assert_eq!(flood.fill(&mesh, &ALL), Partition::TwoSides);
    let larger = 1 - flood.smaller();
    assert_eq!(flood.side_of(VertexId(60)), None);
    flood.reach(&mesh, &ALL, [VertexId(0), VertexId(60)].into_iter());
    assert_eq!(flood.side_of(VertexId(60)), Some(larger));
    assert!(flood.side(larger).len() < 80);
    flood.complete(&mesh, &ALL);
    assert_eq!(flood.side(larger).len(), 1002 - 6);
}
