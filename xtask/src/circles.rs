//! Modules that need each other: drawn from the imports, no arrows between a crate's modules make a circle.
//!
//! Cargo lets no circle of crates pass, rustc any of modules. Drawn are, for each crate of the repository, its root and
//! the modules directly beneath it, and for each module that has others in it, its own file and those. Each is drawn
//! with all that is in it, but a root and a folder's own file with nothing but what they define themselves.
//!
//! | what counts as an arrow | to |
//! |---|---|
//! | an import, a path in code or within what a macro is given | the module that defines what is named, wherever it was handed on from |
//! | the same, through a module that hands on what is none of its own | that module, too |
//! | what a module takes that the one which it is in itself defines | that one's own file, drawn as `lib.rs` or `mod.rs`, as it is called |
//! | what such a file's own code takes of the modules in it | these |
//!
//! What counts for none: what is compiled in tests only; methods, and macros by example without a path, which name no
//! module: a type's methods may stand in several files beneath its own; and what a module hands on from those in it
//! (`pub use`), for it only gathers.

mod graph;
mod imports;
mod modules;
mod references;
mod tests_only;

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use anyhow::Result;
use xshell::{Shell, cmd};

use graph::Arrows;
use modules::{Module, Modules};

/// The roots of crates, beside their manifests, which need not name them.
const ROOTS: [&str; 2] = ["src/lib.rs", "src/main.rs"];

/// What each arrow is drawn from, as `src/a.rs:12`, by the names of its ends.
type Drawn = Arrows<String, String>;

/// The circles in the crates of the repository, each with the line of every arrow.
///
/// # Errors
/// A source is no Rust, or declares a module that has no file.
pub fn of_repository(sh: &Shell) -> Result<Vec<String>> {
    let mut found = Vec::new();
    for manifest in cmd!(sh, "git ls-files -- *Cargo.toml").quiet().read()?.lines().map(Path::new) {
        let folder = manifest.parent().unwrap_or(Path::new(""));
        let text = sh.read_file(manifest)?;
        let named = named_roots(&text).map(Path::new);
        let roots: BTreeSet<&Path> = ROOTS.iter().map(Path::new).chain(named).collect();
        for root in roots.into_iter().map(|root| folder.join(root)).filter(|root| sh.path_exists(root)) {
            found.extend(of_crate(&folder.display().to_string(), &root, &|file| sh.read_file(file).ok())?);
        }
    }
    Ok(found)
}

/// The roots that a manifest names, of programs and libraries at other places.
fn named_roots(manifest: &str) -> impl Iterator<Item = &str> {
    let quoted = manifest.lines().filter_map(|line| line.strip_prefix("path = \"")?.strip_suffix('"'));
    quoted.filter(|path| path.ends_with(".rs"))
}

/// Those of the crate `name` with this root, of whose files `read` has the texts.
fn of_crate(name: &str, root: &Path, read: &dyn Fn(&Path) -> Option<String>) -> Result<Vec<String>> {
    let modules = Modules::read(root, read)?;
    let mut found = Vec::new();
    for (folder, arrows) in drawn(&modules) {
        let within = [&[name.to_owned()], &folder[..]].concat().join("::");
        found.extend(graph::circles(&arrows).into_iter().map(|circle| {
            let places = circle.windows(2).map(|pair| arrows[&pair[0]][&pair[1]].as_str());
            let places = places.collect::<Vec<_>>().join(", ");
            format!("{within}: {} ({places}): move what both need to where neither needs the other", circle.join(" → "))
        }));
    }
    Ok(found)
}

/// The arrows between the modules of each module and its own file, by its path.
fn drawn(modules: &Modules) -> BTreeMap<Vec<String>, Drawn> {
    let mut drawn: BTreeMap<Vec<String>, Drawn> = BTreeMap::new();
    for (number, from) in modules.0.iter().enumerate() {
        for reference in references::of(&from.items) {
            let Some(target) = modules.target(number, &reference.path) else { continue };
            for to in std::iter::once(target.module).chain(target.through) {
                let to = &modules.0[to];
                let common = from.path.iter().zip(&to.path).take_while(|(one, other)| one == other).count();
                let own = |module: &Module| module.file.file_name().unwrap_or_default().display().to_string();
                let [tail, head] = match [from.path.get(common), to.path.get(common)] {
                    [Some(tail), Some(head)] => [tail.clone(), head.clone()],
                    [None, Some(head)] if !reference.hands_on => [own(from), head.clone()],
                    [Some(tail), None] => [tail.clone(), own(to)],
                    _ => continue,
                };
                let arrows = drawn.entry(from.path[..common].to_vec()).or_default().entry(tail).or_default();
                let place = || format!("{}:{}", from.file.display(), reference.line);
                arrows.entry(head).or_insert_with(place);
            }
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The circles in a crate of these files.
    fn found(files: &[(&str, &str)]) -> Vec<String> {
        let read =
            |path: &Path| files.iter().find(|(file, _)| Path::new(file) == path).map(|(_, text)| (*text).to_owned());
        let circles = of_crate("c", Path::new(files[0].0), &read).unwrap();
        circles.into_iter().map(|circle| circle.split("):").next().unwrap_or_default().to_owned() + ")").collect()
    }

    #[test]
    fn two_modules_that_take_from_each_other_are_named_with_a_line_for_each_arrow() {
        let files = [
            ("src/lib.rs", "mod a;\nmod b;\npub use b::B;"),
            ("src/a.rs", "use crate::B;\npub struct A(B);"),
            ("src/b/mod.rs", "mod inner;\npub struct B;"),
            ("src/b/inner.rs", "\nfn a() { let _ = vec![Some(crate::a::A::new())]; }"),
        ];
        assert_eq!(found(&files), ["c: a → b → a (src/a.rs:1, src/b/inner.rs:2)"]);
    }

    #[test]
    fn a_manifest_names_the_roots_that_stand_elsewhere_and_folders_of_other_crates_are_none() {
        let manifest =
            "[[bin]]\nname = \"board\"\npath = \"src/board/main.rs\"\n\n[dependencies.core]\npath = \"../core\"\n";
        assert_eq!(named_roots(manifest).collect::<Vec<_>>(), ["src/board/main.rs"]);
    }

    #[test]
    fn arrows_that_lead_one_way_make_no_circle() {
        let files = [
            ("src/lib.rs", "mod a;\nmod b;\nmod c { pub struct C; }\npub use a::A;\npub use c::C;\nuse std::fmt;"),
            ("src/a.rs", "use crate::b::{self, B};\nuse super::C;\npub struct A(B, C);\nfn of() { b::of() }"),
            ("src/b.rs", "//! [`A`](crate::a::A)\npub(in crate::b) fn of() {}\npub struct B(::a::A);"),
        ];
        assert_eq!(found(&files), [""; 0]);
    }

    #[test]
    fn what_is_compiled_in_tests_only_draws_no_arrow() {
        let files = [
            ("src/lib.rs", "mod a;\nmod b;\n#[cfg(test)]\nmod fixtures;"),
            ("src/a.rs", "use crate::b::B;\npub struct A;"),
            (
                "src/b.rs",
                "#[cfg(all(unix, test))]\nuse crate::a::A;\npub struct B;\nimpl B {\n#[cfg(test)]\nfn a() -> crate::a::A {}\n}\n\
                 #[cfg(test)]\nmod tests {\nuse crate::a::A;\n}",
            ),
        ];
        assert_eq!(found(&files), [""; 0]);
    }

    #[test]
    fn a_root_counts_with_what_it_defines_and_not_with_what_it_gathers() {
        let gathers = [
            ("src/lib.rs", "mod a;\npub use a::A;\npub const N: u8 = 1;"),
            ("src/a.rs", "pub struct A([u8; crate::N]);"),
        ];
        assert_eq!(found(&gathers), [""; 0]);
        let needs = [("src/main.rs", "mod a;\npub struct N(a::A);"), ("src/a.rs", "use crate::N;\npub struct A;")];
        assert_eq!(found(&needs), ["c: a → main.rs → a (src/a.rs:1, src/main.rs:2)"]);
    }

    #[test]
    fn a_folders_own_file_counts_with_what_it_defines_and_not_with_what_it_gathers() {
        let lib = ("src/lib.rs", "mod a;");
        let inner = ("src/a/inner.rs", "use super::N;\npub struct Inner([u8; N]);\nimpl super::A { fn of() {} }");
        let gathers = "mod inner;\npub use inner::Inner;\npub const N: usize = 1;\npub struct A;";
        assert_eq!(found(&[lib, ("src/a.rs", gathers), inner]), [""; 0]);
        let needs = "mod inner;\npub const N: usize = 1;\npub struct A;\nfn of(_: inner::Inner) {}";
        assert_eq!(
            found(&[lib, ("src/a/mod.rs", needs), inner]),
            ["c::a: inner → mod.rs → inner (src/a/inner.rs:1, src/a/mod.rs:4)"]
        );
    }

    #[test]
    fn a_variable_of_a_modules_name_draws_no_arrow() {
        let files = [
            ("src/lib.rs", "mod a;"),
            ("src/a.rs", "mod inner;\npub struct A;\nfn of(inner: u8) -> String { format!(\"{}\", inner + inner) }"),
            ("src/a/inner.rs", "use super::A;"),
        ];
        assert_eq!(found(&files), [""; 0]);
    }

    #[test]
    fn modules_within_a_module_make_circles_of_their_own() {
        let files = [
            ("src/lib.rs", "mod a;"),
            ("src/a.rs", "mod b;\nmod c;\npub use c::C;\npub struct A;"),
            ("src/a/b.rs", "use super::{A, C};\npub struct B(A, C);"),
            ("src/a/c.rs", "use super::b::B;\npub struct C;"),
        ];
        assert_eq!(found(&files), ["c::a: b → c → b (src/a/b.rs:1, src/a/c.rs:1)"]);
    }

    #[test]
    fn what_another_module_hands_on_is_taken_from_that_module_and_from_its_home() {
        let files = [
            ("src/lib.rs", "mod a;\nmod b;\nmod c;"),
            ("src/a.rs", "use crate::b::C;"),
            ("src/b.rs", "pub use crate::c::C;\nuse crate::a;"),
            ("src/c.rs", "pub struct C;"),
        ];
        assert_eq!(found(&files), ["c: a → b → a (src/a.rs:1, src/b.rs:2)"]);
    }

    #[test]
    fn a_module_without_a_file_is_an_error_that_names_it() {
        let error = of_crate("c", Path::new("lib.rs"), &|file| (file == Path::new("lib.rs")).then(|| "mod a;".into()));
        assert_eq!(error.unwrap_err().to_string(), "lib.rs declares the module a, of which there is no file");
    }
}
