//! The report's page: complete, self-contained, well nested, and the same for the same data.

mod report_support;

use hexagen_host::report::{ReportData, render, write};
use std::path::Path;
use std::sync::LazyLock;

static DATA: LazyLock<ReportData> = LazyLock::new(report_support::data);
static PAGE: LazyLock<String> = LazyLock::new(|| render(&DATA).expect("the page renders"));

/// Writes the page where a person can look at it: the folder for files of integration tests.
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
