//! The names that a file takes from others: every path in its syntax, with its imports spelled out.

use std::collections::BTreeMap;

use syn::{
    Attribute, File, Item, ItemUse, UseTree, Visibility,
    visit::{self, Visit},
};

/// What a file says about names.
#[derive(Debug, Default)]
pub(crate) struct Names {
    /// Paths as they stand in the code, but for those of imports.
    pub(crate) paths: Vec<Vec<String>>,
    /// Imports by the name that they bring.
    pub(crate) imports: BTreeMap<String, Vec<String>>,
    /// Names that the file hands on.
    pub(crate) exports: BTreeMap<String, Vec<String>>,
}

/// Reads a file; what only its tests use is left out.
pub(crate) fn read(source: &str) -> Names {
    let file: File = syn::parse_file(source).unwrap();
    let mut names = Names::default();
    names.visit_file(&file);
    names
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|condition| condition.is_ident("test"))
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Mod(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        _ => &[],
    }
}

fn spell_out(tree: &UseTree, before: &[String], add: &mut impl FnMut(String, Vec<String>)) {
    let with = |name: String| [before, &[name]].concat();
    match tree {
        UseTree::Path(path) => spell_out(&path.tree, &with(path.ident.to_string()), add),
        UseTree::Name(name) if name.ident == "self" => {
            add(before.last().cloned().unwrap_or_default(), before.to_vec());
        }
        UseTree::Name(name) => add(name.ident.to_string(), with(name.ident.to_string())),
        UseTree::Rename(rename) => add(rename.rename.to_string(), with(rename.ident.to_string())),
        UseTree::Glob(_) => add("*".to_owned(), before.to_vec()),
        UseTree::Group(group) => group.items.iter().for_each(|tree| spell_out(tree, before, add)),
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item(&mut self, item: &'ast Item) {
        if !is_test(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let names = if matches!(item.vis, Visibility::Inherited) { &mut self.imports } else { &mut self.exports };
        spell_out(&item.tree, &[], &mut |name, path| {
            names.insert(name, path);
        });
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.paths.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }
}
