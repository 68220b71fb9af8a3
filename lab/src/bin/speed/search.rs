//! The search for intersecting faces beside parry's tree.

use std::time::Duration;

use parry3d_f64::{
    bounding_volume::Aabb,
    math::Vector,
    partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace},
};
use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector, do_intersect},
    mesh::{FaceId, Mesh},
};
use untangled_lab::{
    Failure,
    clock::{milliseconds, timed},
    states::{bent, later},
    table::{print_header, print_text},
};
use untangled_testkit::generate::{Sheet, crumpled};

pub(crate) fn table(resolutions: &[u32]) -> Result<(), Failure> {
    println!("\n## Broad and narrow phase\n");
    print_text(
        "All intersecting pairs of a frame on one thread. `cold`: without certificates, in the tree that is sorted \
         already. `coherent`: the mean of 100 frames in which the sheet moves on by five edges and waves of a \
         hundredth of an edge run through it; the same bytes come out. `boxes`: parry3d's refit and traversal, without \
         any test of faces; `parry`: with `do_intersect` for each pair, which filters pairs as `cold` does but \
         takes those that share a vertex pair by pair; all found the same pairs. `bytes`: memory kept for each \
         triangle, cold and coherent together.\n",
    );
    print_header(&[
        "triangles",
        "state",
        "pairs",
        "cold ms",
        "coherent ms",
        "boxes ms",
        "parry ms",
        "parry / cold",
        "cold / coherent",
        "bytes",
    ]);
    for &resolution in resolutions {
        let sheet = crumpled(11, resolution);
        let mesh = sheet.mesh();
        for (state, positions) in [("untangled", bent(&sheet)), ("tangled", sheet.positions.clone())] {
            row(&sheet, &mesh, resolution, state, &positions)?;
        }
    }
    Ok(())
}

fn row(sheet: &Sheet, mesh: &Mesh, resolution: u32, state: &str, positions: &[[f64; 3]]) -> Result<(), Failure> {
    let frame = Frame::new(mesh, positions)?;
    let mut contender = Contender::new(mesh, &frame);
    let (mut intersector, mut found) = (Intersector::default(), Intersections::default());
    let mut best = [Duration::MAX; 3];
    for _ in 0..if resolution < 250 { 15 } else { 4 } {
        let times = [
            timed(|| {
                intersector.clear_cache();
                intersector.intersect(mesh, &frame, &mut found);
            }),
            timed(|| contender.num_boxes(mesh, &frame)),
            timed(|| contender.num_pairs(mesh, &frame)),
        ];
        best = std::array::from_fn(|which| best[which].min(times[which]));
    }
    if contender.num_found != found.segments.len() {
        return Err(format!("{} pairs against {}", contender.num_found, found.segments.len()).into());
    }
    let num_pairs = found.segments.len();
    let (coherent, bytes) = coherent_search(sheet, mesh, resolution, positions)?;
    let [cold, boxes, parry] = best.map(milliseconds);
    println!(
        "| {} | {state} | {num_pairs} | {cold:.2} | {:.2} | {boxes:.2} | {parry:.2} | {:.1} | {:.1} | {:.0} |",
        mesh.num_faces(),
        milliseconds(coherent),
        parry / cold,
        cold / milliseconds(coherent),
        bytes as f64 / mesh.num_faces() as f64,
    );
    Ok(())
}

/// Mean time of a search that follows others, and the bytes that the intersector keeps.
fn coherent_search(
    sheet: &Sheet,
    mesh: &Mesh,
    resolution: u32,
    positions: &[[f64; 3]],
) -> Result<(Duration, i64), Failure> {
    let (mut intersector, mut found) = (Intersector::default(), Intersections::default());
    let (mut coherent, mut bytes) = (Duration::ZERO, 0);
    let frames = (0..104).map(|number| Frame::new(mesh, &later(sheet, positions, resolution, number)));
    for (number, frame) in frames.enumerate() {
        let frame = frame?;
        let mut time = Duration::ZERO;
        let memory = allocation_counter::measure(|| {
            time = timed(|| intersector.intersect(mesh, &frame, &mut found));
        });
        bytes += memory.bytes_current;
        if number >= 4 {
            coherent += time / 100;
        }
    }
    Ok((coherent, bytes))
}

/// parry's tree over the boxes of all faces.
struct Contender {
    tree: Bvh,
    workspace: BvhWorkspace,
    num_found: usize,
}

impl Contender {
    fn new(mesh: &Mesh, frame: &Frame) -> Self {
        let boxes: Vec<Aabb> = mesh.face_ids().map(|face| box_of(mesh, frame, face)).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self { tree, workspace: BvhWorkspace::default(), num_found: 0 }
    }

    fn num_boxes(&mut self, mesh: &Mesh, frame: &Frame) {
        self.search(mesh, frame, |_| true);
    }

    fn num_pairs(&mut self, mesh: &Mesh, frame: &Frame) {
        self.search(mesh, frame, |faces| do_intersect(mesh, frame, faces));
    }

    fn search(&mut self, mesh: &Mesh, frame: &Frame, counts: impl Fn([FaceId; 2]) -> bool) {
        for face in mesh.face_ids() {
            self.tree.insert_or_update_partially(box_of(mesh, frame, face), face.0, 0.0);
        }
        self.tree.refit(&mut self.workspace);
        let mut num_found = 0;
        self.tree.traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut |a, b| {
            num_found += usize::from(counts([FaceId(a), FaceId(b)]));
        });
        self.num_found = num_found;
    }
}

fn box_of(mesh: &Mesh, frame: &Frame, face: FaceId) -> Aabb {
    let corners = mesh.face(face).map(|vertex| frame.position(vertex));
    Aabb::from_points(corners.map(|corner| Vector::new(corner.x, corner.y, corner.z)))
}
