# code crates/untangle/src/intersect/bvh/within_margin.rs
#   let margin = (margin_m * self.scale * (1.0 + 1e-6) + 1e-6) as f32;
#   f64::from(margin) - f64::from(largest) * 4e-7 - 1e-37
# code crates/untangle/src/intersect/bvh/aabb.rs
#   pub(crate) const FAR_ROUNDING: f32 = 4.0 * f32::EPSILON;
#   boxes.min[axis][slot] -= margin;
#   boxes.min[axis][slot] = (low - (margin + FAR_ROUNDING * low.abs())).max(f32::MIN);
#
# Boxes that are truly no farther apart than g, in the unit of the map, have to overlap once one of them is grown.
#
# Near vertices. Of the two ends that face each other, low and high as mapped, each is off by 0.250001 2^-23
# (`single_map.g`) and at most 1. So low - high <= g + 0.500002 2^-23. The margin is g with three roundings (d1 to d3:
# the two products, and the constant), a sum (d4) and the conversion (d5); low less the margin is rounded by 2^-24 of 1
# + margin at most. What the margin has of g, and beside it, is enough if neither of these is negative:

near_g = (1 + 1e-6) * (1 + d1) * (1 + d2) * (1 + d3) * (1 + d4) * (1 + d5) * (1 - 1b-24) - 1;
near_rest = 1e-6 * (1 + d4) * (1 + d5) * (1 - 1b-24) - 1b-24 - 0.500002 * 1b-23;

# Far vertices. An end x is off by v |x| beside that, v = 2^-24 and two roundings in double precision. With t = low -
# high > 0 and |high| <= |low| + t: t (1 - v) <= g + 2 v |low| + the same rest. The end is grown by the margin and by 8
# u |low|, with two roundings of single precision (f1, f2), and their difference is rounded by 2^-24 of all three.

far_g = (1 + 1e-6) * (1 + d1) * (1 + d2) * (1 + d3) * (1 + d4) * (1 + d5) * (1 + f2) * (1 - 1b-24) - 1 / (1 - v);
far_low = 8b-24 * (1 + f1) * (1 + f2) * (1 - 1b-24) - 1b-24 - 2 * v / (1 - v);
far_rest = 1e-6 * (1 + d4) * (1 + d5) * (1 + f2) * (1 - 1b-24) - 0.500002 * 1b-23 / (1 - v);

# Distance of what does not overlap. Relative to a corner, coordinates are off by v of themselves. A low end less the
# margin that is above a high end, rounded by u: their distance is the margin at least, but for (u + 2 v) of the largest
# magnitude and the margin together, which is computed with a rounding (h1). The rest is in double precision (k1 to k3).

beyond = 4e-7 * (1 + h1) * (1 + k1) * (1 + k2) * (1 + k3) - 1b-24 - 2 * v - 4b-53;

{ d1 in [-1b-53, 1b-53] /\ d2 in [-1b-53, 1b-53] /\ d3 in [-1b-53, 1b-53] /\ d4 in [-1b-53, 1b-53]
  /\ d5 in [-1b-24, 1b-24] /\ f1 in [-1b-24, 1b-24] /\ f2 in [-1b-24, 1b-24] /\ h1 in [-1b-24, 1b-24]
  /\ k1 in [-1b-53, 1b-53] /\ k2 in [-1b-53, 1b-53] /\ k3 in [-1b-53, 1b-53] /\ v in [1b-24, 17b-28]
  -> near_g >= 0 /\ near_rest >= 0 /\ far_g >= 0 /\ far_low >= 0 /\ far_rest >= 0 /\ beyond >= 0 }
