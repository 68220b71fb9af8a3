//! Only what the scene requires: which stages run for what.

use std::sync::Arc;

use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription, Uvs},
    settings::{Response, Settings},
    untangler::Untangler,
};
use untangled_lab::{
    Failure,
    states::bent,
    table::{print_header, print_text},
};
use untangled_publisher::scenes::Scene;
use untangled_testkit::generate::crumpled_further;

use crate::frames::Stopwatch;

/// One row.
struct Case {
    name: String,
    response: Response,
    mesh: Mesh,
    positions: Vec<[f64; 3]>,
}

pub(crate) fn table() -> Result<(), Failure> {
    println!("\n## Only what the scene requires\n");
    print_text(
        "Microseconds of each stage of a second frame, and the bytes for each triangle that analysis and response keep \
         after the first. A stage that has nothing to do takes less than a microsecond, but for writing a zero for \
         each vertex of the correction. The daemon encodes and publishes paths only for frames on which somebody \
         listens to them.\n",
    );
    print_header(&[
        "scene",
        "response",
        "triangles",
        "pairs of paths",
        "search",
        "paths",
        "regions",
        "targets",
        "response",
        "bytes",
    ]);
    for case in sheets().into_iter().chain(scenes()?) {
        row(case)?;
    }
    Ok(())
}

/// Generated sheets, with one thing after the other left out.
fn sheets() -> Vec<Case> {
    let crumpled = crumpled_further(2, 35, 2.5, 12);
    let case = |name: &str, response, mesh, positions: &[[f64; 3]]| Case {
        name: name.to_owned(),
        response,
        mesh,
        positions: positions.to_vec(),
    };
    let tangled = |name, response| case(name, response, crumpled.mesh(), &crumpled.positions);
    vec![
        case("sheet without contact", Response::Rbf, crumpled.mesh(), &bent(&crumpled)),
        tangled("tangled sheet", Response::Rbf),
        case("the same without texture coordinates", Response::Rbf, crumpled.bare_mesh(), &crumpled.positions),
        tangled("tangled sheet", Response::Displacement),
        tangled("tangled sheet", Response::Coupled),
        tangled("tangled sheet", Response::Contour),
        tangled("tangled sheet", Response::Mask),
    ]
}

/// The scenes of the example host, each with one type of path.
fn scenes() -> Result<Vec<Case>, Failure> {
    let types = [
        ("bag", "CLOSED alone"),
        ("tongue", "BB/II alone"),
        ("curtains", "BI/BI alone: pushed, no targets"),
        ("crease", "LL alone"),
        ("twist", "BLI alone"),
        ("drop", "EIGHT alone"),
        ("wedge", "CROSS alone"),
    ];
    types
        .into_iter()
        .map(|(scene, name)| {
            let cloth = scene.parse::<Scene>()?.build(1, 0.025);
            let mesh = Mesh::new(MeshDescription {
                num_vertices: cloth.positions.len(),
                faces: cloth.triangles,
                uvs: cloth.uvs.map(|uvs| Uvs { coordinates: uvs.coordinates, corners: uvs.corners }),
                pins: cloth.pins,
                ..MeshDescription::default()
            })?;
            let positions = cloth.positions.iter().map(|&point| point.into()).collect();
            Ok(Case { name: name.to_owned(), response: Response::Rbf, mesh, positions })
        })
        .collect()
}

fn row(Case { name, response, mesh, positions }: Case) -> Result<(), Failure> {
    let mesh = Arc::new(mesh);
    let frame = Frame::new(&mesh, &positions)?;
    let elsewhere: Vec<_> = positions.iter().map(|point| point.map(|x| 2.0 * x)).collect();
    let elsewhere = Frame::new(&mesh, &elsewhere)?;
    let mut untangler = Untangler::new(mesh.clone(), Settings { response, ..Settings::default() })?;
    let mut num_paths = 0;
    let memory = allocation_counter::measure(|| {
        num_paths = untangler.process(&frame, &mut ()).analysis.paths.pairs.len();
    });
    let mut best = [f64::MAX; 5];
    for _ in 0..10 {
        untangler.process(&elsewhere, &mut ());
        let mut watch = Stopwatch::default();
        untangler.process(&frame, &mut watch);
        best = std::array::from_fn(|stage| best[stage].min(watch.stages[stage].as_secs_f64() * 1e6));
    }
    println!(
        "| {name} | {response:?} | {} | {num_paths} | {} | {:.0} |",
        mesh.num_faces(),
        best.map(|time| format!("{time:.0}")).join(" | "),
        memory.bytes_current as f64 / mesh.num_faces() as f64,
    );
    Ok(())
}
