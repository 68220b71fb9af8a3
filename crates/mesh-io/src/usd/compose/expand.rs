//! The arcs of a prim, followed: references, payloads and variants.

use super::{
    stacks::Stage,
    tree::{ArcKind, Node, Site},
};
use crate::usd::{
    fault::UsdError,
    layers::{
        Address,
        spec::{ArcTarget, ListOp, MOST_DEPTH, PrimSpec, Retiming},
        value::Value,
    },
};

/// Most sites with opinions on one prim.
const MOST_SITES: usize = 512;
/// Most opinions that are looked at for a whole stage.
const MOST_WORK: usize = 4_000_000;
/// How deep targets may stand below prims with arcs of their own, one target within the other.
const MOST_NESTED: usize = 16;

/// A site that is named by another: its layer stack, its path, and its time codes.
type Target = (Option<Address>, String, Retiming);

impl Stage {
    /// What the layers of a site say, the strongest first, each with the number of its layer and its time codes in
    /// those of the stage.
    pub(super) fn opinions(&self, node: &Node) -> Result<Vec<(usize, Retiming, PrimSpec)>, UsdError> {
        let mut opinions = Vec::new();
        for (layer, retiming) in &self.stacks[node.stack].layers {
            if let Some(spec) = self.layers[*layer].spec(&node.path)? {
                opinions.push((*layer, node.retiming.then(*retiming), spec));
            }
        }
        Ok(opinions)
    }

    /// Follows the arcs of all sites of a prim. Of a target that is composed by itself, `above` are the sites from
    /// which arcs lead to it.
    pub(super) fn expand(&mut self, tree: &mut Node, prim: &str, above: &[Site]) -> Result<(), UsdError> {
        loop {
            let sites = tree.sites();
            self.work += sites.iter().map(|node| self.stacks[node.stack].layers.len()).sum::<usize>();
            let is_too_deep = prim.split('/').count() > MOST_DEPTH || tree.path.len() > MOST_DEPTH;
            if sites.len() > MOST_SITES || is_too_deep || self.work > MOST_WORK {
                return Err(self.error(prim, "has too many references, payloads and variants"));
            }
            if let Some(chain) = tree.chain_to(&|node| !node.has_arcs) {
                let node = chain.last().map_or_else(Node::root, |node| node.alone());
                let chain: Vec<Site> = above.iter().cloned().chain(chain.iter().map(|node| node.site())).collect();
                let nodes = self.referenced(&node, prim, &chain)?;
                let node = tree.first_mut(&|node| !node.has_arcs);
                node.into_iter().for_each(|node| {
                    node.has_arcs = true;
                    node.attach(nodes.clone());
                });
            } else if let Some(node) = sites.iter().find(|node| !node.has_variants) {
                // After all references, since these may choose.
                let nodes = self.variants(node, tree)?;
                let node = tree.first_mut(&|node| !node.has_variants);
                node.into_iter().for_each(|node| {
                    node.has_variants = true;
                    node.attach(nodes.clone());
                });
            } else {
                return self.check_classes(tree, prim);
            }
        }
    }

    /// The sites of the references and payloads of a site, the last of a chain.
    fn referenced(&mut self, node: &Node, prim: &str, chain: &[Site]) -> Result<Vec<Node>, UsdError> {
        let opinions = self.opinions(node)?;
        if let Some(what) = opinions.iter().find_map(|(_, _, spec)| spec.beyond) {
            return Err(self.error(prim, format!("{what}, which is not read; flatten the stage first")));
        }
        let mut nodes = Vec::new();
        for kind in [ArcKind::Reference, ArcKind::Payload] {
            let mut targets: Vec<Target> = Vec::new();
            for (layer, retiming, spec) in opinions.iter().rev() {
                let list = if kind == ArcKind::Reference { &spec.references } else { &spec.payloads };
                self.resolved(list, *layer, *retiming).apply(&mut targets);
            }
            for (address, path, retiming) in targets {
                let (stack, elements) = self.target_site(node, address.as_ref(), &path, prim)?;
                let scale = self.stacks[node.stack].rate() / self.stacks[stack].rate();
                let rate = Retiming { offset: 0.0, scale: if address.is_some() { scale } else { 1.0 } };
                let root = Node::new(stack, Vec::new(), kind, retiming.then(rate));
                nodes.push(self.target(root, &elements, prim, chain)?);
            }
        }
        Ok(nodes)
    }

    /// A list of targets by where they are.
    fn resolved(&self, list: &ListOp<ArcTarget>, layer: usize, retiming: Retiming) -> ListOp<Target> {
        let own = &self.layers[layer].address;
        let resolve = |targets: &Vec<ArcTarget>| -> Vec<Target> {
            let address = |asset: &str| (!asset.is_empty()).then(|| own.resolve(asset));
            targets
                .iter()
                .map(|target| (address(&target.asset), target.prim.clone(), retiming.then(target.retiming)))
                .collect()
        };
        ListOp {
            explicit: list.explicit.as_ref().map(resolve),
            prepended: resolve(&list.prepended),
            appended: resolve(&list.appended),
            deleted: resolve(&list.deleted),
        }
    }

    /// Where a target stands: its layer stack and its path.
    fn target_site(
        &mut self,
        node: &Node,
        address: Option<&Address>,
        path: &str,
        prim: &str,
    ) -> Result<Site, UsdError> {
        let stack = address.map_or(Ok(node.stack), |address| {
            self.stack(address).map_err(|error| self.error(prim, format!("names a layer that is not read: {error}")))
        })?;
        let default = self.stacks[stack].root_spec.stage.get("defaultPrim").and_then(Value::as_text);
        let path = if path.is_empty() { default.unwrap_or_default() } else { path };
        let elements = elements(path);
        if elements.is_empty() {
            return Err(
                self.error(prim, format!("names the layer {}, which has no default prim", self.stacks[stack].root))
            );
        }
        Ok((stack, elements))
    }

    /// The site of a target below the `root` of its layer stack, with all that the arcs of prims above it bring in.
    ///
    /// # Errors
    /// For a target that leads back to a site of the `chain` that leads to it, and for one of which no layer says
    /// anything: what it should bring in would be certified unseen.
    fn target(&mut self, root: Node, elements: &[String], prim: &str, chain: &[Site]) -> Result<Node, UsdError> {
        let site = (root.stack, elements.to_vec());
        // A prim that brings in one above or below it has no end either.
        let is_same =
            |(stack, path): &Site| *stack == root.stack && (path.starts_with(elements) || elements.starts_with(path));
        if let Some(start) = chain.iter().position(is_same) {
            let cycle = chain[start..].iter().chain([&site]).map(|site| self.words(site)).collect::<Vec<_>>();
            return Err(self.error(prim, format!("refers to itself in a cycle: {}", cycle.join(" -> "))));
        }
        if chain.len() > MOST_SITES || self.num_nested >= MOST_NESTED {
            return Err(self.error(prim, "has too many references, payloads and variants"));
        }
        let mut node = root;
        self.num_nested += 1;
        for (index, name) in elements.iter().enumerate() {
            node.descend(name);
            // Its own arcs are followed with those of the prim that it is a target of, whose opinions may choose.
            if index + 1 < elements.len() {
                self.expand(&mut node, prim, chain)?;
            }
        }
        self.num_nested -= 1;
        for site in node.sites() {
            if !self.opinions(site)?.is_empty() {
                return Ok(node);
            }
        }
        Err(self.error(prim, format!("refers to {}, which is not there", self.words(&site))))
    }

    /// A site in the notation of USD.
    fn words(&self, (stack, path): &Site) -> String {
        format!("@{}@</{}>", self.stacks[*stack].root, path.join("/"))
    }

    /// The sites of the variants that are chosen at a site.
    fn variants(&self, node: &Node, tree: &Node) -> Result<Vec<Node>, UsdError> {
        let mut sets: Vec<String> = Vec::new();
        for (_, _, spec) in self.opinions(node)? {
            for set in spec.variant_sets {
                if !sets.contains(&set) {
                    sets.push(set);
                }
            }
        }
        let mut nodes = Vec::new();
        for set in sets {
            if let Some(variant) = self.selection(tree, &set)? {
                let path = [node.path.clone(), vec![format!("{{{set}={variant}}}")]].concat();
                nodes.push(Node::new(node.stack, path, ArcKind::Variant, node.retiming));
            }
        }
        Ok(nodes)
    }

    /// The variant of a set that the strongest opinion chooses.
    fn selection(&self, tree: &Node, set: &str) -> Result<Option<String>, UsdError> {
        for node in tree.sites() {
            for (_, _, spec) in self.opinions(node)? {
                if let Some(variant) = spec.selections.get(set) {
                    return Ok(Some(variant.clone()).filter(|variant| !variant.is_empty()));
                }
            }
        }
        Ok(None)
    }

    /// Refuses classes that say something: their opinions are not composed.
    fn check_classes(&self, tree: &Node, prim: &str) -> Result<(), UsdError> {
        for node in tree.sites() {
            for class in self.opinions(node)?.into_iter().flat_map(|(_, _, spec)| spec.classes) {
                let path = elements(&class);
                for site in tree.sites() {
                    let site = Node { path: path.clone(), ..site.alone() };
                    if self.opinions(&site)?.iter().any(|(_, _, spec)| says_something(spec)) {
                        let reason =
                            format!("has opinions of the class {class}, which are not read; flatten the stage");
                        return Err(self.error(prim, reason));
                    }
                }
            }
        }
        Ok(())
    }
}

/// The names of a path.
pub(super) fn elements(path: &str) -> Vec<String> {
    path.split('/').filter(|name| !name.is_empty()).map(ToOwned::to_owned).collect()
}

fn says_something(spec: &PrimSpec) -> bool {
    !spec.properties.is_empty()
        || !spec.children.is_empty()
        || !spec.references.is_empty()
        || !spec.payloads.is_empty()
        || !spec.variant_sets.is_empty()
        || !spec.classes.is_empty()
}
