use nalgebra::Point3;

use super::*;
use crate::relax::{escape::tests::samples::Pieces, outcome::Method};

/// Where coarser meshes lead to, on a number of threads.
fn end(pieces: &Pieces, num_threads: usize) -> Vec<Point3<f64>> {
    let (mesh, _) = pieces.mesh();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap();
    pool.install(|| {
        let settings = RelaxSettings::default();
        let mut relaxer = Relaxer::new(&mesh, &pieces.positions, &settings, &|| false).unwrap();
        let largest = analyse_input(&mut relaxer);
        assert!(!relaxer.is_clean());
        let end = end_by_coarser(&relaxer, largest).unwrap().unwrap();
        take(&mut relaxer, end).unwrap();
        assert!(relaxer.is_clean());
        relaxer.frame.positions().to_vec()
    })
}

#[test]
fn coarser_meshes_lead_to_a_clean_end_in_the_same_bytes_on_one_or_three_threads() {
    for pieces in [Pieces::finger(24), Pieces::tubes(24)] {
        assert_eq!(end(&pieces, 1), end(&pieces, 3));
    }
}

#[test]
fn work_that_is_ended_in_a_coarser_mesh_leaves_no_end() {
    let pieces = Pieces::finger(24);
    let (mesh, _) = pieces.mesh();
    let settings = RelaxSettings::default();
    let mut relaxer = Relaxer::new(&mesh, &pieces.positions, &settings, &|| true).unwrap();
    let largest = analyse_input(&mut relaxer);
    assert!(end_by_coarser(&relaxer, largest).unwrap().is_none());
}

/// Where an attempt on a mesh ends, and where the mesh as the coarsest of a chain does.
fn ends(pieces: &Pieces) -> [End; 2] {
    let (mesh, _) = pieces.mesh();
    let settings = RelaxSettings::default();
    let mut progress = |_: &Iteration| ControlFlow::Continue(());
    let mut relaxer = Relaxer::new(&mesh, &pieces.positions, &settings, &|| false).unwrap();
    let num_edge_face = analyse_input(&mut relaxer).num_edge_face;
    let mut best = BestState { merit: f64::INFINITY, positions: relaxer.frame.positions().to_vec() };
    let alone = attempt(&mut relaxer, num_edge_face, DescentVariant::FIRST, &mut best, &mut progress).unwrap();
    let coarsest = Level::Coarser { num_below: 0 };
    let found = solve_level(coarsest, &mesh, &pieces.positions, &settings, &mut progress, &|| false).unwrap();
    assert!(found.history.iter().all(|step| step.method != Method::Flatten));
    [alone, found.end]
}

#[test]
fn coarsest_mesh_comes_apart_where_one_attempt_ends_stuck() {
    for depth_m in [0.3, 0.6] {
        assert_eq!(ends(&Pieces::scissors(10, depth_m)), [End::Stuck, End::Clean]);
    }
}
