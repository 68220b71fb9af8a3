//! Packages and the modules of which they consist.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use super::tree;

/// A package, or one of its programs.
#[derive(Clone, Debug)]
pub(crate) struct Package {
    pub(crate) name: String,
    /// Names of the packages that it needs to be built; those of its tests are left out.
    pub(crate) dependencies: Vec<String>,
    /// File of each module, by the path of the module from the root of the crate.
    pub(crate) modules: BTreeMap<Vec<String>, PathBuf>,
}

/// All packages of the workspace.
pub(crate) fn packages() -> Vec<Package> {
    let files = tree::files();
    let manifests = files.iter().filter(|file| file.file_name().is_some_and(|name| name == "Cargo.toml"));
    manifests
        .filter_map(|manifest| {
            let text = std::fs::read_to_string(tree::root().join(manifest)).unwrap();
            let table: toml::Table = text.parse().unwrap();
            let name = table.get("package")?.get("name")?.as_str()?.to_owned();
            let dependencies = table.get("dependencies").and_then(toml::Value::as_table);
            let dependencies = dependencies.into_iter().flat_map(|table| table.iter());
            let real_name = |(key, value): (&String, &toml::Value)| {
                value.get("package").and_then(toml::Value::as_str).unwrap_or(key).to_owned()
            };
            let folder = manifest.parent().unwrap().join("src");
            let modules = modules_below(&folder, &files);
            Some(Package { name, dependencies: dependencies.map(real_name).collect(), modules })
        })
        .collect()
}

fn modules_below(folder: &Path, files: &[PathBuf]) -> BTreeMap<Vec<String>, PathBuf> {
    let sources = files.iter().filter(|file| file.starts_with(folder));
    let sources = sources.filter(|file| file.extension().is_some_and(|kind| kind == "rs"));
    sources.map(|file| (module_of(file.strip_prefix(folder).unwrap()), file.clone())).collect()
}

/// The path of the module that a file holds.
fn module_of(file: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        file.with_extension("").components().map(|part| part.as_os_str().to_str().unwrap().to_owned()).collect();
    if matches!(names.last().map(String::as_str), Some("mod" | "lib" | "main")) {
        names.pop();
    }
    names
}

impl Package {
    /// The package without its programs, and each program in `bin` as a package of its own.
    pub(crate) fn programs(&self) -> Vec<Self> {
        let mut programs: BTreeMap<Option<String>, Self> = BTreeMap::new();
        for (module, file) in &self.modules {
            let (program, module) = match &module[..] {
                [bin, program, rest @ ..] if bin == "bin" => (Some(program.clone()), rest.to_vec()),
                _ => (None, module.clone()),
            };
            let of_program =
                programs.entry(program).or_insert_with(|| Self { modules: BTreeMap::new(), ..self.clone() });
            of_program.modules.insert(module, file.clone());
        }
        programs.into_values().collect()
    }

    /// The module below the root of the crate in which a file stands; `lib` for the root itself.
    pub(crate) fn top_module(&self, file: &Path) -> String {
        let module = self.modules.iter().find(|(_, of)| *of == file).map(|(module, _)| module);
        module.and_then(|module| module.first()).map_or_else(|| "lib".to_owned(), Clone::clone)
    }
}
