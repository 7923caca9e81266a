//! The report's page: complete, self-contained, well nested, and the same for the same data.

mod report_support;

use hexagen_host::closed_loop::{LimitOutcome, SpeedLimit};
use hexagen_host::report::{Expected, ExpectedPoint, ReportData, Variant, render, write};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::LazyLock;

static DATA: LazyLock<ReportData> = LazyLock::new(report_support::data);
static PAGE: LazyLock<String> = LazyLock::new(|| render(&DATA).expect("the page renders"));

/// Elements that have no end tag.
const VOID: [&str; 3] = ["meta", "br", "wbr"];

/// One tag: name, attributes as written, and whether it opens, closes or stands alone.
struct Tag<'a> {
    name: &'a str,
    attributes: &'a str,
    end: bool,
    alone: bool,
}

/// The tags of a page, in order. Enough for pages without comments and scripts.
fn tags(page: &str) -> Vec<Tag<'_>> {
    let mut found = Vec::new();
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        let mut quoted = false;
        let end = rest[start..]
            .find(|c| {
                quoted ^= c == '"';
                c == '>' && !quoted
            })
            .expect("every tag ends")
            + start;
        let inside = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if inside.starts_with('!') {
            continue;
        }
        let closing = inside.starts_with('/');
        let body = inside.trim_start_matches('/');
        let (name, attributes) = body.split_once(char::is_whitespace).unwrap_or((body, ""));
        let name = name.trim_end_matches('/');
        found.push(Tag {
            name,
            attributes,
            end: closing,
            alone: inside.ends_with('/') || VOID.contains(&name),
        });
    }
    found
}

#[test]
fn every_section_is_there_and_linked() {
    for (id, title) in [
        ("motor", "Motor and inverter"),
        ("results", "Results"),
        ("currents", "Phase currents"),
        ("trajectory", "Current in the alpha-beta plane"),
        ("torque", "Torque"),
        ("spectra", "Spectra"),
        ("torque-speed", "Torque over speed"),
        ("formats", "Formats"),
        ("errors", "Fixed point against float"),
        ("stability", "Stable ranges"),
        ("code", "Emitted code"),
        ("data-sheet", "Data sheet"),
        ("spec", "Specification"),
    ] {
        let section = format!("<section id=\"{id}\"><h2>{title}</h2>");
        assert!(PAGE.contains(&section), "{section}");
        assert!(PAGE.contains(&format!("href=\"#{id}\"")), "link to {id}");
    }
    assert!(!PAGE.contains("This report has no"), "nothing is missing");
    // Two speeds: six currents, trajectories and torques each, four spectra, one torque-speed
    // curve, two stable ranges.
    assert_eq!(PAGE.matches("<svg class=\"plot\"").count(), 25);
}

#[test]
fn page_refers_to_nothing_outside_and_runs_nothing() {
    for tag in tags(&PAGE) {
        assert!(
            !["script", "link", "img", "iframe", "object", "image"].contains(&tag.name),
            "<{} {}>",
            tag.name,
            tag.attributes
        );
        assert!(!tag.attributes.contains("://"), "{}", tag.attributes);
        assert!(!tag.attributes.contains("url("), "{}", tag.attributes);
        assert!(!tag.attributes.starts_with("on"), "{}", tag.attributes);
    }
    let style =
        &PAGE[PAGE.find("<style>").expect("a style")..PAGE.find("</style>").expect("its end")];
    assert!(!style.contains("url(") && !style.contains("@import"));
}

#[test]
fn tags_nest_and_names_are_unique() {
    let mut open = Vec::new();
    let mut ids = BTreeSet::new();
    for tag in tags(&PAGE) {
        if tag.end {
            assert_eq!(open.pop(), Some(tag.name), "end tag");
        } else if !tag.alone {
            open.push(tag.name);
        }
        if let Some((_, id)) = tag.attributes.split_once("id=\"") {
            let id = id.split('"').next().unwrap_or_default();
            assert!(ids.insert(id), "{id} twice");
        }
    }
    assert_eq!(open, [""; 0], "unclosed");
}

#[test]
fn same_data_give_the_same_bytes() {
    assert_eq!(render(&DATA).expect("the page renders"), *PAGE);
}

#[test]
fn texts_of_the_data_are_escaped() {
    assert!(PAGE.contains("&lt;text &amp; &quot;quotes&quot;&gt;"));
    assert!(!PAGE.contains("<text & "));
}

#[test]
fn plots_hold_finite_numbers_inside_their_frames() {
    for plot in PAGE.split("<svg class=\"plot\"").skip(1) {
        let plot = &plot[..plot.find("</svg>").expect("its end")];
        let numbers = |text: &str| -> Vec<f64> {
            text.split([' ', ','])
                .filter_map(|number| number.parse().ok())
                .collect()
        };
        let quoted = |text: &str, name: &str| {
            let (_, rest) = text.split_once(&format!("{name}=\""))?;
            Some(rest.split('"').next()?.to_owned())
        };
        let frame = numbers(&quoted(plot, "viewBox").expect("a view box"));
        for element in tags(plot) {
            let Some(points) = quoted(element.attributes, "points") else {
                continue;
            };
            for point in numbers(&points).chunks(2) {
                assert!(
                    (0.0..=frame[2]).contains(&point[0]) && (0.0..=frame[3]).contains(&point[1]),
                    "{point:?} outside of {frame:?}"
                );
            }
        }
    }
}

#[test]
fn difference_from_the_expected_is_marked() {
    assert!(
        !PAGE.contains("td class=\"number edge missed\""),
        "all figures are met"
    );
    let mut data = DATA.clone();
    let run = &mut data.variants[0].runs[0];
    run.expected = Some(Expected {
        points: vec![ExpectedPoint {
            rpm: 400.0,
            mean_torque_nm: Some(3.5.into()),
            ripple_pp_pct: Some((2.0, 3.0).into()),
            ripple_rms_pct: None,
        }],
        limit_pct: Some(120.0.into()),
    });
    run.limit = Some(SpeedLimit {
        limit_rpm: None,
        limit_pct: None,
        outcome: LimitOutcome::NeverHeld,
        curve: Vec::new(),
    });
    let page = render(&data).expect("the page renders");
    assert!(page.contains("\u{2260}\u{a0}3.30"), "the mean differs");
    assert!(page.contains("2.0\u{2013}3.0"), "a band is shown as one");
    assert!(page.contains("missed\">never held"), "so does the limit");
    assert!(page.contains("expected figures are met; the others are marked"));
}

#[test]
fn page_without_runs_says_so_instead_of_failing() {
    let mut data = DATA.clone();
    data.variants = vec![Variant::default()];
    data.verification = None;
    data.marks.clear();
    let page = render(&data).expect("the page renders");
    for what in ["records", "torque-speed curves", "formats", "emitted code"] {
        let sentence = format!("This report has no {what}.");
        assert!(page.contains(&sentence), "{sentence}");
    }
}

/// Also leaves the page where a person can look at it: the folder for files of integration tests.
#[test]
fn page_is_written_whole_under_the_motors_name() {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    let path = write(&DATA, &dir).expect("the page is written");
    assert_eq!(path, dir.join("report-trivedi-keshri660w.html"));
    assert_eq!(std::fs::read_to_string(&path).expect("it is there"), *PAGE);
    let left: Vec<_> = std::fs::read_dir(&dir)
        .expect("the folder is there")
        .filter_map(|entry| Some(entry.ok()?.file_name()))
        .collect();
    assert_eq!(left, ["report-trivedi-keshri660w.html"]);
}
