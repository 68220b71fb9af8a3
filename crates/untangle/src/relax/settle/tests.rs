//! Shape recovery, on meshes of several finenesses.

use std::ops::ControlFlow;

use nalgebra::Point3;

use crate::{
    mesh::Mesh,
    relax::{Method, RelaxSettings, Relaxation, escape::tests::samples::Pieces, relax},
};

fn relaxed(pieces: &Pieces) -> (Mesh, Relaxation) {
    let (mesh, _) = pieces.mesh();
    let settings = RelaxSettings::default();
    let relaxation = relax(&mesh, &pieces.positions, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(relaxation.blocked.is_empty());
    (mesh, relaxation)
}

fn distance_m(positions: &[[f64; 3]], others: &[[f64; 3]], vertex: usize) -> f64 {
    (Point3::from(positions[vertex]) - Point3::from(others[vertex])).norm()
}

/// The factor by which the worst edge is longer or shorter than in the input.
fn worst_stretch(mesh: &Mesh, before: &[[f64; 3]], after: &[[f64; 3]]) -> f64 {
    let length =
        |positions: &[[f64; 3]], [a, b]: [usize; 2]| (Point3::from(positions[a]) - Point3::from(positions[b])).norm();
    let stretch = |ends: [usize; 2]| length(after, ends) / length(before, ends);
    let stretches = mesh.edge_ids().map(|edge| stretch(mesh.edge(edge).map(|end| end.index())));
    stretches.fold(1.0, |worst: f64, stretch| worst.max(stretch).max(1.0 / stretch))
}

#[test]
fn settled_tubes_keep_their_lengths_and_move_as_far_at_a_half_and_a_quarter_of_the_edge() {
    let mut means_m = Vec::new();
    for squares in [16, 32, 64] {
        let pieces = Pieces::tubes(squares);
        let (mesh, relaxation) = relaxed(&pieces);
        assert!(relaxation.history.iter().any(|step| step.method == Method::RecoverShape), "{squares}");
        let stretch = worst_stretch(&mesh, &pieces.positions, &relaxation.positions);
        let count = pieces.positions.len();
        let moved = (0..count).map(|vertex| distance_m(&pieces.positions, &relaxation.positions, vertex));
        means_m.push(moved.sum::<f64>() / f64::from(u32::try_from(count).unwrap()));
        println!("{squares}: {stretch} {means_m:?} {}", relaxation.history.len());
        assert!(stretch < 1.1, "{squares}: {stretch}");
    }
    assert!(means_m.iter().all(|mean_m| *mean_m < 1.5 * means_m[0] && *mean_m > means_m[0] / 1.5), "{means_m:?}");
}

#[test]
fn displacement_of_a_sheet_under_a_tongue_ends_away_from_it() {
    let pieces = Pieces::tongue(24, 0.31);
    let (mesh, relaxation) = relaxed(&pieces);
    let far = |&vertex: &usize| {
        let [x, y, _] = pieces.positions[vertex];
        x.abs().max(y.abs()) > 0.9
    };
    let far: Vec<usize> = (0..mesh.num_vertices()).filter(far).collect();
    let bits = |positions: &[[f64; 3]], vertex: usize| positions[vertex].map(f64::to_bits);
    let is_kept = |&&vertex: &&usize| bits(&pieces.positions, vertex) == bits(&relaxation.positions, vertex);
    let kept = far.iter().filter(is_kept).count();
    println!("{kept} of {}", far.len());
    assert!(4 * kept > far.len(), "{kept} of {}", far.len());
}
