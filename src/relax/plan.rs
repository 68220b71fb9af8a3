//! Which motions are tried.

use super::{Quality, candidate::Try, goals::Aim};
use crate::settings::InsideChoice;

/// Motions of one iteration stiffen edges that change their length by more than this factor, in the careful kind of motion.
pub(super) const TOLERATED: f64 = 1.08;

/// Which aim is tried first, and which side of a path is taken for its inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    pub(super) aim: Aim,
    pub(super) inside: InsideChoice,
}

/// Where one plan ends stuck, the next begins again from the input.
pub(super) const PLANS: [Plan; 4] = [
    Plan { aim: Aim::Normal, inside: InsideChoice::Work },
    Plan { aim: Aim::Target, inside: InsideChoice::Work },
    Plan { aim: Aim::Normal, inside: InsideChoice::Count },
    Plan { aim: Aim::Target, inside: InsideChoice::Count },
];

/// The motions that are tried; `widen` adds those of the other aims.
pub(super) fn tries(first: Aim, quality: Quality, widen: bool) -> Vec<Try> {
    let others = if first == Aim::Normal { [Aim::Target, Aim::Shorten] } else { [Aim::Normal, Aim::Shorten] };
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
