//! What a layer says of a prim, whatever its format.

use std::collections::BTreeMap;

use super::value::Slot;

/// How deep prims may be nested.
pub(in crate::usd) const MOST_DEPTH: usize = 128;

/// `def`, `over` or `class`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::usd) enum Specifier {
    Def,
    #[default]
    Over,
    Class,
}

/// A reference, a payload, or a sublayer.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::usd) struct ArcTarget {
    /// The asset path; empty within the same layer stack.
    pub(in crate::usd) asset: String,
    /// The path of the prim; empty for the default prim.
    pub(in crate::usd) prim: String,
    pub(in crate::usd) retiming: Retiming,
}

/// How time codes of a layer become those of the layer that brings it in: `offset + scale * time`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::usd) struct Retiming {
    pub(in crate::usd) offset: f64,
    pub(in crate::usd) scale: f64,
}

impl Default for Retiming {
    fn default() -> Self {
        Self { offset: 0.0, scale: 1.0 }
    }
}

impl Retiming {
    /// The retiming of something that is brought in by what this one brings in.
    pub(in crate::usd) fn then(self, inner: Self) -> Self {
        Self { offset: self.offset + self.scale * inner.offset, scale: self.scale * inner.scale }
    }

    pub(in crate::usd) fn apply(self, time: f64) -> f64 {
        self.offset + self.scale * time
    }
}

/// An edited list.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::usd) struct ListOp<T> {
    pub(in crate::usd) explicit: Option<Vec<T>>,
    pub(in crate::usd) prepended: Vec<T>,
    pub(in crate::usd) appended: Vec<T>,
    pub(in crate::usd) deleted: Vec<T>,
}

impl<T> Default for ListOp<T> {
    fn default() -> Self {
        Self { explicit: None, prepended: Vec::new(), appended: Vec::new(), deleted: Vec::new() }
    }
}

impl<T: Clone + PartialEq> ListOp<T> {
    /// Applies it to the list of weaker opinions.
    pub(in crate::usd) fn apply(&self, list: &mut Vec<T>) {
        if let Some(explicit) = &self.explicit {
            list.clone_from(explicit);
            return;
        }
        list.retain(|item| {
            !self.deleted.contains(item) && !self.prepended.contains(item) && !self.appended.contains(item)
        });
        list.splice(0..0, self.prepended.iter().cloned());
        list.extend(self.appended.iter().cloned());
    }

    pub(in crate::usd) fn is_empty(&self) -> bool {
        self.explicit.as_ref().is_none_or(Vec::is_empty) && self.prepended.is_empty() && self.appended.is_empty()
    }
}

/// A property of a prim.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::usd) struct Property {
    pub(in crate::usd) type_name: String,
    pub(in crate::usd) default: Option<Slot>,
    /// Time codes, ascending, and values; empty without.
    pub(in crate::usd) samples: Vec<(f64, Slot)>,
    /// Metadata `interpolation` of a primvar.
    pub(in crate::usd) interpolation: Option<String>,
    /// Whether its values are a curve.
    pub(in crate::usd) has_spline: bool,
}

/// What one layer says of one prim, or in the root prim of itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::usd) struct PrimSpec {
    pub(in crate::usd) specifier: Specifier,
    pub(in crate::usd) type_name: Option<String>,
    pub(in crate::usd) active: Option<bool>,
    pub(in crate::usd) instanceable: Option<bool>,
    pub(in crate::usd) references: ListOp<ArcTarget>,
    pub(in crate::usd) payloads: ListOp<ArcTarget>,
    /// The prims from which it inherits, or that it specializes.
    pub(in crate::usd) classes: Vec<String>,
    /// The first of its arcs and features that are not composed here, in words.
    pub(in crate::usd) beyond: Option<&'static str>,
    pub(in crate::usd) selections: BTreeMap<String, String>,
    pub(in crate::usd) variant_sets: Vec<String>,
    pub(in crate::usd) children: Vec<String>,
    pub(in crate::usd) properties: BTreeMap<String, Property>,
    /// Of the root: the layers below this one.
    pub(in crate::usd) sublayers: Vec<ArcTarget>,
    /// Of the root: `defaultPrim`, `upAxis`, `metersPerUnit`, time codes.
    pub(in crate::usd) stage: BTreeMap<String, super::value::Value>,
}

/// Metadata of the root that belongs to the stage.
pub(in crate::usd) const STAGE_METADATA: [&str; 7] =
    ["defaultPrim", "endTimeCode", "framesPerSecond", "metersPerUnit", "startTimeCode", "timeCodesPerSecond", "upAxis"];

/// The words for a feature that is not composed here, by the name of its metadata.
pub(in crate::usd) fn beyond(name: &str) -> Option<&'static str> {
    match name {
        "clips" | "clipSets" => Some("has its values in clips"),
        "relocates" => Some("relocates prims"),
        _ => None,
    }
}
