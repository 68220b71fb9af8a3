# code crates/untangle/src/intersect/filter/separating_axis.rs
#   pub(super) const ROUNDING: f64 = 16.0;
#   let rounding = simd.mul(simd.splat(ROUNDING * L::ROUNDOFF), simd.dot(magnitudes, max_abs));
#   simd.sub(gap, simd.add(rounding, simd.splat(L::FLOOR)))
# code crates/untangle/src/simd/lanes.rs
#   self.add(self.add(self.mul(a[0], b[0]), self.mul(a[1], b[1])), self.mul(a[2], b[2]))
# code crates/untangle/src/simd/portable.rs
#   pub(super) const F64_FLOOR: f64 = 1e-290;
#   pub(super) const F32_FLOOR: f64 = 1e-30;
#
# The axis is taken as it is. A projection is a sum of three products m D of its coordinates with rounded differences.
# As a part of the sum S of |m| max |D|, each product is off by the difference (d1), and by the product and two sums (d2
# to d4). The gap is a difference of two projections, and its last rounding (d5) turns no sign. The bound is made of
# three products and two sums (e1 to e3), of a product with an exact constant (e4), and of a sum with the floor (e5);
# the subtraction of the bound turns no sign. With u = 2^-53, and with 2^-24, which is worse.
#
# Underflow: each of the six products is off by half the least number at most, 2^-1075 and 2^-150; of the bound three
# products, and the one with the constant.

off = (1 + d2) * (1 + d3) * (1 + d4) - 1 / (1 + d1);
bound = 16 * 1b-24 * (1 + e1) * (1 + e2) * (1 + e3) * (1 + e4) * (1 + e5) / (1 + d5);
floor_64 = 1e-290 * (1 + e5);
floor_32 = 1e-30 * (1 - 1b-20);

{ d1 in [-1b-24, 1b-24] /\ d2 in [-1b-24, 1b-24] /\ d3 in [-1b-24, 1b-24] /\ d4 in [-1b-24, 1b-24]
  /\ d5 in [-1b-24, 1b-24] /\ e1 in [-1b-24, 1b-24] /\ e2 in [-1b-24, 1b-24] /\ e3 in [-1b-24, 1b-24]
  /\ e4 in [-1b-24, 1b-24] /\ e5 in [-1b-24, 1b-24]
  -> bound - 2 * off >= 0 /\ bound + 2 * off >= 0 /\ floor_64 >= 16b-1075 /\ floor_32 >= 16b-150 }
