//! The structure of a text layer: prims, variants, their metadata and properties.

use super::{
    arcs,
    lexer::{Lexer, Token, unescape},
    values,
};
use crate::usd::{
    fault::Fault,
    layers::{
        spec::{MOST_DEPTH, PrimSpec, Property, STAGE_METADATA, Specifier, beyond},
        value::{Slot, Value},
    },
};

/// A prim or a variant, and those below it by name.
#[derive(Clone, Debug, Default)]
pub(super) struct Prim {
    pub(super) spec: PrimSpec,
    pub(super) below: std::collections::HashMap<String, u32>,
}

/// Builds the prims of a layer.
#[derive(Debug)]
pub(super) struct Parser<'b> {
    lexer: Lexer<'b>,
    pub(super) prims: Vec<Prim>,
}

impl<'b> Parser<'b> {
    /// Parses a layer; the first of its prims is the root.
    pub(super) fn parse(bytes: &'b [u8]) -> Result<Vec<Prim>, Fault> {
        let mut parser = Self { lexer: Lexer::new(bytes), prims: vec![Prim::default()] };
        if parser.lexer.take(b'(') {
            parser.metadata(0)?;
        }
        while parser.lexer.peek()? != Token::End {
            parser.item(0, 0)?;
        }
        Ok(parser.prims)
    }

    fn word(&mut self) -> Result<&'b str, Fault> {
        match self.lexer.next()? {
            Token::Word(word) => Ok(word),
            _ => Err(self.lexer.fault("a name is needed here")),
        }
    }

    fn quoted(&mut self) -> Result<String, Fault> {
        match self.lexer.next()? {
            Token::Quoted(text) => Ok(unescape(text).into_owned()),
            _ => Err(self.lexer.fault("a name in quotes is needed here")),
        }
    }

    /// One of the things that may stand in a prim.
    fn item(&mut self, prim: u32, depth: usize) -> Result<(), Fault> {
        if self.lexer.take(b';') {
            return Ok(());
        }
        match self.word()? {
            word @ ("def" | "over" | "class") => self.prim(prim, depth, word),
            "variantSet" => self.variant_set(prim, depth),
            "reorder" => {
                self.word()?;
                self.lexer.expect(b'=')?;
                self.lexer.skip_value()
            }
            word => self.property(prim, word),
        }
    }

    fn prim(&mut self, above: u32, depth: usize, specifier: &str) -> Result<(), Fault> {
        let type_name = match self.lexer.peek()? {
            Token::Word(_) => Some(self.word()?.to_owned()),
            _ => None,
        };
        let name = self.quoted()?;
        let prim = self.add(above, &name, depth)?;
        self.prims[above as usize].spec.children.push(name);
        let spec = &mut self.prims[prim as usize].spec;
        spec.type_name = type_name;
        spec.specifier = match specifier {
            "def" => Specifier::Def,
            "class" => Specifier::Class,
            _ => Specifier::Over,
        };
        self.body(prim, depth)
    }

    fn add(&mut self, above: u32, name: &str, depth: usize) -> Result<u32, Fault> {
        if depth >= MOST_DEPTH {
            return Err(self.lexer.fault("prims are nested too deeply here"));
        }
        let index = u32::try_from(self.prims.len()).map_err(|_| self.lexer.fault("there are too many prims"))?;
        if self.prims[above as usize].below.insert(name.to_owned(), index).is_some() {
            return Err(self.lexer.fault(format!("there are two prims `{name}` here")));
        }
        self.prims.push(Prim::default());
        Ok(index)
    }

    /// Metadata and contents of a prim or variant.
    fn body(&mut self, prim: u32, depth: usize) -> Result<(), Fault> {
        if self.lexer.take(b'(') {
            self.metadata(prim)?;
        }
        self.lexer.expect(b'{')?;
        let start = self.lexer.end();
        while !self.lexer.take_end(b'}', start)? {
            self.item(prim, depth + 1)?;
        }
        Ok(())
    }

    fn variant_set(&mut self, prim: u32, depth: usize) -> Result<(), Fault> {
        let set = self.quoted()?;
        self.lexer.expect(b'=')?;
        self.lexer.expect(b'{')?;
        let start = self.lexer.end();
        while !self.lexer.take_end(b'}', start)? {
            let variant = self.quoted()?;
            let index = self.add(prim, &format!("{{{set}={variant}}}"), depth)?;
            self.body(index, depth)?;
        }
        Ok(())
    }

    /// Metadata in round brackets, of which the first is taken already.
    fn metadata(&mut self, prim: u32) -> Result<(), Fault> {
        let start = self.lexer.end();
        while !self.lexer.take_end(b')', start)? {
            match self.lexer.next()? {
                Token::Quoted(_) | Token::Sign(b';' | b',') => {}
                Token::Word(word) => self.metadatum(prim, word)?,
                _ => return Err(self.lexer.fault("metadata are needed here")),
            }
        }
        Ok(())
    }

    fn metadatum(&mut self, prim: u32, word: &'b str) -> Result<(), Fault> {
        let edit = matches!(word, "prepend" | "append" | "add" | "delete" | "reorder").then_some(word);
        let name = if edit.is_some() { self.word()? } else { word };
        if !self.lexer.take(b'=') {
            return Ok(());
        }
        let lexer = &mut self.lexer;
        let spec = &mut self.prims[prim as usize].spec;
        let start = lexer.offset();
        match name {
            "inherits" | "specializes" if edit != Some("delete") => {
                spec.classes.extend(arcs::targets(lexer)?.into_iter().map(|target| target.prim));
            }
            "references" => arcs::edit(&mut spec.references, edit, arcs::targets(lexer)?),
            "payload" => arcs::edit(&mut spec.payloads, edit, arcs::targets(lexer)?),
            "subLayers" => spec.sublayers = arcs::targets(lexer)?,
            "variants" => spec.selections = arcs::selections(lexer)?,
            "variantSets" if edit != Some("delete") => spec.variant_sets.extend(arcs::names(lexer)?),
            "active" | "instanceable" => {
                let value = Some(matches!(lexer.next()?, Token::Word("true" | "True" | "1")));
                *(if name == "active" { &mut spec.active } else { &mut spec.instanceable }) = value;
            }
            name if prim == 0 && STAGE_METADATA.contains(&name) => {
                lexer.skip_value()?;
                let type_name = if matches!(name, "defaultPrim" | "upAxis") { "token" } else { "double" };
                let value = lexer.decode(start, |bytes| values::decode(bytes, type_name))?;
                spec.stage.insert(name.to_owned(), value);
            }
            name => {
                let is_none = lexer.peek()? == Token::Word("None");
                lexer.skip_value()?;
                spec.beyond = spec.beyond.or_else(|| beyond(name).filter(|_| !is_none && edit != Some("delete")));
            }
        }
        Ok(())
    }

    /// A property; its first word is taken already.
    fn property(&mut self, prim: u32, first: &'b str) -> Result<(), Fault> {
        let mut word = first;
        while matches!(word, "custom" | "uniform" | "varying" | "config" | "prepend" | "append" | "add" | "delete") {
            word = self.word()?;
        }
        let mut type_name = word.to_owned();
        if self.lexer.take(b'[') {
            self.lexer.expect(b']')?;
            type_name.push_str("[]");
        }
        let full = self.word()?;
        let (name, suffix) = full.rsplit_once('.').unwrap_or((full, ""));
        let mut property = Property::default();
        if self.lexer.take(b'=') {
            match suffix {
                "timeSamples" => property.samples = self.samples()?,
                _ => property.default = Some(self.slot()?).filter(|_| matches!(suffix, "" | "default")),
            }
            property.has_spline = suffix == "spline";
        }
        if self.lexer.take(b'(') {
            self.property_metadata(&mut property)?;
        }
        if type_name == "rel" || suffix == "connect" {
            return Ok(());
        }
        let own = self.prims[prim as usize].spec.properties.entry(name.to_owned()).or_default();
        own.type_name = type_name;
        own.default = property.default.or(own.default.take());
        own.interpolation = property.interpolation.or(own.interpolation.take());
        own.has_spline |= property.has_spline;
        if suffix == "timeSamples" {
            own.samples = property.samples;
        }
        Ok(())
    }

    fn property_metadata(&mut self, property: &mut Property) -> Result<(), Fault> {
        let start = self.lexer.end();
        while !self.lexer.take_end(b')', start)? {
            match self.lexer.next()? {
                Token::Word("interpolation") if self.lexer.take(b'=') => property.interpolation = Some(self.quoted()?),
                Token::Sign(b'=') => self.lexer.skip_value()?,
                _ => {}
            }
        }
        Ok(())
    }

    fn slot(&mut self) -> Result<Slot, Fault> {
        let start = self.lexer.offset();
        self.lexer.skip_value()?;
        Ok(Slot::Text { start: start as u64, length: (self.lexer.end() - start) as u64 })
    }

    /// `{ time: value, ... }`
    fn samples(&mut self) -> Result<Vec<(f64, Slot)>, Fault> {
        let mut samples: Vec<(f64, Slot)> = Vec::new();
        self.lexer.expect(b'{')?;
        let start = self.lexer.end();
        while !self.lexer.take_end(b'}', start)? {
            let word = self.lexer.until(b':')?;
            let time = word.parse().ok().filter(|time: &f64| time.is_finite());
            let time = time.ok_or_else(|| self.lexer.fault(format!("`{word}` is no time code")))?;
            samples.push((time, self.slot()?));
            self.lexer.take(b',');
        }
        samples.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        if samples.is_sorted_by(|(a, _), (b, _)| a < b) {
            return Ok(samples);
        }
        Err(self.lexer.fault("there are two samples of one time code"))
    }
}

impl<'b> Lexer<'b> {
    /// Decodes what was just skipped.
    fn decode(&self, start: usize, decode: impl Fn(&'b [u8]) -> Result<Value, Fault>) -> Result<Value, Fault> {
        decode(self.between(start)).map_err(|Fault { reason, .. }| self.fault(reason))
    }
}
