//! A composed prim: its children and attributes.

use super::{expand::elements, stacks::Stage, tree::Node};
use crate::usd::{
    fault::UsdError,
    layers::{
        spec::{PrimSpec, Property, Retiming, Specifier},
        value::{Slot, Value},
    },
};

/// What all layers say of a prim.
#[derive(Clone, Debug)]
pub(in crate::usd) struct ComposedPrim {
    pub(in crate::usd) path: String,
    tree: Node,
    /// The strongest first.
    opinions: Vec<(usize, Retiming, PrimSpec)>,
}

/// An attribute: its strongest values.
#[derive(Clone, Debug, Default)]
pub(in crate::usd) struct Attribute {
    /// The path of its prim, and its own name.
    prim: String,
    pub(in crate::usd) name: String,
    pub(in crate::usd) type_name: String,
    layer: usize,
    default: Option<Slot>,
    /// Time codes of the stage, ascending, and values; empty without.
    pub(in crate::usd) samples: Vec<(f64, Slot)>,
    pub(in crate::usd) has_spline: bool,
    pub(in crate::usd) interpolation: Option<String>,
}

impl Stage {
    /// The prims on the way to a path, itself last.
    pub(in crate::usd) fn prims_to(&mut self, path: &str) -> Result<Vec<ComposedPrim>, UsdError> {
        let names = elements(path);
        if names.is_empty() || !path.starts_with('/') {
            return Err(self.error(path, "is no path of a prim, such as /garment/cloth"));
        }
        let mut prim = ComposedPrim { path: String::new(), tree: Node::root(), opinions: Vec::new() };
        let mut prims = Vec::new();
        for name in names {
            prim = self.child(&prim, &name)?;
            if prim.opinions.is_empty() {
                return Err(self.error(&prim.path, "is not there"));
            }
            prims.push(prim.clone());
        }
        Ok(prims)
    }

    /// A child of a prim. Of one that the stage itself makes inactive no arcs are followed: nothing of it is drawn,
    /// whether they lead anywhere or not.
    pub(in crate::usd) fn child(&mut self, above: &ComposedPrim, name: &str) -> Result<ComposedPrim, UsdError> {
        let path = format!("{}/{name}", above.path);
        let mut tree = above.tree.clone();
        tree.descend(name);
        let own = self.opinions(&tree)?;
        if own.iter().find_map(|(_, _, spec)| spec.active) != Some(false) {
            self.expand(&mut tree, &path, &[])?;
        }
        let mut opinions = Vec::new();
        for node in tree.sites() {
            opinions.extend(self.opinions(node)?);
        }
        Ok(ComposedPrim { path, tree, opinions })
    }

    /// The value of an attribute where it has no samples.
    pub(in crate::usd) fn default(&self, attribute: &Attribute) -> Result<Option<Value>, UsdError> {
        let value = |slot: &Slot| self.value(attribute, slot);
        Ok(attribute.default.as_ref().map(value).transpose()?.filter(|value| *value != Value::Blocked))
    }

    /// A value of an attribute.
    pub(in crate::usd) fn value(&self, attribute: &Attribute, slot: &Slot) -> Result<Value, UsdError> {
        let value = self.layers[attribute.layer].value(slot, &attribute.type_name);
        value.map_err(|error| UsdError {
            prim: Some(attribute.prim.clone()),
            reason: format!("{}: {}", attribute.name, error.reason),
            ..error
        })
    }
}

impl ComposedPrim {
    fn strongest<T>(&self, of: impl Fn(&PrimSpec) -> Option<T>) -> Option<T> {
        self.opinions.iter().find_map(|(_, _, spec)| of(spec))
    }

    /// Names of its children: those of weaker opinions first.
    pub(in crate::usd) fn children(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for (_, _, spec) in self.opinions.iter().rev() {
            for name in &spec.children {
                if !names.contains(name) {
                    names.push(name.clone());
                }
            }
        }
        names
    }

    pub(in crate::usd) fn type_name(&self) -> Option<String> {
        self.strongest(|spec| spec.type_name.clone())
    }

    pub(in crate::usd) fn is_active(&self) -> bool {
        self.strongest(|spec| spec.active).unwrap_or(true)
    }

    /// Whether it is defined, and no class.
    pub(in crate::usd) fn is_defined(&self) -> bool {
        let specifier = self.strongest(|spec| Some(spec.specifier).filter(|own| *own != Specifier::Over));
        specifier == Some(Specifier::Def)
    }

    /// Whether what is below it is shared with other instances.
    pub(in crate::usd) fn is_instance(&self) -> bool {
        self.strongest(|spec| spec.instanceable).unwrap_or(false) && self.tree.sites().len() > 1
    }

    /// An attribute that has a value, or is said to have none.
    pub(in crate::usd) fn attribute(&self, name: &str) -> Option<Attribute> {
        let own = self.opinions.iter().filter_map(|(layer, retiming, spec)| {
            spec.properties.get(name).map(|property| (*layer, *retiming, property))
        });
        let has_value =
            |property: &Property| property.default.is_some() || !property.samples.is_empty() || property.has_spline;
        let type_name = own.clone().map(|(_, _, property)| &property.type_name).find(|name| !name.is_empty());
        let interpolation = own.clone().find_map(|(_, _, property)| property.interpolation.clone());
        let (layer, retiming, property) = own.clone().find(|(_, _, property)| has_value(property))?;
        let mut samples: Vec<_> =
            property.samples.iter().map(|(time, slot)| (retiming.apply(*time), slot.clone())).collect();
        // A negative scale turns time round.
        samples.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        Some(Attribute {
            prim: self.path.clone(),
            name: name.to_owned(),
            type_name: type_name.cloned().unwrap_or_default(),
            layer,
            default: property.default.clone(),
            samples,
            has_spline: property.has_spline,
            interpolation,
        })
    }
}
