# code crates/untangle/src/intersect/filter/apart_x8.rs
#   let rounding = simd.mul(simd.splat(ROUNDING * L::ROUNDOFF), simd.dot(magnitudes, max_abs));
#   let gap = simd.sub(reach, simd.add(rounding, simd.splat(L::FLOOR)));
#   let needed = simd.add(simd.mul(margin_squared, simd.dot(axis, axis)), simd.splat(L::FLOOR));
#   simd.gt_zero_mask(simd.min(gap, simd.sub(simd.mul(gap, gap), needed)))
# code crates/untangle/src/intersect/bvh/within_margin.rs
#   let margin = (margin_m * self.scale * (1.0 + 1e-6) + 1e-6) as f32;
#
# About points as they are after the map. The product of an axis with a difference: its three terms are off by the
# difference (d1), the product (d2) and two sums (d3, d4), as a part of the largest rounded differences. The bound has
# three sums (e3 to e5), a product (e2), and a product with a constant (e1). The last subtraction (g) makes the gap
# larger by a part of itself at most.

reach = 16b-24 * (1 + e1) * (1 + e2) * (1 + e3) * (1 + e4) * (1 + e5) - ((1 + d2) * (1 + d3) * (1 + d4) - 1 / (1 + d1));

# What is compared are squares: the gap (g, twice), its square (a1); the margin squared (a2), the axis squared (a3 to
# a5), their product (a6) and a sum (a7). The square of the true gap is at least `kept` times that of the margin and of
# the length of the axis. An axis is what it was computed to be.

kept = (1 + a2) * (1 + a3) * (1 + a4) * (1 + a5) * (1 + a6) * (1 + a7) / ((1 + a1) * (1 + g) * (1 + g));

# The margin is a distance with three roundings (m1 to m3), a sum (m4) and the conversion (m5). Two points of two
# primitives are nearer before the map than after it by twice 0.250001 2^-23 (`single_map.g`) along each of three axes
# at most. Both parts of the margin are enough:

near_g = (1 + 1e-6) * (1 + m1) * (1 + m2) * (1 + m3) * (1 + m4) * (1 + m5);
near_rest = 1e-6 * (1 + m4) * (1 + m5);
moved = 0.500002 * 1b-23;

# What underflows: a few products by 2^-150 each, beside a floor of 1e-30 on either side.

{ d1 in [-1b-24, 1b-24] /\ d2 in [-1b-24, 1b-24] /\ d3 in [-1b-24, 1b-24] /\ d4 in [-1b-24, 1b-24]
  /\ e1 in [-1b-24, 1b-24] /\ e2 in [-1b-24, 1b-24] /\ e3 in [-1b-24, 1b-24] /\ e4 in [-1b-24, 1b-24]
  /\ e5 in [-1b-24, 1b-24] /\ g in [-1b-24, 1b-24] /\ a1 in [-1b-24, 1b-24] /\ a2 in [-1b-24, 1b-24]
  /\ a3 in [-1b-24, 1b-24] /\ a4 in [-1b-24, 1b-24] /\ a5 in [-1b-24, 1b-24] /\ a6 in [-1b-24, 1b-24]
  /\ a7 in [-1b-24, 1b-24] /\ m1 in [-1b-53, 1b-53] /\ m2 in [-1b-53, 1b-53] /\ m3 in [-1b-53, 1b-53]
  /\ m4 in [-1b-53, 1b-53] /\ m5 in [-1b-24, 1b-24]
  -> reach >= 0 /\ near_g * near_g * kept >= 1 /\ near_rest * near_rest * kept - 3 * moved * moved >= 0
     /\ 1e-30 * (1 - 1b-20) >= 16b-150 }
