//! The modules of a crate as its files declare them, what each defines and imports, and where a path in one leads.
//!
//! What is compiled for tests only is not among them.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail};
use syn::{Attribute, Item, Meta, ext::IdentExt};

use super::imports::{Import, imports};
use super::tests_only::{attributes, for_tests};

/// Imports of imports that are followed: more than anybody writes, and an end for those that lead to themselves.
const MOST_IMPORTS: usize = 16;

/// A module: a file, or a block within one.
pub struct Module {
    /// Its name below the crate's root, with those of the modules that it is in; the root's is empty.
    pub path: Vec<String>,
    pub file: PathBuf,
    parent: usize,
    children: BTreeMap<String, usize>,
    defined: Vec<String>,
    imported: Vec<Import>,
    /// Its items, those of its modules in blocks left out.
    pub items: Vec<Item>,
}

/// Where a path leads.
pub struct Target {
    /// The module that defines what it names.
    pub module: usize,
    /// Those that hand it on by an import.
    pub through: Vec<usize>,
}

/// The modules of a crate, its root first.
pub struct Modules(pub Vec<Module>);

/// A module that is read next.
struct Next<'a> {
    path: Vec<String>,
    parent: usize,
    file: &'a Path,
    /// The folder of its modules' files.
    folder: PathBuf,
}

impl Modules {
    /// Those of the crate with the root `file`, of which `read` has the text.
    ///
    /// # Errors
    /// A file is no Rust, or declares a module that has no file.
    pub fn read(file: &Path, read: &dyn Fn(&Path) -> Option<String>) -> Result<Self> {
        let mut modules = Self(Vec::new());
        let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
        modules.file(Next { path: Vec::new(), parent: 0, file, folder }, read)?;
        Ok(modules)
    }

    fn file(&mut self, next: Next<'_>, read: &dyn Fn(&Path) -> Option<String>) -> Result<usize> {
        let place = next.file.display();
        let text = read(next.file).with_context(|| format!("{place} cannot be read"))?;
        let parsed = syn::parse_file(&text).with_context(|| format!("{place} is no Rust that syn can read"))?;
        self.items(next, parsed.items, read)
    }

    fn items(&mut self, next: Next<'_>, items: Vec<Item>, read: &dyn Fn(&Path) -> Option<String>) -> Result<usize> {
        let number = self.0.len();
        self.0.push(Module {
            path: next.path.clone(),
            file: next.file.to_path_buf(),
            parent: next.parent,
            children: BTreeMap::new(),
            defined: Vec::new(),
            imported: Vec::new(),
            items: Vec::new(),
        });
        for item in items.into_iter().filter(|item| !for_tests(attributes(item))) {
            let Item::Mod(declared) = item else {
                match &item {
                    Item::Use(used) => self.0[number].imported.extend(imports(used)),
                    other => self.0[number].defined.extend(name(other)),
                }
                self.0[number].items.push(item);
                continue;
            };
            let name = declared.ident.unraw().to_string();
            let path = [next.path.as_slice(), std::slice::from_ref(&name)].concat();
            let child = Next { path, parent: number, file: next.file, folder: next.folder.join(&name) };
            let child = if let Some((_, items)) = declared.content {
                self.items(child, items, read)?
            } else {
                let (file, folder) = beside(&next, &name, stated(&declared.attrs), read)?;
                self.file(Next { file: &file, folder, ..child }, read)?
            };
            self.0[number].children.insert(name, child);
        }
        Ok(number)
    }

    /// Where `path` leads in the module `from`; nowhere if it leaves the crate, or names nothing but a module in there.
    pub fn target(&self, from: usize, path: &[String]) -> Option<Target> {
        let mut through = Vec::new();
        let (module, itself) = self.follow(from, path, &mut through, 0)?;
        if itself && path.len() == 1 {
            // A variable or a field that is called as a module is: nobody takes a module itself.
            return None;
        }
        // Whoever gathers what its own modules have hands on what is beneath it.
        through.retain(|&by| by != from && !self.0[module].path.starts_with(&self.0[by].path));
        Some(Target { module, through })
    }

    /// The module that a path leads to or into, and whether the path names the module itself.
    fn follow(&self, from: usize, path: &[String], through: &mut Vec<usize>, depth: usize) -> Option<(usize, bool)> {
        if depth > MOST_IMPORTS {
            return None;
        }
        let mut at = from;
        for (position, name) in path.iter().enumerate() {
            match name.as_str() {
                "crate" => at = 0,
                "super" => at = self.0[at].parent,
                "self" => {}
                name => match self.named(at, name, through, depth) {
                    Some((module, true)) => at = module,
                    Some((module, false)) => return Some((module, false)),
                    // Of the module that the path has named so far, though no file says so: a macro made it, or it
                    // comes from another crate.
                    None => return (position > 0).then_some((at, false)),
                },
            }
        }
        Some((at, true))
    }

    /// The same for a name in the module `at`.
    fn named(&self, at: usize, name: &str, through: &mut Vec<usize>, depth: usize) -> Option<(usize, bool)> {
        let module = &self.0[at];
        if let Some(&child) = module.children.get(name) {
            return Some((child, true));
        }
        if module.defined.iter().any(|defined| defined == name) {
            return Some((at, false));
        }
        let called = module.imported.iter().filter(|import| import.name.as_deref() == Some(name));
        for import in called {
            if let Some(found) = self.follow(at, &import.path, through, depth + 1) {
                through.push(at);
                return Some(found);
            }
        }
        for all in module.imported.iter().filter(|import| import.name.is_none()) {
            let Some((other, true)) = self.follow(at, &all.path, through, depth + 1) else { continue };
            if let Some(found) = (other != at).then(|| self.named(other, name, through, depth + 1)).flatten() {
                through.push(at);
                return Some(found);
            }
        }
        None
    }
}

/// The file of a module that is declared without a block, and the folder of the files of those that it declares.
fn beside(
    declaring: &Next<'_>,
    name: &str,
    stated: Option<String>,
    read: &dyn Fn(&Path) -> Option<String>,
) -> Result<(PathBuf, PathBuf)> {
    let parent = |path: &Path| path.parent().unwrap_or(Path::new("")).to_path_buf();
    if let Some(stated) = stated {
        let file = parent(declaring.file).join(stated);
        return Ok((file.clone(), parent(&file)));
    }
    let folder = declaring.folder.join(name);
    for file in [declaring.folder.join(format!("{name}.rs")), folder.join("mod.rs")] {
        if read(&file).is_some() {
            return Ok((file, folder));
        }
    }
    bail!("{} declares the module {name}, of which there is no file", declaring.file.display());
}

/// The file that `#[path = "…"]` states.
fn stated(attributes: &[Attribute]) -> Option<String> {
    attributes.iter().find_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("path") => match &pair.value {
            syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value()),
            _ => None,
        },
        _ => None,
    })
}

/// The name that an item defines.
fn name(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::TraitAlias(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(name.unraw().to_string())
}
