//! What must not change the analysis: names, order, sides, place, size, threads, history, and how texture coordinates
//! are cut up.

use nalgebra::{Point3, Rotation3, Vector3};
use proptest::{prelude::*, test_runner::RngSeed};
use untangle::{
    analysis::{Analyser, Analysis, analyse},
    mesh::{Mesh, MeshDescription, Uvs},
    settings::Settings,
};
use untangled_testkit::{
    generate::{Relabelled, Sheet, crumpled, relabelled, reordered},
    judge::{Summary, rules, summary},
};

const SHEETS: u64 = 60;

fn sheets() -> impl Iterator<Item = (u64, Sheet)> {
    (0..SHEETS).map(|seed| (seed, crumpled(seed, [6, 9, 13, 20][usize::try_from(seed).unwrap() % 4])))
}

/// With texture coordinates, or measured by the lengths of its edges.
fn mesh_of(sheet: &Sheet, with_uvs: bool) -> Mesh {
    if with_uvs { sheet.mesh() } else { sheet.bare_mesh() }
}

fn summary_of(sheet: &Sheet, with_uvs: bool) -> Summary {
    let mesh = mesh_of(sheet, with_uvs);
    summary(&mesh, &analyse(&mesh, &sheet.frame(&mesh)), |vertex| vertex, |face| face)
}

fn assert_same(found: &Summary, expected: &Summary, what: &str) {
    assert_eq!(found.edge_face, expected.edge_face, "{what}");
    assert_eq!(found.face_pairs, expected.face_pairs, "{what}");
    assert_eq!(found.pairs, expected.pairs, "{what}");
}

#[test]
fn analysis_of_relabelled_and_turned_sheets_is_unchanged() {
    for (seed, sheet) in sheets() {
        for with_uvs in [false, true] {
            let expected = summary_of(&sheet, with_uvs);
            let others = [relabelled(&sheet, seed, false), relabelled(&sheet, seed, true), reordered(&sheet, seed)];
            for (which, other) in others.iter().enumerate() {
                let ([vertex, face], Relabelled { sheet, .. }) = (other.old_names(), other);
                let mesh = mesh_of(sheet, with_uvs);
                let analysis = analyse(&mesh, &sheet.frame(&mesh));
                let found = summary(&mesh, &analysis, |new| vertex[new as usize], |new| face[new as usize]);
                assert_same(&found, &expected, &format!("seed {seed}, names {which}, texture coordinates: {with_uvs}"));
            }
        }
    }
}

#[test]
fn analysis_of_mirrored_sheets_is_unchanged() {
    for (seed, sheet) in sheets() {
        for (axis, with_uvs) in [(0, true), (1, false), (2, true)] {
            let mut mirrored = sheet.clone();
            mirrored.positions.iter_mut().for_each(|position| position[axis] = -position[axis]);
            let expected = summary_of(&sheet, with_uvs);
            assert_same(&summary_of(&mirrored, with_uvs), &expected, &format!("seed {seed}, axis {axis}"));
        }
    }
}

/// The mesh of a sheet with texture coordinates of its own for each face.
fn with_seams(sheet: &Sheet) -> Mesh {
    let corners = |face: usize, corner: u32| {
        // Apart from all neighbours, and near enough to lose few digits.
        let shift = [7, 11].map(|period| f64::from(u32::try_from(face).unwrap() % period));
        let [u, v] = sheet.uvs[corner as usize];
        [u + 4.0 * shift[0], v - 4.0 * shift[1]]
    };
    let all = sheet.faces.iter().enumerate();
    let coordinates: Vec<[f64; 2]> =
        all.flat_map(|(face, face_corners)| face_corners.map(|corner| corners(face, corner))).collect();
    let count = u32::try_from(sheet.faces.len()).unwrap();
    let uvs = Uvs { coordinates, corners: (0..count).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect() };
    Mesh::new(MeshDescription { uvs: Some(uvs), ..sheet.bare_description() }).unwrap()
}

/// Texture coordinates of which each face has its own are unfolded face by face; the result are the coordinates of the
/// whole.
#[test]
fn analysis_with_texture_seams_between_all_faces_is_unchanged() {
    let mut num_discs = 0;
    for (seed, sheet) in sheets() {
        let cut_up = with_seams(&sheet);
        assert!(cut_up.chart_place(untangle::mesh::VertexId(0)).is_none());
        let found = analyse(&cut_up, &sheet.frame(&cut_up));
        let whole = sheet.mesh();
        assert!(whole.chart_place(untangle::mesh::VertexId(0)).is_some());
        let expected = analyse(&whole, &sheet.frame(&whole));
        let names = |mesh: &Mesh, analysis: &Analysis| summary(mesh, analysis, |vertex| vertex, |face| face);
        assert_same(&names(&cut_up, &found), &names(&whole, &expected), &format!("seed {seed}"));
        for (found, expected) in found.regions.by_copy.iter().zip(&expected.regions.by_copy) {
            let radius = |region: &Option<untangle::regions::InsideRegion>| region.as_ref()?.disc_radius;
            assert_eq!(radius(found).is_some(), radius(expected).is_some());
            if let (Some(found), Some(expected)) = (radius(found), radius(expected)) {
                assert!((found - expected).abs() < 1e-12, "seed {seed}: {found} {expected}");
                num_discs += 1;
            }
        }
    }
    assert!(num_discs > 50, "{num_discs}");
}

#[test]
fn analysis_on_any_number_of_threads_and_after_other_frames_is_unchanged() {
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let pools = [1, 2, 3, 16].map(pool);
    for seed in [3, 7, 11, 15] {
        let sheet = crumpled(seed, 60);
        let mesh = sheet.mesh();
        let frame = sheet.frame(&mesh);
        let expected = format!("{:?}", analyse(&mesh, &frame));
        for pool in &pools {
            assert_eq!(format!("{:?}", pool.install(|| analyse(&mesh, &frame))), expected, "seed {seed}");
        }
        // Another state in between: more tangled, then not at all.
        let mut analyser = Analyser::default();
        for (factor, is_same) in [(1.0, true), (1.2, false), (0.0, false), (1.0, true)] {
            let mut other = sheet.clone();
            for position in &mut other.positions {
                position[2] *= factor;
            }
            let other = other.frame(&mesh);
            let found = format!("{:?}", analyser.analyse(&mesh, &other, &Settings::default(), &mut ()));
            if is_same {
                assert_eq!(found, expected, "seed {seed}");
            }
        }
    }
}

#[test]
fn analysis_of_sheets_scaled_over_twelve_decades_is_unchanged() {
    for (seed, sheet) in sheets() {
        for with_uvs in [true, false] {
            let expected = summary_of(&sheet, with_uvs);
            for scale in [1e-6, 1e-3, 7.0, 1e3, 1e6] {
                let mut scaled = sheet.clone();
                scaled.positions.iter_mut().flatten().for_each(|coordinate| *coordinate *= scale);
                assert_same(&summary_of(&scaled, with_uvs), &expected, &format!("seed {seed}, scale {scale}"));
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 120,
        rng_seed: RngSeed::Fixed(2006),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn analysis_of_rigidly_moved_and_scaled_sheets_is_unchanged(
        seed in 0..200u64,
        resolution in prop::sample::select(vec![6, 9, 13]),
        with_uvs in any::<bool>(),
        angles in prop::array::uniform3(-3.0..3.0f64),
        shift in prop::array::uniform3(-10.0..10.0f64),
        scale_exponent in -6.0..6.0f64,
    ) {
        let sheet = crumpled(seed, resolution);
        let expected = summary_of(&sheet, with_uvs);
        let scale = 10f64.powf(scale_exponent);
        let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let mut moved = sheet.clone();
        for position in &mut moved.positions {
            let point = rotation * Point3::from(*position) + Vector3::from(shift);
            *position = (point.coords * scale).into();
        }
        let mesh = mesh_of(&moved, with_uvs);
        let frame = moved.frame(&mesh);
        let analysis = analyse(&mesh, &frame);
        rules::check_paths(&mesh, &frame, &analysis, 20.0 * scale);
        let found = summary(&mesh, &analysis, |vertex| vertex, |face| face);
        assert_same(&found, &expected, &format!("seed {seed}, resolution {resolution}"));
    }
}
