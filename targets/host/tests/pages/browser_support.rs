//! A page in headless Chromium: what its console says, what it answers, mouse and keyboard.

use headless_chrome::protocol::cdp::types::Event;
use headless_chrome::protocol::cdp::{Emulation, Input};
use headless_chrome::{Browser, LaunchOptions, Tab};
use serde_json::Value;
use std::ffi::OsStr;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// What the tests ask a page for.
const HELPERS: &str = include_str!("questions.js");

/// A page in a browser of its own, with what its console said.
pub struct Open {
    tab: Arc<Tab>,
    errors: Arc<Mutex<Vec<String>>>,
    /// Ends with its browser.
    _browser: Browser,
}

/// Opens a page's file at a width, all plots drawn; `None` as [`load`].
pub fn open(file: &Path, width: u32, scheme: &str) -> Option<Open> {
    let open = load(file, width, scheme)?;
    open.ask("drawAll()");
    Some(open)
}

/// Opens a page's file at a width, as a reader finds it: few plots are drawn; `None`, with a message,
/// without a browser outside of continuous integration.
pub fn load(file: &Path, width: u32, scheme: &str) -> Option<Open> {
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
    let url = format!("file://{}", file.display());
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
    Some(open)
}

impl Open {
    /// The value of an expression in the page, which has reacted to what was done before.
    pub fn ask(&self, expression: &str) -> Value {
        let text = format!(
            "(async () => {{ await settled(); return JSON.stringify((await {expression}) ?? null); }})()"
        );
        let found = self.tab.evaluate(&text, true);
        let found = found.unwrap_or_else(|error| panic!("{expression}: {error}"));
        let text = found.value.unwrap_or_default();
        let text = text
            .as_str()
            .unwrap_or_else(|| panic!("{expression}: no value"));
        serde_json::from_str(text).expect("JSON")
    }

    /// Moves the mouse, or presses or releases its button, at a point of the window.
    pub fn mouse(&self, kind: Input::DispatchMouseEventTypeOption, [x, y]: [f64; 2], clicks: u32) {
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

    /// Puts fingers on points of the window, moves them there, or lifts those that are not there.
    pub fn touch(&self, kind: Input::DispatchTouchEventTypeOption, fingers: &[[f64; 2]]) {
        let points = fingers
            .iter()
            .zip(0_u32..)
            .map(|(&[x, y], id)| Input::TouchPoint {
                x,
                y,
                radius_x: None,
                radius_y: None,
                rotation_angle: None,
                force: None,
                tangential_pressure: None,
                tilt_x: None,
                tilt_y: None,
                twist: None,
                id: Some(id.into()),
            });
        let event = Input::DispatchTouchEvent {
            Type: kind,
            touch_points: points.collect(),
            modifiers: None,
            timestamp: None,
        };
        self.tab.call_method(event).expect("a touch screen");
    }

    /// Moves the mouse to a point of the window.
    pub fn point_at(&self, at: [f64; 2]) {
        self.mouse(Input::DispatchMouseEventTypeOption::MouseMoved, at, 0);
    }

    /// Presses a key, by its name on the web.
    pub fn press(&self, key: &str) {
        self.tab.press_key(key).expect("a keyboard");
    }

    /// Expects an empty list of faults.
    #[track_caller]
    pub fn assert_none(&self, question: &str) {
        let faults = self.ask(question);
        assert_eq!(faults, Value::from(Vec::<String>::new()), "{question}");
    }

    /// The point at shares of the plotted area of a plot, scrolled into view.
    pub fn point(&self, plot: usize, x: f64, y: f64) -> [f64; 2] {
        self.place(&format!("pointOf({plot}, {x}, {y})"))
    }

    /// A point of the window, as an expression gives it.
    pub fn place(&self, expression: &str) -> [f64; 2] {
        place_of(&self.ask(expression))
    }

    /// Expects nothing in the console, once the page has reacted to all that was done.
    #[track_caller]
    pub fn assert_no_errors(&self) {
        self.ask("null");
        let errors = self.errors.lock().expect("no panic");
        assert!(errors.is_empty(), "{errors:#?}");
    }
}

/// A point of the window from a page's answer.
pub fn place_of(answer: &Value) -> [f64; 2] {
    [0, 1].map(|axis| answer[axis].as_f64().expect("a number"))
}
