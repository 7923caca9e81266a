//! Progress on stderr: a bar on a terminal; elsewhere a line for each part of long work.

use hexagen_lab::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// A progress bar for work of the laboratory, removed when dropped; drawn only if stderr is a
/// terminal.
pub struct Bar {
    bar: ProgressBar,
    /// Without a terminal each part is said as it begins.
    tells: bool,
}

impl Bar {
    /// For work of half a minute and more.
    pub fn of_long_work() -> Self {
        Self::new(true)
    }

    fn new(tells: bool) -> Self {
        let bar = ProgressBar::new(0);
        let template = "{msg:24} {wide_bar} {human_pos}/{human_len} {eta}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        Self { bar, tells }
    }
}

impl Default for Bar {
    fn default() -> Self {
        Self::new(false)
    }
}

impl Progress for Bar {
    fn begin(&self, what: &'static str, units: u64) {
        self.bar.set_length(units);
        self.bar.set_message(what);
        self.bar.reset();
        if self.tells && self.bar.is_hidden() {
            super::note(&format!("{what} …"));
        }
    }

    fn advance(&self, units: u64) {
        self.bar.inc(units);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// A spinner for work of unknown length.
pub fn spinner(message: &str) -> ProgressBar {
    let spinner = ProgressBar::new_spinner();
    spinner.set_message(message.to_owned());
    spinner.enable_steady_tick(Duration::from_millis(100));
    spinner
}
