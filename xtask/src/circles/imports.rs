//! What a `use` brings, name by name.

use proc_macro2::Span;
use syn::{Ident, ItemUse, UseTree, ext::IdentExt};

/// What an import brings.
pub struct Import {
    /// The name that it has here; none where it brings all that a module has.
    pub name: Option<String>,
    pub path: Vec<String>,
    pub line: usize,
}

/// What the `use` brings.
pub fn imports(used: &ItemUse) -> Vec<Import> {
    let mut found = Vec::new();
    if used.leading_colon.is_none() {
        gather(&used.tree, &mut Vec::new(), &mut found);
    }
    found
}

fn gather(tree: &UseTree, before: &mut Vec<String>, found: &mut Vec<Import>) {
    let import = |name: Option<&Ident>, last: Option<&Ident>, line: Span| {
        let last = last.map(|last| last.unraw().to_string()).filter(|last| last != "self");
        let path: Vec<_> = before.iter().cloned().chain(last).collect();
        let name = name.map(|name| name.unraw().to_string()).map(|name| match name.as_str() {
            "self" => path.last().cloned().unwrap_or(name),
            _ => name,
        });
        Import { name, path, line: line.start().line }
    };
    match tree {
        UseTree::Path(path) => {
            before.push(path.ident.unraw().to_string());
            gather(&path.tree, before, found);
            before.pop();
        }
        UseTree::Name(name) => found.push(import(Some(&name.ident), Some(&name.ident), name.ident.span())),
        UseTree::Rename(renamed) => {
            found.push(import(Some(&renamed.rename), Some(&renamed.ident), renamed.ident.span()));
        }
        UseTree::Glob(glob) => found.push(import(None, None, glob.star_token.spans[0])),
        UseTree::Group(group) => group.items.iter().for_each(|tree| gather(tree, before, found)),
    }
}
