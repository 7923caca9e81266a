//! What holds for every page: complete in itself, well nested, plots inside of their frames.

use serde_json::Value;
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

/// The tags of a page, in order, without what is inside of scripts. Enough for pages without
/// comments.
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
        if name == "script" && !closing {
            rest = &rest[rest.find("</script>").expect("its end")..];
        }
        found.push(Tag {
            name,
            attributes,
            end: closing,
            alone: inside.ends_with('/') || VOID.contains(&name),
        });
    }
    found
}

/// Expects no reference to anything outside of the page.
#[track_caller]
pub fn assert_refers_to_nothing_outside(page: &str) {
    for tag in tags(page) {
        assert!(
            !["link", "img", "iframe", "object", "image"].contains(&tag.name),
            "<{} {}>",
            tag.name,
            tag.attributes
        );
        assert!(!tag.attributes.contains("://"), "{}", tag.attributes);
        assert!(!tag.attributes.contains("src="), "{}", tag.attributes);
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

/// The plots' data, in order.
pub fn plots(page: &str) -> Vec<Value> {
    let (_, body) = page.split_once("<body>").expect("a body");
    let opened = body.split("<script type=\"application/json\">").skip(1);
    let texts = opened.map(|rest| rest.split("</script>").next().expect("its end"));
    texts
        .map(|text| serde_json::from_str(text).expect("JSON"))
        .collect()
}

/// The whole numbers in a text of base 64 VLQ, as source maps write them.
fn unpacked(text: &str) -> Vec<i64> {
    const DIGITS: &str = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut numbers = Vec::new();
    let (mut number, mut shift) = (0, 0);
    for letter in text.chars() {
        let digit = DIGITS.find(letter).expect("a digit") as i64;
        number |= (digit & 31) << shift;
        shift += 5;
        if digit < 32 {
            let sign = if number & 1 == 1 { -1 } else { 1 };
            numbers.push(sign * (number >> 1));
            (number, shift) = (0, 0);
        }
    }
    numbers
}

/// Expects the points of all plots to lie within their frames, a tenth of the frame aside, and
/// signals to ascend.
#[track_caller]
pub fn assert_plots_stay_inside_their_frames(page: &str) {
    for plot in plots(page) {
        for element in plot["elements"].as_array().expect("a list") {
            for axis in ["x", "y"] {
                let Some(steps) = element[axis].as_str().map(unpacked) else {
                    continue;
                };
                let is_signal = element["kind"] == "series";
                let ascends = steps.iter().skip(1).all(|step| *step >= 0);
                assert!(!is_signal || axis == "y" || ascends, "descends: {element}");
                let inside = if is_signal && axis == "y" {
                    -40_960..=45_056
                } else {
                    -410..=4506
                };
                let mut place = 0;
                for step in steps {
                    place += step;
                    assert!(inside.contains(&place), "{place} of {plot}");
                }
            }
        }
    }
}
