# code crates/untangle/src/intersect/bvh/single_map.rs
#   let map = |axis: usize| to_single((position[axis] - centre[axis]) * scale);
# code crates/untangle/src/intersect/bvh/refit.rs
#   pub(crate) const POINT_F32_ERROR: f64 = (0.25 + 1e-6) * f32::EPSILON as f64;
#
# The operations themselves. v is where the map without rounding takes a coordinate: to one half at most where the
# centre is the middle of the frame, and to one where it is rounded to an end of it, as in a frame of a few units in the
# last place.

@double = float<ieee_64, ne>;
@single = float<ieee_32, ne>;

difference = position - centre;
point = single(double(double(difference) * scale));
v = difference * scale;

{ |v| <= 1 /\ @FIX(position, -302) /\ @FIX(centre, -303) /\ @FLT(scale, 53) /\ scale in [1b-252, 1b303]
  /\ |difference| in [1b-303, 1b252]
  -> |point - v| / 1b-23 <= 0.250001 }
