# code crates/untangle/src/intersect/exact/directions.rs
#   const ROUNDING: f64 = 1e-14;
#   let room = (b - a).norm_squared() / 4.0 + ROUNDING;
# code crates/checker/src/tree.rs
#   const ROUNDING: f64 = 1e-14;
#   let room = (0..3).map(|axis| (b[axis] - a[axis]).powi(2)).sum::<f64>() / 4.0 + ROUNDING;
#
# A unit vector as computed: the differences of coordinates are off by u of themselves, which turns the vector by 2 u at
# most; then a quotient (q1, in the checker alone), the root (q5) of a square of three roundings (q2 to q4), and a
# quotient (q6): together `off`.

off = 2b-53 * (1 + 2b-53) + (1 + q1) * (1 + q6) / (sqrt((1 + q2) * (1 + q3) * (1 + q4)) * (1 + q5)) - 1;

# Both ends of a chord of length c are off by 8 u, which `off` stays below. So the true c^2 / 4, to which the arc keeps,
# is at most ((c + 16 u)^2) / 4, of which the computed one has six roundings (a difference, which counts twice, a
# square, two sums; a quarter is exact): 6 u of it.

chord = ((c + 16b-53) * (c + 16b-53) - c * c) / 4 + 6b-53 * (c * c / 4) * (1 + 8b-53);

# What the room has to hold beside c^2 / 4: the ends, the chord, the rounding of the room and of the box.

needed = 8b-53 + chord + 1b-53 * (1.01 + 1e-14) + 1b-53 * 2.02;

{ q1 in [-1b-53, 1b-53] /\ q2 in [-1b-53, 1b-53] /\ q3 in [-1b-53, 1b-53] /\ q4 in [-1b-53, 1b-53]
  /\ q5 in [-1b-53, 1b-53] /\ q6 in [-1b-53, 1b-53] /\ c in [0, 2.001]
  -> off <= 8b-53 /\ off >= -8b-53 /\ needed <= 4e-15 }

(c + 16b-53) * (c + 16b-53) - c * c -> 32b-53 * c + 256b-106;
