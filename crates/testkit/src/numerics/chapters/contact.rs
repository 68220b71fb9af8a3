//! Layers that all but touch, that touch, and that are the same.

use std::{ops::ControlFlow, sync::Arc};

use untangle::{
    mesh::Mesh,
    relax::{RelaxSettings, relax},
};

use crate::{
    generate::{Sheet, crumpled, degenerate},
    numerics::{
        answer::{check_against_brute_force, check_all_responses, default_answer, frame, rounded},
        case::{Case, Chapter, Effort, Seen, ensure},
    },
};

const COMPLETE: &str = "equal to brute force; finite with every response; `relax` ends (5 iterations), finite";

pub(super) fn chapter() -> Chapter {
    let mut cases = Vec::new();
    for single in [true, false] {
        let precision = if single { "f32" } else { "f64" };
        cases.push(Case::new(
            format!("{precision}, two level layers 0 to 10 ulp apart"),
            "no intersection from 1 ulp on; at 0, in one plane, equal to brute force; finite",
            move |_| gaps(single),
        ));
        cases.push(Case::new(
            format!("{precision}, a vertex 0 to 10 ulp deep in the other layer"),
            "from 1 ulp on one closed pair of paths with that vertex inside; at 0, touching, equal to brute force; \
             finite",
            move |_| depths(single),
        ));
    }
    cases.extend(degenerate_cases());
    cases.extend(repeated_cases());
    Chapter {
        title: "Contact",
        text: "Signs are exact, on input that is thought to be moved infinitesimally: touching layers either intersect \
               or don't, always in the same way. An ulp is that of the layers' height of 1. \
               `tests/analysis/invariance/degenerate.rs` holds that the order of faces and of their corners changes \
               none of these answers.",
        cases,
    }
}

/// Every degenerate kind of sheet that is in contact.
fn degenerate_cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (what, names) in [
        ("coincident vertices", &["duplicate_positions", "zero_area", "one_point"][..]),
        ("everything coplanar", &["coplanar"]),
        ("everything collinear, and everything in one point", &["one_line", "one_point"]),
        (
            "layers that touch in points, edges and lines of both grids",
            &[
                "tip_on_face",
                "tip_on_edge",
                "tip_on_vertex",
                "edge_touch",
                "grid_aligned",
                "mirrored_fold",
                "stacked_boxes",
            ],
        ),
        ("faces given twice", &["duplicate_faces"]),
    ] {
        cases.push(Case::new(what, COMPLETE, move |_| degenerates(names)));
    }
    cases
}

/// Layers in the same place.
fn repeated_cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for count in [2, 5, 10] {
        cases.push(Case::new(format!("the same layer {count} times, flat"), COMPLETE, move |_| {
            let mut sheet = Sheet::default();
            for _ in 0..count {
                sheet.add_grid([0.0, 1.0], [0.0, 1.0], [6, 6], |x, y| [x, y, 0.0]);
            }
            complete([sheet])
        }));
        cases.push(Case::new(format!("the same layer {count} times, crumpled"), COMPLETE, move |effort: Effort| {
            complete([repeated(&crumpled(4, 9), count.min(effort.choose(3, count)))])
        }));
    }
    cases
}

/// Two level layers, of which the upper one's heights are given by its vertices' places.
fn layers(single: bool, height: impl Fn(f64, f64) -> f64) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add_grid([0.0, 1.0], [0.0, 1.0], [8, 8], |x, y| [x, y, 1.0]);
    sheet.add_grid([0.13, 0.93], [0.17, 0.87], [6, 6], |x, y| [x, y, height(x, y)]);
    if single {
        sheet.positions = rounded(&sheet.positions);
    }
    sheet
}

fn ulp(single: bool) -> f64 {
    if single { f64::from(f32::EPSILON) } else { f64::EPSILON }
}

fn gaps(single: bool) -> Seen {
    let mut seen = Vec::new();
    for gap in 0..=10 {
        let sheet = layers(single, |_, _| 1.0 + f64::from(gap) * ulp(single));
        let num_segments = checked(&sheet)?;
        ensure(gap == 0 || num_segments == 0, || format!("{gap} ulp apart: {num_segments} intersections"))?;
        seen.push(num_segments.to_string());
    }
    Ok(format!("segments at 0, 1, .. 10 ulp: {}", seen.join(", ")))
}

fn depths(single: bool) -> Seen {
    let mut seen = Vec::new();
    for depth in 0..=10 {
        let is_tip = |x: f64, y: f64| (x - 0.53).abs() < 0.01 && (y - 0.52).abs() < 0.01;
        // Below 1 an ulp is half as long.
        let tip = 1.0 - 0.5 * f64::from(depth) * ulp(single);
        let sheet = layers(single, |x, y| if is_tip(x, y) { tip } else { 1.5 });
        let num_segments = checked(&sheet)?;
        let mesh = Arc::new(sheet.bare_mesh());
        let analysis = default_answer(&mesh, &sheet.positions)?.analysis;
        let deepest = sheet.positions.iter().rposition(|position| position[2] <= 1.0);
        let inside = |copy: usize| analysis.regions.vertices_of(copy);
        let is_found = analysis.paths.pairs.len() == 1
            && analysis.paths.pairs[0].copies.clone().any(|copy| {
                inside(copy).len() == 1
                    && deepest == Some(inside(copy)[0].index())
                    && analysis.paths.copies[copy].closed
            });
        ensure(depth == 0 || is_found, || format!("{depth} ulp deep: {num_segments} segments, but not that vertex"))?;
        seen.push(num_segments.to_string());
    }
    Ok(format!("segments at 0, 1, .. 10 ulp: {}", seen.join(", ")))
}

/// The number of intersecting pairs of faces, which are those of brute force.
fn checked(sheet: &Sheet) -> Result<usize, String> {
    let mesh = Arc::new(sheet.bare_mesh());
    let frame = frame(&mesh, &sheet.positions)?;
    check_against_brute_force(&mesh, &frame, &default_answer(&mesh, &sheet.positions)?.analysis)?;
    check_all_responses(&mesh, &frame)
}

fn degenerates(names: &[&str]) -> Seen {
    let sheets: Vec<_> = degenerate::all().into_iter().filter(|(name, _)| names.contains(name)).collect();
    ensure(sheets.len() == names.len(), || "a kind is missing".into())?;
    complete(sheets.into_iter().map(|(_, sheet)| sheet))
}

fn complete(sheets: impl IntoIterator<Item = Sheet>) -> Seen {
    let (mut num_segments, mut num_paths, mut left) = (0, 0, 0);
    for sheet in sheets {
        num_segments += checked(&sheet)?;
        let mesh = Arc::new(sheet.bare_mesh());
        num_paths += default_answer(&mesh, &sheet.positions)?.analysis.paths.pairs.len();
        left += relaxed(&mesh, &sheet.positions)?;
    }
    Ok(format!("{num_segments} segments in {num_paths} pairs of paths; `relax` left {left} paths"))
}

/// Relaxes; returns how many paths are left.
fn relaxed(mesh: &Mesh, positions: &[[f64; 3]]) -> Result<usize, String> {
    let settings = RelaxSettings { max_iterations: 5, ..RelaxSettings::default() };
    let end = relax(mesh, positions, &settings, &mut |_| ControlFlow::Continue(()));
    let end = end.map_err(|error| error.to_string())?;
    ensure(end.positions.iter().flatten().all(|x| x.is_finite()), || "`relax` is not finite".into())?;
    Ok(end.blocked.len())
}

/// So many sheets in the same place, as pieces of their own.
fn repeated(sheet: &Sheet, count: u32) -> Sheet {
    let mut all = Sheet::default();
    for _ in 0..count {
        let first = u32::try_from(all.positions.len()).unwrap();
        all.faces.extend(sheet.faces.iter().map(|face| face.map(|corner| corner + first)));
        all.uvs.extend(&sheet.uvs);
        all.positions.extend(&sheet.positions);
    }
    all
}
