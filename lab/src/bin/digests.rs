//! Digests of all answers, to compare two builds bit for bit.
//!
//! ```sh
//! cargo run --release -p untangled-lab --bin digests -- FILE... > before.txt
//! ```
//!
//! With `--portable` before them the files are processed without the instructions that not every processor has: the
//! same digests come out.
//!
//! An argument names one mesh file, or several joined by `+`, which are pieces in one world. Each world is processed
//! with each response, each quality and each choice of the inside, with one thread and with two, over [`FRAMES`]
//! frames: the positions of the file, then those with the corrections applied, so that caches kept from frame to frame
//! are used as well. One line for each, fields separated by tabs: the argument, the setting, the number of threads, the
//! digest of the analyses, the digest of the corrections. A digest is FNV-1a (64 bits) over every number, field by
//! field; floating-point numbers count by their bits, so that 0 and -0 differ. A world that is refused gets one line
//! with the error.

#![allow(clippy::print_stdout, reason = "prints a table")]

use std::{error::Error, ops::Range, sync::Arc};

use nalgebra::{Point3, Vector3};
use rayon::{ThreadPool, ThreadPoolBuilder};
use untangle::{
    analysis::Analysis,
    frame::Frame,
    intersect::{EdgeFaceIntersection, Intersections, Segment, SegmentEnd},
    labels::VertexLabel,
    mesh::{EdgeId, FaceId, Mesh, VertexId},
    paths::{
        ChainEnd, IntersectionPaths, PairType, PathCopy, PathPair, PathPoint, PathSegment, PathType, SurfacePoint,
    },
    regions::{InsideRegion, InsideRegions},
    respond::{Corrections, LeftOut, VertexFlags},
    settings::{InsideChoice, Quality, Response, Settings},
    simd::use_portable_instructions,
    untangler::Untangler,
};
use untangled_mesh_io::{concatenate, read_mesh};

/// Frames of each world.
const FRAMES: usize = 3;

/// Largest mesh for which slow settings are not skipped: beyond it, a frame of them can take minutes.
const MAX_FACES_SLOW: usize = 80_000;

/// Errors that may pass from a thread to another.
type BoxedError = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), BoxedError> {
    let pools = [1, 2].map(|threads| ThreadPoolBuilder::new().num_threads(threads).build());
    let pools = pools.into_iter().collect::<Result<Vec<_>, _>>()?;
    for argument in std::env::args().skip(1) {
        if argument == "--portable" {
            use_portable_instructions(true);
            continue;
        }
        if let Err(error) = print_world(&argument, &pools) {
            println!("{argument}\trefused\t{error}");
        }
    }
    Ok(())
}

/// Prints the lines of one world.
fn print_world(argument: &str, pools: &[ThreadPool]) -> Result<(), BoxedError> {
    let files = argument.split('+').map(read_mesh).collect::<Result<Vec<_>, _>>()?;
    let world = concatenate(&files)?;
    let mesh = Arc::new(Mesh::new(world.description)?);
    for (name, settings) in choices() {
        let is_slow = settings.response == Response::Coupled || settings.inside == InsideChoice::Work;
        if is_slow && mesh.num_faces() > MAX_FACES_SLOW {
            println!("{argument}\t{name}\tskipped");
            continue;
        }
        for pool in pools {
            let [analyses, corrections] = pool.install(|| digest_frames(&mesh, &world.positions, &settings))?;
            let threads = pool.current_num_threads();
            println!("{argument}\t{name}\t{threads}\t{:016x}\t{:016x}", analyses.0, corrections.0);
        }
    }
    Ok(())
}

/// Settings that decide which code runs, named as in a settings file.
fn choices() -> Vec<(&'static str, Settings)> {
    let responses = [
        ("response=rbf", Response::Rbf),
        ("response=contour", Response::Contour),
        ("response=displacement", Response::Displacement),
        ("response=coupled", Response::Coupled),
        ("response=mask", Response::Mask),
    ];
    let qualities = [
        ("quality=fast", Quality::Fast),
        ("quality=balanced", Quality::Balanced),
        ("quality=accurate", Quality::Accurate),
    ];
    let sides = [("inside=area", InsideChoice::Area), ("inside=work", InsideChoice::Work)];
    let of_quality = |quality: Quality| {
        let mut settings = Settings::default();
        quality.apply(&mut settings);
        settings
    };
    let responses = responses.map(|(name, response)| (name, Settings { response, ..Settings::default() }));
    let qualities = qualities.map(|(name, quality)| (name, of_quality(quality)));
    let sides = sides.map(|(name, inside)| (name, Settings { inside, ..Settings::default() }));
    let winding = [("winding=true", Settings { winding: true, ..Settings::default() })];
    responses.into_iter().chain(qualities).chain(sides).chain(winding).collect()
}

/// Digests of the analyses and of the corrections of [`FRAMES`] frames, each the one before it with its corrections
/// applied. A first frame that is refused is an error; a later one that is refused ends the sequence.
fn digest_frames(mesh: &Arc<Mesh>, positions: &[[f64; 3]], settings: &Settings) -> Result<[Digest; 2], BoxedError> {
    let mut untangler = Untangler::new(mesh.clone(), settings.clone())?;
    let mut frame = Frame::new(mesh, positions)?;
    let [mut analyses, mut corrections] = [Digest::default(); 2];
    for _ in 0..FRAMES {
        let outcome = untangler.process(&frame, &mut ());
        outcome.analysis.feed(&mut analyses);
        outcome.corrections.feed(&mut corrections);
        let next = corrected(mesh, &frame, outcome.corrections);
        let Ok(next) = Frame::new(mesh, &next) else { break };
        frame = next;
    }
    Ok([analyses, corrections])
}

/// Positions after one step along the forces, in metres; vertices weigh 1 kg where no masses are given.
fn corrected(mesh: &Mesh, frame: &Frame, corrections: &Corrections) -> Vec<[f64; 3]> {
    let mass_kg = |vertex: usize| mesh.masses_kg().map_or(1.0, |masses| masses[vertex]);
    let moved = frame.positions().iter().zip(&corrections.forces).enumerate();
    moved.map(|(vertex, (position, force))| (position + force / mass_kg(vertex)).into()).collect()
}

/// FNV-1a hash of 64 bits (Fowler, Noll and Vo).
#[derive(Clone, Copy)]
struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    fn bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// Values that a digest can be taken of. Structures are destructured in full: a new field stops the build until fed.
trait Feed {
    /// Feeds all numbers of a value into `digest`.
    fn feed(&self, digest: &mut Digest);
}

/// Numbers, by their bytes.
macro_rules! feed_bytes {
    ($($number:ty),*) => {
        $(impl Feed for $number {
            fn feed(&self, digest: &mut Digest) {
                digest.bytes(&self.to_le_bytes());
            }
        })*
    };
}

feed_bytes!(u8, u32, usize, f64);

/// Structures, field by field.
macro_rules! feed_fields {
    ($($structure:ident { $($field:ident),* })*) => {
        $(impl Feed for $structure {
            fn feed(&self, digest: &mut Digest) {
                let Self { $($field),* } = self;
                $($field.feed(digest);)*
            }
        })*
    };
}

feed_fields! {
    Analysis { intersections, paths, regions }
    Intersections { edge_face, segments }
    EdgeFaceIntersection { edge, face, edge_parameter, barycentric, position }
    Segment { faces, ends }
    IntersectionPaths { pairs, copies, points, segments }
    PathCopy { path_type, closed, points, segments, partner, pair }
    PathPoint { position, own, partner }
    PathSegment { own, partner }
    InsideRegions { by_copy, vertices, order, num_done }
    InsideRegion { partitioning, vertices, joint, disc_radius }
    LeftOut { num_pairs, length_m }
    VertexLabel { vertex, label }
}

impl Feed for Corrections {
    fn feed(&self, digest: &mut Digest) {
        // Which vertices were touched follows from forces and flags.
        let Self { forces, flags, touched: _, labels, net_force, net_torque, max_displacement_m, left_out } = self;
        forces.feed(digest);
        flags.feed(digest);
        net_force.feed(digest);
        net_torque.feed(digest);
        max_displacement_m.feed(digest);
        left_out.feed(digest);
        // Only where they were asked for: builds without labels have the same digests.
        if !labels.is_empty() {
            labels.feed(digest);
        }
    }
}

/// Values that are fed as another value.
macro_rules! feed_as {
    ($($of:ty: $value:ident => $other:expr;)*) => {
        $(impl Feed for $of {
            fn feed(&self, digest: &mut Digest) {
                let $value = self;
                $other.feed(digest);
            }
        })*
    };
}

feed_as! {
    VertexId: id => id.0;
    FaceId: id => id.0;
    EdgeId: id => id.0;
    VertexFlags: flags => flags.0;
    bool: value => u8::from(*value);
    Range<usize>: range => [range.start, range.end];
    Point3<f64>: point => <[f64; 3]>::from(*point);
    Vector3<f64>: vector => <[f64; 3]>::from(*vector);
}

impl<T: Feed> Feed for [T] {
    fn feed(&self, digest: &mut Digest) {
        self.len().feed(digest);
        self.iter().for_each(|element| element.feed(digest));
    }
}

impl<T: Feed> Feed for Vec<T> {
    fn feed(&self, digest: &mut Digest) {
        self.as_slice().feed(digest);
    }
}

impl<T: Feed, const N: usize> Feed for [T; N] {
    fn feed(&self, digest: &mut Digest) {
        self.iter().for_each(|element| element.feed(digest));
    }
}

impl<T: Feed> Feed for Option<T> {
    fn feed(&self, digest: &mut Digest) {
        self.as_slice().feed(digest);
    }
}

impl Feed for SegmentEnd {
    fn feed(&self, digest: &mut Digest) {
        match self {
            Self::EdgeFace(index) => [0, *index].feed(digest),
            Self::LoopVertex(vertex) => [1, vertex.0].feed(digest),
        }
    }
}

impl Feed for SurfacePoint {
    fn feed(&self, digest: &mut Digest) {
        match self {
            Self::Vertex(vertex) => [0, vertex.0].feed(digest),
            Self::Edge { edge, parameter } => {
                [1, edge.0].feed(digest);
                parameter.feed(digest);
            }
            Self::Face { face, barycentric } => {
                [2, face.0].feed(digest);
                barycentric.feed(digest);
            }
        }
    }
}

impl Feed for ChainEnd {
    fn feed(&self, digest: &mut Digest) {
        match self {
            Self::Boundary { edge: [a, b], face } => [0, *a, *b, *face].feed(digest),
            Self::Loop { vertex } => [1, *vertex].feed(digest),
            Self::Junction { edge: [a, b], face } => [2, *a, *b, *face].feed(digest),
        }
    }
}

impl Feed for PathPair {
    fn feed(&self, digest: &mut Digest) {
        let Self { pair_type, closed, num_segments, length_m, loop_vertices, ends, copies } = self;
        pair_type.feed(digest);
        closed.feed(digest);
        num_segments.feed(digest);
        length_m.feed(digest);
        loop_vertices.as_slice().feed(digest);
        ends.as_slice().feed(digest);
        copies.feed(digest);
    }
}

/// Types of paths, by their names.
macro_rules! feed_names {
    ($($named:ident),*) => {
        $(impl Feed for $named {
            fn feed(&self, digest: &mut Digest) {
                digest.bytes(self.name().as_bytes());
            }
        })*
    };
}

feed_names!(PairType, PathType);
