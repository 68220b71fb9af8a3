# code crates/untangle/src/predicates/plane.rs
#   const ROUNDING: f64 = (7.0 + 56.0 * UNIT) * UNIT;
#   let volume = away[0] * self.minors[0] + away[1] * self.minors[1] + away[2] * self.minors[2];
#   let bound = ROUNDING * (x * self.magnitudes[0] + y * self.magnitudes[1] + z * self.magnitudes[2]);
#
# The volume is a sum of six products +-a u v of differences. Let P be the rounded product u v of rounded differences,
# and a the third one as rounded. Of the exact product, P a is off by the three differences and the product (d1 to d4);
# of the computed one, without the last sum, by the difference of the minor, the product and the first sum (d5 to d7).
# The last sum (d8) turns no sign: with it the volume exceeds the bound, hence without it the bound over 1 + d8. The
# bound is made of the same P, with roundings of its own: a sum, a product, two sums, and the product with the constant
# (e1 to e5), which is a double itself.
#
# So what each product is off by, as a part of |P a|, has to be at most what the bound has of it.

off = (1 + d5) * (1 + d6) * (1 + d7) - 1 / ((1 + d1) * (1 + d2) * (1 + d3) * (1 + d4));
bound = (7 + 56 * 1b-53) * 1b-53 * (1 + e1) * (1 + e2) * (1 + e3) * (1 + e4) * (1 + e5) / (1 + d8);

{ d1 in [-1b-53, 1b-53] /\ d2 in [-1b-53, 1b-53] /\ d3 in [-1b-53, 1b-53] /\ d4 in [-1b-53, 1b-53]
  /\ d5 in [-1b-53, 1b-53] /\ d6 in [-1b-53, 1b-53] /\ d7 in [-1b-53, 1b-53] /\ d8 in [-1b-53, 1b-53]
  /\ e1 in [-1b-53, 1b-53] /\ e2 in [-1b-53, 1b-53] /\ e3 in [-1b-53, 1b-53] /\ e4 in [-1b-53, 1b-53]
  /\ e5 in [-1b-53, 1b-53]
  -> bound - off >= 0 /\ bound + off >= 0 }
