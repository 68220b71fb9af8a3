//! The period of a chart that was cut open: the similarity from one side of the cut to the other, which generates the
//! deck transformations of the chart's universal cover.

use nalgebra::{Point2, Vector2};

use super::{cut::Cut, patch::Patch, similarity::Similarity, unfolding::Unfolding};

/// A cut that is not one similarity of the plane, but for this part of its edges, has no period.
const PERIOD_TOLERANCE: f64 = 0.5;
/// A point is looked for in this many copies of the chart to either side of it.
const MAX_COPIES: i32 = 2;

/// A cut as it lies in an unfolded patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnfoldedCut<'a> {
    pub(super) patch: &'a Patch,
    pub(super) cut: &'a Cut,
    pub(super) unfolding: &'a Unfolding,
}

impl<'a> UnfoldedCut<'a> {
    /// The two ends of each edge of the cut, as they lie on either side of it, taken in one direction through the cut.
    fn banks(self) -> impl Iterator<Item = [[Point2<f64>; 2]; 2]> + Clone + 'a {
        let across = |bank: &[[Point2<f64>; 2]; 2]| bank[1][0] - bank[0][0] + (bank[1][1] - bank[0][1]);
        let first = self.cut.edges.first().map_or_else(Vector2::zeros, |edge| across(&self.bank(edge)));
        let banks = self.cut.edges.iter().map(move |edge| self.bank(edge));
        banks.map(move |bank| if across(&bank).dot(&first) < 0.0 { [bank[1], bank[0]] } else { bank })
    }

    /// The two ends of one edge of the cut on either side of it.
    fn bank(self, &[(face, side), (next, _)]: &[(usize, usize); 2]) -> [[Point2<f64>; 2]; 2] {
        let here = self.patch.corners()[face];
        let ends = [here[side], here[(side + 1) % 3]];
        let there = ends.map(|end| {
            let vertex = self.patch.vertices()[end as usize];
            let is_copy = |&&corner: &&u32| self.patch.vertices()[corner as usize] == vertex;
            self.patch.corners()[next].iter().find(is_copy).copied().unwrap_or(end)
        });
        [ends, there].map(|bank| bank.map(|end| self.unfolding.points[end as usize]))
    }

    /// How far the two sides of the cut are apart, in lengths of its edges.
    pub(super) fn gap(self) -> f64 {
        let (mut gap, mut length) = (0.0, 0.0);
        for [one, other] in self.banks() {
            gap += (other[0] - one[0]).norm() + (other[1] - one[1]).norm();
            length += (one[1] - one[0]).norm() + (other[1] - other[0]).norm();
        }
        gap / length
    }

    /// The rotation and translation from one side of the cut to the other, where one fits.
    pub(super) fn fit_period(self) -> Option<Similarity> {
        let pairs = self.banks().flat_map(|[one, other]| [[one[0], other[0]], [one[1], other[1]]]);
        let (period, rest) = Similarity::fit_rigid(pairs)?;
        #[expect(clippy::cast_precision_loss, reason = "a count of edges")]
        let count = self.cut.edges.len() as f64;
        let length = self.banks().map(|[one, _]| (one[1] - one[0]).norm()).sum::<f64>() / count;
        (rest <= PERIOD_TOLERANCE * length).then_some(period)
    }
}

/// The deck transformations to the nearest copies of a chart: the identity first, then the powers of its period, if it
/// has one.
pub(crate) fn deck_transformations(period: Option<Similarity>) -> impl Iterator<Item = Similarity> {
    let most = if period.is_some() { MAX_COPIES } else { 0 };
    let exponents = (1..=most).flat_map(|exponent| [exponent, -exponent]);
    let powers = exponents.filter_map(move |exponent| Some(period?.power(exponent)));
    std::iter::once(Similarity::IDENTITY).chain(powers)
}
