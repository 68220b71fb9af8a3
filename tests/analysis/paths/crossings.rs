//! Flat sheets placed through each other, one for each type of path that they can have.

use untangle::{
    mesh::VertexId,
    paths::{PairType, PathType},
};
use untangled_testkit::generate::Sheet;

use super::expect::{assert_inside, assert_types};

#[test]
fn path_of_a_bump_through_a_sheet_is_closed() {
    let mut sheet = Sheet::default();
    sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [23, 21], |x, y| [x, y, 0.01 * x]);
    let height = |x: f64, y: f64| 0.5 - 2.0 * (x * x + y * y);
    sheet.add_grid([-0.9, 0.93], [-0.91, 0.9], [22, 24], |x, y| [x, y, height(x, y)]);
    let found = assert_types(&sheet, &[PairType::Closed], &[PathType::Closed; 2]);
    assert_inside(&sheet, &found, |vertex| {
        let [x, y] = sheet.uvs[vertex.index()];
        height(x, y) > 0.01 * x
    });
}

/// A horizontal sheet and an upright one through it, `x` from `range`.
fn upright_through_flat(range: [f64; 2]) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [21, 19], |x, y| [x, y, 0.013 * x * y]);
    sheet.add_grid(range, [-0.3, 1.0], [12, 13], |x, z| [x, 0.07 * x + 0.03 * z, z]);
    sheet
}

#[test]
fn path_of_a_strip_end_through_a_sheet_is_boundary_boundary_and_inside_inside() {
    let sheet = upright_through_flat([-0.5, 0.4]);
    let types = [PathType::BoundaryBoundary, PathType::InsideInside];
    let found = assert_types(&sheet, &[PairType::BoundaryBoundaryInsideInside], &types);
    // The strip was added last.
    assert_inside(&sheet, &found, |vertex| vertex.index() >= 22 * 20 && sheet.positions[vertex.index()][2] < 0.0);
}

#[test]
fn path_of_a_strip_through_a_sheet_edge_is_boundary_inside_twice() {
    let sheet = upright_through_flat([0.4, 1.6]);
    let (_, analysis) = assert_types(&sheet, &[PairType::BoundaryInside], &[PathType::BoundaryInside; 2]);
    assert!(analysis.regions.by_copy.iter().all(Option::is_none));
}

/// A flat sheet whose edges are x = -1 and x = 1, and an upright one with an edge at x = 1, which meet in (1, 0.25, 0):
/// in numbers that are exact in binary.
fn touching(left: f64, cells: u32) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [8, 8], |x, y| [x, y, 0.0]);
    sheet.add_grid([left, 1.0], [-0.5, 0.75], [cells, 5], |x, z| [x, 0.25 * x + 0.125 * z, z]);
    sheet
}

/// The vertices of the upright sheet under the flat one: fewer than above.
fn is_under(sheet: &Sheet, vertex: VertexId) -> bool {
    vertex.index() >= 81 && sheet.positions[vertex.index()][2] < 0.0
}

#[test]
fn path_to_exactly_touching_boundaries_is_boundary_boundary_and_boundary_inside() {
    let sheet = touching(-0.5, 6);
    let types = [PathType::BoundaryBoundary, PathType::BoundaryInside];
    let found = assert_types(&sheet, &[PairType::BoundaryBoundaryBoundaryInside], &types);
    assert!(found.1.regions.by_copy[0].as_ref().unwrap().partitioning);
    assert_inside(&sheet, &found, |vertex| is_under(&sheet, vertex));
}

#[test]
fn path_between_exactly_touching_boundaries_is_boundary_boundary_twice() {
    let sheet = touching(-1.0, 8);
    let found = assert_types(&sheet, &[PairType::BoundaryBoundaryBoundaryBoundary], &[PathType::BoundaryBoundary; 2]);
    assert!(found.1.regions.by_copy.iter().all(|region| region.as_ref().unwrap().partitioning));
    // The flat sheet is cut along y = 0.25 x, in two parts of nearly the same size; which is smaller is counted.
    let beyond = |vertex: &VertexId| {
        let [x, y, _] = sheet.positions[vertex.index()];
        vertex.index() < 81 && y > 0.25 * x
    };
    let num_beyond = found.0.vertex_ids().filter(beyond).count();
    let smaller = num_beyond < 81 - num_beyond;
    assert_inside(&sheet, &found, |vertex| {
        if vertex.index() < 81 { beyond(&vertex) == smaller } else { is_under(&sheet, vertex) }
    });
}
