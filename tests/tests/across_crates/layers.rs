//! The generator's stages import earlier stages only (`hexagen_codegen`'s own picture of its
//! pipeline).

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Modules of the generator, each with its allowed imports besides itself.
const IMPORTS: [(&str, &[&str]); 17] = [
    ("at_once", &[]),
    ("derive", &[]),
    ("stopwatch", &[]),
    ("diagnostics", &[]),
    ("interface", &["timing"]),
    ("ir", &[]),
    ("timing", &["ir"]),
    ("spec", &["diagnostics"]),
    ("design", &["spec"]),
    (
        "blocks",
        &["design", "diagnostics", "interface", "ir", "spec"],
    ),
    (
        "scaling",
        &["at_once", "interface", "blocks", "ir", "spec", "stopwatch"],
    ),
    (
        "laws",
        &[
            "design",
            "diagnostics",
            "interface",
            "ir",
            "blocks",
            "scaling",
            "spec",
            "stopwatch",
            "timing",
        ],
    ),
    (
        "pipeline",
        &[
            "at_once",
            "design",
            "laws",
            "diagnostics",
            "interface",
            "ir",
            "scaling",
            "spec",
            "stopwatch",
            "timing",
        ],
    ),
    (
        "emit",
        &["at_once", "diagnostics", "interface", "ir", "timing"],
    ),
    ("builder", &["diagnostics", "emit", "pipeline", "spec"]),
    ("field_items", &["diagnostics", "spec"]),
    (
        "expand",
        &[
            "diagnostics",
            "emit",
            "field_items",
            "interface",
            "ir",
            "pipeline",
            "spec",
            "stopwatch",
        ],
    ),
];

/// Rust files under `folder`, except unit tests.
fn sources(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() {
            if path.file_name().is_some_and(|name| name != "tests") {
                sources(&path, found);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs")
            && path.file_stem().is_some_and(|name| name != "tests")
        {
            found.push(path);
        }
    }
}

#[test]
fn stages_import_earlier_stages_only() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../codegen/src");
    let allowed = BTreeMap::from(IMPORTS);
    let mut files = vec![];
    sources(&root, &mut files);
    let mut wrong = vec![];
    let mut imports = 0;
    for file in files {
        let within = file
            .strip_prefix(&root)
            .expect("a file of the generator")
            .with_extension("");
        let module = within.iter().next().and_then(|part| part.to_str());
        let module = module.expect("a name in UTF-8");
        if module == "lib" {
            continue;
        }
        let Some(allowed) = allowed.get(module) else {
            wrong.push(format!("{module}: a module without a row in IMPORTS"));
            continue;
        };
        let text = fs::read_to_string(&file).expect("a readable file");
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or("");
        for line in code.lines() {
            for reference in line.split("crate::").skip(1) {
                let end = reference.find(|letter: char| !(letter.is_lowercase() || letter == '_'));
                let other = &reference[..end.unwrap_or(reference.len())];
                if other.is_empty() || other == module {
                    continue;
                }
                imports += 1;
                if !allowed.contains(&other) {
                    wrong.push(format!("{}: {}", within.display(), line.trim()));
                }
            }
        }
    }
    assert!(imports > 100, "{imports} imports found");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
