//! Text layers of USD, `.usda`.
//!
//! The structure is parsed when a file is opened; values stay in the file until they are asked for. Source: the AOUSD
//! Core Specification 1.0, section 16.2.
//!
//! | file | purpose |
//! |---|---|
//! | `lexer` | tokens |
//! | `values` | values by the type of their property |
//! | `arcs` | references, payloads, sublayers, variants in metadata |
//! | `parser` | prims, variants, properties |

mod arcs;
mod lexer;
mod parser;
mod values;

use super::{
    source::Source,
    spec::PrimSpec,
    value::{Slot, Value},
};
use crate::usd::fault::Fault;
use parser::{Parser, Prim};

/// A layer in a text file.
#[derive(Debug)]
pub(super) struct TextLayer {
    source: Source,
    prims: Vec<Prim>,
}

/// Whether these are the first bytes of a text layer.
pub(super) fn is_text(start: &[u8]) -> bool {
    start.starts_with(b"#usda")
}

impl TextLayer {
    pub(super) fn read(source: Source) -> Result<Self, Fault> {
        let bytes = source.read(0, source.length())?;
        let prims = Parser::parse(&bytes)?;
        Ok(Self { source, prims })
    }

    /// A prim, or a variant as `{set=name}`, below another.
    pub(super) fn child(&self, prim: u32, name: &str) -> Option<u32> {
        self.prims.get(prim as usize)?.below.get(name).copied()
    }

    pub(super) fn spec(&self, prim: u32) -> PrimSpec {
        self.prims.get(prim as usize).map(|prim| prim.spec.clone()).unwrap_or_default()
    }

    pub(super) fn value(&self, slot: &Slot, type_name: &str) -> Result<Value, Fault> {
        let Slot::Text { start, length } = *slot else { return Ok(Value::Other) };
        values::decode(&self.source.read(start, length)?, type_name).map_err(|fault| {
            // Its line is that within the value.
            let before = self.source.read(0, start).unwrap_or_default();
            let num_lines = before.iter().filter(|&&byte| byte == b'\n').count();
            Fault { line: fault.line.map(|line| num_lines + line), ..fault }
        })
    }

    pub(super) fn budget(&self) -> u64 {
        self.source.budget()
    }
}
