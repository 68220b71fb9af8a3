//! Reading ascii STL.

use crate::{
    error::ReadErrorKind,
    formats::{
        mesh_data::MeshData,
        part::{Part, PartBuilder, PartName},
        stl::{
            facet::{FacetOffsets, Facets},
            write::StlDocument,
        },
        text::{self, LogicalLines, Tokens},
    },
};

#[derive(Default)]
struct Parser {
    facets: Facets,
    offsets: Vec<FacetOffsets>,
    parts: PartBuilder,
    open: FacetOffsets,
    corners: Vec<[f64; 3]>,
    is_open: bool,
}

/// Parses a whole file. An error comes with its line.
pub(super) fn parse(source: Vec<u8>) -> Result<(MeshData, StlDocument), (Option<usize>, ReadErrorKind)> {
    let mut parser = Parser::default();
    for (line, mut tokens) in LogicalLines::new(&source) {
        parser.line(&mut tokens).map_err(|kind| (Some(line), kind))?;
    }
    if parser.is_open {
        let element = format!("facet {}", parser.offsets.len());
        return Err((None, ReadErrorKind::Truncated { element }));
    }
    let Parser { facets, offsets, parts, .. } = parser;
    let parts: Vec<Part> = parts.finish(facets.polygons.len(), facets.positions.len());
    let (mut data, document) = StlDocument::new(source, Some(offsets), facets);
    data.parts = parts;
    Ok((data, document))
}

impl Parser {
    fn line(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadErrorKind> {
        let Some((_, word)) = tokens.next() else { return Ok(()) };
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => {
                let words: Vec<&[u8]> = tokens.map(|(_, token)| token).collect();
                let name = String::from_utf8_lossy(&words.join(&b' ')).into();
                let part = (!words.is_empty()).then_some(PartName { kind: "solid", name });
                self.parts.rename(self.facets.polygons.len(), self.facets.positions.len(), |open| open.outer = part);
                Ok(())
            }
            b"facet" => self.facet(tokens),
            b"vertex" if self.is_open => self.corner(tokens),
            b"endfacet" => self.end_facet(),
            b"outer" | b"endloop" | b"endsolid" => Ok(()),
            _ => Err(ReadErrorKind::Malformed(format!("`{}` is no line of an STL file", text::shortened(word)))),
        }
    }

    fn name(&self) -> String {
        format!("facet {}", self.offsets.len())
    }

    fn facet(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadErrorKind> {
        if self.is_open {
            return Err(ReadErrorKind::Malformed(format!("{} has no `endfacet`", self.name())));
        }
        self.is_open = true;
        self.open = FacetOffsets::default();
        self.corners.clear();
        // The word `normal`.
        tokens.next();
        self.open.normal = self.numbers(tokens, |token, _| Ok(text::number(token).unwrap_or(0.0)))?.1;
        Ok(())
    }

    fn corner(&mut self, tokens: &mut Tokens<'_>) -> Result<(), ReadErrorKind> {
        let (corner, offsets) = self.numbers(tokens, |token, element| text::finite_number(token, element))?;
        if let Some(slot) = self.open.corners.get_mut(self.corners.len()) {
            *slot = offsets;
        }
        self.corners.push(corner);
        Ok(())
    }

    fn numbers(
        &self,
        tokens: &mut Tokens<'_>,
        parse: impl Fn(&[u8], &dyn Fn() -> String) -> Result<f64, ReadErrorKind>,
    ) -> Result<([f64; 3], [usize; 3]), ReadErrorKind> {
        let element = || self.name();
        let (mut values, mut offsets) = ([0.0; 3], [0; 3]);
        for axis in 0..3 {
            let Some((offset, token)) = tokens.next() else {
                return Err(ReadErrorKind::TooFewCoordinates { element: element(), given: axis, needed: 3 });
            };
            values[axis] = parse(token, &element)?;
            offsets[axis] = offset;
        }
        Ok((values, offsets))
    }

    fn end_facet(&mut self) -> Result<(), ReadErrorKind> {
        let Ok(corners) = <[[f64; 3]; 3]>::try_from(self.corners.as_slice()) else {
            let what = format!("{} has {} corners, 3 are needed", self.name(), self.corners.len());
            return Err(ReadErrorKind::Malformed(what));
        };
        self.is_open = false;
        self.facets.push(corners);
        self.offsets.push(self.open);
        Ok(())
    }
}
