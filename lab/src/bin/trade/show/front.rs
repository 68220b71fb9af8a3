//! Which points no other point beats.

/// The indices of the points that are not dominated, ascending in the first coordinate: smaller is better in all, and a
/// point is dominated by one that is at least as good in all and better in one. Of equal points all stay.
pub(crate) fn pareto_front<const N: usize>(points: &[[f64; N]]) -> Vec<usize> {
    let dominates =
        |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).all(|(a, b)| a <= b) && a.iter().zip(b).any(|(a, b)| a < b);
    let mut front: Vec<usize> =
        (0..points.len()).filter(|&index| !points.iter().any(|other| dominates(other, &points[index]))).collect();
    front.sort_by(|&a, &b| points[a][0].total_cmp(&points[b][0]));
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_nothing_beats_is_on_the_front() {
        let points = [[3.0, 1.0], [1.0, 3.0], [2.0, 3.0], [2.0, 2.0], [3.0, 3.0], [1.0, 4.0]];
        assert_eq!(pareto_front(&points), [1, 3, 0]);
    }

    #[test]
    fn being_best_in_one_figure_is_enough() {
        let points = [[1.0, 5.0, 5.0], [2.0, 5.0, 4.0], [3.0, 5.0, 4.0], [3.0, 4.0, f64::INFINITY]];
        assert_eq!(pareto_front(&points), [0, 1, 3]);
    }

    #[test]
    fn equal_points_stay_and_one_point_is_its_own_front() {
        assert_eq!(pareto_front(&[[1.0, 1.0], [1.0, 1.0]]), [0, 1]);
        assert_eq!(pareto_front(&[[5.0, 5.0]]), [0]);
        assert!(pareto_front::<2>(&[]).is_empty());
    }
}
