//! Tracing where it is hard: many chains in one vertex, edges of more than two faces, vertices of more than one fan.

use std::collections::BTreeMap;

use untangle::{
    analysis::Analysis,
    mesh::Mesh,
    paths::{ChainEnd, PairType, PathType, SurfacePoint},
};
use untangled_testkit::{
    generate::{Sheet, fan},
    judge::rules,
};

fn types(analysis: &Analysis) -> BTreeMap<PairType, usize> {
    let mut types = BTreeMap::new();
    for pair in &analysis.paths.pairs {
        *types.entry(pair.pair_type).or_default() += 1;
    }
    types
}

fn checked(sheet: &Sheet) -> (Mesh, Analysis) {
    let (mesh, frame, analysis) = sheet.analyse();
    rules::check_paths(&mesh, &frame, &analysis, 10.0);
    (mesh, analysis)
}

#[test]
fn paths_of_many_curves_from_one_vertex_are_joined_in_pairs() {
    for (num_curves, num_sectors) in [(1, 24), (2, 36), (3, 50), (5, 80), (8, 120), (21, 400)] {
        let (_, analysis) = checked(&fan(num_curves, num_sectors));
        // As many as possible are joined two by two, side by side; an odd one folds back.
        let mut expected = BTreeMap::from([(PairType::Cross, num_curves as usize / 2)]);
        expected.insert(PairType::BoundaryLoopInside, num_curves as usize % 2);
        expected.retain(|_, count| *count > 0);
        assert_eq!(types(&analysis), expected, "{num_curves} curves");
        for pair in &analysis.paths.pairs {
            assert_eq!(pair.loop_vertices.iter().map(|vertex| vertex.0).collect::<Vec<_>>(), [0]);
        }
        // Each copy passes through the vertex once, and joined ones don't cross: together they run through each
        // half-path once.
        let through = |point: &&untangle::paths::PathPoint| matches!(point.own, SurfacePoint::Vertex(_));
        let num_passes = analysis.paths.points.iter().filter(through).count();
        assert_eq!(num_passes, num_curves as usize);
    }
}

/// Pages that share their spine, an upright line, each a grid; and a level sheet through them if `cut`.
fn book(num_pages: u32, cut: bool) -> Sheet {
    let mut sheet = Sheet::default();
    let rows = 6;
    let height = |row: u32| -0.9 + 1.7 * f64::from(row) / f64::from(rows);
    for row in 0..=rows {
        sheet.positions.push([0.01, 0.02, height(row)]);
        sheet.uvs.push([0.0, height(row)]);
    }
    for page in 0..num_pages {
        let angle = 0.3 + std::f64::consts::TAU * f64::from(page) / f64::from(num_pages);
        let first = u32::try_from(sheet.positions.len()).unwrap();
        let columns = 5;
        for row in 0..=rows {
            for column in 1..=columns {
                let radius = 0.7 * f64::from(column) / f64::from(columns);
                let z = height(row) + 0.03 * radius;
                sheet.positions.push([0.01 + radius * angle.cos(), 0.02 + radius * angle.sin(), z]);
                sheet.uvs.push([radius, z]);
            }
        }
        let at = |row: u32, column: u32| if column == 0 { row } else { first + row * columns + column - 1 };
        for row in 0..rows {
            for column in 0..columns {
                sheet.faces.push([at(row, column), at(row, column + 1), at(row + 1, column + 1)]);
                sheet.faces.push([at(row, column), at(row + 1, column + 1), at(row + 1, column)]);
            }
        }
    }
    if cut {
        sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [9, 11], |x, y| [x, y, 0.017 * x - 0.011 * y]);
    }
    sheet
}

#[test]
fn paths_through_an_edge_of_many_faces_are_split_and_marked_there() {
    for num_pages in [3, 4, 7] {
        let (mesh, analysis) = checked(&book(num_pages, true));
        assert!(!mesh.is_manifold());
        // One path a page, from the spine to the page's outer edge.
        assert_eq!(analysis.paths.pairs.len(), num_pages as usize);
        for pair in &analysis.paths.pairs {
            let spine = |end: &ChainEnd| matches!(end, ChainEnd::Junction { edge, .. } if edge.iter().all(|&v| v < 7));
            let outer = |end: &ChainEnd| matches!(end, ChainEnd::Boundary { .. });
            assert_eq!(pair.ends.iter().filter(|end| spine(end)).count(), 1, "{:?}", pair.ends);
            assert_eq!(pair.ends.iter().filter(|end| outer(end)).count(), 1, "{:?}", pair.ends);
            // The page's copy can't divide the book, which the other pages hold together.
            for copy in pair.copies.clone() {
                assert!(analysis.regions.by_copy[copy].as_ref().is_none_or(|region| !region.partitioning));
            }
        }
    }
    // Two pages are a sheet: nothing is split.
    let (mesh, analysis) = checked(&book(2, true));
    assert!(mesh.is_manifold());
    assert_eq!(types(&analysis), BTreeMap::from([(PairType::BoundaryBoundaryInsideInside, 1)]));
}

#[test]
fn path_beside_an_edge_of_many_faces_has_its_region() {
    let mut sheet = book(5, false);
    // A wall across the upper outer corner of the page at angle 0.3.
    let (sin, cos) = 0.3f64.sin_cos();
    sheet.add_grid([-0.05, 0.05], [-0.7, 0.7], [3, 9], |s, t| {
        let (along, up) = (0.45 + 0.5 * t, 0.55 - 0.5 * t);
        [0.01 + along * cos - s * sin, 0.02 + along * sin + s * cos, up + 0.01 * s]
    });
    let (mesh, analysis) = checked(&sheet);
    assert!(!mesh.is_manifold());
    assert_eq!(types(&analysis), BTreeMap::from([(PairType::BoundaryBoundaryInsideInside, 1)]));
    let region = analysis.regions.by_copy[0].as_ref().unwrap();
    assert!(region.partitioning);
    // Beyond the wall: where `along + up > 1`.
    let is_beyond = |&vertex: &usize| {
        let [x, y, z] = sheet.positions[vertex];
        (7..7 + 35).contains(&vertex) && ((x - 0.01) * cos + (y - 0.02) * sin) + z > 1.0
    };
    let expected: Vec<u32> = (0..sheet.positions.len()).filter(is_beyond).map(|v| u32::try_from(v).unwrap()).collect();
    assert!(!expected.is_empty());
    assert_eq!(analysis.regions.vertices_of(0).iter().map(|vertex| vertex.0).collect::<Vec<_>>(), expected);
}

#[test]
fn paths_at_a_vertex_of_two_fans_are_not_joined() {
    // Two discs whose centres are one vertex, upside down and tilted into each other.
    let mut sheet = Sheet::default();
    sheet.positions.push([0.0; 3]);
    sheet.uvs.push([0.0; 2]);
    for (disc, tilt) in [(0u32, 0.0), (1, 0.7)] {
        for k in 0..9u32 {
            let angle = std::f64::consts::TAU * (f64::from(k) + 0.31 * f64::from(disc)) / 9.0;
            let (sin, cos) = angle.sin_cos();
            sheet.positions.push([cos, sin + 0.01 * cos, tilt * cos + 0.1]);
            sheet.uvs.push([cos, sin]);
        }
        for k in 0..9 {
            sheet.faces.push([0, 1 + 9 * disc + k, 1 + 9 * disc + (k + 1) % 9]);
        }
    }
    let (mesh, analysis) = checked(&sheet);
    assert!(!mesh.is_manifold() && mesh.num_pieces() == 2);
    // Two curves from the common vertex to where one rim pierces the other disc. No fan holds both half-paths of a
    // curve: none is joined.
    assert!(analysis.paths.pairs.iter().all(|pair| pair.loop_vertices.iter().all(|vertex| vertex.0 == 0)));
    assert_eq!(types(&analysis), BTreeMap::from([(PairType::BoundaryLoopInside, 2)]));
    for copy in &analysis.paths.copies {
        assert_eq!(copy.path_type, PathType::BoundaryLoopInside);
        let length = analysis.paths.points[copy.points.clone()].last().unwrap().position.coords.norm();
        assert!((0.8..1.2).contains(&length), "{length}");
    }
}
