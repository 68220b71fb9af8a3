//! One row: a mesh, relaxed and judged.

use std::{error::Error, fmt, ops::ControlFlow};

use cpu_time::ProcessTime;
use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    relax::{Iteration, RelaxSettings, Relaxation, relax},
};
use untangled_checker::count_edge_face;

use crate::change::Change;

/// How one mesh is relaxed, and what is said beside the table.
#[derive(Clone, Default)]
pub(crate) struct Run {
    pub(crate) settings: RelaxSettings,
    /// Processor seconds after which a mesh is given up.
    pub(crate) most_seconds: Option<f64>,
    /// Whether the intersections after each iteration are printed.
    pub(crate) curve: bool,
    /// The same on standard error while it works.
    pub(crate) watch: bool,
}

/// What became of a mesh.
pub(crate) struct Row {
    pub(crate) num_faces: usize,
    /// Edge-face intersections before and after.
    pub(crate) before: usize,
    pub(crate) after: usize,
    pub(crate) iterations: usize,
    pub(crate) change: Change,
    /// Seconds of the processors.
    pub(crate) cpu_s: f64,
    /// The methods of all iterations, those in a row with their number.
    pub(crate) methods: String,
    /// Intersections and method of each iteration.
    pub(crate) curve: String,
}

/// The names of the columns that [`Row`] writes, without that of the mesh.
pub(crate) fn header() -> String {
    format!(
        "{:>6} {:>6} {:>6} {:>4} {:>8} {:>8} {:>6} {:>6} {:>6} {:>7} {:>7} methods",
        "faces", "before", "after", "it", "mean %", "most %", "short", "long", "area", "moved %", "cpu s"
    )
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { num_faces, before, after, iterations, cpu_s, methods, .. } = self;
        let Change { mean_percent, most_percent, shortest, longest, smallest, moved_percent } = self.change;
        write!(
            f,
            "{num_faces:>6} {before:>6} {after:>6} {iterations:>4} {mean_percent:>8.4} {most_percent:>8.3} \
             {shortest:>6.3} {longest:>6.3} {smallest:>6.3} {moved_percent:>7.2} {cpu_s:>7.2} {methods}"
        )
    }
}

impl Run {
    /// Relaxes a mesh and judges the result.
    pub(crate) fn row(&self, description: &MeshDescription, positions: &[[f64; 3]]) -> Result<Row, Box<dyn Error>> {
        let mesh = Mesh::new(description.clone())?;
        Frame::new(&mesh, positions)?;
        let before = count_edge_face(positions, &description.faces)?;
        let start = ProcessTime::now();
        let relaxation = relax(&mesh, positions, &self.settings, &mut |step| {
            let seconds = start.elapsed().as_secs_f64();
            if self.watch {
                let Iteration { num_edge_face_intersections: left, path_length_m, method, .. } = step;
                eprintln!("{seconds:>8.1} s {left:>8} {path_length_m:>10.4} m {method:?}");
            }
            let is_over = self.most_seconds.is_some_and(|most| seconds > most);
            if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        let cpu_s = start.elapsed().as_secs_f64();
        Ok(Row {
            num_faces: description.faces.len(),
            before,
            after: count_edge_face(&relaxation.positions, &description.faces)?,
            iterations: relaxation.history.len(),
            change: Change::between(&mesh, positions, &relaxation.positions),
            cpu_s,
            methods: methods(&relaxation),
            curve: if self.curve { curve(&relaxation) } else { String::new() },
        })
    }
}

fn curve(relaxation: &Relaxation) -> String {
    let left = relaxation.history.iter().map(|step| format!("{} {:?}", step.num_edge_face_intersections, step.method));
    left.collect::<Vec<_>>().join(", ").to_lowercase()
}

fn methods(relaxation: &Relaxation) -> String {
    let mut runs: Vec<(String, usize)> = Vec::new();
    for step in &relaxation.history {
        let name = format!("{:?}", step.method).to_lowercase();
        match runs.last_mut() {
            Some((last, count)) if *last == name => *count += 1,
            _ => runs.push((name, 1)),
        }
    }
    runs.iter().map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
}
