//! A mesh whose vertices are split at edges is, welded, the mesh that it was.

use untangle::{mesh::MeshDescription, weld::Weld};
use untangled_mesh_io::{concatenate, read_mesh};
use untangled_testkit::{
    files::shared,
    generate::{Sheet, crumpled, fan, split_at_edges},
};

/// Splits a mesh at random edges; its weld must give the faces of the mesh's own weld.
fn assert_weld_undoes_splits(name: &str, faces: &[[u32; 3]], positions: &[[f64; 3]]) {
    let describe = |faces: &[[u32; 3]], positions: &[[f64; 3]]| MeshDescription {
        num_vertices: positions.len(),
        faces: faces.to_vec(),
        ..Default::default()
    };
    // Nothing is cut: vertices without a face are left out.
    let whole = split_at_edges(faces, positions, 0.0, 0);
    let expected = describe(&whole.faces, &whole.positions);
    let weld = Weld::find(&expected, &whole.positions, &[], 0.0).unwrap();
    let places = weld.gather(&whole.positions);
    let expected = weld.describe(&expected);
    for (seed, part) in [(1, 0.02), (2, 0.3), (3, 1.0)] {
        let split = split_at_edges(faces, positions, part, seed);
        let description = describe(&split.faces, &split.positions);
        let weld = Weld::find(&description, &split.positions, &[], 0.0).unwrap();
        // A cut at few edges of a small mesh may part no vertex.
        assert!(part < 1.0 || weld.num_merged() > 0, "{name}: nothing was cut");
        assert!(weld.describe(&description).faces == expected.faces, "{name}: {part} of its edges cut");
        assert!(weld.gather(&split.positions) == places, "{name}: {part} of its edges cut");
    }
}

#[test]
fn weld_of_generated_meshes_split_at_random_edges_gives_the_mesh() {
    let fold = Sheet::fold([-1.0, 1.0], [24, 16], |p, v| p - 0.4 - 0.2 * v);
    let crumpled = crumpled(1, 20);
    for (name, sheet) in [("fold", &fold), ("crumpled", &crumpled), ("fan", &fan(2, 9))] {
        assert_weld_undoes_splits(name, &sheet.faces, &sheet.positions);
    }
}

#[test]
fn weld_of_real_meshes_split_at_random_edges_gives_the_mesh() {
    for folder in ["data", "scenes"] {
        let Some(folder) = shared(folder) else { return };
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            // Scenes of degenerate geometry touch themselves in ways that splitting makes ambiguous.
            if path.extension().is_none_or(|extension| extension != "obj") || name.starts_with("deg_") {
                continue;
            }
            let world = concatenate(&[read_mesh(&path).unwrap()]).unwrap();
            assert_weld_undoes_splits(&name, &world.description.faces, &world.positions);
        }
    }
}
