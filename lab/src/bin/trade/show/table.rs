//! Tables, for reading and for other programs.

use std::fmt::Write;

use crate::measure::study::{Figures, Measured};

/// Rows of cells under a heading.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    pub(crate) heading: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(heading: &[&str]) -> Self {
        Self { heading: heading.iter().map(ToString::to_string).collect(), rows: Vec::new() }
    }

    /// As Markdown.
    pub(crate) fn markdown(&self) -> String {
        let mut text = format!("| {} |\n|{}\n", self.heading.join(" | "), "---|".repeat(self.heading.len()));
        for row in &self.rows {
            let _ = writeln!(text, "| {} |", row.join(" | "));
        }
        text
    }

    /// In columns, the first two to the left.
    pub(crate) fn plain(&self) -> String {
        let all = || std::iter::once(&self.heading).chain(&self.rows);
        let width = |column: usize| all().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.heading.len()).map(width).collect();
        let mut text = String::new();
        for row in all() {
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                let _ = if column < 2 { write!(text, "{cell:<width$}  ") } else { write!(text, "{cell:>width$}  ") };
            }
            text.truncate(text.trim_end().len());
            text.push('\n');
        }
        text
    }

    /// As comma-separated values; cells with commas in quotes.
    pub(crate) fn csv(&self) -> String {
        let cell = |cell: &String| if cell.contains(',') { format!("\"{cell}\"") } else { cell.clone() };
        let line = |row: &Vec<String>| row.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
        std::iter::once(&self.heading).chain(&self.rows).map(line).collect()
    }
}

/// The figures of each variant, over all scenes.
pub(crate) fn figures(axis: &str, measured: &[Measured]) -> Table {
    let mut table = Table::new(&[
        axis,
        "ms/frame",
        "frames",
        "not clean",
        "remaining",
        "target error",
        "worst",
        "distortion",
        "force left",
        "torque left",
    ]);
    for Measured { variant, all, targets, .. } in measured {
        let Figures { num_runs, num_tangled, ms_per_frame, frames, remaining, distortion, residuals, .. } = all;
        let target = |value: Option<f64>| value.map_or_else(|| "-".into(), |value| format!("{value:.3}"));
        table.rows.push(vec![
            variant.value.clone(),
            format!("{ms_per_frame:.2}"),
            format!("{frames:.1}"),
            format!("{num_tangled} of {num_runs}"),
            format!("{remaining:.1}"),
            target(targets.map(|errors| errors.mean)),
            target(targets.map(|errors| errors.max)),
            format!("{distortion:.2}"),
            format!("{:.0e}", residuals[0]),
            format!("{:.0e}", residuals[1]),
        ]);
    }
    table
}

/// Everything: a row for each variant and scene, and one for all scenes together.
pub(crate) fn everything<'a>(measured: impl IntoIterator<Item = &'a Measured>, limit: usize) -> Table {
    let mut table = Table::new(&[
        "axis",
        "value",
        "scene",
        "runs",
        "not_clean",
        "ms_per_frame",
        "ms_per_answer",
        "frames_to_clean",
        "limit",
        "remaining",
        "target_error_mean_edges",
        "target_error_max_edges",
        "distortion",
        "force_residual",
        "torque_residual",
    ]);
    for Measured { variant, scenes, all, targets } in measured {
        for (scene, figures) in scenes.iter().map(|(name, figures)| (name.as_str(), figures)).chain([("all", all)]) {
            // Targets are measured on sheets of their own.
            let errors = targets.filter(|_| scene == "all");
            let target = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.6}"));
            table.rows.push(vec![
                variant.axis.into(),
                variant.value.clone(),
                scene.into(),
                figures.num_runs.to_string(),
                figures.num_tangled.to_string(),
                format!("{:.4}", figures.ms_per_frame),
                format!("{:.4}", figures.ms_per_answer),
                format!("{:.3}", figures.frames),
                limit.to_string(),
                format!("{:.3}", figures.remaining),
                target(errors.map(|errors| errors.mean)),
                target(errors.map(|errors| errors.max)),
                format!("{:.5}", figures.distortion),
                format!("{:.3e}", figures.residuals[0]),
                format!("{:.3e}", figures.residuals[1]),
            ]);
        }
    }
    table
}
