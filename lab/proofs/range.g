# code crates/untangle/src/frame.rs
#   const LARGEST: f64 = f64::from_bits((1023 + 250) << 52);
#   const SMALLEST: f64 = f64::from_bits((1023 - 250) << 52);
#
# A double of at least 2^-250 is a whole multiple of 2^-302, and zero is one. So are all sums and differences of such,
# rounded or not; products of two are multiples of 2^-604, of three of 2^-906: nothing that a determinant is made of,
# nor any part of an expansion of it, lies below the least normal number 2^-1022 except zero, so nothing underflows. Nor
# does anything reach 2^1023.

@rnd = float<ieee_64, ne>;

u = rnd(x1 - x0); v = rnd(y1 - y0); w = rnd(z1 - z0);
minor = rnd(rnd(u * v) - rnd(u2 * v2));
volume = rnd(minor * w);

{ @FIX(x0, -302) /\ @FIX(x1, -302) /\ @FIX(y0, -302) /\ @FIX(y1, -302) /\ @FIX(z0, -302) /\ @FIX(z1, -302)
  /\ @FIX(u2, -302) /\ @FIX(v2, -302)
  /\ |x0| <= 1b250 /\ |x1| <= 1b250 /\ |y0| <= 1b250 /\ |y1| <= 1b250 /\ |z0| <= 1b250 /\ |z1| <= 1b250
  /\ |u2| <= 1b251 /\ |v2| <= 1b251
  -> @FIX(u * v, -604) /\ @FIX(minor * w, -906) /\ |volume| <= 1b756 }
