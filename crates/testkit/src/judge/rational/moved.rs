//! The sign of four moved points.

use std::{cmp::Ordering, collections::BTreeMap};

use super::number::{Fraction, Point, minus};

/// A polynomial in the size of the move: coefficients by exponent.
type Polynomial = BTreeMap<u128, Fraction>;

/// Most vertices whose moves have exponents that fit.
pub(super) const MAX_VERTICES: usize = 128 / 3;

/// Rule 2: the exponent by which a vertex moves along x, y or z.
fn exponent(vertex: u32, axis: usize) -> u128 {
    1 << (3 * vertex + [2, 1, 0][axis])
}

/// Rule 3: whether the sign of four different vertices is positive.
pub(super) fn is_positive(points: &[Point], [a, b, c, d]: [u32; 4]) -> bool {
    let at = |vertex: u32| &points[vertex as usize];
    let still = [b, c, d].map(|vertex| minus(at(vertex), at(a)));
    let term = |row: usize, column: usize| still[row][column].clone();
    let constant = determinant(term, |x, y| x * y, |x, y| x + y, |x, y| x - y);
    match constant.cmp(&Fraction::ZERO) {
        Ordering::Greater => true,
        Ordering::Less => false,
        Ordering::Equal => {
            let moved = |row: usize, column: usize| {
                let to = [b, c, d][row];
                Polynomial::from([
                    (0, still[row][column].clone()),
                    (exponent(to, column), Fraction::ONE),
                    (exponent(a, column), Fraction::NEG_ONE),
                ])
            };
            let all = determinant(moved, |x, y| product(&x, &y), |x, y| sum(x, &y, true), |x, y| sum(x, &y, false));
            // Ascending.
            let first = all.into_values().find(|coefficient| *coefficient != Fraction::ZERO);
            first.expect("some coefficient is a constant other than zero") > Fraction::ZERO
        }
    }
}

/// The determinant of three rows, expanded along the first.
fn determinant<T>(
    entry: impl Fn(usize, usize) -> T,
    times: impl Fn(T, T) -> T,
    plus: impl Fn(T, T) -> T,
    less: impl Fn(T, T) -> T,
) -> T {
    let minor = |j: usize, k: usize| less(times(entry(1, j), entry(2, k)), times(entry(1, k), entry(2, j)));
    let [first, second, third] =
        [(0, 1, 2), (1, 2, 0), (2, 0, 1)].map(|(column, j, k)| times(entry(0, column), minor(j, k)));
    plus(plus(first, second), third)
}

fn product(a: &Polynomial, b: &Polynomial) -> Polynomial {
    let mut product = Polynomial::new();
    for (first, x) in a {
        for (second, y) in b {
            // Each power of two once: no vertex meets the same coordinate of itself in one term of a determinant.
            *product.entry(first + second).or_insert(Fraction::ZERO) += x * y;
        }
    }
    product
}

fn sum(mut a: Polynomial, b: &Polynomial, is_plus: bool) -> Polynomial {
    for (exponent, value) in b {
        let coefficient = a.entry(*exponent).or_insert(Fraction::ZERO);
        *coefficient += if is_plus { value.clone() } else { -value.clone() };
    }
    a
}
