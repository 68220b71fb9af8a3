# code crates/untangle/src/intersect/filter/vertex_star_x8.rs
#   let off = simd.add(simd.splat(2.0 * POINT_F32_ERROR), simd.mul(simd.splat(L::ROUNDOFF), max_abs));
#   let off = simd.mul(off, simd.add(simd.mul(simd.splat(5.0), max_abs), simd.mul(simd.splat(3.0), off)));
#   let rounding = simd.mul(simd.splat(8.0 * L::ROUNDOFF), simd.mul(max_abs, max_abs));
#   simd.add(simd.add(off, rounding), simd.splat(L::FLOOR))
#
# Coordinates of a spoke, at most r as computed, are off by d = 2 m + u r: two maps (`single_map.g`) and one difference,
# by a part of its rounded value. An area of two spokes is off by 4 r d + 2 d^2, and by the rounding of two products, 2
# u r^2; the last difference (g) turns no sign, nor does that of the bound.
#
# The bound as it is computed: the constant (c), a product with a power of two, a sum (a1); two products and a sum (a2
# to a4), a product (a5), and two sums (a6, a7). All terms are positive: what has to hold is that each has enough of r
# d, of d^2, and of u r^2. What underflows is less than the floor: eight products by 2^-150 each.

off = (1 + c) * (1 + a1);
first = 5 * off * (1 + a2) * (1 + a4) * (1 + a5) * (1 + a6) * (1 + a7) / (1 + g);
second = 3 * off * off * (1 + a3) * (1 + a4) * (1 + a5) * (1 + a6) * (1 + a7) / (1 + g);
third = 8 * (1 + a2) * (1 + a3) * (1 + a6) * (1 + a7) / (1 + g);

{ c in [-1b-24, 1b-24] /\ a1 in [-1b-24, 1b-24] /\ a2 in [-1b-24, 1b-24] /\ a3 in [-1b-24, 1b-24]
  /\ a4 in [-1b-24, 1b-24] /\ a5 in [-1b-24, 1b-24] /\ a6 in [-1b-24, 1b-24] /\ a7 in [-1b-24, 1b-24]
  /\ g in [-1b-24, 1b-24]
  -> first >= 4 /\ second >= 2 /\ third >= 2 /\ 1e-30 * (1 - 1b-20) >= 8b-150 }
