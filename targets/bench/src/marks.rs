//! The marks of the repository: its size, and the dependencies of its files.
//!
//! Counts the files that git knows. A file depends on another one of its crate if it names it by
//! `use` or a path; a re-export (`pub use`) is no dependency. Files that depend on each other in a
//! circle cannot be read one after the other.

use crate::BenchError;
use comfy_table::Table;
use petgraph::algo::tarjan_scc;
use petgraph::graphmap::DiGraphMap;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use syn::visit::{self, Visit};

/// An option for counting the files that name one.
const OPTION: &str = "emf_filter";

/// Prints all marks, and the circles of files.
pub fn print() -> Result<(), BenchError> {
    let files = Files::tracked()?;
    let generator = ["codegen/src/", "codegen/macros/"];
    let laws = ["codegen/src/laws/", "codegen/src/blocks/"];
    let rust = |folders: &[&str]| files.lines(|path| is_rust(path) && is_in(path, folders));
    let longest = files.longest_function(&laws);
    let circles = files.circles();
    let mut table = Table::new();
    table.load_style(comfy_table::presets::ASCII_MARKDOWN);
    table.set_header(["", "lines or files", "mark"]);
    let rows = [
        ("Rust, all", rust(&[""]), 55_000),
        ("generator", rust(&generator), 21_000),
        ("laws and blocks", rust(&laws), 2200),
        ("longest function of them", longest.0, 60),
        (
            "snapshots",
            files.lines(|path| has_extension(path, "snap")),
            15_000,
        ),
        ("files that name one option", files.that_name(OPTION), 8),
        ("circles of files within crates", circles.len(), 0),
    ];
    for (what, count, mark) in rows {
        table.add_row([what.to_owned(), count.to_string(), mark.to_string()]);
    }
    println!("{table}");
    println!(
        "The longest function of laws and blocks is `{}`; the option is `{OPTION}`.",
        longest.1
    );
    for circle in circles {
        println!("circle:");
        for (file, others) in circle {
            println!("  {file} names {}", others.join(", "));
        }
    }
    Ok(())
}

fn has_extension(path: &str, extension: &str) -> bool {
    Path::new(path)
        .extension()
        .is_some_and(|known| known == extension)
}

fn is_rust(path: &str) -> bool {
    has_extension(path, "rs")
}

fn is_in(path: &str, folders: &[&str]) -> bool {
    folders.iter().any(|folder| path.starts_with(folder))
}

/// Texts by path from the root.
struct Files(BTreeMap<String, String>);

impl Files {
    fn tracked() -> Result<Self, BenchError> {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
        let listed = Command::new("git")
            .args(["-C", root, "ls-files"])
            .output()?;
        let listed = String::from_utf8_lossy(&listed.stdout).into_owned();
        // Binary files, and deleted ones, do not count.
        let texts = listed.lines().filter_map(|path| {
            let text = fs::read_to_string(format!("{root}/{path}")).ok()?;
            Some((path.to_owned(), text))
        });
        Ok(Self(texts.collect()))
    }

    fn lines(&self, counts: impl Fn(&str) -> bool) -> usize {
        let counted = self.0.iter().filter(|(path, _)| counts(path));
        counted.map(|(_, text)| text.lines().count()).sum()
    }

    /// Source files that name an option.
    fn that_name(&self, option: &str) -> usize {
        let mut sources = self.0.iter().filter(|(path, _)| is_rust(path));
        let names = |text: &String| text.contains(option);
        sources.by_ref().filter(|(_, text)| names(text)).count()
    }

    fn longest_function(&self, folders: &[&str]) -> (usize, String) {
        let mut longest = Longest(0, String::new());
        for (_, text) in self.0.iter().filter(|(path, _)| is_in(path, folders)) {
            if let Ok(file) = syn::parse_file(text) {
                longest.visit_file(&file);
            }
        }
        (longest.0, longest.1)
    }

    /// Files that depend on each other, crate by crate, each with those of its circle that it names.
    fn circles(&self) -> Vec<Vec<(String, Vec<String>)>> {
        let mut graph: DiGraphMap<&str, ()> = DiGraphMap::new();
        for (path, text) in self.0.iter().filter(|(path, _)| is_rust(path)) {
            let (Some((root, module)), Ok(file)) = (module_of(path), syn::parse_file(text)) else {
                continue;
            };
            let mut leaning = Leaning {
                module,
                named: vec![],
            };
            leaning.visit_file(&file);
            let other = leaning
                .named
                .iter()
                .filter_map(|named| self.file_of(root, named));
            for other in other.filter(|other| *other != path) {
                graph.add_edge(path, other, ());
            }
        }
        let groups = tarjan_scc(&graph)
            .into_iter()
            .filter(|group| group.len() > 1);
        groups
            .map(|group| {
                let named_by = |file: &&str| {
                    let named = group
                        .iter()
                        .filter(|&&other| graph.contains_edge(file, other));
                    (
                        file.to_string(),
                        named.map(|&other| other.to_owned()).collect(),
                    )
                };
                group.iter().map(named_by).collect()
            })
            .collect()
    }

    /// The file of the deepest module in a path within a crate.
    fn file_of(&self, root: &str, named: &[String]) -> Option<&str> {
        (1..=named.len()).rev().find_map(|length| {
            let module = named[..length].join("/");
            let places = [
                format!("{root}{module}.rs"),
                format!("{root}{module}/mod.rs"),
            ];
            let found = places.iter().find_map(|place| self.0.get_key_value(place));
            found.map(|(path, _)| path.as_str())
        })
    }
}

/// The folder of a crate's sources, and the module of a file.
fn module_of(path: &str) -> Option<(&str, Vec<String>)> {
    let (root, module) = path.split_at(path.find("src/")? + "src/".len());
    let module = module.strip_suffix(".rs")?;
    let mut module: Vec<String> = module.split('/').map(str::to_owned).collect();
    if matches!(
        module.last().map(String::as_str),
        Some("mod" | "lib" | "main")
    ) {
        module.pop();
    }
    Some((root, module))
}

/// The longest function: lines and name.
struct Longest(usize, String);

impl Longest {
    fn look_at(&mut self, name: &syn::Ident, block: &syn::Block) {
        let span = block.brace_token.span;
        let lines = span.close().end().line + 1 - span.open().start().line;
        if lines > self.0 {
            *self = Self(lines, name.to_string());
        }
    }
}

impl<'ast> Visit<'ast> for Longest {
    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.look_at(&function.sig.ident, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.look_at(&function.sig.ident, &function.block);
        visit::visit_impl_item_fn(self, function);
    }
}

/// References of a file to its crate.
struct Leaning {
    /// The module of the file.
    module: Vec<String>,
    /// Paths from the crate's root.
    named: Vec<Vec<String>>,
}

impl Leaning {
    fn note(&mut self, segments: &[String]) {
        let mut path = match segments.first().map(String::as_str) {
            Some("crate") => vec![],
            Some("self" | "super") => self.module.clone(),
            _ => return,
        };
        for segment in segments {
            match segment.as_str() {
                "crate" | "self" => {}
                "super" => {
                    path.pop();
                }
                name => path.push(name.to_owned()),
            }
        }
        self.named.push(path);
    }

    fn note_tree(&mut self, before: &[String], tree: &syn::UseTree) {
        let mut path = before.to_vec();
        match tree {
            syn::UseTree::Path(step) => {
                path.push(step.ident.to_string());
                self.note_tree(&path, &step.tree);
            }
            syn::UseTree::Group(group) => {
                group
                    .items
                    .iter()
                    .for_each(|tree| self.note_tree(&path, tree));
            }
            syn::UseTree::Name(syn::UseName { ident, .. })
            | syn::UseTree::Rename(syn::UseRename { ident, .. }) => {
                path.push(ident.to_string());
                self.note(&path);
            }
            syn::UseTree::Glob(_) => self.note(&path),
        }
    }
}

impl<'ast> Visit<'ast> for Leaning {
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if matches!(item.vis, syn::Visibility::Inherited) {
            self.note_tree(&[], &item.tree);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments = path.segments.iter();
        let segments: Vec<String> = segments.map(|segment| segment.ident.to_string()).collect();
        self.note(&segments);
        visit::visit_path(self, path);
    }

    /// Who may name an item is no dependency.
    fn visit_vis_restricted(&mut self, _: &'ast syn::VisRestricted) {}

    /// Tests may depend on the tested module.
    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        if module.ident != "tests" {
            visit::visit_item_mod(self, module);
        }
    }
}
