//! Which motions are tried.

use super::{Quality, candidate::Try, goals::Aim};

/// Motions of one iteration stiffen edges that change their length by more than this factor, in the careful kind of motion.
pub(super) const TOLERATED: f64 = 1.08;

/// Which aim is tried first. Where one order ends stuck, the next begins again from the input.
#[derive(Clone, Copy, Debug)]
pub(super) enum Plan {
    NormalFirst,
    TargetFirst,
}

pub(super) const PLANS: [Plan; 2] = [Plan::NormalFirst, Plan::TargetFirst];

/// The motions that are tried; `widen` adds those of the other aims.
pub(super) fn tries(plan: Plan, quality: Quality, widen: bool) -> Vec<Try> {
    let (first, others) = match plan {
        Plan::NormalFirst => (Aim::Normal, [Aim::Target, Aim::Shorten]),
        Plan::TargetFirst => (Aim::Target, [Aim::Normal, Aim::Shorten]),
    };
    let stiffnesses: &[f64] = if quality == Quality::Fast { &[16.0] } else { &[1.0, 16.0, 256.0] };
    let mut tries = Vec::new();
    for &stiffness in stiffnesses {
        for tolerated in [f64::INFINITY, TOLERATED] {
            tries.push(Try { aim: first, stiffness, tolerated });
        }
    }
    if widen {
        for stiffness in [1.0, 16.0, 256.0] {
            for aim in others {
                tries.push(Try { aim, stiffness, tolerated: f64::INFINITY });
                if quality == Quality::Accurate {
                    tries.push(Try { aim, stiffness, tolerated: TOLERATED });
                }
            }
        }
    }
    tries
}
