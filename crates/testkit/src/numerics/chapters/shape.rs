//! Faces like needles, and coordinates like dust.

use std::{collections::BTreeSet, sync::Arc};

use untangle::frame::Frame;

use crate::{
    generate::Sheet,
    judge::{PairSummary, Summary},
    numerics::{
        answer::{check_against_brute_force, check_all_responses, default_answer, frame, sheets},
        case::{Case, Chapter, Effort, Seen, ensure},
    },
};

const SHEETS: u64 = 60;

pub(super) fn chapter() -> Chapter {
    let mut cases = Vec::new();
    for exponent in [7, 14, 20, 27, 34] {
        let ratio = 2f64.powi(exponent);
        cases.push(Case::new(
            format!("sheets pressed flat by 2^-{exponent}, an aspect ratio of {ratio:.0e}"),
            "the same edges pierce the same faces, the same types of paths; with texture coordinates as many vertices \
             inside, the same ones but where both sides have as many; finite",
            move |effort| pressed(effort, ratio.recip()),
        ));
    }
    for ratio in [1e2, 1e4, 1e6, 1e8, 1e10] {
        cases.push(Case::new(
            format!("a sheet of needles, {ratio:e} times as long as wide, through another"),
            "equal to brute force; finite with every response",
            move |_| needles(ratio),
        ));
    }
    cases.push(Case::new(
        "f64 coordinates of 1e-76 to 5e-324",
        "below 2^-250 = 5.5e-76 a coordinate counts as zero; finite with every response",
        |_| dust([1e-76, 1e-80, 1e-160, 1e-308, 1e-320, f64::from_bits(1)]),
    ));
    cases.push(Case::new(
        "f32 sheets scaled into the denormals: 1e-38, 1e-40, 1e-42",
        "taken exactly: same topology while the spacing of 1.4e-45 is small beside the gaps; at any scale equal to \
         brute force and finite",
        f32_denormals,
    ));
    Chapter {
        title: "Aspect ratios and denormals",
        text: "Signs survive any linear map, so pressing a sheet flat changes none, and its charts keep their shape \
               where there are texture coordinates. Only lengths and areas in the world, of which corrections are \
               made, become as thin as the faces.",
        cases,
    }
}

fn pressed(effort: Effort, factor: f64) -> Seen {
    let (mut count, mut condition, mut same) = (0, 1.0f64, [0, 0]);
    for (seed, sheet) in sheets(effort.choose(9, SHEETS)).iter().enumerate() {
        for axis in 0..3 {
            let mut flat = sheet.positions.clone();
            flat.iter_mut().for_each(|position| position[axis] *= factor);
            for with_uvs in [true, false] {
                let mesh = Arc::new(if with_uvs { sheet.mesh() } else { sheet.bare_mesh() });
                let expected = default_answer(&mesh, &sheet.positions)?;
                let found = default_answer(&mesh, &flat)?;
                let what = || format!("sheet {seed} along axis {axis}, texture coordinates {with_uvs}");
                let [is_same, has_same_types, has_as_many] = compared(&found.topology, &expected.topology);
                ensure(has_same_types, || format!("{}: other intersections", what()))?;
                ensure(!with_uvs || has_as_many, || format!("{}: another inside", what()))?;
                // Most of the time of a test, in which each sheet of a size takes another axis.
                if effort == Effort::Full || (seed + seed / 3) % 3 == axis {
                    check_all_responses(&mesh, &frame(&mesh, &flat)?)
                        .map_err(|words| format!("{}: {words}", what()))?;
                }
                condition = condition.max(found.condition());
                same[usize::from(with_uvs)] += usize::from(is_same);
                count += 1;
            }
        }
    }
    Ok(format!(
        "held {count} times; the same inside {} times of {half} with texture coordinates, {} without; condition of \
         fits up to {condition:.0e}",
        same[1],
        same[0],
        half = count / 2
    ))
}

/// Whether all is the same; whether intersections and types of paths are; whether the inside sets are at least as
/// large.
fn compared(found: &Summary, expected: &Summary) -> [bool; 3] {
    let types = |summary: &Summary| {
        let mut types: Vec<_> = summary.pairs.iter().map(|pair| (pair.pair_type, pair.num_segments)).collect();
        types.sort_unstable();
        types
    };
    let sizes = |summary: &Summary| {
        let sizes_of = |pair: &PairSummary| {
            let mut sizes: Vec<_> = pair.inside.iter().map(BTreeSet::len).collect();
            sizes.sort_unstable();
            (pair.pair_type, pair.num_segments, sizes)
        };
        let mut sizes: Vec<_> = summary.pairs.iter().map(sizes_of).collect();
        sizes.sort_unstable();
        sizes
    };
    let same_edges = found.edge_face == expected.edge_face && found.face_pairs == expected.face_pairs;
    [found == expected, same_edges && types(found) == types(expected), sizes(found) == sizes(expected)]
}

/// A sheet whose columns are narrow stands through a level one, whose rows are.
fn needles(ratio: f64) -> Seen {
    let mut sheet = Sheet::default();
    sheet.add_grid([-1.0, 1.0], [0.0, 9.0 / ratio], [3, 8], |x, y| [x, y, 0.013 * x]);
    sheet.add_grid([0.0, 7.0 / ratio], [-0.45, 0.55], [5, 2], |s, z| [0.1 + s, 0.3 * s + 0.7 / ratio, z]);
    let mesh = Arc::new(sheet.mesh());
    let frame = frame(&mesh, &sheet.positions)?;
    let found = default_answer(&mesh, &sheet.positions)?;
    check_against_brute_force(&mesh, &frame, &found.analysis)?;
    let num_segments = check_all_responses(&mesh, &frame)?;
    ensure(num_segments > 0, || "they do not meet".into())?;
    Ok(format!(
        "{num_segments} segments, {} pairs of paths, condition of {} fits up to {:.0e}",
        found.analysis.paths.pairs.len(),
        found.fits.len(),
        found.condition()
    ))
}

fn dust(scales: impl IntoIterator<Item = f64>) -> Seen {
    let sheet = &sheets(3)[2];
    let mesh = Arc::new(sheet.mesh());
    let mut num_zeros = 0;
    for scale in scales {
        let positions: Vec<_> = sheet.positions.iter().map(|position| position.map(|x| x * scale)).collect();
        let frame = frame(&mesh, &positions)?;
        let coordinates = frame.positions().iter().flat_map(|point| point.iter());
        let (mut zeros, mut all) = (0, 0);
        for &coordinate in coordinates {
            ensure(coordinate == 0.0 || coordinate.abs() >= 2f64.powi(-250), || format!("{coordinate:e} was kept"))?;
            zeros += usize::from(coordinate == 0.0);
            all += 1;
        }
        ensure(scale > 1e-79 || zeros == all, || format!("scale {scale:e}: not all are zero"))?;
        check_all_responses(&mesh, &frame)?;
        num_zeros += zeros;
    }
    Ok(format!("{num_zeros} coordinates became zero; all corrections finite"))
}

fn f32_denormals(effort: Effort) -> Seen {
    let mut seen = Vec::new();
    for scale in [1e-38, 1e-40, 1e-42] {
        let (mut same, mut count) = (0, 0);
        for (seed, sheet) in sheets(effort.choose(9, SHEETS)).iter().enumerate() {
            let mesh = Arc::new(sheet.mesh());
            let expected = default_answer(&mesh, &sheet.positions)?;
            let single = sheet.positions.iter().map(|position| position.map(|x| (x * scale) as f32));
            let mut frame = Frame::default();
            frame.set(&mesh, single).map_err(|error| error.to_string())?;
            let positions: Vec<[f64; 3]> = frame.positions().iter().map(|&point| point.into()).collect();
            let found = default_answer(&mesh, &positions)?;
            check_against_brute_force(&mesh, &frame, &found.analysis)?;
            let is_same = found.is_same_topology(&expected);
            ensure(is_same || scale < 1e-39, || format!("sheet {seed} scaled by {scale:e}: another topology"))?;
            same += usize::from(is_same);
            count += 1;
        }
        seen.push(format!("{scale:e}: {same} of {count}"));
    }
    Ok(format!("same topology at {}", seen.join("; at ")))
}
