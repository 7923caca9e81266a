//! What holds for every page: complete in itself, well nested, plots inside of their frames.

use std::collections::BTreeSet;

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

/// Expects no script and no reference to anything outside of the page.
#[track_caller]
pub fn assert_refers_to_nothing_outside(page: &str) {
    for tag in tags(page) {
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
        &page[page.find("<style>").expect("a style")..page.find("</style>").expect("its end")];
    assert!(!style.contains("url(") && !style.contains("@import"));
}

/// Expects tags that nest and names that are there once.
#[track_caller]
pub fn assert_well_nested(page: &str) {
    let mut open = Vec::new();
    let mut ids = BTreeSet::new();
    for tag in tags(page) {
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

/// Expects lines of plots to consist of numbers inside of their pictures.
#[track_caller]
pub fn assert_plots_stay_inside_their_frames(page: &str) {
    for plot in page.split("<svg class=\"plot\"").skip(1) {
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
