//! Crate files: the binary format of USD, `.usdc`.
//!
//! Sections of structure are read when a file is opened; values stay in the file until they are asked for. Sources:
//! the AOUSD Core Specification 1.0, section 16.3, and `crateFile.cpp` of OpenUSD.
//!
//! | file | purpose |
//! |---|---|
//! | `integers` | compressed blocks and integers |
//! | `tables` | tokens, fields, paths, specs |
//! | `rep` | the representation of a value |
//! | `reader` | numbers one after the other, and structures of them |
//! | `values` | values by their representation |

mod integers;
mod reader;
mod rep;
mod tables;
mod values;

use std::collections::HashMap;

use super::{
    source::Source,
    spec::{ArcTarget, MOST_DEPTH, PrimSpec, Property, STAGE_METADATA, Specifier, beyond},
    value::{Slot, Value},
};
use crate::usd::fault::Fault;
use rep::Rep;
use tables::{END, MAGIC, Tables};

/// A layer in a crate file.
#[derive(Debug)]
pub(super) struct BinaryLayer {
    tables: Tables,
    root: u32,
    /// Prims and variants by the path above and their token.
    prims: HashMap<(u32, u32), u32>,
    properties: HashMap<u32, Vec<u32>>,
    tokens: HashMap<String, u32>,
}

/// Whether these are the first bytes of a crate file.
pub(super) fn is_binary(start: &[u8]) -> bool {
    start.starts_with(MAGIC)
}

impl BinaryLayer {
    pub(super) fn read(source: Source) -> Result<Self, Fault> {
        let tables = Tables::read(source)?;
        let (mut prims, mut properties, mut root) = (HashMap::new(), HashMap::<_, Vec<_>>::new(), None);
        for (index, node) in (0u32..).zip(&tables.paths) {
            match node.parent {
                None if root.is_none() && tables.specs.contains_key(&index) => root = Some(index),
                None => {}
                Some(parent) if node.is_property => properties.entry(parent).or_default().push(index),
                Some(parent) => drop(prims.insert((parent, node.token), index)),
            }
        }
        let root = root.ok_or_else(|| Fault::new("has no root"))?;
        let tokens = (0..).zip(&tables.tokens).map(|(index, token)| (token.clone(), index)).collect();
        Ok(Self { tables, root, prims, properties, tokens })
    }

    pub(super) fn root(&self) -> u32 {
        self.root
    }

    /// A prim, or a variant as `{set=name}`, below another.
    pub(super) fn child(&self, prim: u32, name: &str) -> Option<u32> {
        let token = self.tokens.get(name)?;
        self.prims.get(&(prim, *token)).copied()
    }

    pub(super) fn value(&self, rep: u64) -> Result<Value, Fault> {
        self.tables.value(Rep(rep))
    }

    pub(super) fn budget(&self) -> u64 {
        self.tables.source.budget()
    }

    /// What the layer says of a prim; nothing where it only names the path.
    pub(super) fn spec(&self, prim: u32) -> Result<Option<PrimSpec>, Fault> {
        let tables = &self.tables;
        if !tables.specs.contains_key(&prim) {
            return Ok(None);
        }
        let mut spec = PrimSpec::default();
        let mut retimings = Vec::new();
        for (name, rep) in self.fields(prim)? {
            let value = || tables.value(rep);
            let texts = || Ok::<_, Fault>(if let Value::Texts(texts) = value()? { texts } else { Vec::new() });
            match name {
                "specifier" => spec.specifier = specifier(&value()?),
                "typeName" => {
                    spec.type_name = value()?.as_text().filter(|name| !name.is_empty()).map(ToOwned::to_owned)
                }
                "active" => spec.active = value()?.as_bool(),
                "instanceable" => spec.instanceable = value()?.as_bool(),
                "references" => spec.references = tables.reader(rep).references()?,
                "payload" => spec.payloads = tables.reader(rep).payloads(rep)?,
                "inheritPaths" | "specializes" => spec.classes.extend(tables.reader(rep).paths()?),
                "variantSelection" => spec.selections = tables.reader(rep).selections()?.into_iter().collect(),
                "variantSetNames" => spec.variant_sets = texts()?,
                "primChildren" => spec.children = texts()?,
                "subLayers" => spec.sublayers = texts()?.into_iter().map(sublayer).collect(),
                "subLayerOffsets" => retimings = tables.reader(rep).retimings()?,
                name if STAGE_METADATA.contains(&name) => drop(spec.stage.insert(name.to_owned(), value()?)),
                name => spec.beyond = spec.beyond.or_else(|| beyond(name)),
            }
        }
        for (sublayer, retiming) in spec.sublayers.iter_mut().zip(retimings) {
            sublayer.retiming = retiming;
        }
        let mut num_samples = 0;
        for &property in self.properties.get(&prim).into_iter().flatten() {
            let name = tables.token(tables.paths[property as usize].token)?.to_owned();
            let property = self.property(property)?;
            num_samples += property.samples.len() as u64;
            // Properties may share their samples.
            tables::bounded(&tables.source, num_samples, 32)?;
            spec.properties.insert(name, property);
        }
        Ok(Some(spec))
    }

    fn property(&self, path: u32) -> Result<Property, Fault> {
        let mut property = Property::default();
        for (name, rep) in self.fields(path)? {
            let text = || Ok::<_, Fault>(self.tables.value(rep)?.as_text().map(ToOwned::to_owned));
            match name {
                "typeName" => property.type_name = text()?.unwrap_or_default(),
                "default" => property.default = Some(Slot::Binary(rep.0)),
                "timeSamples" => property.samples = self.tables.samples(rep)?,
                "interpolation" => property.interpolation = text()?,
                "spline" => property.has_spline = true,
                _ => {}
            }
        }
        Ok(property)
    }

    /// The fields of a path; none where it has no spec.
    fn fields(&self, path: u32) -> Result<Vec<(&str, Rep)>, Fault> {
        let Some(&start) = self.tables.specs.get(&path) else { return Ok(Vec::new()) };
        let set = self.tables.field_sets.get(start as usize..).unwrap_or_default();
        let fields = set.iter().take_while(|field| **field != END).map(|&field| {
            let (name, rep) =
                self.tables.fields.get(field as usize).ok_or_else(|| Fault::new("has fields out of range"))?;
            Ok((self.tables.token(*name)?, Rep(*rep)))
        });
        fields.collect()
    }
}

impl Tables {
    /// A path in words, as references name it; empty for the root, which stands for the default prim.
    fn path(&self, mut index: u32) -> Result<String, Fault> {
        let mut elements = Vec::new();
        loop {
            let node = self.paths.get(index as usize).ok_or_else(|| Fault::new("refers to a path that is none"))?;
            let Some(parent) = node.parent else { break };
            elements.push(self.token(node.token)?);
            if elements.len() > MOST_DEPTH {
                return Err(Fault::new("has prims that are nested too deeply"));
            }
            index = parent;
        }
        Ok(elements.iter().rev().map(|element| format!("/{element}")).collect())
    }
}

fn sublayer(asset: String) -> ArcTarget {
    ArcTarget { asset, ..ArcTarget::default() }
}

fn specifier(value: &Value) -> Specifier {
    match value.as_number() {
        Some(0.0) => Specifier::Def,
        Some(2.0) => Specifier::Class,
        _ => Specifier::Over,
    }
}
