//! How far the single precision of the search carries: the same sheet, with one triangle farther and farther away.

use std::time::Duration;

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector},
    mesh::{Mesh, MeshDescription},
};
use untangled_lab::{
    Failure,
    clock::{milliseconds, timed},
    states::bent,
    table::{print_header, print_text},
};
use untangled_testkit::generate::crumpled;

const RESOLUTION: u32 = 125;

pub(crate) fn table() -> Result<(), Failure> {
    println!("\n## How far single precision carries\n");
    print_text(
        "A cold search through 31,250 triangles, with one more as many edges away, on one thread. Filters in \
         single precision fail where edges are short beside the whole; doubles and signs then do what they left.\n",
    );
    print_header(&["edges from end to end", "untangled ms", "tangled ms"]);
    let sheet = crumpled(11, RESOLUTION);
    let mut mesh = MeshDescription {
        num_vertices: sheet.positions.len() + 3,
        faces: sheet.faces.clone(),
        ..MeshDescription::default()
    };
    let last = u32::try_from(sheet.positions.len())?;
    mesh.faces.push([last, last + 1, last + 2]);
    let mesh = Mesh::new(mesh)?;
    let states = [bent(&sheet), sheet.positions.clone()];
    for away in [1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8] {
        let mut best = [Duration::MAX; 2];
        for (positions, best) in states.iter().zip(&mut best) {
            let edge = 1.0 / f64::from(RESOLUTION);
            let x = 0.5 + edge * away;
            let mut positions = positions.clone();
            positions.extend([[x, 0.0, 0.0], [x, edge, 0.0], [x, 0.0, edge]]);
            let frame = Frame::new(&mesh, &positions)?;
            let (mut intersector, mut found) = (Intersector::default(), Intersections::default());
            for _ in 0..8 {
                *best = (*best).min(timed(|| {
                    intersector.clear_cache();
                    intersector.intersect(&mesh, &frame, &mut found);
                }));
            }
        }
        let [untangled, tangled] = best.map(milliseconds);
        println!("| {away:.0e} | {untangled:.2} | {tangled:.2} |");
    }
    Ok(())
}
