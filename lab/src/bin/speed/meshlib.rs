//! The search for intersecting faces beside MeshLib's, where a Python with the package `meshlib` is at hand.

use std::{
    io::{BufRead, BufReader, Write},
    path::Path,
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
    time::Duration,
};

use untangle::{
    frame::Frame,
    intersect::{Intersections, Intersector, SegmentEnd},
    mesh::Mesh,
};
use untangled_lab::{
    Failure,
    clock::{milliseconds, timed},
    states::bent,
    table::{print_header, print_text},
};
use untangled_testkit::generate::crumpled;

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/bin/speed/contender.py");

/// The variable that names the Python.
const PYTHON: &str = "MESHLIB_PYTHON";

pub(crate) fn table(resolutions: &[u32]) -> Result<(), Failure> {
    println!("\n## Beside MeshLib\n");
    let python = std::env::var(PYTHON).unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", "import meshlib, numpy"]).stderr(Stdio::null()).status();
    if !has.is_ok_and(|status| status.success()) {
        print_text(&format!(
            "Left out: {python} has no packages meshlib and numpy; {PYTHON} names another one (`--only meshlib` makes \
             this part alone)."
        ));
        return Ok(());
    }
    print_text(
        "`findSelfCollidingTriangles` of MeshLib (PyPI, through Python) on one core after a refit of its tree over all \
         vertices, in turns with a cold search here. Pairs that share a vertex are left out of the count: MeshLib \
         looks at few of them. Its coordinates are of single precision.\n",
    );
    print_header(&["triangles", "state", "pairs", "MeshLib's pairs", "cold ms", "MeshLib ms", "MeshLib / cold"]);
    for &resolution in resolutions.iter().filter(|&&resolution| resolution <= 500) {
        let sheet = crumpled(11, resolution);
        let mesh = sheet.mesh();
        for (state, positions) in [("untangled", bent(&sheet)), ("tangled", sheet.positions.clone())] {
            // What single precision holds, so that both see the same numbers.
            #[expect(clippy::cast_possible_truncation, reason = "that is what it is for")]
            let positions: Vec<_> = positions.iter().map(|point| point.map(|x| f64::from(x as f32))).collect();
            row(&python, &mesh, &sheet.faces, state, &positions)?;
        }
    }
    Ok(())
}

fn row(python: &str, mesh: &Mesh, faces: &[[u32; 3]], state: &str, positions: &[[f64; 3]]) -> Result<(), Failure> {
    let frame = Frame::new(mesh, positions)?;
    let (mut intersector, mut found) = (Intersector::default(), Intersections::default());
    let mut other = Contender::start(python, positions, faces)?;
    let (mut best, mut best_other, mut pairs_other) = (Duration::MAX, f64::INFINITY, 0);
    for _ in 0..6 {
        best = best.min(timed(|| {
            intersector.clear_cache();
            intersector.intersect(mesh, &frame, &mut found);
        }));
        let (ms, pairs) = other.search()?;
        (best_other, pairs_other) = (best_other.min(ms), pairs);
    }
    let is_apart = |end: &SegmentEnd| matches!(end, SegmentEnd::EdgeFace(_));
    let pairs = found.segments.iter().filter(|segment| segment.ends.iter().all(is_apart)).count();
    let cold = milliseconds(best);
    println!(
        "| {} | {state} | {pairs} | {pairs_other} | {cold:.2} | {best_other:.2} | {:.1} |",
        mesh.num_faces(),
        best_other / cold
    );
    Ok(())
}

/// MeshLib in a process of its own.
struct Contender {
    child: Child,
    orders: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Contender {
    fn start(python: &str, positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, Failure> {
        let folder = std::env::temp_dir();
        let write = |name: &str, bytes: Vec<u8>| -> Result<_, Failure> {
            let path = folder.join(format!("speed-{}-{name}", std::process::id()));
            std::fs::write(&path, bytes)?;
            Ok(path)
        };
        let vertices = write("vertices", positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect())?;
        let faces = write("faces", faces.iter().flatten().flat_map(|corner| corner.to_le_bytes()).collect())?;
        let mut child = Command::new(python)
            .args([Path::new(SCRIPT), &vertices, &faces])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (Some(orders), Some(answers)) = (child.stdin.take(), child.stdout.take()) else {
            return Err("the process has no pipes".into());
        };
        let mut contender = Self { child, orders, answers: BufReader::new(answers) };
        let ready = contender.line();
        std::fs::remove_file(vertices)?;
        std::fs::remove_file(faces)?;
        ready?;
        Ok(contender)
    }

    fn line(&mut self) -> Result<String, Failure> {
        let mut line = String::new();
        if self.answers.read_line(&mut line)? == 0 {
            return Err("MeshLib's process ended".into());
        }
        Ok(line)
    }

    /// Milliseconds and pairs of one search.
    fn search(&mut self) -> Result<(f64, usize), Failure> {
        writeln!(self.orders)?;
        let line = self.line()?;
        let (ms, pairs) = line.trim().split_once(' ').ok_or("an answer that is none")?;
        Ok((ms.parse()?, pairs.parse()?))
    }
}

impl Drop for Contender {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
