//! Wavefront OBJ, as far as a cloth needs it.
//!
//! Read are `v`, `vt` and `f` (polygons as fans, negative indices); all else is skipped. Positions are written so that
//! they read back to the same bits. This reader shares no code with the untangler, on purpose: together with the [exact
//! check](untangled_checker) it judges files that the untangler wrote, and a fault in a shared reader would escape
//! both.

use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use thiserror::Error;

use crate::mesh::{Cloth, Uvs, Vec3};

/// A file that can't be used.
#[derive(Debug, Error)]
pub enum ObjError {
    /// The file can't be read or written.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A line that can't be parsed.
    #[error("{path}:{line}: {reason}: `{text}`")]
    Line {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        reason: &'static str,
        /// The line.
        text: String,
    },
    /// The file has no faces.
    #[error("{0}: there are no faces in this file")]
    Empty(PathBuf),
}

/// Reads a cloth. Its rest shape is the shape that it has in the file.
///
/// # Errors
/// [`ObjError`], with the line at fault.
pub fn read(path: &Path) -> Result<Cloth, ObjError> {
    let text = fs::read_to_string(path).map_err(|source| ObjError::File { path: path.into(), source })?;
    let mut reader = Reader::default();
    for (number, line) in (1..).zip(text.lines()) {
        reader.line(line).map_err(|reason| ObjError::Line {
            path: path.into(),
            line: number,
            reason,
            text: line.trim().into(),
        })?;
    }
    let Reader { positions, coordinates, triangles, corners, all_corners_have_uvs } = reader;
    if triangles.is_empty() {
        return Err(ObjError::Empty(path.into()));
    }
    let uvs = (all_corners_have_uvs && !corners.is_empty()).then_some(Uvs { coordinates, corners });
    let mut cloth = Cloth { positions, triangles, uvs, ..Cloth::default() };
    cloth.round_to_f32();
    cloth.rest_positions.clone_from(&cloth.positions);
    Ok(cloth)
}

struct Reader {
    positions: Vec<Vec3>,
    coordinates: Vec<[f64; 2]>,
    triangles: Vec<[u32; 3]>,
    corners: Vec<[u32; 3]>,
    all_corners_have_uvs: bool,
}

impl Default for Reader {
    fn default() -> Self {
        Self {
            positions: Vec::new(),
            coordinates: Vec::new(),
            triangles: Vec::new(),
            corners: Vec::new(),
            all_corners_have_uvs: true,
        }
    }
}

impl Reader {
    fn line(&mut self, line: &str) -> Result<(), &'static str> {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => self.positions.push(Vec3::from(numbers(words)?)),
            Some("vt") => {
                let u = number(words.next())?;
                self.coordinates.push([u, words.next().map_or(Ok(0.0), |word| number(Some(word)))?]);
            }
            Some("f") => self.face(words)?,
            _ => {}
        }
        Ok(())
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Result<(), &'static str> {
        let mut polygon = Vec::new();
        for word in words {
            let mut parts = word.split('/');
            let vertex = index(parts.next(), self.positions.len())?;
            let uv = match parts.next() {
                None | Some("") => None,
                part => Some(index(part, self.coordinates.len())?),
            };
            polygon.push((vertex, uv));
        }
        if polygon.len() < 3 {
            return Err("a face needs at least three vertices");
        }
        for pair in polygon[1..].windows(2) {
            let triangle = [polygon[0], pair[0], pair[1]];
            self.triangles.push(triangle.map(|(vertex, _)| vertex));
            match triangle.map(|(_, uv)| uv) {
                [Some(a), Some(b), Some(c)] => self.corners.push([a, b, c]),
                _ => self.all_corners_have_uvs = false,
            }
        }
        Ok(())
    }
}

fn numbers<'a, const N: usize>(mut words: impl Iterator<Item = &'a str>) -> Result<[f64; N], &'static str> {
    let mut values = [0.0; N];
    for value in &mut values {
        *value = number(words.next())?;
    }
    Ok(values)
}

fn number(word: Option<&str>) -> Result<f64, &'static str> {
    let value: f64 = word.ok_or("a number is missing")?.parse().map_err(|_| "this is not a number")?;
    if value.is_finite() && value.abs() <= f64::from(f32::MAX) {
        Ok(value)
    } else {
        Err("a coordinate is not finite in single precision")
    }
}

/// Converts an index of the file (from 1, or backwards from -1) to one from 0.
fn index(word: Option<&str>, count: usize) -> Result<u32, &'static str> {
    let given: i64 = word.and_then(|word| word.parse().ok()).ok_or("this is not an index")?;
    let count = i64::try_from(count).map_err(|_| "the file is too large")?;
    let from_zero = if given < 0 { count + given } else { given - 1 };
    if (0..count).contains(&from_zero) {
        u32::try_from(from_zero).map_err(|_| "the file is too large")
    } else {
        Err("an index names nothing that stands above")
    }
}

/// Writes the current positions of a cloth, its texture coordinates and its triangles.
///
/// # Errors
/// [`ObjError::File`].
pub fn write(path: &Path, cloth: &Cloth) -> Result<(), ObjError> {
    let attempt = || -> io::Result<()> {
        let mut file = BufWriter::new(fs::File::create(path)?);
        for position in &cloth.positions {
            writeln!(file, "v {} {} {}", position.x, position.y, position.z)?;
        }
        if let Some(uvs) = &cloth.uvs {
            for [u, v] in &uvs.coordinates {
                writeln!(file, "vt {u} {v}")?;
            }
            for (triangle, corners) in cloth.triangles.iter().zip(&uvs.corners) {
                let [a, b, c] = triangle.map(|vertex| vertex + 1);
                let [p, q, r] = corners.map(|corner| corner + 1);
                writeln!(file, "f {a}/{p} {b}/{q} {c}/{r}")?;
            }
        } else {
            for triangle in &cloth.triangles {
                let [a, b, c] = triangle.map(|vertex| vertex + 1);
                writeln!(file, "f {a} {b} {c}")?;
            }
        }
        file.flush()
    };
    attempt().map_err(|source| ObjError::File { path: path.into(), source })
}

#[cfg(test)]
mod tests {
    use untangled_checker::{edge_face_hits, face_pairs};

    use super::*;

    fn read_text(name: &str, text: &str) -> Result<Cloth, ObjError> {
        let path = std::env::temp_dir().join(format!("untangled-publisher-{}-{name}", std::process::id()));
        fs::write(&path, text).unwrap();
        let result = read(&path);
        fs::remove_file(&path).unwrap();
        result
    }

    #[test]
    fn read_of_polygons_negative_indices_and_texture_coordinates_gives_a_fan() {
        let text =
            "# cloth\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 -1/-1\n";
        let cloth = read_text("quad", text).unwrap();
        assert_eq!(cloth.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(cloth.uvs.as_ref().unwrap().corners, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(cloth.positions[3].z.to_bits(), f64::from(0.1_f32).to_bits());
        assert!(read_text("bare", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap().uvs.is_none());
    }

    #[test]
    fn write_then_read_gives_the_same_bits() {
        let mut cloth =
            read_text("first", "v 0.1 1e-7 3.3333333\nv 1 0 0\nv 0 1 0\nvt 0.1 0.2\nf 1/1 2/1 3/1\n").unwrap();
        let path = std::env::temp_dir().join(format!("untangled-publisher-{}-again", std::process::id()));
        write(&path, &cloth).unwrap();
        cloth.rest_positions.clone_from(&cloth.positions);
        assert_eq!(read(&path).unwrap(), cloth);
        fs::remove_file(&path).unwrap();
    }

    #[test]
    fn read_of_bad_lines_names_them() {
        let error = read_text("bad", "v 0 0 0\nf 1 2 3\n").unwrap_err().to_string();
        assert!(error.ends_with(":2: an index names nothing that stands above: `f 1 2 3`"), "{error}");
        assert!(matches!(read_text("nan", "v 0 nan 0\n"), Err(ObjError::Line { line: 1, .. })));
        assert!(matches!(read_text("empty", "v 0 0 0\n"), Err(ObjError::Empty(_))));
    }

    #[test]
    fn face_pairs_of_shared_meshes_have_known_numbers() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
        for (file, expected) in
            [("tshirt_trifold_3k7.obj", 117), ("tshirt_rest_3k7.obj", 0), ("unisex_shirt_12k7.obj", 0)]
        {
            let path = std::path::Path::new(folder).join(file);
            if !path.exists() {
                println!("skipped: no {}", path.display());
                continue;
            }
            let cloth = read(&path).unwrap();
            let hits = edge_face_hits(&cloth.points(), &cloth.triangles).unwrap();
            assert_eq!(face_pairs(&hits, &cloth.triangles).len(), expected, "{file}");
        }
    }
}
