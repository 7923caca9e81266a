//! The generator's output, versioned: emitted Rust and C99, IR text and data sheets.
//!
//! In full: Rust and C of the paper's motor with the default controller. With another of the paper's
//! controllers, C with one, all items, but names of those that an earlier drive has letter for letter
//! (`// As in`). Of its variants new units, and of known units the lines with a new shape. Of all
//! motors and of the covering arrays the shapes of lines that appear nowhere above. IR text of the
//! default controllers alone: Rust and C show the graph of all others, though not its intervals. A
//! digest of every text reveals any other change: of numbers, of the order of lines, of function heads, of the
//! arguments of stages, of the width of products, of C's comments, of a name in a line of C.
//!
//! In extracts `=` begins a drive, `+` new units, `~` lines of a known unit.
//! `INSTA_UPDATE=always cargo test -p hexagen-tests --test snapshots` writes all of them; a person
//! reads the difference.

mod drives;
mod extracts;
mod items;
mod prose;
mod shape;
mod units;

use drives::{Drive, TEXTS};
use extracts::{Shown, shapes_of_extracts};
use items::{Earlier, without_names};
use shape::Shape;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use units::{Unit, units};

/// Folder of the snapshots, relative to this file.
const FOLDER: &str = "kept";

/// The kind of text that is kept of the default controllers alone.
const OF_DEFAULTS: &str = "ir";

/// Controllers whose Rust is kept item by item, the first in full.
const ITEM_BY_ITEM_IN_RUST: [&str; 4] = ["pdcc", "fcs-mpc", "phcc", "pi-pwm"];

/// Controllers whose C is.
const ITEM_BY_ITEM_IN_C: [&str; 2] = ["pdcc", "fcs-mpc"];

/// All drives, generated once.
static DRIVES: LazyLock<[Vec<Drive>; 3]> =
    LazyLock::new(|| [drives::defaults(), drives::variants(), drives::others()]);

/// Snapshots by file name without ending, except that of the digests.
static SNAPSHOTS: LazyLock<BTreeMap<String, String>> = LazyLock::new(snapshots);

/// File name of the digests.
const DIGESTS: &str = "digests";

/// The drives whose text of a kind is kept: defaults, variants and others.
fn kept(kind: &str) -> [&'static [Drive]; 3] {
    let [defaults, variants, others] = &*DRIVES;
    if kind == OF_DEFAULTS {
        [defaults, &[], &[]]
    } else {
        [defaults, variants, others]
    }
}

fn snapshots() -> BTreeMap<String, String> {
    let mut snapshots = BTreeMap::new();
    for kind in TEXTS {
        let [defaults, variants, others] = kept(kind);
        let item_by_item: &[&str] = match kind {
            "rust" => &ITEM_BY_ITEM_IN_RUST,
            "c99" => &ITEM_BY_ITEM_IN_C,
            _ => &[],
        };
        let item_by_item = item_by_item
            .iter()
            .filter_map(|name| defaults.iter().find(|drive| drive.name == *name));
        let mut shown = Shown::default();
        let mut earlier = Earlier::default();
        for drive in item_by_item {
            shown.add(&units(kind, drive.text(kind)));
            let name = format!("{}.{kind}", drive.name);
            snapshots.insert(
                name,
                earlier.differences(&drive.name, kind, drive.text(kind)),
            );
        }
        let mut extracts = String::new();
        for drive in defaults.iter().chain(variants) {
            let extract = shown.extract(&units(kind, drive.text(kind)));
            if !extract.is_empty() {
                write!(extracts, "= {}\n{extract}\n", drive.name).expect("a string takes all");
            }
        }
        let name = if variants.is_empty() {
            "defaults"
        } else {
            "variants"
        };
        snapshots.insert(format!("{name}.{kind}"), extracts);
        let rest = others
            .iter()
            .flat_map(|drive| units(kind, drive.text(kind)));
        let rest = shown.rest(rest);
        if !rest.is_empty() {
            snapshots.insert(format!("others.{kind}"), rest);
        }
    }
    snapshots
}

/// A line per drive: 64 bits of each of its texts.
fn digests() -> String {
    let mut digests = format!(
        "{:40} {}\n",
        "drive",
        TEXTS.map(|kind| format!("{kind:16}")).join(" ")
    );
    for drive in DRIVES.iter().flatten() {
        let texts = TEXTS.map(|kind| format!("{:016x}", digest(drive.text(kind))));
        writeln!(digests, "{:40} {}", drive.name, texts.join(" ")).expect("a string takes all");
    }
    digests
}

/// The 64-bit FNV-1a hash of a text.
fn digest(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

fn assert_kept(snapshots: &BTreeMap<String, String>) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(FOLDER);
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| {
        for (name, text) in snapshots {
            insta::assert_snapshot!(name.as_str(), text);
        }
    });
}

#[test]
fn the_generators_output_is_as_reviewed() {
    assert_kept(&SNAPSHOTS);
}

/// Numbers, orders and repetitions, which no extract shows.
#[test]
fn the_digests_have_not_changed() {
    assert_kept(&BTreeMap::from([(DIGESTS.to_owned(), digests())]));
}

#[test]
fn no_snapshot_is_left_over() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/snapshots")
        .join(FOLDER);
    let files = fs::read_dir(folder).expect("the snapshots are there");
    let kept: BTreeSet<String> = files
        .filter_map(|entry| {
            let name = entry.expect("a directory entry").file_name();
            Some(name.to_str()?.strip_suffix(".snap")?.to_owned())
        })
        .collect();
    let made = SNAPSHOTS.keys().cloned().chain([DIGESTS.to_owned()]);
    let made: BTreeSet<String> = made.collect();
    let orphans: Vec<&String> = kept.difference(&made).collect();
    assert_eq!(orphans, Vec::<&String>::new(), "orphans");
}

#[test]
fn every_line_is_in_a_snapshot() {
    for kind in TEXTS {
        let files = SNAPSHOTS.iter().filter(|(name, _)| name.ends_with(kind));
        let shown: BTreeSet<Shape> = files
            .flat_map(|(name, text)| {
                if ["defaults.", "variants.", "others."]
                    .iter()
                    .any(|extracts| name.starts_with(extracts))
                {
                    shapes_of_extracts(kind, text)
                } else {
                    let units = units(kind, &without_names(text));
                    units.iter().flat_map(Unit::shapes).collect()
                }
            })
            .collect();
        for drive in kept(kind).into_iter().flatten() {
            for unit in units(kind, drive.text(kind)) {
                let missing = unit.shapes().find(|shape| !shown.contains(shape));
                assert_eq!(missing, None, "{kind} of {}", drive.name);
            }
        }
    }
}

#[test]
fn every_stage_is_shown_whole() {
    let [defaults, variants, others] = &*DRIVES;
    let names = |drives: &[Drive]| {
        let units = drives
            .iter()
            .flat_map(|drive| units("rust", drive.text("rust")))
            .filter(|unit| unit.text.contains("fn "));
        units.map(|unit| unit.name).collect::<BTreeSet<String>>()
    };
    let shown = &names(defaults) | &names(variants);
    assert_eq!(&names(others) - &shown, BTreeSet::new());
}
