//! Every error code that a text for people names exists.

use hexagen_codegen::diagnostics::Code;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders with texts, below the repository's root. The changelog may name codes of the past.
const FOLDERS: [&str; 4] = ["codegen", "runtime", "targets", "tests"];

/// The repository.
fn root() -> &'static Path {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().expect("stands in the repository")
}

/// All Markdown files of a folder and of those in it, but for what is built.
fn texts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("is a folder") {
        let entry = entry.expect("can be read");
        let (path, kind) = (entry.path(), entry.file_type().expect("has a type"));
        if kind.is_dir() && entry.file_name() != "target" {
            texts(&path, found);
        } else if kind.is_file() && path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
}

/// The codes that a text names: `HX` and four digits.
fn named(text: &str) -> impl Iterator<Item = &str> {
    let codes = text.match_indices("HX");
    codes.filter_map(|(at, _)| {
        let code = text.get(at..at + 6)?;
        let is_number = code[2..].bytes().all(|byte| byte.is_ascii_digit());
        is_number.then_some(code)
    })
}

#[test]
fn codes_named_in_texts_exist() {
    let known: BTreeSet<String> = Code::ALL.iter().map(Code::to_string).collect();
    let mut files = vec![root().join("README.md")];
    for folder in FOLDERS {
        texts(&root().join(folder), &mut files);
    }
    let (mut count, mut unknown) = (0, vec![]);
    for file in &files {
        let text = fs::read_to_string(file).expect("is text");
        for code in named(&text) {
            count += 1;
            if !known.contains(code) {
                unknown.push(format!("{}: {code}", file.display()));
            }
        }
    }
    assert!(unknown.is_empty(), "no such codes:\n{}", unknown.join("\n"));
    assert!(count > 0, "no codes in {} files", files.len());
    let has = |name: &str| files.iter().any(|file| file.ends_with(name));
    for name in [
        "README.md",
        "guide/boards.md",
        "frameworks/BRING-UP.md",
        "laws/semantics.md",
    ] {
        assert!(has(name), "{name} was not read");
    }
}
