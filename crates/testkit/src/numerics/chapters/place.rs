//! The same cloth larger, smaller and farther away.

use std::{ops::ControlFlow, sync::Arc};

use untangle::relax::{RelaxSettings, Relaxation, relax};

use crate::numerics::{
    answer::{check_against_brute_force, check_all_responses, default_answer, frame, rounded, sheets},
    case::{Case, Chapter, Effort, Seen, ensure},
};

const SHEETS: u64 = 60;
/// In no special direction, of length 1.
const AWAY: [f64; 3] = [0.600_3, -0.638_1, 0.482_1];

const SAME: &str = "same topology; corrections scale, relative error below 1e-6";
const EXACT: &str = "same topology; corrections scale to the last bit";
const SAME_PLACE: &str = "same topology";
const COMPLETE: &str = "finite, and complete for the positions as they arrived: equal to brute force";

pub(super) fn chapter() -> Chapter {
    let mut cases = vec![
        Case::new("f64, scaled by 2^-40 to 2^40", EXACT, |effort| {
            scaled(effort, (-40..=40).step_by(8).map(|power| 2f64.powi(power)), false, 0.0)
        }),
        Case::new("f64, scaled by 1e-12 to 1e12", SAME, |effort| scaled(effort, decades(), false, 1e-6)),
        Case::new(
            "f32, scaled by 1e-12 to 1e12",
            "same topology; corrections scale, relative error below 1e-2",
            |effort| scaled(effort, decades(), true, 1e-2),
        ),
        Case::new(
            "f64, `relax` of sheets scaled by 2^-40, 2^-20, 2^20 and 2^40",
            "the same iterations; positions scale to the last bit",
            relaxed,
        ),
        Case::new("f64, scaled by 1e-36, 1e-20, 1e20 and 1e36", SAME, |effort| {
            scaled(effort, [1e-36, 1e-20, 1e20, 1e36], false, 1e-6)
        }),
        Case::new(
            "f64, scaled by 1e-74 and 1e74, the ends of what is accepted",
            "finite; at the upper end same topology",
            ends,
        ),
    ];
    for single in [false, true] {
        let decades = (0..=8).map(|power| 10f64.powi(power));
        let mut ratios: Vec<f64> = if single { [3e2].into_iter().chain(decades).collect() } else { decades.collect() };
        ratios.sort_unstable_by(f64::total_cmp);
        for ratio in ratios {
            let promise = if ratio <= largest_ratio(single) { SAME_PLACE } else { COMPLETE };
            let precision = if single { "f32" } else { "f64" };
            let what = format!("{precision}, {ratio:e} sizes away");
            cases.push(Case::new(what, promise, move |effort| moved(effort, ratio, single)));
        }
    }
    Chapter {
        title: "Scale and place",
        text: "Crumpled sheets of 72 to 338 triangles just beyond their first contact, where gaps and depths are \
               smallest. *Same topology*: the same edges pierce the same faces, and the paths have the same types, \
               loop vertices and inside sets. The size is that of the sheet, about 1 m; an edge is 1/6 to 1/13 of \
               it. Differences of corrections are parts of the longest force.\n\n**Where f32 on the wire is the \
               limit**: it rounds a coordinate by up to 6e-8 of the distance from the origin. A gap or a depth \
               below that may close or open, at any distance; the topology stays where all are larger. Those of \
               these sheets are, up to 100 sizes: none changes; the rows beyond say on how many it does. Layers \
               that touch, or nearly, are not, and change at 1 size. A host whose cloth is farther away publishes \
               positions about an origin near the cloth, or in f64, which is enough for 1e8 sizes. What arrives is \
               always taken exactly.",
        cases,
    }
}

/// Up to which distance, in sizes, the topology is promised to stay: where the wire rounds by less than gaps and
/// depths.
const fn largest_ratio(single: bool) -> f64 {
    if single { 1e2 } else { 1e8 }
}

fn decades() -> impl Iterator<Item = f64> + Clone {
    (-12..=12).step_by(3).map(|power| 10f64.powi(power))
}

/// The worst relative difference of corrections over all sheets and scales.
fn scaled(effort: Effort, scales: impl IntoIterator<Item = f64> + Clone, single: bool, tolerance: f64) -> Seen {
    let (mut worst, mut count) = (0.0f64, 0);
    for (seed, sheet) in sheets(effort.choose(9, SHEETS)).iter().enumerate() {
        let mesh = Arc::new(sheet.mesh());
        let expected = default_answer(&mesh, &sheet.positions)?;
        for scale in scales.clone() {
            let positions: Vec<_> = sheet.positions.iter().map(|position| position.map(|x| x * scale)).collect();
            let found = default_answer(&mesh, &if single { rounded(&positions) } else { positions })?;
            ensure(found.is_same_topology(&expected), || {
                format!("sheet {seed} scaled by {scale:e}: another topology")
            })?;
            let apart = found.difference(&expected, scale);
            ensure(apart <= tolerance, || {
                format!("sheet {seed} scaled by {scale:e}: corrections are {apart:e} apart")
            })?;
            worst = worst.max(apart);
            count += 1;
        }
    }
    Ok(format!("same topology {count} times of {count}; corrections at most {worst:.0e} apart"))
}

/// Relaxes the same sheets at several scales.
fn relaxed(effort: Effort) -> Seen {
    let (mut count, mut clean) = (0, 0);
    let settings = RelaxSettings { max_iterations: 10, ..RelaxSettings::default() };
    for (seed, sheet) in sheets(effort.choose(3, 12)).iter().enumerate() {
        let mesh = sheet.mesh();
        let run = |scale: f64| {
            let positions: Vec<_> = sheet.positions.iter().map(|position| position.map(|x| x * scale)).collect();
            relax(&mesh, &positions, &settings, &mut |_| ControlFlow::Continue(())).map_err(|error| error.to_string())
        };
        let expected = run(1.0)?;
        for scale in [-40, -20, 20, 40].map(|power| 2f64.powi(power)) {
            let found = run(scale)?;
            let steps = |end: &Relaxation| -> Vec<_> {
                end.history.iter().map(|step| (step.method, step.num_edge_face_intersections)).collect()
            };
            ensure(steps(&found) == steps(&expected), || {
                format!("sheet {seed} scaled by {scale:e}: other iterations")
            })?;
            let pairs = found.positions.iter().flatten().zip(expected.positions.iter().flatten());
            let is_scaled = pairs.into_iter().all(|(found, expected)| *found == expected * scale);
            ensure(is_scaled, || format!("sheet {seed} scaled by {scale:e}: other positions"))?;
            clean += usize::from(found.blocked.is_empty());
            count += 1;
        }
    }
    Ok(format!("the same {count} times of {count}, {clean} of them clean within 10 iterations"))
}

/// Where squares of squares of lengths are no numbers any more.
fn ends(effort: Effort) -> Seen {
    let (mut same, mut count) = ([0, 0], 0);
    for (seed, sheet) in sheets(effort.choose(9, SHEETS)).iter().enumerate() {
        let mesh = Arc::new(sheet.mesh());
        let expected = default_answer(&mesh, &sheet.positions)?;
        for (end, scale) in [1e-74, 1e74].into_iter().enumerate() {
            let positions: Vec<_> = sheet.positions.iter().map(|position| position.map(|x| x * scale)).collect();
            let is_same = default_answer(&mesh, &positions)?.is_same_topology(&expected);
            check_all_responses(&mesh, &frame(&mesh, &positions)?)?;
            ensure(is_same || end == 0, || format!("sheet {seed} scaled by {scale:e}: another topology"))?;
            same[end] += usize::from(is_same);
        }
        count += 1;
    }
    Ok(format!("same topology {} and {} times of {count}", same[0], same[1]))
}

fn moved(effort: Effort, ratio: f64, single: bool) -> Seen {
    let (mut same, mut count, mut num_pairs) = (0, 0, 0);
    let mut differences = Vec::new();
    for (seed, sheet) in sheets(effort.choose(9, SHEETS)).iter().enumerate() {
        let mesh = Arc::new(sheet.mesh());
        let expected = default_answer(&mesh, &sheet.positions)?;
        let size = size(&sheet.positions);
        let away = |&position: &[f64; 3]| std::array::from_fn(|axis| position[axis] + ratio * size * AWAY[axis]);
        let positions: Vec<[f64; 3]> = sheet.positions.iter().map(away).collect();
        let positions = if single { rounded(&positions) } else { positions };
        let found = default_answer(&mesh, &positions)?;
        check_against_brute_force(&mesh, &frame(&mesh, &positions)?, &found.analysis)?;
        let is_same = found.is_same_topology(&expected);
        ensure(is_same || ratio > largest_ratio(single), || format!("sheet {seed}: another topology"))?;
        if is_same {
            differences.push(found.difference(&expected, 1.0));
        }
        same += usize::from(is_same);
        num_pairs += found.analysis.paths.pairs.len();
        count += 1;
    }
    differences.sort_unstable_by(f64::total_cmp);
    let apart = match differences[..] {
        [] => format!("{num_pairs} pairs of paths in all"),
        [.., worst] => {
            format!("corrections {:.0e} apart (median), {worst:.0e} at worst", differences[differences.len() / 2])
        }
    };
    Ok(format!("same topology {same} times of {count}; {apart}"))
}

/// The largest extent along an axis.
fn size(positions: &[[f64; 3]]) -> f64 {
    let extent = |axis: usize| {
        let along = positions.iter().map(|position| position[axis]);
        along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
    };
    (0..3).map(extent).fold(0.0, f64::max)
}
