//! No two files of a crate name each other, not even by way of others: a reader can always begin with one that needs
//! none of the rest.
//!
//! The graph is built from `use` declarations and from paths in the code. A name that a module only passes on counts as a name of
//! the file that defines it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Attribute, Item, UseTree, Visibility};

/// A module of a crate: its path from the root.
type Name = Vec<String>;

/// A module's own names.
#[derive(Default)]
struct Module {
    file: PathBuf,
    children: BTreeSet<String>,
    /// What it takes in, or passes on: a name here, and the path that it stands for.
    taken: Vec<(String, Name)>,
    /// The names that others see.
    public: BTreeSet<String>,
    /// Modules all of whose names it takes in.
    globs: Vec<Name>,
    /// Paths that it writes, as they stand there.
    written: Vec<Name>,
    defined: BTreeSet<String>,
}

/// The modules of a crate without those that tests alone have.
#[derive(Default)]
struct Modules(BTreeMap<Name, Module>);

fn is_for_tests(attributes: &[Attribute]) -> bool {
    let text = |attribute: &Attribute| match &attribute.meta {
        syn::Meta::List(list) if list.path.is_ident("cfg") => list.tokens.to_string() == "test",
        _ => false,
    };
    attributes.iter().any(text)
}

/// Collects the paths of all but tests.
struct Paths(Vec<Name>);

impl<'a> Visit<'a> for Paths {
    fn visit_path(&mut self, path: &'a syn::Path) {
        self.0.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_item_mod(&mut self, _: &'a syn::ItemMod) {}

    /// `pub(super)` names nothing.
    fn visit_visibility(&mut self, _: &'a Visibility) {}
}

impl Modules {
    fn of_crate(root: &Path) -> Self {
        let mut modules = Self::default();
        modules.read(root, vec![]);
        modules
    }

    fn read(&mut self, file: &Path, name: Name) {
        let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let folder = match file.file_stem().and_then(|stem| stem.to_str()) {
            Some("lib" | "main") => file.parent().expect("a folder").to_owned(),
            _ => file.with_extension(""),
        };
        self.enter(file, &folder, name, &parsed.items);
    }

    fn enter(&mut self, file: &Path, folder: &Path, name: Name, items: &[Item]) {
        let mut module = Module { file: file.to_owned(), ..Module::default() };
        let mut paths = Paths(vec![]);
        for item in items {
            match item {
                Item::Mod(inner) if !is_for_tests(&inner.attrs) => {
                    let own = inner.ident.to_string();
                    module.children.insert(own.clone());
                    let below: Name = name.iter().cloned().chain([own.clone()]).collect();
                    match &inner.content {
                        Some((_, items)) => self.enter(file, &folder.join(&own), below, items),
                        None => self.read(&folder.join(format!("{own}.rs")), below),
                    }
                }
                Item::Mod(_) => {}
                Item::Use(used) => {
                    let before = module.taken.len();
                    module.take(&used.tree, vec![]);
                    if !matches!(used.vis, Visibility::Inherited) {
                        module.public.extend(module.taken[before..].iter().map(|(name, _)| name.clone()));
                    }
                }
                other => {
                    if let Some(own) = defined(other) {
                        module.defined.insert(own);
                    }
                    paths.visit_item(other);
                }
            }
        }
        module.written = paths.0;
        self.0.insert(name, module);
    }

    /// The file in which a path of module `from` ends, if it is one of this crate.
    fn end(&self, from: &Name, path: &[String], depth: usize) -> Option<&Path> {
        let (first, rest) = path.split_first()?;
        let here = &self.0[from];
        match first.as_str() {
            _ if depth > 20 => None,
            "crate" => self.inside(&vec![], rest, depth),
            "self" => self.inside(from, rest, depth),
            "super" => self.inside(&from[..from.len().checked_sub(1)?].to_vec(), rest, depth),
            _ if here.children.contains(first) => self.inside(from, path, depth),
            _ => {
                let (_, taken) = here.taken.iter().find(|(name, _)| name == first)?;
                let whole: Name = taken.iter().chain(rest).cloned().collect();
                if whole == path { None } else { self.end(from, &whole, depth + 1) }
            }
        }
    }

    /// The file in which a path ends that begins in module `module`.
    fn inside(&self, module: &Name, path: &[String], depth: usize) -> Option<&Path> {
        let here = self.0.get(module)?;
        let Some((first, rest)) = path.split_first() else { return Some(&here.file) };
        if first == "super" {
            return self.inside(&module[..module.len().checked_sub(1)?].to_vec(), rest, depth);
        }
        if here.children.contains(first) {
            let below: Name = module.iter().cloned().chain([first.clone()]).collect();
            return self.inside(&below, rest, depth);
        }
        if here.defined.contains(first) {
            return Some(&here.file);
        }
        if here.taken.iter().any(|(name, _)| name == first) {
            return self.end(module, path, depth + 1);
        }
        let passed_on = |glob: &Name| {
            let whole: Name = glob.iter().chain(path).cloned().collect();
            self.end(module, &whole, depth + 1)
        };
        here.globs.iter().find_map(passed_on).or(Some(&here.file))
    }

    /// Which files each file names.
    fn edges(&self) -> BTreeMap<&Path, BTreeSet<&Path>> {
        let mut edges: BTreeMap<&Path, BTreeSet<&Path>> = BTreeMap::new();
        for (name, module) in &self.0 {
            let taken = module.taken.iter().filter(|(as_name, _)| !module.passes_on(as_name)).map(|(_, path)| path);
            let named = taken.chain(&module.globs).chain(&module.written);
            let ends = named.filter_map(|path| self.end(name, path, 0)).filter(|end| *end != module.file);
            edges.entry(&module.file).or_default().extend(ends);
        }
        edges
    }
}

impl Module {
    fn take(&mut self, tree: &UseTree, mut before: Name) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.take(&path.tree, before);
            }
            UseTree::Name(name) if name.ident == "self" => {
                self.taken.push((before.last().cloned().unwrap_or_default(), before));
            }
            UseTree::Name(name) => {
                before.push(name.ident.to_string());
                self.taken.push((name.ident.to_string(), before));
            }
            UseTree::Rename(rename) => {
                before.push(rename.ident.to_string());
                self.taken.push((rename.rename.to_string(), before));
            }
            UseTree::Glob(_) => self.globs.push(before),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.take(tree, before.clone())),
        }
    }

    /// Whether a name is taken in for others alone: they see it, and nothing here is written with it.
    fn passes_on(&self, name: &str) -> bool {
        self.public.contains(name) && !self.written.iter().any(|path| path.first().is_some_and(|first| first == name))
    }
}

fn defined(item: &Item) -> Option<String> {
    Some(match item {
        Item::Const(x) => x.ident.to_string(),
        Item::Enum(x) => x.ident.to_string(),
        Item::Fn(x) => x.sig.ident.to_string(),
        Item::Static(x) => x.ident.to_string(),
        Item::Struct(x) => x.ident.to_string(),
        Item::Trait(x) => x.ident.to_string(),
        Item::Type(x) => x.ident.to_string(),
        _ => return None,
    })
}

/// Files that can be reached from themselves, each with those that it names.
fn circles<'e>(edges: &BTreeMap<&'e Path, BTreeSet<&'e Path>>) -> Vec<String> {
    let reached = |from: &'e Path| {
        let mut found = BTreeSet::new();
        let mut waiting = vec![from];
        while let Some(file) = waiting.pop() {
            waiting.extend(edges.get(file).into_iter().flatten().filter(|next| found.insert(**next)));
        }
        found
    };
    let all: BTreeMap<&Path, BTreeSet<&Path>> = edges.keys().map(|file| (*file, reached(file))).collect();
    let in_circle = |file: &&Path| all[*file].contains(*file);
    let line = |file: &Path| {
        let back = edges[file].iter().filter(|next| all[**next].contains(file));
        let names: Vec<String> = back.map(|next| next.display().to_string()).collect();
        format!("{} names {}", file.display(), names.join(", "))
    };
    edges.keys().copied().filter(in_circle).map(line).collect()
}

#[test]
fn no_two_files_of_a_crate_name_each_other() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace");
    let crates =
        std::fs::read_dir(workspace.join("crates")).expect("crates").map(|entry| entry.expect("a folder").path());
    let (mut found, mut files) = (vec![], 0);
    for root in crates.chain([workspace.join("xtask")]) {
        let modules = Modules::of_crate(&root.join("src/lib.rs"));
        files += modules.0.len();
        found.extend(circles(&modules.edges()));
    }
    assert!(files > 200, "{files} files were read");
    let prefix = format!("{}/", workspace.display());
    let found: Vec<String> = found.iter().map(|line| line.replace(&prefix, "")).collect();
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

#[test]
fn a_circle_is_found_behind_a_name_that_is_passed_on() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("circle");
    std::fs::create_dir_all(&folder).expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a file");
    write("lib.rs", "mod a; mod b; mod c; pub use a::A; pub use b::B;");
    write("a.rs", "use crate::B; pub struct A(pub Option<Box<B>>);");
    write("b.rs", "pub struct B(pub Option<Box<crate::A>>);");
    write("c.rs", "use crate::{A, B}; pub struct C(pub A, pub B);");
    let modules = Modules::of_crate(&folder.join("lib.rs"));
    let found = circles(&modules.edges());
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].contains("a.rs names") && found[0].ends_with("b.rs"), "{found:?}");
}
