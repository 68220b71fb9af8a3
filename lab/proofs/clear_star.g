# code crates/untangle/src/intersect/filter/clear_star.rs
#   let rounding = simd.mul(simd.splat(8.0 * L::ROUNDOFF), simd.add(simd.abs(terms[0]), simd.abs(terms[1])));
#   let area = simd.sub(simd.sub(terms[0], terms[1]), rounding);
#   let rounding = simd.mul(simd.splat(16.0 * L::ROUNDOFF), simd.add(squared, next_squared));
#   let link = simd.add(simd.add(link, rounding), floor);
#   let needed = simd.mul(simd.mul(margin, margin), simd.splat(1.0 + 64.0 * L::ROUNDOFF));
#   let beyond = simd.sub(simd.mul(min_sine, min_height), simd.add(needed, floor));
#   const LEAST_SINE: f64 = 1e-6;
#   let needed = f64::from(margin) * (1.0 + 1e-7);
#
# About points as they are after the map, so that coordinates of a spoke are off by a rounding (d1, d2). A term of an
# area is a product of two (p); as a part of both rounded terms, their difference (q) is off by u, and the bound has two
# products and a sum (e1 to e3). The last difference (g) turns no sign.

area = 8b-24 * (1 + e1) * (1 + e2) * (1 + e3) - ((1 + p) - 1 / ((1 + d1) * (1 + d2))) * (1 + q) - 1b-24 * (1 + p);

# A link of two rounded spokes, of at most r: each coordinate is off by 2 u r, the link by that times the root of two,
# and it is at most 2 r; its square by 4 r 2 root(2) u r and the square of 2 root(2) u r, beside roundings of its own
# that are left to the comparison. The bound has the square of one spoke at least, with three roundings (s1 to s3), two
# sums and two products (e1 to e4).

link = 16b-24 * (1 + s1) * (1 + s2) * (1 + s3) * (1 + e1) * (1 + e2) * (1 + e3) * (1 + e4)
  - (4 * 2 * 1.41422 * 1b-24 + 8b-48);

# The comparison: the area (g) squared (a1), twice. The squares of two spokes, each of rounded coordinates (d1, d1
# again), with three roundings (s1, s2), multiplied (b1) and with the floor (b2); the quotient (b3). The square of a
# link with its difference (l1, squared), a product and three sums (l2 to l5), and the quotient (b4). Both multiplied
# (b5). The margin squared (f1), times a constant (f2, c), and a sum (f3).

sine = (1 + g) * (1 + g) * (1 + a1) * (1 + b3)
  / ((1 - 1b-24) * (1 - 1b-24) * (1 - 1b-24) * (1 - 1b-24) * (1 + s1) * (1 + s1) * (1 + s2) * (1 + s2) * (1 + b1)
    * (1 + b2));
height = (1 + g) * (1 + g) * (1 + a1) * (1 + b4)
  / ((1 + l1) * (1 + l1) * (1 + l2) * (1 + l3) * (1 + l4) * (1 + l5));
kept = (1 + 64b-24) * (1 + c) * (1 + f1) * (1 + f2) * (1 + f3) / (sine * height * (1 + b5));

# In double precision: spokes along two directions, sums of three terms, are off by some 16 u of their length, and areas
# by 40 u of both; with a sine of 1e-6 that is 1e-8 of the area. Squares and quotients add 40 u.

double = (1 + 1e-7) * (1 - 40b-53 * 1e6) * (1 - 40b-53 * 1e6) * (1 - 40b-53);

{ d1 in [-1b-24, 1b-24] /\ d2 in [-1b-24, 1b-24] /\ p in [-1b-24, 1b-24] /\ q in [-1b-24, 1b-24]
  /\ e1 in [-1b-24, 1b-24] /\ e2 in [-1b-24, 1b-24] /\ e3 in [-1b-24, 1b-24] /\ e4 in [-1b-24, 1b-24]
  /\ g in [-1b-24, 1b-24] /\ c in [-1b-24, 1b-24] /\ a1 in [-1b-24, 1b-24] /\ b1 in [-1b-24, 1b-24]
  /\ b2 in [-1b-24, 1b-24] /\ b3 in [-1b-24, 1b-24] /\ b4 in [-1b-24, 1b-24] /\ b5 in [-1b-24, 1b-24]
  /\ s1 in [-1b-24, 1b-24] /\ s2 in [-1b-24, 1b-24] /\ s3 in [-1b-24, 1b-24] /\ l1 in [-1b-24, 1b-24]
  /\ l2 in [-1b-24, 1b-24] /\ l3 in [-1b-24, 1b-24] /\ l4 in [-1b-24, 1b-24] /\ l5 in [-1b-24, 1b-24]
  /\ f1 in [-1b-24, 1b-24] /\ f2 in [-1b-24, 1b-24] /\ f3 in [-1b-24, 1b-24]
  -> area >= 0 /\ link >= 0 /\ kept >= 1 /\ double >= 1 }
