# code crates/untangle/src/predicates/distance/certificate.rs
#   const ERROR: f64 = 32.0 * (0.5 * f64::EPSILON);
#   const UNDERFLOW: f64 = f64::from_bits((1023 - 500) << 52);
#   if length + ERROR * dot(magnitudes, magnitudes).sqrt() + UNDERFLOW < distance * sum * (1.0 - ERROR) {
#   let reach = along - ERROR * (terms[0].abs() + terms[1].abs() + terms[2].abs());
#   let needed = distance * (length + UNDERFLOW) * (1.0 + ERROR) + UNDERFLOW;
#
# Nearer. The point is a sum of up to four products of weights with rounded differences: as a part of the magnitudes, a
# term is off by the difference (d1), the product (d2) and three sums (d3 to d5). The magnitudes share the product and
# have sums of their own (e3 to e5); their length, and that of the point, is the root (r4) of a square of three
# roundings (r1 to r3). The left side: the product with a constant (f1) and two sums (f2, f3). The right side: the sum
# of the weights (s1 to s3), and two products (s4, s5). With T the distance times the exact sum, the comparison says
# length `left` + magnitudes `error` < T. The exact length is at most length `true` + magnitudes `off`.

root = sqrt((1 + r1) * (1 + r2) * (1 + r3)) * (1 + r4);
right = (1 + s1) * (1 + s2) * (1 + s3) * (1 + s4) * (1 + s5) * (1 - 32b-53);
left = (1 + f2) * (1 + f3) / right;
error = 32b-53 * (1 + f1) * (1 + f2) * (1 + f3) / right;
true = 1 / root;
off = ((1 + d3) * (1 + d4) * (1 + d5) - 1 / ((1 + d1) * (1 + d2))) / ((1 + e3) * (1 + e4) * (1 + e5) * root);

# Not nearer. The product of the direction with a difference: its three terms are off by the difference (d1), the
# product (d2) and two sums (d3, d4), as a part of the rounded products, whose sum has two roundings (e3, e4); the
# constant (f1) and the subtraction (f2), of two numbers of at most (1 + 33 u) times that sum, are left to be made good
# for. What is needed: the length, two sums (s1, s5; the second counts UNDERFLOW, which the root needs), and two
# products (s2, s3), with a rounded constant (s4).

reach = 32b-53 * (1 + e3) * (1 + e4) * (1 + f1)
  - ((1 + d3) * (1 + d4) - 1 / ((1 + d1) * (1 + d2))) - 1b-53 * (1 + 40b-53);
needed = root * (1 + s1) * (1 + s2) * (1 + s3) * (1 + s4) * (1 + s5) * (1 + 32b-53);

# Underflow: products of a weight by 2^-1075 each, and a root of squares that do by 2^-536.

{ d1 in [-1b-53, 1b-53] /\ d2 in [-1b-53, 1b-53] /\ d3 in [-1b-53, 1b-53] /\ d4 in [-1b-53, 1b-53]
  /\ d5 in [-1b-53, 1b-53] /\ e3 in [-1b-53, 1b-53] /\ e4 in [-1b-53, 1b-53] /\ e5 in [-1b-53, 1b-53]
  /\ r1 in [-1b-53, 1b-53] /\ r2 in [-1b-53, 1b-53] /\ r3 in [-1b-53, 1b-53] /\ r4 in [-1b-53, 1b-53]
  /\ s1 in [-1b-53, 1b-53] /\ s2 in [-1b-53, 1b-53] /\ s3 in [-1b-53, 1b-53] /\ s4 in [-1b-53, 1b-53]
  /\ s5 in [-1b-53, 1b-53] /\ f1 in [-1b-53, 1b-53] /\ f2 in [-1b-53, 1b-53] /\ f3 in [-1b-53, 1b-53]
  -> left - true >= 0 /\ error - off >= 0 /\ reach >= 0 /\ needed >= 1
     /\ 1b-500 * (1 - 1b-40) - 2b-536 - 64b-1075 >= 0 }
