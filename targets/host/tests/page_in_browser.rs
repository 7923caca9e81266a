//! The report's page in headless Chromium: no errors, nothing overlaps, every control does
//! something.

mod report_support;

use headless_chrome::protocol::cdp::types::Event;
use headless_chrome::protocol::cdp::{Emulation, Input};
use headless_chrome::{Browser, LaunchOptions, Tab};
use hexagen_host::render;
use hexagen_lab::report::results_page;
use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex};

/// The page's file.
static FILE: LazyLock<PathBuf> = LazyLock::new(|| {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser");
    render::write(&results_page(&report_support::data()), &dir).expect("the page is written")
});

/// What the tests ask a page for.
const HELPERS: &str = include_str!("page_in_browser.js");

/// A page in a browser of its own, with what its console said.
struct Open {
    tab: Arc<Tab>,
    errors: Arc<Mutex<Vec<String>>>,
    /// Ends with its browser.
    _browser: Browser,
}

/// Opens the page at a width; `None`, with a message, without a browser outside of continuous
/// integration.
fn open(width: u32, scheme: &str) -> Option<Open> {
    let args = ["--disable-quic", "--disable-component-update"].map(OsStr::new);
    let options = LaunchOptions {
        // Containers of continuous integration run as root, where Chromium has no sandbox. The page
        // is our own.
        sandbox: false,
        args: args.to_vec(),
        ..LaunchOptions::default()
    };
    let browser = match Browser::new(options) {
        Ok(browser) => browser,
        Err(error) => {
            let message = format!(
                "Chromium is missing, in which the page is tested; install it: `apt-get install --no-install-recommends chromium` \
                 as root on Debian, else from https://www.chromium.org, or name it by CHROME ({error})"
            );
            assert!(std::env::var_os("CI").is_none(), "{message}");
            eprintln!("NOT TESTED: {message}");
            return None;
        }
    };
    let tab = browser.new_tab().expect("a tab");
    let errors = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&errors);
    let listener = move |event: &Event| match event {
        Event::RuntimeExceptionThrown(of) => {
            seen.lock()
                .expect("no panic")
                .push(format!("{:?}", of.params.exception_details));
        }
        Event::RuntimeConsoleAPICalled(of) => {
            seen.lock()
                .expect("no panic")
                .push(format!("{:?}", of.params));
        }
        Event::LogEntryAdded(of) => {
            seen.lock()
                .expect("no panic")
                .push(format!("{:?}", of.params.entry));
        }
        _ => {}
    };
    tab.add_event_listener(Arc::new(listener))
        .expect("a listener");
    tab.enable_runtime().expect("enabled");
    tab.enable_log().expect("enabled");
    tab.call_method(Emulation::SetDeviceMetricsOverride {
        width,
        height: 900,
        device_scale_factor: 1.0,
        mobile: false,
        scale: None,
        screen_width: None,
        screen_height: None,
        position_x: None,
        position_y: None,
        dont_set_visible_size: None,
        screen_orientation: None,
        viewport: None,
        display_feature: None,
        device_posture: None,
    })
    .expect("a width");
    tab.call_method(Emulation::SetEmulatedMedia {
        media: None,
        features: Some(vec![Emulation::MediaFeature {
            name: "prefers-color-scheme".to_owned(),
            value: scheme.to_owned(),
        }]),
    })
    .expect("a scheme");
    let url = format!("file://{}", FILE.display());
    tab.navigate_to(&url)
        .expect("opens")
        .wait_until_navigated()
        .expect("is there");
    let open = Open {
        tab,
        errors,
        _browser: browser,
    };
    open.tab.evaluate(HELPERS, false).expect("helpers");
    open.ask("drawAll()");
    Some(open)
}

impl Open {
    /// The value of an expression in the page.
    fn ask(&self, expression: &str) -> Value {
        let text = format!("(async () => JSON.stringify((await {expression}) ?? null))()");
        let found = self.tab.evaluate(&text, true);
        let found = found.unwrap_or_else(|error| panic!("{expression}: {error}"));
        let text = found.value.unwrap_or_default();
        let text = text
            .as_str()
            .unwrap_or_else(|| panic!("{expression}: no value"));
        serde_json::from_str(text).expect("JSON")
    }

    /// Moves the mouse, or presses or releases its button, at a point of the window.
    fn mouse(&self, kind: Input::DispatchMouseEventTypeOption, [x, y]: [f64; 2], clicks: u32) {
        let event = Input::DispatchMouseEvent {
            Type: kind,
            x,
            y,
            modifiers: None,
            timestamp: None,
            button: Some(Input::MouseButton::Left),
            buttons: None,
            click_count: Some(clicks),
            force: None,
            tangential_pressure: None,
            tilt_x: None,
            tilt_y: None,
            twist: None,
            delta_x: None,
            delta_y: None,
            pointer_Type: None,
        };
        self.tab.call_method(event).expect("a mouse");
    }

    /// The point at shares of the plotted area of a plot, scrolled into view.
    fn point(&self, plot: usize, x: f64, y: f64) -> [f64; 2] {
        let point = self.ask(&format!("pointOf({plot}, {x}, {y})"));
        let point: Vec<f64> = serde_json::from_value(point).expect("two numbers");
        [point[0], point[1]]
    }

    fn assert_no_errors(&self) {
        let errors = self.errors.lock().expect("no panic");
        assert!(errors.is_empty(), "{errors:#?}");
    }
}

#[test]
fn nothing_overlaps_at_three_widths() {
    for width in [390, 768, 1280] {
        let Some(page) = open(width, "light") else {
            return;
        };
        for unfolded in [false, true] {
            page.ask(&format!("unfold({unfolded})"));
            let faults = page.ask("faults()");
            assert_eq!(
                faults,
                Value::from(Vec::<String>::new()),
                "at {width} pixels"
            );
        }
        let drawn = page.ask("drawnPlots()");
        assert_eq!(
            drawn,
            Value::from(vec![29, 29]),
            "plots, and those with ink"
        );
        page.assert_no_errors();
    }
}

#[test]
fn the_dark_page_is_legible() {
    let Some(page) = open(1280, "dark") else {
        return;
    };
    assert_eq!(page.ask("faintTexts()"), Value::from(Vec::<String>::new()));
    assert_eq!(page.ask("isDark()"), Value::from(true));
    page.assert_no_errors();
}

#[test]
fn plots_tell_values_zoom_and_switch() {
    use Input::DispatchMouseEventTypeOption::{MouseMoved, MousePressed, MouseReleased};
    let Some(page) = open(1280, "light") else {
        return;
    };
    // Every plot tells the values below the mouse.
    let plots = page.ask("plots.length").as_u64().expect("a number") as usize;
    for plot in 0..plots {
        let before = page.ask(&format!("told({plot})"));
        // Elsewhere than in the plot before, which moves the pointers of others with it.
        let share = 0.2 + 0.1 * (plot % 6) as f64;
        page.mouse(MouseMoved, page.point(plot, share, 0.5), 0);
        page.ask("settled()");
        let after = page.ask(&format!("told({plot})"));
        assert_ne!(before, after, "plot {plot}");
        assert!(
            after
                .as_str()
                .is_some_and(|text| text.contains(char::is_numeric)),
            "{after}"
        );
    }
    // The mouse over the currents reads the torque, too, at the same angle.
    page.mouse(MouseMoved, page.point(0, 0.25, 0.5), 0);
    page.ask("settled()");
    assert_eq!(
        page.ask("told(0).split('phase')[0]"),
        page.ask("told(1).split('PDCC')[0]")
    );
    // A drag zooms both; a double click shows all of it.
    let whole = page.ask("scaleOf(0)");
    page.mouse(MousePressed, page.point(0, 0.25, 0.5), 1);
    page.mouse(MouseMoved, page.point(0, 0.5, 0.5), 0);
    page.mouse(MouseReleased, page.point(0, 0.5, 0.5), 1);
    page.ask("settled()");
    let zoomed = page.ask("scaleOf(0)");
    assert_eq!(zoomed, Value::from(vec![15, 30]));
    assert_eq!(page.ask("scaleOf(1)"), zoomed);
    for clicks in [1, 2] {
        page.mouse(MousePressed, page.point(0, 0.5, 0.5), clicks);
        page.mouse(MouseReleased, page.point(0, 0.5, 0.5), clicks);
    }
    page.ask("settled()");
    assert_eq!(
        (page.ask("scaleOf(0)"), page.ask("scaleOf(1)")),
        (whole.clone(), whole)
    );
    // Every name in a legend switches its line.
    assert_eq!(page.ask("deadNames()"), Value::from(Vec::<String>::new()));
    page.assert_no_errors();
}

#[test]
fn switches_tables_links_and_details_do_something() {
    let Some(page) = open(1280, "light") else {
        return;
    };
    for question in [
        "deadSwitches()",
        "deadHeadings()",
        "deadLinks()",
        "deadDetails()",
        "deadAnchors()",
    ] {
        assert_eq!(
            page.ask(question),
            Value::from(Vec::<String>::new()),
            "{question}"
        );
    }
    // From a field to its formulas and lines, and back from one of the lines.
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
