pub(in crate::relax) mod samples;

use std::ops::ControlFlow;

use crate::{
    analysis::analyse,
    frame::Frame,
    relax::{Method, RelaxSettings, Relaxation, relax},
};
use samples::Pieces;

/// Relaxes pieces, which have to come clean by local motions alone.
fn relaxed(pieces: &Pieces) -> Relaxation {
    let (mesh, _) = pieces.mesh();
    let relaxation =
        relax(&mesh, &pieces.positions, &RelaxSettings::default(), &mut |_| ControlFlow::Continue(())).unwrap();
    let frame = Frame::new(&mesh, &relaxation.positions).unwrap();
    assert!(analyse(&mesh, &frame).intersections.edge_face.is_empty());
    assert!(relaxation.history.iter().all(|step| matches!(step.method, Method::Push | Method::RecoverShape)));
    relaxation
}

fn num_pushes(relaxation: &Relaxation) -> usize {
    relaxation.history.iter().filter(|step| step.method == Method::Push).count()
}

/// The farthest that a vertex moved, in metres.
fn farthest_m(pieces: &Pieces, relaxation: &Relaxation) -> f64 {
    let distance = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    pieces.positions.iter().zip(&relaxation.positions).map(distance).fold(0.0, f64::max)
}

#[test]
fn crossing_tubes_come_clean_in_about_as_many_steps_at_half_the_edge_length() {
    let [coarse, fine] = [12, 24].map(|squares| num_pushes(&relaxed(&Pieces::tubes(squares))));
    assert!(2 * fine <= 3 * coarse.max(2), "{coarse} {fine}");
}

#[test]
fn finger_through_sheet_leaves_it_and_moves_no_farther_than_it_sticks_out() {
    let pieces = Pieces::finger(20);
    let relaxation = relaxed(&pieces);
    assert!(farthest_m(&pieces, &relaxation) < 0.6);
}

#[test]
fn tongue_is_drawn_back_in_the_same_bytes_on_one_or_three_threads() {
    let pieces = Pieces::tongue(8, 0.31);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| relaxed(&pieces))
    };
    let relaxation = on(1);
    assert!(farthest_m(&pieces, &relaxation) < 0.4);
    assert_eq!(on(3), relaxation);
}
