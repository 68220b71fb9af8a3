//! Very many of one thing: segments of a path, paths of a frame, chains in a vertex.

use std::{collections::BTreeMap, sync::Arc};

use untangle::{
    frame::Frame,
    mesh::Mesh,
    paths::{PairType, SurfacePoint},
};

use crate::{
    generate::{Sheet, fan},
    judge::rules,
    numerics::{
        answer::{Answer, check_all_responses, default_answer, frame},
        case::{Case, Chapter, Effort, Seen, ensure},
    },
};

/// Faces round the vertex for each chain.
const SECTORS: u32 = 12;

pub(super) fn chapter() -> Chapter {
    let cases = vec![
        Case::new(
            "100,000 segments on one path",
            "one pair of paths with all of them; finite with every response",
            long,
        ),
        Case::new(
            "10,000 paths",
            "as many pairs of closed paths, each with its one vertex inside; finite with every response",
            many,
        ),
        Case::new(
            "200 chains in one loop vertex",
            "joined two by two into 100 CROSS, none twice; finite with every response",
            |effort| chains(effort.choose(20, 200)),
        ),
        Case::new("201 chains in one loop vertex", "the same, and the odd one folds back as BLI", |effort| {
            chains(effort.choose(21, 201))
        }),
    ];
    Chapter {
        title: "Numbers of things",
        text: "How long these take is not promised here. Time is linear, up to a logarithm, in faces and segments \
               (`docs/results/speed.md`), but for fits, which are cubic in their centres and limited by `max_centres`, \
               and for faces round one vertex, which are compared in pairs.",
        cases,
    }
}

/// A long strip that stands through another.
fn long(effort: Effort) -> Seen {
    let cells = effort.choose(500, 25_000);
    let mut sheet = Sheet::default();
    let length = f64::from(cells);
    sheet.add_grid([0.0, length], [-1.5, 1.5], [cells, 3], |x, y| [x, y, 0.01 * (0.1 * x).sin()]);
    sheet.add_grid([0.37, length - 0.41], [-1.4, 0.6], [cells, 2], |x, z| [x, 0.1 + 0.03 * z, z]);
    let (mesh, frame, answer) = solved(&sheet)?;
    let pairs = &answer.analysis.paths.pairs;
    let most = pairs.iter().map(|pair| pair.num_segments).max().unwrap_or(0);
    ensure(pairs.len() == 1 && most as f64 >= 3.99 * length, || format!("{} pairs, {most} segments", pairs.len()))?;
    check_all_responses(&mesh, &frame)?;
    Ok(format!("{most} segments on one {} pair, condition {:.0e}", pairs[0].pair_type.name(), answer.condition()))
}

/// A sheet of which every other vertex dips into a level one.
fn many(effort: Effort) -> Seen {
    let side = effort.choose(16, 100);
    let cells = 2 * side;
    let mut sheet = Sheet::default();
    let size = f64::from(cells);
    let is_odd = |x: f64| (x / 2.0).fract() > 0.25;
    sheet.add_grid([0.0, size], [0.0, size], [cells, cells], |x, y| {
        [x, y, if is_odd(x) && is_odd(y) { -0.35 } else { 0.5 }]
    });
    sheet.add_grid([-0.77, size + 0.71], [-0.73, size + 0.79], [cells / 2, cells / 2], |x, y| [x, y, 0.001 * x / size]);
    let (mesh, frame, answer) = solved(&sheet)?;
    let Answer { analysis, topology, .. } = &answer;
    let wanted = (side * side) as usize;
    let of_type = topology.pairs.iter().filter(|pair| pair.pair_type == PairType::Closed);
    let dips = of_type.filter(|pair| pair.inside.iter().any(|inside| inside.len() == 1)).count();
    ensure(dips == wanted && analysis.paths.pairs.len() == wanted, || {
        format!("{} pairs, {dips} of them of one vertex, of {wanted}", analysis.paths.pairs.len())
    })?;
    check_all_responses(&mesh, &frame)?;
    Ok(format!(
        "{dips} pairs with {} segments; {} fits, condition up to {:.0e}",
        analysis.intersections.segments.len(),
        answer.fits.len(),
        answer.condition()
    ))
}

fn chains(count: u32) -> Seen {
    let sheet = fan(count, SECTORS * count);
    let (mesh, frame, answer) = solved(&sheet)?;
    let paths = &answer.analysis.paths;
    let mut types: BTreeMap<PairType, usize> = BTreeMap::new();
    for pair in &paths.pairs {
        *types.entry(pair.pair_type).or_default() += 1;
    }
    let mut expected = BTreeMap::from([(PairType::Cross, count as usize / 2)]);
    if count % 2 == 1 {
        expected.insert(PairType::BoundaryLoopInside, 1);
    }
    ensure(types == expected, || format!("{types:?}"))?;
    let passes = paths.points.iter().filter(|point| matches!(point.own, SurfacePoint::Vertex(_))).count();
    ensure(passes == count as usize, || format!("{passes} passes through the vertex"))?;
    check_all_responses(&mesh, &frame)?;
    Ok(format!("{types:?}, {} faces round the vertex", SECTORS * count))
}

fn solved(sheet: &Sheet) -> Result<(Arc<Mesh>, Frame, Answer), String> {
    let mesh = Arc::new(sheet.mesh());
    let frame = frame(&mesh, &sheet.positions)?;
    let answer = default_answer(&mesh, &sheet.positions)?;
    let size = sheet.positions.iter().flatten().fold(1.0, |size: f64, x| size.max(x.abs()));
    rules::check_paths(&mesh, &frame, &answer.analysis, size);
    Ok((mesh, frame, answer))
}
