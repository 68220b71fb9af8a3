//! The document of a page, and its file.

use std::io::Write;

use serde::Serialize;

use untangled_mesh_io::{MeshFile, Printable};

use super::{
    change::ChangeData,
    numbers::{index, whole},
    sequence::SequenceData,
    settings::Setting,
    state::{StateData, centre_of},
};
use crate::cli::{
    fix::{FixError, Interrupt, Target},
    input::Input,
    roles::Roles,
};

/// What `report/` builds: the script with its libraries, and the style. They are kept built, so that nobody needs
/// Node to build this program.
const SCRIPT: &str = include_str!("../../../report/built/page.js");
const STYLE: &str = include_str!("../../../report/built/page.css");

/// All that a page shows. Its fields are what `report/src/data.ts` reads.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct PageData<R> {
    schema: &'static str,
    /// The version of this program.
    version: &'static str,
    /// `check` or `fix`.
    pub(in crate::cli) command: &'static str,
    /// The report for people, as it is printed.
    pub(in crate::cli) summary: String,
    pub(in crate::cli) settings: Vec<Setting>,
    /// The JSON document of the command.
    pub(in crate::cli) report: R,
    pub(in crate::cli) mesh: MeshData,
    pub(in crate::cli) states: Vec<StateData>,
    /// What a repair did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(in crate::cli) change: Option<ChangeData>,
    /// The frames of a shot; the states are those of the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(in crate::cli) sequence: Option<SequenceData>,
}

/// What does not change between states.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct MeshData {
    parts: Vec<PartData>,
    num_vertices: usize,
    /// `num_faces x 3`, whole: vertices counted over all files.
    triangles: String,
    /// In metres; positions are relative to it.
    pub(in crate::cli) centre: [f64; 3],
    pinned: Vec<u32>,
}

/// A file.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct PartData {
    file: String,
    /// `cloth`, `layer` or `body`.
    role: &'static str,
    num_vertices: usize,
    num_faces: usize,
}

impl<R: Serialize> PageData<R> {
    pub(in crate::cli) fn new(command: &'static str, summary: String, report: R, mesh: MeshData) -> Self {
        Self {
            schema: "untangled.page/1",
            version: env!("CARGO_PKG_VERSION"),
            command,
            summary,
            settings: Vec::new(),
            report,
            mesh,
            states: Vec::new(),
            change: None,
            sequence: None,
        }
    }

    /// Writes the file to its place.
    ///
    /// # Errors
    /// [`FixError::Target`].
    pub(in crate::cli) fn write(&self, target: &Target, interrupt: &Interrupt) -> Result<(), FixError> {
        let html = self.to_html();
        let write = |out: &mut dyn Write| out.write_all(html.as_bytes()).map_err(|source| target.failed(&source));
        target.stage(interrupt, write)?.persist()
    }

    /// The file: HTML with its style, its data and its script inside.
    fn to_html(&self) -> String {
        let title = self.mesh.parts.first().map_or("", |part| part.file.as_str());
        let title = escaped(&format!("untangled {}: {}", self.command, Printable(title)));
        let data = serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a page is plain data: {error}"));
        // Inside of a script element nothing but `<` can end it, and `<` occurs in strings only.
        let data = data.replace('<', "\\u003c");
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; \
             style-src 'unsafe-inline'; img-src data: blob:\">\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
             <noscript>This page draws its picture and its tables by a script inside of this file. Allow scripts to \
             see them; nothing is fetched from anywhere.</noscript>\n\
             <div id=\"page\"></div>\n<script type=\"application/json\" id=\"data\">{data}</script>\n\
             <script>\n{SCRIPT}</script>\n</body>\n</html>\n"
        )
    }
}

impl MeshData {
    /// The world of `files` and bodies; the centre is that of the box round the positions of `input`.
    pub(in crate::cli) fn new(files: &[MeshFile], roles: &Roles, input: &Input, pinned: &[u32]) -> Self {
        Self::with_centre(files, roles, centre_of(&input.positions), pinned)
    }

    /// The same with a centre that is known.
    pub(in crate::cli) fn with_centre(files: &[MeshFile], roles: &Roles, centre: [f64; 3], pinned: &[u32]) -> Self {
        let role = if roles.has_layers() { "layer" } else { "cloth" };
        let cloth = files.iter().map(|file| (file, role));
        let all: Vec<_> = cloth.chain(roles.bodies.iter().map(|file| (file, "body"))).collect();
        let mut triangles: Vec<u32> = Vec::new();
        let mut first = 0;
        for (file, _) in &all {
            triangles.extend(file.faces().iter().flatten().map(|vertex| vertex + first));
            first += index(file.positions().len());
        }
        let part = |&(file, role): &(&MeshFile, _)| PartData {
            file: file.path().display().to_string(),
            role,
            num_vertices: file.positions().len(),
            num_faces: file.faces().len(),
        };
        Self {
            parts: all.iter().map(part).collect(),
            num_vertices: first as usize,
            triangles: whole(triangles),
            centre,
            pinned: pinned.to_vec(),
        }
    }
}

/// Text as it stands between tags.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
