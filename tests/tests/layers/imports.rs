//! Which file takes definitions from which, as the parsed sources tell.
//!
//! An arrow leads to the file that defines a name, through whatever passes it on; passing on is no arrow.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use syn::visit::Visit;
use syn::{Attribute, Item, UseTree, Visibility};

/// Segments of a path.
type Segments = Vec<String>;

/// What one file defines and names.
#[derive(Default)]
struct File {
    defined: BTreeSet<String>,
    /// Names that it brings in, with where from and whether it passes them on.
    used: Vec<(String, Segments, bool)>,
    /// Paths of two segments and more in its code.
    paths: Vec<Segments>,
}

/// Files of a crate by the path of their module.
pub struct Crate(BTreeMap<Segments, File>);

impl Crate {
    /// The sources below a folder, without test modules.
    pub fn read(root: &Path) -> Self {
        let mut files = Vec::new();
        super::collect(root, &mut files);
        let is_own = |file: &Path| !file.ends_with("tests.rs") && !file.iter().any(|part| part == "tests");
        let texts = files.iter().filter(|file| is_own(file.strip_prefix(root).unwrap())).map(|file| {
            let name = file.strip_prefix(root).unwrap().with_extension("");
            let mut module: Segments = name.iter().map(|part| part.to_string_lossy().into_owned()).collect();
            if matches!(module.last().map(String::as_str), Some("mod" | "lib" | "main")) {
                module.pop();
            }
            (module, fs::read_to_string(file).unwrap())
        });
        Self::of(texts)
    }

    /// Of the texts of its files, those of one module together.
    pub fn of(texts: impl IntoIterator<Item = (Segments, String)>) -> Self {
        let mut files: BTreeMap<Segments, File> = BTreeMap::new();
        for (module, text) in texts {
            let parsed = syn::parse_file(&text).unwrap_or_else(|cause| panic!("{module:?}: {cause}"));
            files.entry(module).or_default().visit_file(&parsed);
        }
        Self(files)
    }

    /// A path as it is written in a file, from the crate's root; `None` for other crates.
    fn absolute(&self, module: &[String], path: &[String]) -> Option<Segments> {
        let mut from = module.to_vec();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => (from, rest) = (Vec::new(), &path[1..]),
            "self" => rest = &path[1..],
            "super" => {
                while let Some(("super", after)) = rest.split_first().map(|(first, after)| (first.as_str(), after)) {
                    from.pop();
                    rest = after;
                }
            }
            child => {
                let inner: Segments = [module, &[child.to_owned()]].concat();
                self.0.contains_key(&inner).then_some(())?;
            }
        }
        from.extend_from_slice(rest);
        Some(from)
    }

    /// The file that defines what a path from the root names.
    fn defining(&self, path: &[String], depth: usize) -> Option<Segments> {
        let inside = (0..=path.len()).rev().find(|count| self.0.contains_key(&path[..*count]))?;
        let (module, rest) = (path[..inside].to_vec(), &path[inside..]);
        let (Some(name), file) = (rest.first(), &self.0[&module]) else { return Some(module) };
        if file.defined.contains(name) || depth > 8 {
            return Some(module);
        }
        let passed = file.used.iter().find(|(alias, ..)| alias == name);
        let further = passed.and_then(|(_, from, _)| self.absolute(&module, from));
        further.map_or(Some(module), |from| self.defining(&from, depth + 1))
    }

    /// Files that each file takes something from.
    fn arrows(&self) -> BTreeMap<&Segments, BTreeSet<Segments>> {
        let of = |(module, file): (&Segments, &File)| {
            let brought = file.used.iter().filter(|(.., passes)| !passes).map(|(_, from, _)| from);
            let named = brought.chain(&file.paths).filter_map(|path| self.absolute(module, path));
            named.filter_map(|path| self.defining(&path, 0)).filter(|to| to != module).collect()
        };
        self.0.iter().map(|entry| (entry.0, of(entry))).collect()
    }

    /// What the files of a folder name outside of it and of the allowed folders.
    pub fn leaving(&self, folder: &str, allowed: &[&str]) -> Vec<String> {
        let of = |(module, file): (&Segments, &File)| -> Vec<String> {
            let named = file.used.iter().map(|(_, from, _)| from).chain(&file.paths);
            let all = named.filter_map(|path| self.absolute(module, path));
            let strange = all.filter(|to| to.first().is_some_and(|to| to != folder && !allowed.contains(&to.as_str())));
            strange.map(|to| format!("{}: {}", module.join("::"), to.join("::"))).collect()
        };
        let own = self.0.iter().filter(|(module, _)| module.first().is_some_and(|first| first == folder));
        own.flat_map(of).collect()
    }

    /// Groups of files that reach each other, of more than one.
    pub fn circles(&self) -> Vec<Vec<String>> {
        let arrows = self.arrows();
        let reached = |from: &Segments| {
            let mut seen = BTreeSet::new();
            let mut open = vec![from.clone()];
            while let Some(at) = open.pop() {
                open.extend(arrows.get(&at).into_iter().flatten().filter(|to| seen.insert((*to).clone())).cloned());
            }
            seen
        };
        let all: BTreeMap<&Segments, BTreeSet<Segments>> =
            self.0.keys().map(|module| (module, reached(module))).collect();
        let circle = |module: &Segments| -> Vec<String> {
            let mutual = all.iter().filter(|(other, back)| all[module].contains(**other) && back.contains(module));
            mutual.map(|(other, _)| other.join("::")).collect()
        };
        let circles: BTreeSet<Vec<String>> = self.0.keys().map(circle).filter(|circle| circle.len() > 1).collect();
        circles.into_iter().collect()
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    let is = |attribute: &Attribute| {
        attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Ident>().is_ok_and(|word| word == "test")
    };
    attributes.iter().any(is)
}

/// Every name that a tree brings in, with its path.
fn names(tree: &UseTree, before: &[String], out: &mut Vec<(String, Segments)>) {
    let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
    match tree {
        UseTree::Path(path) => names(&path.tree, &with(&path.ident), out),
        UseTree::Name(name) if name.ident == "self" => {
            out.push((before.last().cloned().unwrap_or_default(), before.to_vec()));
        }
        UseTree::Name(name) => out.push((name.ident.to_string(), with(&name.ident))),
        UseTree::Rename(rename) => out.push((rename.rename.to_string(), with(&rename.ident))),
        UseTree::Glob(_) => out.push((String::new(), before.to_vec())),
        UseTree::Group(group) => group.items.iter().for_each(|item| names(item, before, out)),
    }
}

impl Visit<'_> for File {
    fn visit_item(&mut self, item: &Item) {
        let defined = match item {
            Item::Fn(own) => Some(&own.sig.ident),
            Item::Struct(own) => Some(&own.ident),
            Item::Enum(own) => Some(&own.ident),
            Item::Trait(own) => Some(&own.ident),
            Item::Const(own) => Some(&own.ident),
            Item::Static(own) => Some(&own.ident),
            Item::Type(own) => Some(&own.ident),
            Item::Mod(own) if is_test(&own.attrs) => return,
            _ => None,
        };
        self.defined.extend(defined.map(ToString::to_string));
        if let Item::Use(own) = item {
            let passes = !matches!(own.vis, Visibility::Inherited);
            let mut all = Vec::new();
            names(&own.tree, &[], &mut all);
            self.used.extend(all.into_iter().map(|(name, from)| (name, from, passes)));
            return;
        }
        syn::visit::visit_item(self, item);
    }

    /// Where a thing may be seen is no import.
    fn visit_visibility(&mut self, _: &Visibility) {}

    fn visit_path(&mut self, path: &syn::Path) {
        if path.segments.len() > 1 {
            self.paths.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        syn::visit::visit_path(self, path);
    }
}
