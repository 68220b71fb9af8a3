use nalgebra::Point3;

use super::*;
use crate::relax::escape::tests::samples::Pieces;

/// Where coarser meshes lead to, the mean displacement as a part of the diagonal, on a number of threads.
fn end(pieces: &Pieces, num_threads: usize) -> (Vec<Point3<f64>>, f64) {
    let (mesh, _) = pieces.mesh();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(num_threads).build().unwrap();
    pool.install(|| {
        let settings = RelaxSettings::default();
        let mut relaxer = Relaxer::new(&mesh, &pieces.positions, &settings, &|| false).unwrap();
        let largest = analyse_input(&mut relaxer);
        let end = end_by_coarser(&relaxer, largest).unwrap().unwrap();
        let mean = end.mean();
        take(&mut relaxer, end).unwrap();
        assert!(relaxer.is_clean());
        (relaxer.frame.positions().to_vec(), mean)
    })
}

#[test]
fn coarser_meshes_lead_to_a_clean_end_near_the_input_in_the_same_bytes_on_one_or_three_threads() {
    for pieces in [Pieces::finger(24), Pieces::tubes(24)] {
        let (positions, mean) = end(&pieces, 1);
        println!("{mean}");
        assert!(mean > 0.0 && mean < 0.1);
        assert_eq!(end(&pieces, 3).0, positions);
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
