//! Reading PLY.

use std::ops::Range;

use crate::{
    error::ReadErrorKind,
    formats::{
        mesh_data::MeshData,
        polygon::{NO_UV, Polygons},
        text::{self, Tokens},
    },
};

use super::header::{self, Element, Encoding, Header, Property, Scalar};

/// A PLY file as it was read.
#[derive(Clone, Debug)]
pub(crate) struct PlyDocument {
    pub(crate) source: Vec<u8>,
    pub(crate) encoding: Encoding,
    /// The types of the three coordinates, for each element `vertex` its own, with the vertices of that element.
    pub(crate) types: Vec<(Range<usize>, [Scalar; 3])>,
    /// Byte offsets of the coordinates of each vertex.
    pub(crate) coordinate_offsets: Vec<[usize; 3]>,
}

impl PlyDocument {
    /// The line of a vertex, counted from 1, if the file is text.
    pub(crate) fn line_of_vertex(&self, vertex: usize) -> Option<usize> {
        let offset = self.coordinate_offsets.get(vertex)?[0];
        (self.encoding == Encoding::Ascii).then(|| text::line_of(&self.source, offset))
    }
}

type Located<T> = Result<T, (Option<usize>, ReadErrorKind)>;

/// Parses a whole file. An error comes with its line, if the file is text.
pub(crate) fn parse(source: Vec<u8>) -> Located<(MeshData, PlyDocument)> {
    let header = header::parse(&source)?;
    let mut body = Body { source: &source, start: header.body, at: header.body, encoding: header.encoding };
    let mut reader = Reader::default();
    reader.elements(&header, &mut body).map_err(|kind| (body.line(), kind))?;
    let data = reader.finish();
    let (types, coordinate_offsets) = (reader.types, reader.coordinate_offsets);
    Ok((data, PlyDocument { encoding: header.encoding, types, coordinate_offsets, source }))
}

/// A cursor in the values after the header.
struct Body<'a> {
    source: &'a [u8],
    start: usize,
    at: usize,
    encoding: Encoding,
}

impl Body<'_> {
    /// The current line of a text file. Before the first value there is none: the header is at fault, not a line.
    fn line(&self) -> Option<usize> {
        let has_read = self.at > self.start;
        (has_read && self.encoding == Encoding::Ascii).then(|| text::line_of(self.source, self.at.saturating_sub(1)))
    }

    /// The next number and its byte offset. A double holds all types exactly.
    fn value(&mut self, scalar: Scalar, element: &dyn Fn() -> String) -> Result<(f64, usize), ReadErrorKind> {
        let truncated = || ReadErrorKind::Truncated { element: element() };
        if self.encoding == Encoding::Ascii {
            let mut tokens = Tokens::new(self.source, self.at, self.source.len());
            let (start, token) = tokens.next().ok_or_else(truncated)?;
            self.at = tokens.offset();
            let value = text::number(token)
                .ok_or_else(|| ReadErrorKind::NotANumber { element: element(), text: text::shortened(token) })?;
            return Ok((value, start));
        }
        let start = self.at;
        let bytes = self.source.get(start..start + scalar.size()).ok_or_else(truncated)?;
        self.at += scalar.size();
        Ok((decode(bytes, scalar, self.encoding), start))
    }

    /// The length of a list, checked against the rest of the file before any memory is taken.
    fn list_length(
        &mut self,
        count: Scalar,
        item: Scalar,
        element: &dyn Fn() -> String,
    ) -> Result<usize, ReadErrorKind> {
        let (value, _) = self.value(count, element)?;
        // An entry of a text file has two bytes or more, the last one or more.
        let size = if self.encoding == Encoding::Ascii { 2 } else { item.size() };
        match whole_number(value) {
            Some(length) if length as usize <= (self.source.len() - self.at + 1) / size => Ok(length as usize),
            Some(_) => Err(ReadErrorKind::Truncated { element: element() }),
            None => Err(ReadErrorKind::Malformed(format!("{} has a list of length {value}", element()))),
        }
    }
}

/// Decodes a number of a binary file; `bytes` has its size.
fn decode(bytes: &[u8], scalar: Scalar, encoding: Encoding) -> f64 {
    let mut raw = [0u8; 8];
    // The significant bytes first, in little-endian order.
    for (slot, at) in raw.iter_mut().zip(0..bytes.len()) {
        *slot = bytes[if encoding == Encoding::BigEndian { bytes.len() - 1 - at } else { at }];
    }
    let [a, b, c, d, ..] = raw;
    match scalar {
        Scalar::I8 => i8::from_le_bytes([a]).into(),
        Scalar::U8 => a.into(),
        Scalar::I16 => i16::from_le_bytes([a, b]).into(),
        Scalar::U16 => u16::from_le_bytes([a, b]).into(),
        Scalar::I32 => i32::from_le_bytes([a, b, c, d]).into(),
        Scalar::U32 => u32::from_le_bytes([a, b, c, d]).into(),
        Scalar::F32 => f32::from_le_bytes([a, b, c, d]).into(),
        Scalar::F64 => f64::from_le_bytes(raw),
    }
}

/// Converts a double to an index, if it is a whole number in range.
fn whole_number(value: f64) -> Option<u32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked by converting back")]
    let whole = value as u32;
    (f64::from(whole).to_bits() == value.to_bits() && whole != NO_UV).then_some(whole)
}

#[derive(Default)]
struct Reader {
    positions: Vec<[f64; 3]>,
    coordinate_offsets: Vec<[usize; 3]>,
    types: Vec<(Range<usize>, [Scalar; 3])>,
    vertex_uvs: Vec<[f64; 2]>,
    face_uvs: Vec<[f64; 2]>,
    polygons: Polygons,
}

impl Reader {
    fn elements(&mut self, header: &Header, body: &mut Body<'_>) -> Result<(), ReadErrorKind> {
        let vertices = header.elements.iter().filter(|element| element.name == b"vertex");
        let num_vertices = vertices.fold(0usize, |sum, element| sum.saturating_add(element.count));
        for element in &header.elements {
            let name = text::shortened(&element.name);
            if element.properties.is_empty() && element.count > 0 {
                return Err(ReadErrorKind::Malformed(format!("element `{name}` has no properties")));
            }
            match element.name.as_slice() {
                b"vertex" => self.vertices(element, body)?,
                b"face" => self.faces(element, num_vertices, body)?,
                _ => {
                    for entry in 0..element.count {
                        for property in &element.properties {
                            skip(property, body, &|| format!("{name} {entry}"))?;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn vertices(&mut self, element: &Element, body: &mut Body<'_>) -> Result<(), ReadErrorKind> {
        const UV_NAMES: [[&[u8]; 2]; 3] = [[b"s", b"t"], [b"u", b"v"], [b"texture_u", b"texture_v"]];
        let column = |name: &[u8]| {
            element.properties.iter().position(|property| property.count.is_none() && property.name == name)
        };
        let mut columns = [0; 3];
        for (slot, name) in columns.iter_mut().zip([b"x", b"y", b"z"]) {
            *slot = column(name).ok_or_else(|| {
                ReadErrorKind::Malformed(format!("element `vertex` has no property `{}`", text::shortened(name)))
            })?;
        }
        let first = self.positions.len();
        let uv_columns = UV_NAMES.iter().find_map(|[u, v]| Some([column(u)?, column(v)?]));
        for vertex in 0..element.count {
            let name = || format!("vertex {vertex}");
            let (mut position, mut offsets, mut uv) = ([0.0; 3], [0; 3], [0.0; 2]);
            for (at, property) in element.properties.iter().enumerate() {
                let axis = columns.iter().position(|&column| column == at);
                let uv_axis = uv_columns.and_then(|columns| columns.iter().position(|&column| column == at));
                if axis.is_none() && uv_axis.is_none() {
                    skip(property, body, &name)?;
                    continue;
                }
                let (value, offset) = body.value(property.item, &name)?;
                if !value.is_finite() {
                    return Err(ReadErrorKind::NotFinite { element: name(), value });
                }
                if let Some(axis) = axis {
                    (position[axis], offsets[axis]) = (value, offset);
                }
                if let Some(axis) = uv_axis {
                    uv[axis] = value;
                }
            }
            self.positions.push(position);
            self.coordinate_offsets.push(offsets);
            if uv_columns.is_some() {
                self.vertex_uvs.push(uv);
            }
        }
        let types = columns.map(|column| element.properties[column].item);
        self.types.push((first..self.positions.len(), types));
        Ok(())
    }

    /// `defined` is the number of vertices that the header promises, before the faces or after them.
    fn faces(&mut self, element: &Element, defined: usize, body: &mut Body<'_>) -> Result<(), ReadErrorKind> {
        let is = |property: &Property, names: &[&[u8]]| property.count.is_some() && names.contains(&&*property.name);
        let corners_at =
            element.properties.iter().position(|property| is(property, &[b"vertex_indices", b"vertex_index"]));
        let Some(corners_at) = corners_at else {
            return Err(ReadErrorKind::Malformed("element `face` has no list `vertex_indices`".into()));
        };
        let uvs_at = element.properties.iter().position(|property| is(property, &[b"texcoord"]));
        let (mut corners, mut uvs) = (Vec::new(), Vec::new());
        for face in 0..element.count {
            let name = || format!("face {face}");
            for (at, property) in element.properties.iter().enumerate() {
                match property.count {
                    Some(count) if at == corners_at => read_list(count, property.item, body, &name, &mut corners)?,
                    Some(count) if Some(at) == uvs_at => read_list(count, property.item, body, &name, &mut uvs)?,
                    _ => skip(property, body, &name)?,
                }
            }
            if corners.len() < 3 {
                return Err(ReadErrorKind::TooFewCorners { element: name(), given: corners.len() });
            }
            let has_uvs = uvs.len() == 2 * corners.len() && uvs.iter().all(|uv| uv.is_finite());
            for (k, &corner) in corners.iter().enumerate() {
                let vertex = whole_number(corner)
                    .ok_or_else(|| ReadErrorKind::NotAnIndex { element: name(), text: corner.to_string() })?;
                if vertex as usize >= defined {
                    let index = vertex.into();
                    return Err(ReadErrorKind::OutOfRange { element: name(), what: "vertex", index, defined });
                }
                let mut uv = NO_UV;
                if has_uvs {
                    uv = u32::try_from(self.face_uvs.len()).unwrap_or(NO_UV);
                    self.face_uvs.push([uvs[2 * k], uvs[2 * k + 1]]);
                }
                self.polygons.push_corner(vertex, uv);
            }
            self.polygons.finish_polygon();
        }
        Ok(())
    }

    /// Hands over the mesh, with the texture coordinates of the faces or else those of the vertices.
    fn finish(&mut self) -> MeshData {
        let mut uv_coordinates = std::mem::take(&mut self.face_uvs);
        // One of several elements `vertex` may have texture coordinates where another has none.
        let has_uvs = !self.vertex_uvs.is_empty() && self.vertex_uvs.len() == self.positions.len();
        if uv_coordinates.is_empty() && has_uvs {
            self.polygons.use_vertices_as_uvs();
            uv_coordinates = std::mem::take(&mut self.vertex_uvs);
        }
        MeshData {
            positions: std::mem::take(&mut self.positions),
            uv_coordinates,
            polygons: std::mem::take(&mut self.polygons),
            parts: Vec::new(),
        }
    }
}

fn read_list(
    count: Scalar,
    item: Scalar,
    body: &mut Body<'_>,
    element: &dyn Fn() -> String,
    list: &mut Vec<f64>,
) -> Result<(), ReadErrorKind> {
    list.clear();
    for _ in 0..body.list_length(count, item, element)? {
        list.push(body.value(item, element)?.0);
    }
    Ok(())
}

fn skip(property: &Property, body: &mut Body<'_>, element: &dyn Fn() -> String) -> Result<(), ReadErrorKind> {
    let length = match property.count {
        Some(count) => body.list_length(count, property.item, element)?,
        None => 1,
    };
    for _ in 0..length {
        body.value(property.item, element)?;
    }
    Ok(())
}
