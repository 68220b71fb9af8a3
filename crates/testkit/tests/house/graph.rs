//! Which file of a package takes something from which other one.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use super::{
    modules::Package,
    names::{self, Names},
    tree,
};

/// Files and arrows between them.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    arrows: BTreeMap<PathBuf, BTreeSet<PathBuf>>,
}

struct Resolver<'a> {
    package: &'a Package,
    names: BTreeMap<Vec<String>, Names>,
}

impl Graph {
    /// Reads all files of a package but those of tests.
    pub(crate) fn of(package: &Package) -> Self {
        let names = package.modules.iter().map(|(module, file)| {
            (module.clone(), names::read(&std::fs::read_to_string(tree::root().join(file)).unwrap()))
        });
        let resolver = Resolver { package, names: names.collect() };
        let mut graph = Self::default();
        for (module, file) in &package.modules {
            if module.iter().any(|name| name.ends_with("tests")) {
                continue;
            }
            let names = &resolver.names[module];
            let to = graph.arrows.entry(file.clone()).or_default();
            for path in names.imports.values().chain(&names.paths) {
                to.extend(resolver.file_of(module, path).filter(|other| *other != file).cloned());
            }
        }
        graph
    }

    /// All arrows.
    pub(crate) fn edges(&self) -> impl Iterator<Item = (&Path, &Path)> {
        self.arrows.iter().flat_map(|(from, to)| to.iter().map(move |to| (from.as_path(), to.as_path())))
    }

    fn reachable(&self, from: &Path) -> BTreeSet<&Path> {
        let mut reached = BTreeSet::new();
        let mut open = vec![from];
        while let Some(file) = open.pop() {
            for to in self.arrows.get(file).into_iter().flatten() {
                if reached.insert(to.as_path()) {
                    open.push(to);
                }
            }
        }
        reached
    }
}

impl Resolver<'_> {
    /// The file of the package in which the last name of a path is defined, as seen from a module; nothing for paths
    /// that lead out of the package and for a module as such.
    fn file_of(&self, module: &[String], path: &[String]) -> Option<&PathBuf> {
        let (base, rest) = self.start(module, path)?;
        self.descend(base, rest, 0)
    }

    fn start<'p>(&self, module: &[String], path: &'p [String]) -> Option<(Vec<String>, &'p [String])> {
        let mut base = module.to_vec();
        match path.first()?.as_str() {
            "crate" => Some((Vec::new(), &path[1..])),
            "self" => Some((base, &path[1..])),
            "super" => {
                let ups = path.iter().take_while(|name| *name == "super").count();
                base.truncate(base.len().checked_sub(ups)?);
                Some((base, &path[ups..]))
            }
            first => {
                base.push(first.to_owned());
                if self.package.modules.contains_key(&base) {
                    return Some((base, &path[1..]));
                }
                // A module that was imported.
                let import = self.names[module].imports.get(first).filter(|import| *import != path)?;
                let (base, rest) = self.start(module, import)?;
                let target = [base.as_slice(), rest].concat();
                self.package.modules.contains_key(&target).then_some((target, &path[1..]))
            }
        }
    }

    /// Goes down through modules and names that are handed on.
    fn descend(&self, mut module: Vec<String>, rest: &[String], depth: usize) -> Option<&PathBuf> {
        let (name, rest) = rest.split_first()?;
        module.push(name.clone());
        if self.package.modules.contains_key(&module) {
            return self.descend(module, rest, depth);
        }
        module.pop();
        match self.names.get(&module)?.exports.get(name) {
            Some(export) if depth < 8 => {
                let (base, rest) = self.start(&module, export)?;
                self.descend(base, rest, depth + 1)
            }
            _ => self.package.modules.get(&module),
        }
    }
}

/// The circles of a graph, each as a line with its files.
pub(crate) fn circles(graph: &Graph) -> Vec<String> {
    let reachable: BTreeMap<&Path, BTreeSet<&Path>> =
        graph.arrows.keys().map(|file| (file.as_path(), graph.reachable(file))).collect();
    let mut found = BTreeSet::new();
    for (file, reached) in &reachable {
        if reached.contains(file) {
            let circle = reached.iter().filter(|other| reachable.get(*other).is_some_and(|back| back.contains(file)));
            let arrows = circle.clone().flat_map(|from| {
                let to = graph.arrows[*from]
                    .iter()
                    .filter(|to| reachable.get(to.as_path()).is_some_and(|b| b.contains(file)));
                to.map(move |to| format!("  {} -> {}", from.display(), to.display()))
            });
            found.insert(arrows.collect::<Vec<_>>().join("\n"));
        }
    }
    found.into_iter().collect()
}
