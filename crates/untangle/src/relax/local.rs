//! Goals in the numbers of a domain, for the solver's inner loops.

use nalgebra::Vector3;

use super::{domain::Domain, goals::Goals};
use crate::mesh::VertexId;

/// Goals on the motion of a domain.
#[derive(Debug, Default)]
pub(super) struct LocalGoals {
    ends: Vec<usize>,
    terms: Vec<(usize, Vector3<f64>)>,
    wanted_m: Vec<f64>,
}

impl LocalGoals {
    /// Takes over goals; vertices that must not move are left out.
    pub(super) fn set(&mut self, goals: &Goals, domain: &Domain) {
        self.ends.clear();
        self.terms.clear();
        self.wanted_m.clear();
        for goal in 0..goals.len() {
            let here = |&(vertex, coefficient): &(VertexId, Vector3<f64>)| Some((domain.local(vertex)?, coefficient));
            self.terms.extend(goals.row(goal).iter().filter_map(here));
            self.ends.push(self.terms.len());
            self.wanted_m.push(goals.wanted_m(goal));
        }
    }

    /// Terms and wanted distance of each goal.
    pub(super) fn rows(&self) -> impl Iterator<Item = (&[(usize, Vector3<f64>)], f64)> {
        let mut start = 0;
        self.ends.iter().zip(&self.wanted_m).map(move |(&end, &wanted_m)| {
            let row = &self.terms[start..end];
            start = end;
            (row, wanted_m)
        })
    }
}

/// The left-hand side of a goal.
pub(super) fn reached(row: &[(usize, Vector3<f64>)], motion: &[Vector3<f64>]) -> f64 {
    row.iter().map(|(local, coefficient)| coefficient.dot(&motion[*local])).sum()
}
