//! Plots as JSON for the page's script, which draws them.
//!
//! Points stand on a grid over the plotted area, whose steps a zoom to a quarter does not show yet.
//! Each is written as its distance from the one before, in a letter or two ([`packed`]).

use super::RenderError;
use super::inline::css;
use hexagen_lab::report::plot::{Axis, Element, Label, Plot, Point, Series, Shape, Side, Stroke};
use maud::{Markup, PreEscaped, html};
use serde_json::{Value, json};

/// Steps of the grid over the range of an axis.
const GRID: f64 = 4096.0;

/// Distance in steps of the grid by which a line may miss a point that is left out: a third of a
/// pixel where the plot is 300 pixels wide.
const OMITTED: f64 = 4.0;

/// A plot, as an element with its data.
///
/// # Errors
/// Data that cannot be written.
pub fn plot(plot: &Plot) -> Result<Markup, RenderError> {
    let elements = plot.elements.iter().map(|of| element(plot, of));
    let (width, height) = plot.size;
    let data = json!({
        "size": [width, height],
        "square": plot.is_square,
        "x": axis(&plot.x),
        "y": axis(&plot.y),
        "elements": without_repeated_places(elements.collect()),
    });
    // No text ends the script element.
    let data = serde_json::to_string(&data)?.replace('<', "\\u003c");
    Ok(html! {
        div.plot role="group" aria-label=(plot.description) {
            script type="application/json" { (PreEscaped(data)) }
        }
    })
}

/// An axis; without ticks where the script can choose them, which knows the width.
fn axis(axis: &Axis) -> Value {
    let is_number = |(at, label): &(f64, String)| {
        let number = label.replace('\u{2212}', "-").parse::<f64>();
        number.is_ok_and(|number| (number - at).abs() <= 1e-6 * at.abs().max(1e-3))
    };
    let ticks = (!axis.ticks.iter().all(is_number)).then_some(&axis.ticks);
    json!({ "title": axis.title, "range": axis.range, "ticks": ticks, "log": axis.is_logarithmic })
}

/// The elements, their horizontal places left out where they are those of the element before: the
/// signals of a record share their columns.
fn without_repeated_places(mut elements: Vec<Value>) -> Vec<Value> {
    let places: Vec<Value> = elements.iter().map(|of| of["x"].clone()).collect();
    for (place, of) in elements.iter_mut().enumerate().skip(1) {
        if places[place].is_string() && places[place] == places[place - 1] {
            of["x"] = Value::Null;
        }
    }
    elements
}

fn element(plot: &Plot, element: &Element) -> Value {
    match element {
        Element::Series(of) => series(plot, of),
        Element::Line { points, stroke } => {
            let (x, y) = steps(&kept(&on_grid(plot, points)));
            json!({ "kind": "line", "x": x, "y": y, "stroke": line(stroke) })
        }
        Element::Area {
            points,
            color,
            opacity,
        } => {
            let (x, y) = steps(&on_grid(plot, points));
            json!({ "kind": "area", "x": x, "y": y, "color": css(*color), "opacity": opacity })
        }
        Element::Dot {
            at,
            radius,
            color,
            width,
        } => {
            json!({ "kind": "dot", "at": at, "radius": radius, "color": css(*color), "width": width })
        }
        Element::Cross { at, color } => json!({ "kind": "cross", "at": at, "color": css(*color) }),
        Element::Mark { at, text } => json!({ "kind": "mark", "at": at, "text": text }),
        Element::Label(of) => label(of),
    }
}

fn series(plot: &Plot, of: &Series) -> Value {
    let (x, y) = steps(&on_grid(plot, &of.points));
    let band = of.points.iter().zip(&of.band);
    let side = |side: fn(&Point) -> f64| -> Vec<Point> {
        let points = band.clone();
        points.map(|((x, _), band)| (*x, side(band))).collect()
    };
    let [least, most] =
        [side(|band| band.0), side(|band| band.1)].map(|side| steps(&on_grid(plot, &side)).1);
    let (shape, ends) = match of.shape {
        Shape::Line => (None, None),
        Shape::Bars(from, to) => (Some("bars"), Some([from, to])),
        Shape::Levels(from, to) => (Some("levels"), Some([from, to])),
    };
    json!({
        "kind": "series",
        "name": of.name,
        "variant": of.variant,
        "x": x,
        "y": y,
        "least": least,
        "most": most,
        "stroke": line(&of.stroke),
        "shape": shape,
        "ends": ends,
        "off": of.is_off,
    })
}

fn line(stroke: &Stroke) -> Value {
    let (dash, gap) = stroke.dash;
    let dash = (gap > 0.0).then_some([dash, gap]);
    json!({ "color": css(stroke.color), "width": stroke.width, "opacity": stroke.opacity, "dash": dash })
}

fn label(label: &Label) -> Value {
    let share = |side| match side {
        Side::Start => 0.0,
        Side::Middle => 0.5,
        Side::End => 1.0,
    };
    json!({
        "kind": "label",
        "at": label.at,
        "offset": label.offset,
        "text": label.text,
        "color": css(label.color),
        "anchor": [share(label.anchor.0), share(label.anchor.1)],
    })
}

/// Points as places on the grid.
fn on_grid(plot: &Plot, points: &[Point]) -> Vec<(i64, i64)> {
    let place =
        |value: f64, (from, to): (f64, f64)| ((value - from) / (to - from) * GRID).round() as i64;
    points
        .iter()
        .map(|&(x, y)| (place(x, plot.x.range), place(y, plot.y.range)))
        .collect()
}

/// The points of a line without those on the way between others (Ramer, Douglas, Peucker).
fn kept(points: &[(i64, i64)]) -> Vec<(i64, i64)> {
    let Some(last) = points.len().checked_sub(1).filter(|&last| last > 1) else {
        return points.to_vec();
    };
    let mut is_kept = vec![false; points.len()];
    (is_kept[0], is_kept[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let off = |k: usize| distance(points[k], points[from], points[to]);
        let farthest = (from + 1..to).max_by(|&a, &b| off(a).total_cmp(&off(b)));
        if let Some(at) = farthest.filter(|&at| off(at) > OMITTED) {
            is_kept[at] = true;
            open.extend([(from, at), (at, to)]);
        }
    }
    let points = points.iter().zip(is_kept);
    points
        .filter(|(_, is_kept)| *is_kept)
        .map(|(point, _)| *point)
        .collect()
}

/// Distance of a point from the line between two others.
fn distance(point: (i64, i64), from: (i64, i64), to: (i64, i64)) -> f64 {
    let minus = |a: (i64, i64), b: (i64, i64)| ((a.0 - b.0) as f64, (a.1 - b.1) as f64);
    let ((x, y), (along_x, along_y)) = (minus(point, from), minus(to, from));
    let square = along_x * along_x + along_y * along_y;
    let share = ((x * along_x + y * along_y) / square.max(1.0)).clamp(0.0, 1.0);
    (x - share * along_x).hypot(y - share * along_y)
}

/// Coordinates as the first one and the distances of all others from the one before.
fn steps(points: &[(i64, i64)]) -> (String, String) {
    let before = [(0, 0)].into_iter().chain(points.iter().copied());
    let pairs = points.iter().zip(before);
    let steps = pairs.map(|((x, y), (x0, y0))| (x - x0, y - y0));
    let (x, y): (Vec<_>, Vec<_>) = steps.unzip();
    (packed(&x), packed(&y))
}

/// The digits of base 64.
const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Whole numbers as source maps write them (base 64 VLQ): five bits per digit, the lowest first and
/// the sign before them; 32 is added where digits follow.
fn packed(numbers: &[i64]) -> String {
    let mut text = String::new();
    for number in numbers {
        let mut rest = number.unsigned_abs() << 1 | u64::from(*number < 0);
        while rest >= 32 {
            text.push(char::from(DIGITS[(rest % 32 + 32) as usize]));
            rest /= 32;
        }
        text.push(char::from(DIGITS[rest as usize]));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{kept, packed, steps};

    #[test]
    fn lines_keep_their_corners_and_lose_what_lies_between() {
        let corner = [(0, 0), (50, 1), (100, 0), (100, 50), (100, 100), (0, 0)];
        assert_eq!(kept(&corner), [(0, 0), (100, 0), (100, 100), (0, 0)]);
        assert_eq!(kept(&corner[..2]), corner[..2]);
    }

    #[test]
    fn steps_add_up_to_their_points() {
        let (x, y) = steps(&[(3, 5), (4, 1)]);
        assert_eq!((x, y), (packed(&[3, 1]), packed(&[5, -4])));
    }

    /// The numbers of the source maps' own examples.
    #[test]
    fn numbers_are_packed_as_in_source_maps() {
        assert_eq!(packed(&[0, 0, 16, 1]), "AAgBC");
        assert_eq!(packed(&[-1, 15, -16, 4096]), "DehBggI");
    }
}
