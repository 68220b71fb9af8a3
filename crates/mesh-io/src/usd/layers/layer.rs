//! A layer of any format: a file, or a file in an archive.

use std::{
    fmt::{self, Display, Formatter},
    path::{Path, PathBuf},
};

use super::{
    archive,
    binary::{self, BinaryLayer},
    source::Source,
    spec::PrimSpec,
    text::{self, TextLayer},
    value::{Slot, Value},
};
use crate::usd::fault::{Fault, UsdError};

/// Where a layer is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::usd) struct Address {
    pub(in crate::usd) file: PathBuf,
    /// Its name in an archive; the first layer of the archive without.
    pub(in crate::usd) entry: Option<String>,
}

impl Display for Address {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        self.entry.as_ref().map_or(Ok(()), |entry| write!(f, "[{entry}]"))
    }
}

impl Address {
    /// The address of an asset that the layer at this one names.
    pub(in crate::usd) fn resolve(&self, asset: &str) -> Self {
        if let Some(entry) = self.entry.as_ref().filter(|_| !is_network(asset)) {
            let folder = Path::new(entry).parent().unwrap_or_else(|| Path::new(""));
            let entry = Some(tidy(&folder.join(asset)).to_string_lossy().into_owned());
            return Self { file: self.file.clone(), entry };
        }
        if is_network(asset) {
            return Self { file: asset.into(), entry: None };
        }
        let folder = self.file.parent().unwrap_or_else(|| Path::new(""));
        Self { file: tidy(&folder.join(asset)), entry: None }
    }
}

/// Whether an asset path is an address with a scheme, such as `https://`.
fn is_network(asset: &str) -> bool {
    asset.split_once("://").is_some_and(|(scheme, _)| {
        let is_part = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'+' | b'-' | b'.');
        scheme.starts_with(|char: char| char.is_ascii_alphabetic()) && scheme.bytes().all(is_part)
    })
}

/// A path without `.`.
fn tidy(path: &Path) -> PathBuf {
    path.components().filter(|part| !matches!(part, std::path::Component::CurDir)).collect()
}

/// An open layer.
#[derive(Debug)]
pub(in crate::usd) struct Layer {
    pub(in crate::usd) address: Address,
    format: Format,
}

#[derive(Debug)]
enum Format {
    Binary(Box<BinaryLayer>),
    Text(TextLayer),
}

impl Layer {
    /// Opens a layer; its first bytes tell the format.
    pub(in crate::usd) fn open(address: &Address) -> Result<Self, UsdError> {
        let mut address = address.clone();
        let opened = open(&mut address);
        match opened {
            Ok(format) => Ok(Self { address, format }),
            Err(fault) => Err(fault.at(address.to_string().into())),
        }
    }

    /// The prim at a path, whose elements are names or variants as `{set=name}`.
    pub(in crate::usd) fn find(&self, path: &[String]) -> Option<u32> {
        let root = match &self.format {
            Format::Binary(layer) => layer.root(),
            Format::Text(_) => 0,
        };
        path.iter().try_fold(root, |prim, name| match &self.format {
            Format::Binary(layer) => layer.child(prim, name),
            Format::Text(layer) => layer.child(prim, name),
        })
    }

    /// What it says of the prim at a path, if anything.
    pub(in crate::usd) fn spec(&self, path: &[String]) -> Result<Option<PrimSpec>, UsdError> {
        let Some(prim) = self.find(path) else { return Ok(None) };
        match &self.format {
            Format::Binary(layer) => layer.spec(prim).map_err(|fault| self.error(fault)),
            Format::Text(layer) => Ok(Some(layer.spec(prim))),
        }
    }

    /// Decodes a value of a property of that type.
    pub(in crate::usd) fn value(&self, slot: &Slot, type_name: &str) -> Result<Value, UsdError> {
        let value = match (&self.format, slot) {
            (Format::Binary(layer), Slot::Binary(rep)) => layer.value(*rep),
            (Format::Text(layer), slot) => layer.value(slot, type_name),
            (Format::Binary(_), Slot::Text { .. }) => Ok(Value::Other),
        };
        value.map_err(|fault| self.error(fault))
    }

    /// Most bytes of mesh that it may give.
    pub(in crate::usd) fn budget(&self) -> u64 {
        match &self.format {
            Format::Binary(layer) => layer.budget(),
            Format::Text(layer) => layer.budget(),
        }
    }

    pub(in crate::usd) fn error(&self, fault: Fault) -> UsdError {
        fault.at(self.address.to_string().into())
    }
}

fn open(address: &mut Address) -> Result<Format, Fault> {
    if is_network(&address.file.to_string_lossy()) {
        return Err(Fault::new("is a network address, and layers are read from files"));
    }
    let mut source = Source::open(&address.file)?;
    if archive::is_archive(&start(&source)?) {
        let entries = archive::entries(&source)?;
        let entry = match &address.entry {
            Some(name) => entries.into_iter().find(|entry| entry.name == *name),
            None => entries.into_iter().next(),
        };
        let entry = entry.ok_or_else(|| Fault::new("there is no such layer in the archive"))?;
        source = source.part(entry.start, entry.length)?;
        address.entry = Some(entry.name);
    }
    let start = start(&source)?;
    if binary::is_binary(&start) {
        BinaryLayer::read(source).map(|layer| Format::Binary(Box::new(layer)))
    } else if text::is_text(&start) {
        TextLayer::read(source).map(Format::Text)
    } else {
        Err(Fault::new("is no USD file; expected .usda, .usdc or .usdz"))
    }
}

fn start(source: &Source) -> Result<Vec<u8>, Fault> {
    source.read(0, source.length().min(16))
}
