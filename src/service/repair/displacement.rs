//! Displacements in the precision of the host, and the positions that it has after adding them.

use untangled_proto::Precision;

/// The displacement from `from` to `to` as the host's precision holds it, and the coordinate that the host has after
/// adding it. That is `to` wherever a displacement leads there: a large coordinate plus a coarse displacement may not
/// reach a small one.
pub(super) fn step(precision: Precision, from: f64, to: f64) -> (f64, f64) {
    match precision {
        Precision::F32 => step_f32(from, to),
        Precision::F64 => {
            let candidates = [to - from, (to - from).next_up(), (to - from).next_down()];
            nearest(to, candidates.map(|step| (step, from + step)))
        }
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounding as the host rounds is the purpose")]
fn step_f32(from: f64, to: f64) -> (f64, f64) {
    let rounded = (to - from) as f32;
    let candidates = [rounded, rounded.next_up(), rounded.next_down()];
    nearest(to, candidates.map(|step| (step.into(), (from as f32 + step).into())))
}

/// The first of the candidates, a displacement and where it leads, that is nearest to the goal.
fn nearest(to: f64, candidates: [(f64, f64); 3]) -> (f64, f64) {
    let [mut best, others @ ..] = candidates;
    for candidate in others {
        if (candidate.1 - to).abs() < (best.1 - to).abs() {
            best = candidate;
        }
    }
    best
}

#[cfg(test)]
#[expect(clippy::float_cmp, clippy::cast_possible_truncation, reason = "bits are what is asked for")]
mod tests {
    use super::*;

    #[test]
    fn step_of_either_precision_leads_to_the_bits_that_the_host_computes() {
        let values = [0.0f32, 1e-30, 1e-8, 0.1, 0.3, 1.0, 1.5, 77.7, -0.1, -1e-8, -12345.678];
        for from in values {
            for to in values {
                let (step32, reached) = step(Precision::F32, from.into(), to.into());
                assert_eq!(f64::from(step32 as f32), step32, "{from} to {to}: a step that single precision holds");
                assert_eq!(f64::from(from + step32 as f32), reached, "{from} to {to}");
                assert!((reached - f64::from(to)).abs() <= f64::from(from.abs().max(to.abs())) * 1.2e-7);
                let (from, to) = (f64::from(from) / 3.0, f64::from(to) / 7.0);
                let (step64, reached) = step(Precision::F64, from, to);
                assert_eq!(from + step64, reached, "{from} to {to}");
            }
        }
        // Where sums of neighbours round apart, the step next to the rounded difference may be the one that arrives.
        assert_eq!(step(Precision::F32, 0.25, 0.25), (0.0, 0.25));
    }
}
