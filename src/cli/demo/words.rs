//! What a demonstration says about itself.

use std::path::Path;

use untangled_publisher::report::Summary;

use untangle::mesh::Mesh;

use crate::cli::wording::Counted;

/// Width of the text in columns.
const COLUMNS: usize = 100;

/// How the run with corrections ended.
pub(super) fn untangled(summary: &Summary) -> String {
    format!("{}: {}", if summary.clean { "clean" } else { "not clean" }, counts(summary))
}

/// How the control ended.
pub(super) fn control(summary: &Summary) -> String {
    let verdict = if summary.clean { "it came clean without corrections" } else { "it stays tangled" };
    format!("{verdict}: {}", counts(summary))
}

fn counts(summary: &Summary) -> String {
    let Summary { num_edge_face_before, num_edge_face_after, num_frames, .. } = summary;
    let frames = Counted(*num_frames, "frame");
    format!("{num_edge_face_before} edge-face intersections became {num_edge_face_after} in {frames}")
}

/// The last sentence: what was shown, and what to look at.
pub(super) fn shown(mesh: &Mesh, summary: &Summary, control: Option<&Summary>, folder: &Path) -> String {
    let frames = Counted(summary.num_frames, "frame");
    let result = if summary.clean { "untangled" } else { "did not finish untangling" };
    let control = match control {
        None => String::new(),
        Some(control) if control.clean => {
            ", but without them it came clean too, so this run says nothing about the corrections".to_owned()
        }
        Some(control) => {
            format!(", and without them it was still tangled after {}", Counted(control.num_frames, "frame"))
        }
    };
    wrapped(&format!(
        "Shown: corrections from the daemon {result} a cloth of {} vertices and {} in {frames}{control}; \
         look at before.png and after.png in {}, where intersection paths have the colour of their type, or open \
         before.obj and after.obj in a 3D viewer.",
        mesh.num_vertices(),
        Counted(mesh.num_faces(), "triangle"),
        folder.display(),
    ))
}

/// Breaks a text into lines of at most [`COLUMNS`] characters, at blanks.
fn wrapped(text: &str) -> String {
    let mut lines = String::new();
    let mut column = 0;
    for word in text.split(' ') {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > COLUMNS {
            lines.push('\n');
            column = 0;
        } else if column > 0 {
            lines.push(' ');
            column += 1;
        }
        lines.push_str(word);
        column += length;
    }
    lines
}

#[cfg(test)]
mod tests {
    use untangle::mesh::MeshDescription;

    use super::*;

    #[test]
    fn shown_names_frames_files_and_the_control() {
        let faces = vec![[0, 1, 2]];
        let mesh = Mesh::new(MeshDescription { num_vertices: 3, faces, ..MeshDescription::default() }).unwrap();
        let summary = |clean, num_frames| Summary {
            clean,
            num_frames,
            num_edge_face_before: 2,
            num_edge_face_after: 0,
            num_face_pairs_before: 1,
            num_face_pairs_after: 0,
            num_late_frames: 0,
            num_repaired_frames: 0,
        };
        let sentence =
            |control: Option<&Summary>| shown(&mesh, &summary(true, 1), control, Path::new("out")).replace('\n', " ");
        let start = "Shown: corrections from the daemon untangled a cloth of 3 vertices and 1 triangle in 1 frame";
        let end = "look at before.png and after.png in out, where intersection paths have the colour of their type, or \
                   open before.obj and after.obj in a 3D viewer.";
        assert_eq!(sentence(None), format!("{start}; {end}"));
        let tangled = sentence(Some(&summary(false, 300)));
        assert_eq!(tangled, format!("{start}, and without them it was still tangled after 300 frames; {end}"));
        assert!(sentence(Some(&summary(true, 7))).contains("says nothing about the corrections"));
    }

    #[test]
    fn wrapped_of_a_long_text_breaks_at_blanks_within_the_width() {
        let text = "word ".repeat(50) + &"x".repeat(120);
        let lines = wrapped(&text);
        assert_eq!(lines.replace('\n', " "), text);
        let widths: Vec<usize> = lines.lines().map(str::len).collect();
        assert_eq!(widths, [99, 99, 49, 120]);
    }
}
