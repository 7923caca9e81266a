//! The pages in headless Chromium: no errors, nothing overlaps, every control does something.
//!
//! The checks are the same for the report of a motor and for the paper's experiment.

use crate::browser_support::{Open, load, open, place_of};
use crate::{report_support, reproduction_support};
use headless_chrome::protocol::cdp::Input::DispatchMouseEventTypeOption::{
    MouseMoved, MousePressed, MouseReleased,
};
use headless_chrome::protocol::cdp::Input::DispatchTouchEventTypeOption::{
    TouchEnd, TouchMove, TouchStart,
};
use hexagen_host::render;
use hexagen_lab::engine::{PlantOptions, SelectedMotor};
use hexagen_lab::report::{Page, reproduction_page, results_page};
use hexagen_lab::results::Plan;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::thread;

/// The report of a motor.
static REPORT: LazyLock<PathBuf> =
    LazyLock::new(|| file(&results_page(&report_support::data()), "browser"));

/// The paper's experiment.
static EXPERIMENT: LazyLock<PathBuf> =
    LazyLock::new(|| file(&reproduction_page(&reproduction_support::data()), "browser"));

/// A page's file in a folder of this test.
fn file(page: &Page, folder: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    render::write(page, &dir).expect("the page is written")
}

/// Both pages.
fn both() -> [&'static Path; 2] {
    [&REPORT, &EXPERIMENT]
}

/// Tests all of these, two at the same time: most of the time a test waits for its browser.
fn two_by_two<T: Sync>(all: &[T], test: impl Fn(&T) + Sync) {
    for two in all.chunks(2) {
        thread::scope(|scope| {
            for one in two {
                scope.spawn(|| test(one));
            }
        });
    }
}

/// Tests both pages at a width, as far as there is a browser.
fn on_both(width: u32, scheme: &str, test: impl Fn(&Open) + Sync) {
    two_by_two(&both(), |file| {
        if let Some(page) = open(file, width, scheme) {
            test(&page);
            page.assert_no_errors();
        }
    });
}

/// Opens a page's file at each width, on a telephone in the dark, too: nothing overlaps, and texts are legible.
fn assert_nothing_overlaps(file: &Path) {
    let places = [
        (390, "dark"),
        (390, "light"),
        (768, "light"),
        (1280, "light"),
    ];
    two_by_two(&places, |&(width, scheme)| {
        let Some(page) = load(file, width, scheme) else {
            return;
        };
        // Draws them all.
        page.assert_none("grownPlots()");
        for unfolded in [false, true] {
            page.ask(&format!("unfold({unfolded})"));
            page.assert_none("faults()");
        }
        page.assert_none("undrawn()");
        page.assert_none("misstatedTicks()");
        page.assert_none("crowdedAxes()");
        page.assert_none("namelessRows()");
        page.assert_none("brokenWords()");
        page.assert_none("faintTexts()");
        assert_eq!(page.ask("isDark()"), Value::from(scheme == "dark"));
        page.assert_no_errors();
    });
}

#[test]
fn nothing_overlaps_at_three_widths() {
    assert_nothing_overlaps(&REPORT);
    assert_nothing_overlaps(&EXPERIMENT);
}

/// The real page of a motor of the library.
fn page_of(motor: &str) -> PathBuf {
    let plan = Plan::of(motor, None).expect("a motor of the library");
    let (data, _) = plan.run(&()).expect("every variant runs");
    file(&results_page(&data), &format!("motors/{motor}"))
}

/// Greatest size of a library motor's page in bytes, well below a megabyte.
const MOST: u64 = 850_000;

/// The real page of each library motor, a minute's simulation.
#[test]
#[ignore = "takes a quarter of an hour: `cargo xtask nightly` runs it"]
fn every_motors_page_is_small_and_nothing_overlaps() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("is read");
    for motor in motors {
        let name = motor.source.name;
        let file = page_of(&name);
        let size = fs::metadata(&file).expect("it is there").len();
        println!("{name}: {size} bytes");
        assert!(size <= MOST, "{name}: {size} bytes of at most {MOST}");
        assert_nothing_overlaps(&file);
    }
}

/// Clicks each link of a page's navigation.
fn assert_links_lead_to_headings(places: &[(&Path, u32)]) {
    two_by_two(places, |&(file, width)| {
        let Some(page) = load(file, width, "light") else {
            return;
        };
        let links = page.ask("document.querySelectorAll('nav a').length");
        let links = links.as_u64().expect("a number");
        assert!(links > 10, "{links} links");
        // The first click scrolls past plots that nobody has seen yet. Each scroll takes a second: the
        // others jump.
        for link in (0..links).rev() {
            let is_first = link + 1 == links;
            page.assert_none(&format!("missedHeading({link}, {is_first})"));
        }
        page.assert_no_errors();
    });
}

#[test]
fn links_of_the_navigation_lead_to_their_headings() {
    assert_links_lead_to_headings(&[(&REPORT, 390), (&EXPERIMENT, 800), (&REPORT, 1280)]);
}

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn links_lead_to_their_headings_at_the_other_widths() {
    assert_links_lead_to_headings(&[(&EXPERIMENT, 390), (&REPORT, 800), (&EXPERIMENT, 1280)]);
}

#[test]
fn the_pages_are_legible_in_both_schemes() {
    for (scheme, is_dark) in [("light", false), ("dark", true)] {
        on_both(1280, scheme, |page| {
            page.assert_none("faintTexts()");
            page.assert_none("wrongWhenOff()");
            assert_eq!(page.ask("isDark()"), Value::from(is_dark));
        });
    }
}

#[test]
fn every_plot_tells_values_and_every_name_switches() {
    on_both(1280, "light", |page| {
        let plots = page.ask("plots.length").as_u64().expect("a number") as usize;
        for plot in 0..plots {
            // Elsewhere than in the plot before, which moves the pointers of others with it.
            let share = 0.1 + 0.3 * (plot % 3) as f64;
            let before = page.ask(&format!("[pointOf({plot}, {share}, 0.5), told({plot})]"));
            page.point_at(place_of(&before[0]));
            let after = page.ask(&format!("told({plot})"));
            assert_ne!(before[1], after, "plot {plot}");
            let has_number = |text: &str| text.contains(char::is_numeric);
            assert!(after.as_str().is_some_and(has_number), "{after}");
        }
        page.assert_none("deadNames()");
    });
}

#[test]
fn bars_tell_their_names_and_values() {
    on_both(1280, "light", |page| {
        let count = page.ask("barsOfPage().length").as_u64().expect("a number");
        assert!(count > 0, "no bars");
        for bar in 0..count {
            page.point_at(page.place(&format!("placeOfBar({bar})")));
            page.assert_none(&format!("untoldOfBar({bar})"));
        }
    });
}

#[test]
fn plots_of_one_axis_are_read_and_zoomed_together() {
    let Some(page) = open(&REPORT, 1280, "light") else {
        return;
    };
    // The mouse over the currents reads the torque, too, at the same angle.
    page.point_at(page.point(0, 0.25, 0.5));
    assert_eq!(
        page.ask("told(0).split('phase')[0]"),
        page.ask("told(1).split('PDCC')[0]")
    );
    // A drag zooms both; a double click shows all of it.
    let scales = || (page.ask("scaleOf(0)"), page.ask("scaleOf(1)"));
    let whole = scales();
    page.mouse(MousePressed, page.point(0, 0.25, 0.5), 1);
    page.mouse(MouseMoved, page.point(0, 0.5, 0.5), 0);
    page.mouse(MouseReleased, page.point(0, 0.5, 0.5), 1);
    let zoomed = Value::from(vec![15, 30]);
    assert_eq!(scales(), (zoomed.clone(), zoomed));
    for clicks in [1, 2] {
        page.mouse(MousePressed, page.point(0, 0.5, 0.5), clicks);
        page.mouse(MouseReleased, page.point(0, 0.5, 0.5), clicks);
    }
    assert_eq!(scales(), whole);
    // So does the keyboard.
    page.ask("plots[0].u.over.focus()");
    for (key, is_whole) in [("+", false), ("0", true), ("+", false), ("-", true)] {
        let before = page.ask("told(1)");
        page.press("ArrowRight");
        assert_ne!(page.ask("told(1)"), before, "the arrow key reads on");
        page.press(key);
        assert_eq!(scales() == whole, is_whole, "{key}");
        assert_eq!(scales().0, scales().1);
    }
    page.assert_no_errors();
}

#[test]
fn two_fingers_zoom_what_is_between_them() {
    let Some(page) = open(&REPORT, 390, "light") else {
        return;
    };
    let scales = || (page.ask("scaleOf(0)"), page.ask("scaleOf(1)"));
    let whole = scales();
    let at = |share: f64| page.point(0, share, 0.5);
    page.touch(TouchStart, &[at(0.4)]);
    page.touch(TouchMove, &[at(0.5)]);
    page.touch(TouchEnd, &[]);
    assert_eq!(scales(), whole, "one finger scrolls");
    page.touch(TouchStart, &[at(0.4), at(0.6)]);
    page.touch(TouchMove, &[at(0.3), at(0.7)]);
    page.touch(TouchEnd, &[]);
    // Half of the axis of 60 degrees, around its middle.
    assert_eq!(scales().0, Value::from(vec![15, 45]));
    assert_eq!(scales().0, scales().1, "its mates follow");
    // Back again, and no farther than the axis.
    page.touch(TouchStart, &[at(0.2), at(0.8)]);
    page.touch(TouchMove, &[at(0.45), at(0.55)]);
    page.touch(TouchEnd, &[]);
    assert_eq!(scales(), whole);
    page.assert_no_errors();
}

#[test]
fn every_control_does_something() {
    let [report, experiment] = both();
    two_by_two(&[(report, 7), (experiment, 4)], |&(file, kinds)| {
        let Some(page) = open(file, 1280, "light") else {
            return;
        };
        page.assert_none("untestedControls()");
        for question in [
            "deadSwitches()",
            "deadHeadings()",
            "deadLinks()",
            "deadDetails()",
            "deadAnchors()",
        ] {
            page.assert_none(question);
        }
        let found = page.ask("kindsOfControls().length");
        assert_eq!(
            found,
            Value::from(kinds),
            "{}",
            page.ask("kindsOfControls()")
        );
        page.assert_no_errors();
    });
}

#[test]
fn the_keyboard_reaches_every_control() {
    on_both(1280, "light", |page| {
        page.ask("unfold(true)");
        page.assert_none("mouseOnly()");
        page.assert_none("unfocusable()");
        page.assert_none("deadKeys()");
    });
}

#[test]
fn the_keyboard_follows_links_from_list_to_list() {
    let Some(page) = open(&REPORT, 1280, "light") else {
        return;
    };
    let focused = || page.ask("about(document.activeElement)").to_string();
    page.ask("document.querySelector('[data-formulas]').focus()");
    let first = focused();
    page.press("ArrowDown");
    assert_ne!(focused(), first, "the next field");
    page.press("Tab");
    let formula = focused();
    page.press("Enter");
    assert!(
        page.ask("marked()").to_string().contains("const "),
        "{formula}"
    );
    page.press("Tab");
    page.press("ArrowDown");
    let line = focused();
    assert!(line.contains("span line"), "{line}");
    page.press(" ");
    let marked = page.ask("markedPanes()");
    assert_eq!(marked, Value::from(vec![true, true, true]), "{line}");
    assert!(line.contains("linked-to") || focused().contains("linked-to"));
    page.assert_no_errors();
}

#[test]
fn a_field_leads_to_its_formulas_and_lines_and_back() {
    let Some(page) = open(&REPORT, 1280, "light") else {
        return;
    };
    let there = page.ask("linkedTo('[data-formulas]', 'motor.inductance')");
    let names = there.to_string();
    assert!(
        names.contains("GAIN") && names.contains("const K_HOLD"),
        "{names}"
    );
    assert!(
        !names.contains("POLE_PAIRS") && !names.contains("V_BUS: "),
        "{names}"
    );
    let back = page.ask("linkedTo('.line', 'const K_HOLD')").to_string();
    assert!(
        back.contains("motor.inductance") && back.contains("K_HOLD: "),
        "{back}"
    );
    page.assert_no_errors();
}
