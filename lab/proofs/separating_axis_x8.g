# code crates/untangle/src/intersect/filter/separating_axis_x8.rs
#   *max_abs = simd.add(*max_abs, simd.splat(5.0 * POINT_F32_ERROR / (ROUNDING * L::ROUNDOFF)));
#
# What single precision adds to `separating_axis.g`. Coordinates are off by m = POINT_F32_ERROR at most
# (`single_map.g`), and a projection of one point minus that of another by 2 m of the sum of |m|, whatever origin both
# are taken from. The bound has 16 u (5 m / 16 u) of it: a constant in single precision (c), a sum (e0), and the
# roundings of `separating_axis.g`. Relative to m:

bound = 5 * (1 + c) * (1 + e0) * (1 + e1) * (1 + e2) * (1 + e3) * (1 + e4) * (1 + e5) / (1 + d5);

{ c in [-1b-24, 1b-24] /\ e0 in [-1b-24, 1b-24] /\ e1 in [-1b-24, 1b-24] /\ e2 in [-1b-24, 1b-24]
  /\ e3 in [-1b-24, 1b-24] /\ e4 in [-1b-24, 1b-24] /\ e5 in [-1b-24, 1b-24] /\ d5 in [-1b-24, 1b-24]
  -> bound >= 2 }
