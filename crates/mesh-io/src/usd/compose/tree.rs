//! Where opinions on one prim stand: sites in layer stacks, in a tree whose order is that of strength.

use crate::usd::layers::spec::Retiming;

/// How a site came in; the strongest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ArcKind {
    Root,
    Variant,
    Reference,
    Payload,
}

/// A layer stack by its number, and a path of names and variants.
pub(super) type Site = (usize, Vec<String>);

/// A site, and those that it brings in.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) stack: usize,
    /// Names and variants.
    pub(super) path: Vec<String>,
    pub(super) kind: ArcKind,
    /// The depth in the namespace of the site that brings it in, at which it came in.
    pub(super) depth: usize,
    /// How its time codes become those of the stage.
    pub(super) retiming: Retiming,
    pub(super) below: Vec<Node>,
    pub(super) has_arcs: bool,
    pub(super) has_variants: bool,
}

impl Node {
    /// The site of the root of a stage.
    pub(super) fn root() -> Self {
        Self::new(0, Vec::new(), ArcKind::Root, Retiming::default())
    }

    pub(super) fn new(stack: usize, path: Vec<String>, kind: ArcKind, retiming: Retiming) -> Self {
        Self { stack, path, kind, depth: 0, retiming, below: Vec::new(), has_arcs: false, has_variants: false }
    }

    pub(super) fn site(&self) -> Site {
        (self.stack, self.path.clone())
    }

    /// The same site without those that it brings in.
    pub(super) fn alone(&self) -> Self {
        Self::new(self.stack, self.path.clone(), self.kind, self.retiming)
    }

    /// Goes to a child of the prim.
    pub(super) fn descend(&mut self, name: &str) {
        self.path.push(name.to_owned());
        (self.has_arcs, self.has_variants) = (false, false);
        self.below.iter_mut().for_each(|node| node.descend(name));
    }

    /// Adds sites: stronger are kinds in their order, then those that came in deeper, then those named first.
    pub(super) fn attach(&mut self, nodes: Vec<Self>) {
        let depth = self.path.len();
        self.below.extend(nodes.into_iter().map(|node| Self { depth, ..node }));
        self.below.sort_by_key(|node| (node.kind, std::cmp::Reverse(node.depth)));
    }

    /// All sites, the strongest first.
    pub(super) fn sites(&self) -> Vec<&Self> {
        let mut sites = vec![self];
        self.below.iter().for_each(|node| sites.extend(node.sites()));
        sites
    }

    /// The sites from this one to the strongest that a condition holds for.
    pub(super) fn chain_to(&self, condition: &impl Fn(&Self) -> bool) -> Option<Vec<&Self>> {
        if condition(self) {
            return Some(vec![self]);
        }
        let below = self.below.iter().find_map(|node| node.chain_to(condition))?;
        Some([vec![self], below].concat())
    }

    /// The strongest site that a condition holds for.
    pub(super) fn first_mut(&mut self, condition: &impl Fn(&Self) -> bool) -> Option<&mut Self> {
        if condition(self) {
            return Some(self);
        }
        self.below.iter_mut().find_map(|node| node.first_mut(condition))
    }
}
