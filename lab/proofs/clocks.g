# code crates/untangle/src/intersect/cache/displacements.rs
#   pub(super) const ROUNDING: f64 = 1e-15;
#   square.sqrt() * (1.0 + ROUNDING) + ROUNDING * self.longest_total_m + 1e-150
#   let relative = moved - translation;
#   *square = relative.dot(&relative);
# code crates/untangle/src/intersect/cache/clocks.rs
#   *time_m = (*time_m + displacements.bound_m(longest)) * (1.0 + ROUNDING);
# code crates/untangle/src/intersect/cache/certificates.rs
#   if clearance_m > 0.0 { (now_m + clearance_m) * (1.0 - ROUNDING) } else { TOUCHING }
#   a + b
#
# Displacement. The rounded difference of two positions is off by u of itself, and so is that of it and the translation:
# the true length is at most the computed one with a rounding (d1), and u of the length of the whole displacement. The
# computed length is the root of a square of three roundings (d2 to d4), and the root rounds (d5); the bound adds 1e-15,
# rounded (d6), and is a product (d7) and two sums (d8, d9). The whole displacement is no longer than the sum of its
# three magnitudes, two sums (d2, d3 again), of rounded differences (d1). Squares that underflow are those of lengths
# below 2^-536: 1e-150 and its rounding is more.

length = (1 + 1e-15) * (1 + d6) * (1 + d7) * (1 + d8) * (1 + d9) * (1 + d5)
  * sqrt((1 + d2) * (1 + d3) * (1 + d4)) - 1 / (1 + d1);
whole = 1e-15 * (1 + d6) * (1 + d7) * (1 + d8) * (1 + d9) * (1 + d2) * (1 + d3) * (1 + d1) - 1b-53;

# Clock. A clock t that advances by s shows at least t + s: a sum (e1) and a product (e3) with a rounded constant (e2).

clock = (1 + e1) * (1 + 1e-15) * (1 + e2) * (1 + e3) - 1;

# Expiry. A certificate is issued at a + b, rounded (i1), with a clearance c: it expires at (a + b + c) (1 - 1e-15),
# with a sum (i2), a product (i4) and a rounded constant (i3). It holds as long as a' + b', rounded (i5), is below that.
# Then the true sum is below (a + b) `shown` + c `cleared`: no more than a + b + c.

shown = 1 - (1 + i1) * (1 + i2) * (1 - 1e-15) * (1 + i3) * (1 + i4) / (1 + i5);
cleared = 1 - (1 + i2) * (1 - 1e-15) * (1 + i3) * (1 + i4) / (1 + i5);

{ d1 in [-1b-53, 1b-53] /\ d2 in [-1b-53, 1b-53] /\ d3 in [-1b-53, 1b-53] /\ d4 in [-1b-53, 1b-53]
  /\ d5 in [-1b-53, 1b-53] /\ d6 in [-1b-53, 1b-53] /\ d7 in [-1b-53, 1b-53] /\ d8 in [-1b-53, 1b-53]
  /\ d9 in [-1b-53, 1b-53] /\ e1 in [-1b-53, 1b-53] /\ e2 in [-1b-53, 1b-53] /\ e3 in [-1b-53, 1b-53]
  /\ i1 in [-1b-53, 1b-53] /\ i2 in [-1b-53, 1b-53] /\ i3 in [-1b-53, 1b-53] /\ i4 in [-1b-53, 1b-53]
  /\ i5 in [-1b-53, 1b-53]
  -> length >= 0 /\ whole >= 0 /\ clock >= 0 /\ shown >= 0 /\ cleared >= 0 /\ 1e-150 * (1 - 1b-50) >= 1b-536 }
