//! Inside regions where they are hard: tubes, holes, several paths at once, regions without vertices, cloth without
//! texture coordinates.

use std::{collections::BTreeSet, f64::consts::TAU};

use untangle::{
    analysis::{Analysis, analyse},
    mesh::Mesh,
    paths::{PairType, PathType},
};
use untangled_testkit::{
    generate::{Sheet, crumpled, folded},
    judge::rules,
};

fn checked(sheet: &Sheet) -> (Mesh, Analysis) {
    let (mesh, frame, analysis) = sheet.analyse();
    rules::check_paths(&mesh, &frame, &analysis, 10.0);
    (mesh, analysis)
}

fn pair_types(analysis: &Analysis) -> Vec<PairType> {
    analysis.paths.pairs.iter().map(|pair| pair.pair_type).collect()
}

fn inside(analysis: &Analysis, copy: usize) -> BTreeSet<usize> {
    analysis.regions.vertices_of(copy).iter().map(|vertex| vertex.index()).collect()
}

/// A tube whose cross-section is an eight, open at both hems: `near` columns in one lobe, `far` in the other.
fn eight_tube(near: u32, far: u32) -> Sheet {
    let lobe =
        |count: u32, from: f64| (0..count).map(move |k| from + 0.5 * TAU * (f64::from(k) + 0.41) / f64::from(count));
    let angles: Vec<f64> = lobe(near, 0.0).chain(lobe(far, 0.5 * TAU)).collect();
    let rows = 9u32;
    let mut sheet = Sheet::default();
    for row in 0..=rows {
        for &angle in &angles {
            // Rows are wavy, so that they meet at the hems only.
            let wave = if row % rows == 0 { 0.0 } else { 0.03 * (angle + 1.0).sin() };
            sheet.uvs.push([angle, f64::from(row)]);
            sheet.positions.push([angle.sin(), angle.sin() * angle.cos(), f64::from(row) / f64::from(rows) + wave]);
        }
    }
    let columns = near + far;
    for row in 0..rows {
        for column in 0..columns {
            let at = |dr: u32, dc: u32| (row + dr) * columns + (column + dc) % columns;
            sheet.faces.push([at(0, 0), at(0, 1), at(1, 1)]);
            sheet.faces.push([at(0, 0), at(1, 1), at(1, 0)]);
        }
    }
    sheet
}

#[test]
fn regions_of_two_hem_to_hem_paths_divide_the_tube_together() {
    for (near, far) in [(11, 16), (16, 11)] {
        let sheet = eight_tube(near, far);
        let (_, analysis) = checked(&sheet);
        // The hems are level: they touch exactly, and both copies end on the boundary twice.
        assert_eq!(pair_types(&analysis), [PairType::BoundaryBoundaryBoundaryBoundary]);
        let [first, second] = [0, 1].map(|copy| analysis.regions.by_copy[copy].clone().unwrap());
        assert!(first.partitioning && second.partitioning);
        // Together they separate the lobes; the first carries the region of both.
        let is_near = |vertex: &usize| sheet.uvs[*vertex][0] < 0.5 * TAU;
        let expected: BTreeSet<usize> = (0..sheet.uvs.len()).filter(|vertex| is_near(vertex) == (near < far)).collect();
        assert_eq!(inside(&analysis, 0), expected);
        assert!(inside(&analysis, 1).is_empty());
    }
}

#[test]
fn region_of_one_hem_to_hem_path_does_not_divide_the_tube() {
    // A tube without a slit, and a strip through it from hem to hem.
    let mut sheet = Sheet::default();
    let columns = 17u32;
    for row in 0..=8u32 {
        for column in 0..columns {
            let angle = TAU * f64::from(column) / f64::from(columns);
            sheet.uvs.push([angle, f64::from(row)]);
            sheet.positions.push([angle.cos(), angle.sin(), 0.25 * f64::from(row) - 1.0]);
        }
    }
    for row in 0..8 {
        for column in 0..columns {
            let at = |dr: u32, dc: u32| (row + dr) * columns + (column + dc) % columns;
            sheet.faces.push([at(0, 0), at(0, 1), at(1, 1)]);
            sheet.faces.push([at(0, 0), at(1, 1), at(1, 0)]);
        }
    }
    sheet.add_grid([0.5, 1.6], [-1.3, 1.3], [7, 9], |x, z| [x, 0.1 * x + 0.02 * z, z]);
    let (_, analysis) = checked(&sheet);
    assert_eq!(pair_types(&analysis), [PairType::BoundaryBoundaryInsideInside]);
    assert!(!analysis.regions.by_copy[0].as_ref().unwrap().partitioning);
    assert!(analysis.regions.vertices.is_empty());
}

/// The path of [`folded_sheet`].
fn curve(u: f64) -> f64 {
    0.65 + 0.1 * u * u
}

/// Both ends of the path lie at u = 0.8 or -0.8, where the shorter side of the sheet ends.
fn disc_radius() -> f64 {
    0.8f64.hypot(curve(0.8) - curve(0.0))
}

/// A sheet with a BLI path over the crease, and holes in it. Less of the disc lies above the path than below.
fn folded_sheet(holes: &[([f64; 2], f64)]) -> Sheet {
    let mut sheet = Sheet::fold([-1.0, 0.8], [60, 50], |x, v| v - 0.65 - 0.1 * x);
    sheet.keep_faces(|[u, v]| holes.iter().all(|&([cu, cv], radius)| (u - cu).hypot(v - cv) > radius));
    sheet
}

#[test]
fn disc_with_holes_is_divided_around_them() {
    let holes = [
        vec![],
        vec![([0.1, 0.85], 0.08)],
        vec![([-0.3, 0.4], 0.15), ([0.35, 0.83], 0.07)],
        vec![([-0.45, 0.82], 0.06), ([-0.2, 0.83], 0.07), ([0.1, 0.82], 0.08), ([0.2, 0.4], 0.2), ([-0.1, 0.15], 0.08)],
    ];
    for holes in holes {
        let sheet = folded_sheet(&holes);
        let (mesh, analysis) = checked(&sheet);
        assert_eq!(pair_types(&analysis), [PairType::BoundaryLoopInside], "{holes:?}");
        assert!(analysis.regions.by_copy[0].as_ref().unwrap().partitioning);
        let found = inside(&analysis, 0);
        let mut num_inside = 0;
        for vertex in mesh.vertex_ids() {
            let [u, v] = sheet.uvs[vertex.index()];
            let (distance, height) = (u.hypot(v - curve(0.0)), v - curve(u));
            if mesh.vertex_faces(vertex).is_empty() {
                assert!(!found.contains(&vertex.index()), "({u}, {v}) is in a hole");
            } else if (distance - disc_radius()).abs() > 0.03 && height.abs() > 0.04 {
                // Next to the path and to the rim the mesh decides.
                let expected = distance < disc_radius() && height > 0.0;
                assert_eq!(found.contains(&vertex.index()), expected, "({u}, {v}) with holes {holes:?}");
                num_inside += usize::from(expected);
            }
        }
        assert!(num_inside > 300, "{num_inside}");
    }
}

#[test]
fn disc_of_a_path_that_ends_in_a_hole_ends_at_the_hole() {
    // The hole lies across the path: its rim is nearer than the sheet's edge. Beyond it the path goes on, from boundary
    // to boundary.
    let sheet = folded_sheet(&[([-0.45, curve(0.45)], 0.12)]);
    let (_, analysis) = checked(&sheet);
    assert_eq!(pair_types(&analysis).iter().filter(|&&pair| pair == PairType::BoundaryLoopInside).count(), 1);
    let copies = analysis.paths.copies.iter();
    let folded = copies.clone().position(|copy| copy.path_type == PathType::BoundaryLoopInside).unwrap();
    let region = analysis.regions.by_copy[folded].as_ref().unwrap();
    let radius = region.disc_radius.unwrap();
    assert!(region.partitioning && (radius - 0.33).abs() < 0.05, "{radius}");
    let distance = |vertex: &usize| sheet.uvs[*vertex][0].hypot(sheet.uvs[*vertex][1] - curve(0.0));
    let found = inside(&analysis, folded);
    assert!(found.len() > 20 && found.iter().all(|vertex| distance(vertex) <= radius));
}

/// The free end is nearer than the one on the boundary: it ends the disc, and nothing leaks round it.
#[test]
fn disc_whose_nearer_path_end_is_free_ends_there() {
    let mut sheet = Sheet::default();
    // The sheet is stretched where u > 0: points over each other are u and -0.7 u.
    let stretch = |u: f64| if u > 0.0 { 0.7 * u } else { u };
    let place = folded(|x, v| v - 0.65 - 0.1 * x);
    sheet.add_grid([-1.0, 1.0], [0.0, 1.0], [60, 50], |u, v| place(stretch(u), v));
    let (mesh, analysis) = checked(&sheet);
    assert_eq!(pair_types(&analysis), [PairType::BoundaryLoopInside]);
    let region = analysis.regions.by_copy[0].as_ref().unwrap();
    let [_, centre] = sheet.uvs[analysis.paths.pairs[0].loop_vertices[0].index()];
    let expected = 0.7f64.hypot(curve(0.7) - centre);
    let radius = region.disc_radius.unwrap();
    assert!(region.partitioning && (radius - expected).abs() < 0.01, "{radius} {expected}");
    let found = inside(&analysis, 0);
    for vertex in mesh.vertex_ids() {
        let [u, v] = sheet.uvs[vertex.index()];
        let (distance, height) = (u.hypot(v - centre), v - curve(stretch(u)));
        if (distance - radius).abs() > 0.01 && height.abs() > 0.04 {
            let expected = distance < radius && height > 0.0;
            assert_eq!(found.contains(&vertex.index()), expected, "({u}, {v})");
        }
    }
}

#[test]
fn regions_of_nested_paths_share_their_vertices() {
    // A strip hangs through three level sheets.
    let mut sheet = Sheet::default();
    for level in [0.0, -0.3, -0.6] {
        sheet.add_grid([-1.0, 1.0], [-1.0, 1.0], [9, 8], |x, y| [x, y, level + 0.013 * x * y]);
    }
    let first = sheet.positions.len();
    sheet.add_grid([-0.5, 0.4], [-0.9, 3.0], [12, 40], |x, z| [x, 0.07 * x + 0.03 * z, z]);
    let (_, analysis) = checked(&sheet);
    assert_eq!(pair_types(&analysis), [PairType::BoundaryBoundaryInsideInside; 3]);
    let mut sets: Vec<BTreeSet<usize>> = (0..analysis.paths.copies.len())
        .filter(|&copy| analysis.paths.copies[copy].path_type == PathType::BoundaryBoundary)
        .map(|copy| inside(&analysis, copy))
        .collect();
    sets.sort_by_key(BTreeSet::len);
    for (set, level) in sets.iter().zip([-0.6, -0.3, 0.0]) {
        let is_below = |&vertex: &usize| {
            let [x, y, z] = sheet.positions[vertex];
            vertex >= first && z < level + 0.013 * x * y
        };
        let expected: BTreeSet<usize> = (0..sheet.positions.len()).filter(is_below).collect();
        assert_eq!(set, &expected, "below {level}");
    }
    assert!(sets[0].is_subset(&sets[1]) && sets[1].is_subset(&sets[2]));
}

#[test]
fn region_between_vertices_is_partitioning_and_empty() {
    // A wall with a bend stands across the edge of a large triangle: the path goes back out over the edge that it came
    // in by.
    let mut sheet = Sheet::default();
    sheet.positions.extend([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [5.0, 8.0, 0.0]]);
    sheet.positions.extend([[5.0, 0.6, -1.0], [5.1, 0.62, 1.0], [4.0, -1.0, -1.0]]);
    sheet.positions.extend([[4.0, -1.1, 1.0], [6.0, -1.0, -1.0], [6.1, -1.0, 1.0]]);
    sheet.uvs = sheet.positions.iter().map(|&[x, y, z]| [x, y + 20.0 * z]).collect();
    sheet.faces.extend([[0, 1, 2], [5, 3, 4], [5, 4, 6], [3, 7, 8], [3, 8, 4]]);
    let (_, analysis) = checked(&sheet);
    assert_eq!(pair_types(&analysis), [PairType::BoundaryBoundaryInsideInside]);
    assert!(analysis.regions.by_copy[0].as_ref().unwrap().partitioning);
    assert!(analysis.regions.vertices.is_empty());
}

/// Without texture coordinates the disc is unfolded by the lengths of a crumpled sheet, which no plane has: it is cut
/// open somewhere. Still every folded path divides its disc.
#[test]
fn discs_of_crumpled_sheets_without_texture_coordinates_are_divided() {
    let (mut num_discs, mut undivided) = (0, Vec::new());
    for seed in 0..200 {
        let sheet = crumpled(seed, [6, 9, 13, 20][usize::try_from(seed).unwrap() % 4]);
        let mesh = sheet.bare_mesh();
        let frame = sheet.frame(&mesh);
        let analysis = analyse(&mesh, &frame);
        for region in analysis.regions.by_copy.iter().flatten().filter(|region| region.disc_radius.is_some()) {
            num_discs += 1;
            if !region.partitioning {
                undivided.push(seed);
            }
        }
    }
    assert!(num_discs > 100, "{num_discs}");
    assert!(undivided.is_empty(), "{} of {num_discs} discs, on sheets {undivided:?}", undivided.len());
}
