# code crates/untangle/src/intersect/filter/separating_axis_x4.rs
#   let gap_m = simd.mul(simd.div(gap, simd.sqrt(square)), simd.splat(1.0 - 1e-14));
#   let gap_m = simd.select(gap, simd.select(simd.sub(square, simd.splat(1e-280)), gap_m, zero), zero);
#
# A gap along an axis is less than the true one by the bound of `separating_axis.g`, which is 16 u of S where 8 u are
# needed. What is left, more than 6 u of S, has to make good for the rounding of the two subtractions, by u of no more
# than 2 S each. The rest is relative: the square of the axis' length (q1 to q3), the root (q4), the quotient (q5), the
# product (q6) and its constant (q7). Squares above 1e-280 have no part of them underflow by more than 2^-1075, a part
# of 2^-140 (q8).
#
# So the product with the length is at most the gap. Parts of the true length and gap:

length = sqrt((1 + q1) * (1 + q2) * (1 + q3) * (1 + q8)) * (1 + q4);
gap = (1 - 1e-14) * (1 + q5) * (1 + q6) * (1 + q7) / length;
slack = 16 * 1b-53 * (1 - 6b-53) - 8b-53 * (1 + 8b-53) - 2 * 2b-53 * (1 + 2b-53);

{ q1 in [-1b-53, 1b-53] /\ q2 in [-1b-53, 1b-53] /\ q3 in [-1b-53, 1b-53] /\ q4 in [-1b-53, 1b-53]
  /\ q5 in [-1b-53, 1b-53] /\ q6 in [-1b-53, 1b-53] /\ q7 in [-1b-53, 1b-53] /\ q8 in [-1b-140, 1b-140]
  -> gap <= 1 /\ slack >= 0 /\ 3b-1075 / 1e-280 <= 1b-140 }
