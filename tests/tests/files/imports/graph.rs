//! The graph of imports: every path that starts at `crate`, `self` or `super`, resolved to its
//! target file.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Item, ItemUse, UseTree};

use super::source::Module;

/// An import of one file's name in another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Import {
    pub(crate) from: String,
    pub(crate) to: String,
    /// Whether a child names a type that its parent declares.
    pub(crate) names_parent: bool,
}

/// All imports between files, each once.
pub(crate) fn imports(modules: &[Module]) -> Vec<Import> {
    let parsed: BTreeMap<&str, syn::File> = modules
        .iter()
        .map(|module| (module.path.as_str(), parse(module)))
        .collect();
    let types: BTreeMap<&str, BTreeSet<String>> = parsed
        .iter()
        .map(|(path, file)| (*path, declared_types(file)))
        .collect();
    let mut imports = BTreeSet::new();
    for (from, file) in &parsed {
        let mut paths = Paths::default();
        paths.visit_file(file);
        for path in paths.found {
            let Some((to, name)) = resolve(from, &path, &parsed) else {
                continue;
            };
            if to == *from {
                continue;
            }
            let is_parent = to.is_empty() || from.starts_with(&format!("{to}::"));
            let names_type = name.is_some_and(|name| types[to.as_str()].contains(&name));
            imports.insert(Import {
                from: (*from).to_owned(),
                names_parent: is_parent && names_type,
                to,
            });
        }
    }
    // Imports that are out of order count even if the same file names a type of the other as well.
    imports.into_iter().collect()
}

/// Modules that import each other in a circle, without the imports that are permitted to a child.
pub(crate) fn circles(imports: &[Import]) -> Vec<Vec<String>> {
    let mut next: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for import in imports.iter().filter(|import| !import.names_parent) {
        next.entry(&import.from).or_default().insert(&import.to);
    }
    let mut circles = Vec::new();
    let mut done = BTreeSet::new();
    for start in next.keys() {
        let mut trail = Vec::new();
        walk(start, &next, &mut trail, &mut done, &mut circles);
    }
    circles
}

fn walk<'a>(
    at: &'a str,
    next: &BTreeMap<&'a str, BTreeSet<&'a str>>,
    trail: &mut Vec<&'a str>,
    done: &mut BTreeSet<&'a str>,
    circles: &mut Vec<Vec<String>>,
) {
    if let Some(first) = trail.iter().position(|module| *module == at) {
        circles.push(trail[first..].iter().map(|module| (*module).to_owned()).collect());
        return;
    }
    if done.contains(at) {
        return;
    }
    trail.push(at);
    for to in next.get(at).into_iter().flatten() {
        walk(to, next, trail, done, circles);
    }
    trail.pop();
    done.insert(at);
}

fn parse(module: &Module) -> syn::File {
    syn::parse_file(&module.text).unwrap_or_else(|error| panic!("{}: {error}", module.path))
}

fn declared_types(file: &syn::File) -> BTreeSet<String> {
    let name = |item: &Item| match item {
        Item::Struct(item) => Some(item.ident.to_string()),
        Item::Enum(item) => Some(item.ident.to_string()),
        Item::Trait(item) => Some(item.ident.to_string()),
        Item::Type(item) => Some(item.ident.to_string()),
        _ => None,
    };
    file.items.iter().filter_map(name).collect()
}

/// The target file of a path, and the name in it; `None` for paths of other crates.
fn resolve(
    from: &str,
    path: &[String],
    files: &BTreeMap<&str, syn::File>,
) -> Option<(String, Option<String>)> {
    let mut at: Vec<&str> = match path.first()?.as_str() {
        "crate" => Vec::new(),
        "self" | "super" => from.split("::").filter(|part| !part.is_empty()).collect(),
        // A child that its parent names without `self`.
        child if files.contains_key(joined(from, child).as_str()) => {
            return resolve(from, &[&["self".to_owned()], path].concat(), files);
        }
        _ => return None,
    };
    let mut rest = path.iter().map(String::as_str).peekable();
    while let Some(part) = rest.next_if(|part| matches!(*part, "crate" | "self" | "super")) {
        if part == "super" {
            at.pop();
        }
    }
    while let Some(part) = rest.next_if(|part| files.contains_key(joined(&at.join("::"), part).as_str())) {
        at.push(part);
    }
    Some((at.join("::"), rest.next().map(str::to_owned)))
}

fn joined(module: &str, child: &str) -> String {
    if module.is_empty() {
        child.to_owned()
    } else {
        format!("{module}::{child}")
    }
}

/// Paths in a file, as lists of names.
#[derive(Default)]
struct Paths {
    found: Vec<Vec<String>>,
}

impl Visit<'_> for Paths {
    fn visit_item_use(&mut self, item: &ItemUse) {
        self.add_tree(&item.tree, &mut Vec::new());
    }

    /// Tests within a file may name all of its items.
    fn visit_item_mod(&mut self, item: &syn::ItemMod) {
        if item.ident != "tests" {
            visit::visit_item_mod(self, item);
        }
    }

    /// `pub(crate)` imports nothing.
    fn visit_visibility(&mut self, _: &syn::Visibility) {}

    fn visit_path(&mut self, path: &syn::Path) {
        self.found.push(
            path.segments
                .iter()
                .map(|segment| segment.ident.to_string())
                .collect(),
        );
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, item: &syn::Macro) {
        self.add_tokens(item.tokens.clone());
    }
}

impl Paths {
    fn add_tree(&mut self, tree: &UseTree, prefix: &mut Vec<String>) {
        match tree {
            UseTree::Path(path) => {
                prefix.push(path.ident.to_string());
                self.add_tree(&path.tree, prefix);
                prefix.pop();
            }
            UseTree::Name(name) => self.found.push([&prefix[..], &[name.ident.to_string()]].concat()),
            UseTree::Rename(name) => self.found.push([&prefix[..], &[name.ident.to_string()]].concat()),
            UseTree::Glob(_) => self.found.push(prefix.clone()),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.add_tree(tree, prefix)),
        }
    }

    /// Paths that start at `crate` in a macro's arguments; `crate` alone is that of `pub(crate)`.
    fn add_tokens(&mut self, tokens: TokenStream) {
        let mut path: Option<Vec<String>> = None;
        for token in tokens {
            match token {
                TokenTree::Ident(name) if name == "crate" => path = Some(vec!["crate".to_owned()]),
                TokenTree::Ident(name) => {
                    if let Some(path) = &mut path {
                        path.push(name.to_string());
                    }
                }
                TokenTree::Punct(mark) if mark.as_char() == ':' => {}
                other => {
                    self.found.extend(path.take().filter(|path| path.len() > 1));
                    if let TokenTree::Group(group) = other {
                        self.add_tokens(group.stream());
                    }
                }
            }
        }
        self.found.extend(path.filter(|path| path.len() > 1));
    }
}
