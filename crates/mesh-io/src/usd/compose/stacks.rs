//! Layers, and the sublayers below each: a stack, the strongest first.

use std::path::{Path, PathBuf};

use crate::usd::{
    fault::{Fault, UsdError},
    layers::{
        Address, Layer,
        spec::{PrimSpec, Retiming},
        value::Value,
    },
};

/// Most layers of a stage.
const MOST_LAYERS: usize = 4096;
/// Time codes in a second where a layer says nothing.
const TIME_CODES_PER_SECOND: f64 = 24.0;

/// A layer and those below it.
#[derive(Debug)]
pub(super) struct Stack {
    pub(super) root: Address,
    /// Layers by number, each with how its time codes become those of the root.
    pub(super) layers: Vec<(usize, Retiming)>,
    /// What the root layer says of the stage.
    pub(super) root_spec: PrimSpec,
}

/// All layers that were opened.
#[derive(Debug)]
pub(in crate::usd) struct Stage {
    pub(in crate::usd) path: PathBuf,
    pub(super) layers: Vec<Layer>,
    pub(super) stacks: Vec<Stack>,
    /// Opinions that were looked at to compose prims.
    pub(super) work: usize,
    /// Targets that are being composed, one for the other.
    pub(super) num_nested: usize,
}

impl Stage {
    /// Opens the layers of the stack of a file.
    pub(in crate::usd) fn open(path: &Path) -> Result<Self, UsdError> {
        let (layers, stacks) = (Vec::new(), Vec::new());
        let mut stage = Self { path: path.to_path_buf(), layers, stacks, work: 0, num_nested: 0 };
        stage.stack(&Address { file: path.to_path_buf(), entry: None })?;
        Ok(stage)
    }

    /// What the root layer says of the stage, by name.
    pub(in crate::usd) fn metadata(&self) -> &std::collections::BTreeMap<String, Value> {
        &self.stacks[0].root_spec.stage
    }

    /// The files of all layers.
    pub(in crate::usd) fn files(&self) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> = self.layers.iter().map(|layer| layer.address.file.clone()).collect();
        files.dedup();
        files
    }

    /// Most bytes of mesh that its files may give.
    pub(in crate::usd) fn budget(&self) -> u64 {
        self.layers.iter().map(Layer::budget).fold(0, u64::saturating_add)
    }

    /// An error of a prim.
    pub(in crate::usd) fn error(&self, prim: &str, reason: impl Into<String>) -> UsdError {
        UsdError { path: self.path.clone(), line: None, prim: Some(prim.to_owned()), reason: reason.into() }
    }

    /// The number of the stack of a layer, which is opened if it was not.
    pub(super) fn stack(&mut self, root: &Address) -> Result<usize, UsdError> {
        if let Some(number) = self.stacks.iter().position(|stack| stack.root == *root) {
            return Ok(number);
        }
        let mut layers = Vec::new();
        let root_spec = self.add(root, Retiming::default(), None, &mut Vec::new(), &mut layers)?;
        self.stacks.push(Stack { root: root.clone(), layers, root_spec });
        Ok(self.stacks.len() - 1)
    }

    /// Adds a layer and those below it to a stack.
    fn add(
        &mut self,
        address: &Address,
        retiming: Retiming,
        rate_above: Option<f64>,
        above: &mut Vec<Address>,
        stack: &mut Vec<(usize, Retiming)>,
    ) -> Result<PrimSpec, UsdError> {
        let number = self.layer(address)?;
        let layer = &self.layers[number];
        if above.contains(address) {
            return Err(layer.error(Fault::new("is a sublayer of itself")));
        }
        let spec = layer.spec(&[])?.unwrap_or_default();
        if let Some(what) = spec.beyond {
            return Err(layer.error(Fault::new(format!("{what}, which is not read; flatten the stage first"))));
        }
        let (own, rate) = (layer.address.clone(), rate(&spec));
        let retiming = retiming.then(Retiming { offset: 0.0, scale: rate_above.map_or(1.0, |above| above / rate) });
        stack.push((number, retiming));
        if stack.len() > MOST_LAYERS {
            return Err(self.layers[number].error(Fault::new("has too many sublayers")));
        }
        above.push(address.clone());
        for sublayer in &spec.sublayers {
            let (retiming, address) = (retiming.then(sublayer.retiming), own.resolve(&sublayer.asset));
            if let Err(error) = self.layer(&address) {
                let fault = Fault::new(format!("names a sublayer that is not read: {error}"));
                return Err(self.layers[number].error(fault));
            }
            self.add(&address, retiming, Some(rate), above, stack)?;
        }
        above.pop();
        Ok(spec)
    }

    fn layer(&mut self, address: &Address) -> Result<usize, UsdError> {
        if let Some(number) = self.layers.iter().position(|layer| layer.address == *address) {
            return Ok(number);
        }
        if self.layers.len() >= MOST_LAYERS {
            return Err(Fault::new("has too many layers").at(self.path.clone()));
        }
        self.layers.push(Layer::open(address)?);
        Ok(self.layers.len() - 1)
    }
}

impl Stack {
    /// Time codes in a second.
    pub(super) fn rate(&self) -> f64 {
        rate(&self.root_spec)
    }
}

fn rate(root: &PrimSpec) -> f64 {
    let number = |name: &str| root.stage.get(name).and_then(Value::as_number).filter(|rate| *rate > 0.0);
    number("timeCodesPerSecond").or_else(|| number("framesPerSecond")).unwrap_or(TIME_CODES_PER_SECOND)
}
