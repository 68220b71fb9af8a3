//! The manual's pictures of intersection paths: for each type of pair a generated scene, in the world and in the
//! parameter domain; and one with the targets of the points inside.
//!
//! Usage: `path_pictures [DIR]`, by default `docs/manual/pictures`. The same bytes come out each time. Each scene is
//! checked: it must have exactly one pair of paths longer than 0.05 m, of the type that its picture is for.

#![allow(clippy::print_stdout, reason = "a program for the terminal")]

mod marks;
mod palette;
mod scenes;

use std::{
    env,
    error::Error,
    f64::consts::FRAC_PI_2,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use nalgebra::{Point3, Vector3};
use palette::Pixels;
use scenes::Scene;
use untangle::{
    analysis::Analysis, correspond::Attraction, frame::Frame, mesh::Mesh, paths::SurfacePoint, regions::InsideRegions,
    settings::Settings, untangler::Untangler,
};
use untangled::cli::picture::{Picture, View};

/// Pixels of each of the two pictures of a scene.
const SIZE: [usize; 2] = [420, 360];
/// Pixels at the top for title and legend.
const HEADROOM: usize = 60;
const NUM_COLOURS: usize = 96;
/// Radius of the mark of a loop vertex, and of one end of a line to a target, in pixels.
const LOOP_VERTEX: f64 = 4.5;
const LINE_END: f64 = 1.0;
/// Shorter pairs come from exact contact beside the path that is meant, and are not drawn.
const SHORTEST_M: f64 = 0.05;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args_os().nth(1).map_or_else(|| PathBuf::from("docs/manual/pictures"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    for scene in scenes::all()? {
        let name = scene.pair_type.name().to_lowercase().replace('/', "-");
        draw(&scene, false, &folder.join(name).with_extension("png"))?;
    }
    draw(&scenes::coarse_strip()?, true, &folder.join("targets.png"))
}

/// Writes a picture of the scene in the world, with a line from each point inside to its target if asked for, and
/// beside it one of its parameter domain, with a dot at both ends of those lines.
fn draw(scene: &Scene, with_targets: bool, path: &Path) -> Result<(), Box<dyn Error>> {
    let (mesh, frame, analysis) = scene.analyse()?;
    let mesh = Arc::new(mesh);
    let attractions = if with_targets { targets(&mesh, &frame)? } else { Vec::new() };
    let analysis = only_long_pair(scene, &analysis)?;
    let flat_frame = Frame::new(&mesh, &scene.domain.iter().map(|&[u, v]| [u, v, 0.0]).collect::<Vec<_>>())?;
    let mut flat_analysis = analysis.clone();
    for point in &mut flat_analysis.paths.points {
        point.position = place(&mesh, &flat_frame, point.own);
    }
    let world = picture(&mesh, &frame, analysis, scene.seen_from, "world", |analysis, scale| {
        for attraction in &attractions {
            let [source, target] = [attraction.source, attraction.target].map(|point| point.position(&frame));
            marks::segment(analysis, [source, target]);
            marks::ball(analysis, target, 2.0 * LINE_END / scale);
        }
    });
    let above = [0.0, FRAC_PI_2];
    let domain = picture(&mesh, &flat_frame, flat_analysis, above, "parameter domain", |analysis, scale| {
        for point in attractions.iter().flat_map(|attraction| [attraction.source, attraction.target]) {
            marks::ball(analysis, point.position(&flat_frame), LINE_END / scale);
        }
    });
    world.beside(&domain).write_png(path, NUM_COLOURS)?;
    println!("{}: {} bytes", path.display(), fs::metadata(path)?.len());
    Ok(())
}

/// Draws the cloth with its paths and loop vertices, and what `mark` adds to them; `mark` gets the pixels per metre.
fn picture(
    mesh: &Mesh,
    frame: &Frame,
    mut analysis: Analysis,
    [azimuth, elevation]: [f64; 2],
    title: &str,
    mark: impl Fn(&mut Analysis, f64),
) -> Pixels {
    let [width, height] = SIZE;
    let view = View::from_direction(frame.positions(), azimuth, elevation, width, height).below(HEADROOM);
    for vertex in analysis.paths.pairs[0].loop_vertices.clone() {
        marks::ball(&mut analysis, frame.position(vertex), LOOP_VERTEX / view.pixels_per_metre());
    }
    mark(&mut analysis, view.pixels_per_metre());
    Pixels { width, rgb: Picture::draw(&view, mesh, frame, &analysis, title).rgb().to_vec() }
}

/// The points inside and their targets.
fn targets(mesh: &Arc<Mesh>, frame: &Frame) -> Result<Vec<Attraction>, Box<dyn Error>> {
    let mut untangler = Untangler::new(Arc::clone(mesh), Settings::default())?;
    Ok(untangler.process(frame, &mut ()).correspondences.attractions.clone())
}

fn place(mesh: &Mesh, frame: &Frame, point: SurfacePoint) -> Point3<f64> {
    match point {
        SurfacePoint::Vertex(vertex) => frame.position(vertex),
        SurfacePoint::Edge { edge, parameter } => {
            let [start, end] = mesh.edge(edge).map(|vertex| frame.position(vertex));
            start + (end - start) * parameter
        }
        SurfacePoint::Face { face, barycentric } => {
            let corners = mesh.face(face).map(|vertex| frame.position(vertex).coords);
            let sum: Vector3<f64> = corners.iter().zip(barycentric).map(|(corner, weight)| corner * weight).sum();
            Point3::from(sum)
        }
    }
}

/// Keeps the one pair that the scene is to show.
fn only_long_pair(scene: &Scene, analysis: &Analysis) -> Result<Analysis, Box<dyn Error>> {
    let long = |k: &usize| analysis.paths.pairs[*k].length_m > SHORTEST_M;
    let found: Vec<usize> = (0..analysis.paths.pairs.len()).filter(long).collect();
    let types: Vec<_> = found.iter().map(|&k| analysis.paths.pairs[k].pair_type).collect();
    if types != [scene.pair_type] {
        return Err(format!("the scene for {} has {types:?}", scene.pair_type.name()).into());
    }
    let mut kept = analysis.clone();
    let copies = analysis.paths.pairs[found[0]].copies.clone();
    kept.paths.pairs = vec![analysis.paths.pairs[found[0]].clone()];
    kept.paths.pairs[0].copies = 0..copies.len();
    kept.paths.copies = analysis.paths.copies[copies.clone()].to_vec();
    kept.paths.copies.iter_mut().for_each(|copy| copy.pair = 0);
    kept.regions = InsideRegions { by_copy: analysis.regions.by_copy[copies].to_vec(), ..analysis.regions.clone() };
    Ok(kept)
}
