//! Constraints in the numbers of a domain, for the solver's inner loops.

use std::ops::Range;

use nalgebra::Vector3;

use super::rows::Constraints;
use crate::{mesh::VertexId, relax::energy::Domain};

/// Constraints on the displacements of a domain.
#[derive(Debug, Default)]
pub(crate) struct LocalConstraints {
    ends: Vec<usize>,
    terms: Vec<(usize, Vector3<f64>)>,
    wanted_m: Vec<f64>,
    /// Where the terms of each active row are, and its right-hand side: a few of many.
    active: Vec<(Range<usize>, f64)>,
}

impl LocalConstraints {
    /// Takes over constraints; terms of vertices that must not move are left out.
    pub(crate) fn set(&mut self, constraints: &Constraints, domain: &Domain) {
        self.ends.clear();
        self.terms.clear();
        self.wanted_m.clear();
        for index in 0..constraints.len() {
            let here = |&(vertex, coefficient): &(VertexId, Vector3<f64>)| Some((domain.local(vertex)?, coefficient));
            self.terms.extend(constraints.row(index).iter().filter_map(here));
            self.ends.push(self.terms.len());
            self.wanted_m.push(constraints.wanted_m(index));
        }
    }

    /// Takes the rows that a displacement does not satisfy as the active ones.
    pub(crate) fn activate(&mut self, displacement: &[Vector3<f64>]) {
        self.active.clear();
        let mut start = 0;
        for (&end, &wanted_m) in self.ends.iter().zip(&self.wanted_m) {
            if row_value(&self.terms[start..end], displacement) < wanted_m {
                self.active.push((start..end, wanted_m));
            }
            start = end;
        }
    }

    /// Terms and right-hand side of each active row.
    pub(crate) fn active_rows(&self) -> impl Iterator<Item = (&[(usize, Vector3<f64>)], f64)> {
        self.active.iter().map(|(terms, wanted_m)| (&self.terms[terms.clone()], *wanted_m))
    }
}

/// The left-hand side of a row.
pub(crate) fn row_value(row: &[(usize, Vector3<f64>)], displacement: &[Vector3<f64>]) -> f64 {
    row.iter().map(|(local, coefficient)| coefficient.dot(&displacement[*local])).sum()
}
