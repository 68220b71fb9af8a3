//! Reading OBJ.

use std::io::{self, Write};

use crate::{
    error::ReadErrorKind,
    formats::{
        mesh_data::MeshData,
        part::{PartBuilder, PartName},
        polygon::{NO_UV, Polygons},
        text::{self, LogicalLines, Tokens},
    },
};

/// An OBJ file as it was read.
#[derive(Clone, Debug)]
pub(crate) struct ObjDocument {
    pub(crate) source: Vec<u8>,
    /// Byte offsets of the coordinates of each vertex.
    pub(crate) coordinate_offsets: Vec<[usize; 3]>,
}

impl ObjDocument {
    /// Writes the file with other positions; only the tokens of coordinates that changed are replaced.
    pub(crate) fn write(&self, before: &[[f64; 3]], after: &[[f64; 3]], out: &mut dyn Write) -> io::Result<()> {
        text::write_replaced(&self.source, &self.coordinate_offsets, before, after, out)
    }

    /// The line of a vertex, counted from 1.
    pub(crate) fn line_of_vertex(&self, vertex: usize) -> Option<usize> {
        Some(text::line_of(&self.source, self.coordinate_offsets.get(vertex)?[0]))
    }
}

/// Parses a whole file. An error comes with its line.
pub(crate) fn parse(source: Vec<u8>) -> Result<(MeshData, ObjDocument), (Option<usize>, ReadErrorKind)> {
    let mut parser = Parser::default();
    let skipped = mark_length(&source);
    let text = &source[skipped..];
    for (line, mut tokens) in LogicalLines::new(text) {
        parser.line(line, &mut tokens).map_err(|kind| (Some(line), kind))?;
    }
    parser.check_references()?;
    for offset in parser.coordinate_offsets.iter_mut().flatten() {
        *offset += skipped;
    }
    let Parser { positions, uv_coordinates, polygons, coordinate_offsets, parts, .. } = parser;
    let parts = parts.finish(polygons.len(), positions.len());
    Ok((MeshData { positions, uv_coordinates, polygons, parts }, ObjDocument { source, coordinate_offsets }))
}

/// Length of the byte order mark at the start of a text.
pub(crate) fn mark_length(source: &[u8]) -> usize {
    const MARK: &[u8] = b"\xef\xbb\xbf";
    if source.starts_with(MARK) { MARK.len() } else { 0 }
}

/// The name in the rest of a line, if there is one.
fn part_name(kind: &'static str, tokens: &mut Tokens<'_>) -> Option<PartName> {
    let words: Vec<&[u8]> = tokens.map(|(_, token)| token).collect();
    let name = String::from_utf8_lossy(&words.join(&b' ')).into();
    (!words.is_empty()).then_some(PartName { kind, name })
}

#[derive(Default)]
struct Parser {
    positions: Vec<[f64; 3]>,
    coordinate_offsets: Vec<[usize; 3]>,
    uv_coordinates: Vec<[f64; 2]>,
    polygons: Polygons,
    polygon_lines: Vec<usize>,
    parts: PartBuilder,
}

impl Parser {
    fn line(&mut self, line: usize, tokens: &mut Tokens<'_>) -> Result<(), ReadErrorKind> {
        match tokens.next() {
            Some((_, b"v")) => self.vertex(tokens),
            Some((_, b"vt")) => self.texture_coordinate(tokens),
            // `fo` is the outdated spelling of `f`.
            Some((_, b"f" | b"fo")) => self.face(line, tokens),
            Some((_, b"o")) => {
                let name = part_name("object", tokens);
                self.parts.rename(self.polygons.len(), self.positions.len(), |part| part.outer = name);
                Ok(())
            }
            Some((_, b"g")) => {
                let name = part_name("group", tokens);
                self.parts.rename(self.polygons.len(), self.positions.len(), |part| part.inner = name);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn vertex(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadErrorKind> {
        let element = || format!("vertex {}", self.positions.len() + 1);
        let (mut position, mut offsets) = ([0.0; 3], [0; 3]);
        for axis in 0..3 {
            let Some((offset, token)) = tokens.next() else {
                return Err(ReadErrorKind::TooFewCoordinates { element: element(), given: axis, needed: 3 });
            };
            position[axis] = text::finite_number(token, element)?;
            offsets[axis] = offset;
        }
        self.positions.push(position);
        self.coordinate_offsets.push(offsets);
        Ok(())
    }

    fn texture_coordinate(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadErrorKind> {
        let element = || format!("texture coordinate {}", self.uv_coordinates.len() + 1);
        let Some((_, token)) = tokens.next() else {
            return Err(ReadErrorKind::TooFewCoordinates { element: element(), given: 0, needed: 1 });
        };
        let u = text::finite_number(token, element)?;
        // The format allows one-dimensional textures.
        let v = tokens.next().map_or(Ok(0.0), |(_, token)| text::finite_number(token, element))?;
        self.uv_coordinates.push([u, v]);
        Ok(())
    }

    fn face(&mut self, line: usize, tokens: &mut Tokens<'_>) -> Result<(), ReadErrorKind> {
        for (_, token) in tokens {
            let mut fields = token.split(|&byte| byte == b'/');
            let vertex = self.index(fields.next().unwrap_or_default(), token, "vertex", self.positions.len())?;
            let uv = match fields.next() {
                None | Some([]) => NO_UV,
                Some(field) => self.index(field, token, "texture coordinate", self.uv_coordinates.len())?,
            };
            self.polygons.push_corner(vertex, uv);
        }
        let given = self.polygons.finish_polygon();
        self.polygon_lines.push(line);
        if given < 3 {
            return Err(ReadErrorKind::TooFewCorners { element: self.face_name(self.polygons.len() - 1), given });
        }
        Ok(())
    }

    fn face_name(&self, polygon: usize) -> String {
        format!("face {}", polygon + 1)
    }

    /// A 0-based index; a negative one counts back from the newest element.
    /// [`check_references`](Self::check_references) checks the positive ones at the end of the file, since a face may
    /// come before its vertices.
    fn index(&self, field: &[u8], token: &[u8], what: &'static str, defined: usize) -> Result<u32, ReadErrorKind> {
        let element = || self.face_name(self.polygons.len());
        let index: i64 = std::str::from_utf8(field)
            .ok()
            .and_then(|field| field.parse().ok())
            .filter(|&index| index != 0)
            .ok_or_else(|| ReadErrorKind::NotAnIndex { element: element(), text: text::shortened(token) })?;
        let from_zero =
            if index > 0 { Some(index - 1) } else { i64::try_from(defined).ok().map(|count| count + index) };
        from_zero
            .and_then(|index| u32::try_from(index).ok())
            .filter(|&index| index != NO_UV)
            .ok_or_else(|| ReadErrorKind::OutOfRange { element: element(), what, index, defined })
    }

    fn check_references(&self) -> Result<(), (Option<usize>, ReadErrorKind)> {
        let check = |polygon: usize, what, index: u32, defined: usize| {
            if (index as usize) < defined {
                return Ok(());
            }
            let (element, index) = (self.face_name(polygon), i64::from(index) + 1);
            Err((Some(self.polygon_lines[polygon]), ReadErrorKind::OutOfRange { element, what, index, defined }))
        };
        for polygon in 0..self.polygons.len() {
            for &corner in self.polygons.corners(polygon) {
                check(polygon, "vertex", corner, self.positions.len())?;
            }
            for &corner in self.polygons.raw_uv_corners(polygon).iter().filter(|&&corner| corner != NO_UV) {
                check(polygon, "texture coordinate", corner, self.uv_coordinates.len())?;
            }
        }
        Ok(())
    }
}
