# code crates/untangle/src/intersect/filter/vertex_star.rs
#   const ROUNDING: f64 = 32.0 * (f64::EPSILON / 2.0);
#   from.x * to.y - from.y * to.x - (ROUNDING * (from.max_abs * to.max_abs) + FLOOR)
#   max_abs: 6.0 * max_abs(spoke),
#   clearance_of_turns(&self.projected, closes, turn) / 3.0
#   if area > 0.0 { area / (2.5 * (from.x.abs() + from.y.abs() + to.x.abs() + to.y.abs())) } else { 0.0 }
#
# A spoke is a vector of rounded differences D, seen along two vectors that are taken as they are. Each has coordinates
# of at most 1, 1 and 2, of which the sum of magnitudes is at most 4: M, the bound of a coordinate, is at least 5 max
# |D| (6, rounded), and |x| is at most 4 max |D|. A coordinate is off by `off` of M (a difference, a product, two sums);
# an axis needs none of that but the difference.
#
# Area. Of M M', two coordinates that are off make 2 off + off^2, and u with their product rounded; two products twice
# that. The last difference (d6) turns no sign. The bound: two products (e1, e2), and a sum with the floor (e3).
#
# Clearance. With a, b the lengths as computed, L the sum of the magnitudes of their coordinates, and m = area / 2.5 L:
# a vector that changes by 2 m, and whose length is off by sqrt(2) off M, changes the area by 2 m (a + b + sqrt(2) off
# (M + M')) + 4 m^2. Since area <= a b <= L^2 / 4, and a b / (a + b) <= sqrt(2) M M' / (M + M'), this is at most (2 + 4
# / 10) / 2.5 area + 4 off / 2.5 M M'. It has to be less than what the area is at least: its computed value and what the
# bound has to spare, 32 u less 18 u. `most` is the first part with the roundings of m (f1 to f6: two subtractions, the
# quotient, and the sum and product below it).
#
# Projections. Moved by m, a point moves, seen along (n2, 0, -n0) and its cross product with n, where no coordinate of n
# is above 1 and one is 1, by at most sqrt(2) m and sqrt(6) m (`stretch`, rounded) along each, and a vector by no more
# than the root of the sum of both squares: their matrix has orthogonal rows, so by the larger of the two.

off = (1 + d2) * (1 + d3) * (1 + d4) - 1 / (1 + d1);
area = 2 * (2 * off * (1 + 4b-53) + off * off + 1b-53 * (1 + 9b-53));
bound = 32 * 1b-53 * (1 + e1) * (1 + e2) * (1 + e3) / (1 + d6);
most = (2 + 0.4) / 2.5 * (1 + f1) * (1 + f2) / ((1 + f3) * (1 + f4) * (1 + f5) * (1 + f6));
spare = 32 * 1b-53 * (1 - 8b-53) - area - 4 * off / 2.5 * (1 + 1b-40);
stretch = sqrt(6) * (1 + 8b-53);

{ d1 in [-1b-53, 1b-53] /\ d2 in [-1b-53, 1b-53] /\ d3 in [-1b-53, 1b-53] /\ d4 in [-1b-53, 1b-53]
  /\ d6 in [-1b-53, 1b-53] /\ e1 in [-1b-53, 1b-53] /\ e2 in [-1b-53, 1b-53] /\ e3 in [-1b-53, 1b-53]
  /\ f1 in [-1b-53, 1b-53] /\ f2 in [-1b-53, 1b-53] /\ f3 in [-1b-53, 1b-53] /\ f4 in [-1b-53, 1b-53]
  /\ f5 in [-1b-53, 1b-53] /\ f6 in [-1b-53, 1b-53]
  -> bound - area >= 0 /\ bound + area >= 0 /\ area <= 19b-53 /\ most <= 0.97 /\ spare >= 0 /\ stretch <= 3 }
