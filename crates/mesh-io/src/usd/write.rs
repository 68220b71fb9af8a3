//! A layer over a stage: `over` each mesh, with its points and nothing else, and the stage below it.

use std::{
    io::{self, Write},
    ops::{Range, RangeInclusive},
    path::{Component, Path, PathBuf},
};

use super::{gather::StageMesh, layers::value::Value, shot::UsdShot};
use crate::printable::Printable;

/// The points of some vertices in a frame, as little-endian singles.
pub(super) type ReadPoints<'r> = &'r mut dyn FnMut(u64, Range<usize>) -> io::Result<Vec<u8>>;

impl UsdShot {
    /// Checks that a layer at a path can name the stage, and the prims of the meshes.
    ///
    /// # Errors
    /// In words, what can't be named.
    pub(crate) fn check_layer(&self, path: &Path) -> Result<(), String> {
        let stage = relative(path, &self.stage().path);
        let shown = Printable(stage.display());
        match stage.to_str() {
            None => return Err(format!("can't name {shown} as the layer below it: names in USD are UTF-8")),
            Some(text) if text.contains("@@@") || text.ends_with('@') || text.chars().any(char::is_control) => {
                return Err(format!(
                    "can't name {shown} as the layer below it: no @@@, no @ at its end, and no control character may \
                     stand in its path"
                ));
            }
            Some(_) => {}
        }
        let is_plain = |char: char| !char.is_control() && !matches!(char, '"' | '\\');
        match self.meshes().iter().find(|mesh| !mesh.path.chars().all(is_plain)) {
            Some(mesh) => Err(format!("can't name the prim {}: no quote may stand in its path", Printable(&mesh.path))),
            None => Ok(()),
        }
    }

    /// Writes the layer of a part of the frames, as a file at a path. `read` gives the points of a range of vertices.
    pub(crate) fn write_layer(
        &self,
        path: &Path,
        part: &RangeInclusive<u64>,
        read: ReadPoints<'_>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        writeln!(out, "#usda 1.0\n(")?;
        for (name, value) in self.stage().metadata() {
            match value {
                Value::Text(text) => writeln!(out, "    {name} = {}", quoted(text))?,
                Value::Numbers(numbers) => writeln!(out, "    {name} = {}", numbers.first().unwrap_or(&0.0))?,
                _ => {}
            }
        }
        writeln!(out, "    subLayers = [\n        {}\n    ]\n)", asset(&relative(path, &self.stage().path)))?;
        let mut open: Vec<&str> = Vec::new();
        let mut first = 0;
        for mesh in self.meshes() {
            let names: Vec<&str> = mesh.path.split('/').skip(1).collect();
            let shared = open.iter().zip(&names).take_while(|(a, b)| a == b).count();
            close(&mut open, shared, out)?;
            for name in &names[shared..] {
                writeln!(out, "\n{0}over \"{name}\"\n{0}{{", indent(open.len()))?;
                open.push(name);
            }
            let vertices = first..first + mesh.num_vertices;
            first = vertices.end;
            self.points(mesh, &vertices, part, read, &indent(open.len()), out)?;
        }
        close(&mut open, 0, out)
    }

    fn points(
        &self,
        mesh: &StageMesh,
        vertices: &Range<usize>,
        part: &RangeInclusive<u64>,
        read: ReadPoints<'_>,
        indent: &str,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let type_name = &mesh.points.type_name;
        if self.time(0).is_none() {
            write!(out, "{indent}{type_name} points = ")?;
            array(&read(0, vertices.clone())?, out)?;
            return writeln!(out);
        }
        writeln!(out, "{indent}{type_name} points.timeSamples = {{")?;
        for frame in part.clone() {
            let time = self.time(frame - self.first).unwrap_or_default();
            write!(out, "{indent}    {time}: ")?;
            array(&read(frame, vertices.clone())?, out)?;
            writeln!(out, ",")?;
        }
        writeln!(out, "{indent}}}")
    }
}

fn indent(depth: usize) -> String {
    "    ".repeat(depth)
}

fn close(open: &mut Vec<&str>, depth: usize, out: &mut dyn Write) -> io::Result<()> {
    while open.len() > depth {
        open.pop();
        writeln!(out, "{}}}", indent(open.len()))?;
    }
    Ok(())
}

/// An array of points of three little-endian singles each.
fn array(bytes: &[u8], out: &mut dyn Write) -> io::Result<()> {
    let mut text = String::from("[");
    for (index, point) in bytes.as_chunks::<12>().0.iter().enumerate() {
        text.push_str(if index == 0 { "(" } else { ", (" });
        for (axis, value) in point.as_chunks::<4>().0.iter().enumerate() {
            text.push_str(if axis == 0 { "" } else { ", " });
            text.push_str(&number(f32::from_le_bytes(*value)));
        }
        text.push(')');
    }
    text.push(']');
    out.write_all(text.as_bytes())
}

/// The shortest number that readers take for this one: they read a double, and round it.
fn number(value: f32) -> String {
    let short =
        if value == 0.0 || (1e-5..1e9).contains(&value.abs()) { value.to_string() } else { format!("{value:e}") };
    #[expect(clippy::cast_possible_truncation, reason = "it is what readers do")]
    let read = short.parse::<f64>().map(|read| read as f32);
    if read.is_ok_and(|read| read.to_bits() == value.to_bits()) { short } else { format!("{:e}", f64::from(value)) }
}

/// A string in quotes.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for char in text.chars() {
        match char {
            '"' | '\\' => out.extend(['\\', char]),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            _ => out.push(char),
        }
    }
    out.push('"');
    out
}

/// An asset path between its marks.
fn asset(path: &Path) -> String {
    let path = path.to_string_lossy();
    if path.contains('@') { format!("@@@{path}@@@") } else { format!("@{path}@") }
}

/// The path to a file from the folder of another, both of which exist; else the whole path.
fn relative(from: &Path, to: &Path) -> PathBuf {
    let folder = from.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let (Ok(folder), Ok(file)) = (folder.canonicalize(), std::path::absolute(to)) else { return to.to_path_buf() };
    // Links in the folders are resolved, but not a link to the file, which may be the name of its latest version.
    let file = match (file.parent().map(Path::canonicalize), file.file_name()) {
        (Some(Ok(folder)), Some(name)) => folder.join(name),
        _ => return file,
    };
    let shared = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let mut up: Vec<Component<'_>> = folder.components().skip(shared).map(|_| Component::ParentDir).collect();
    if up.is_empty() {
        up.push(Component::CurDir);
    }
    up.into_iter().chain(file.components().skip(shared)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[expect(clippy::cast_possible_truncation, reason = "it is what readers do")]
    fn numbers_are_read_as_what_they_were() {
        let special = [0.0, -0.0, 1.0, -1.5, f32::MIN_POSITIVE, f32::MAX, 1e-45, 0.1, 16_777_217.0];
        let many = (0..200_000u32).map(|seed| f32::from_bits(seed.wrapping_mul(0x9e37_79b9)));
        for value in special.into_iter().chain(many).filter(|value| value.is_finite()) {
            assert_eq!((number(value).parse::<f64>().unwrap() as f32).to_bits(), value.to_bits(), "{value:e}");
        }
    }

    #[test]
    fn path_between_files_goes_up_and_down() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        [&a, &b].into_iter().for_each(|folder| std::fs::create_dir(folder).unwrap());
        std::fs::write(a.join("shot.usda"), "").unwrap();
        assert_eq!(relative(&a.join("fix.usda"), &a.join("shot.usda")), Path::new("./shot.usda"));
        assert_eq!(relative(&b.join("fix.usda"), &a.join("shot.usda")), Path::new("../a/shot.usda"));
        assert_eq!(asset(Path::new("./a@b.usda")), "@@@./a@b.usda@@@");
    }
}
