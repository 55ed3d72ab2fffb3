//! The paths that a module's code names: imports, calls, types, and what stands within macros.

use proc_macro2::{TokenStream, TokenTree};
use syn::{
    ImplItem, Item, ItemMod, ItemUse, Macro, VisRestricted, Visibility,
    ext::IdentExt,
    visit::{self, Visit},
};

use super::imports::imports;
use super::tests_only::{attributes, for_tests};

/// A path that code names.
pub struct Reference {
    pub path: Vec<String>,
    pub line: usize,
    /// It is an import for others.
    pub hands_on: bool,
}

/// Those of a module's items, but for what is compiled in tests only.
pub fn of(items: &[Item]) -> Vec<Reference> {
    let mut found = Found(Vec::new());
    items.iter().for_each(|item| found.visit_item(item));
    found.0
}

struct Found(Vec<Reference>);

impl Visit<'_> for Found {
    fn visit_item(&mut self, item: &Item) {
        if !for_tests(attributes(item)) {
            visit::visit_item(self, item);
        }
    }

    fn visit_impl_item(&mut self, item: &ImplItem) {
        let attributes = match item {
            ImplItem::Const(item) => &item.attrs[..],
            ImplItem::Fn(item) => &item.attrs,
            ImplItem::Type(item) => &item.attrs,
            _ => &[],
        };
        if !for_tests(attributes) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_item_use(&mut self, used: &ItemUse) {
        let hands_on = !matches!(used.vis, Visibility::Inherited);
        self.0.extend(imports(used).into_iter().map(|import| Reference {
            path: import.path,
            line: import.line,
            hands_on,
        }));
    }

    /// A module within a function knows other names than the function's module; there is none in this repository.
    fn visit_item_mod(&mut self, _: &ItemMod) {}

    /// `pub(in crate::…)` says who may, not what it takes.
    fn visit_vis_restricted(&mut self, _: &VisRestricted) {}

    fn visit_path(&mut self, path: &syn::Path) {
        if let (None, Some(first)) = (&path.leading_colon, path.segments.first()) {
            let names = path.segments.iter().map(|segment| segment.ident.unraw().to_string()).collect();
            self.add(names, first.ident.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, called: &Macro) {
        self.visit_path(&called.path);
        self.tokens(called.tokens.clone());
    }
}

impl Found {
    fn add(&mut self, path: Vec<String>, line: usize) {
        self.0.push(Reference { path, line, hands_on: false });
    }

    /// What a macro is given is no Rust before the macro made it so: names with `::` between them are paths
    /// all the same.
    fn tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<_> = tokens.into_iter().collect();
        let colon = |at: usize| matches!(tokens.get(at), Some(TokenTree::Punct(mark)) if mark.as_char() == ':');
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            match token {
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Ident(first) => {
                    // Behind `::` stands the rest of a path that began at the crates or at a type in angle brackets.
                    let begins = at < 2 || !(colon(at - 1) && colon(at - 2));
                    let mut names = vec![first.unraw().to_string()];
                    while let (true, true, Some(TokenTree::Ident(name))) =
                        (colon(at + 1), colon(at + 2), tokens.get(at + 3))
                    {
                        names.push(name.unraw().to_string());
                        at += 3;
                    }
                    if begins {
                        self.add(names, first.span().start().line);
                    }
                }
                _ => {}
            }
            at += 1;
        }
    }
}
