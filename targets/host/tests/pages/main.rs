//! The pages of the report and of the paper's experiment: as text, and in a browser.

mod browser_support;
mod in_browser;
mod page_support;
mod report;
mod report_support;
mod reproduction;
mod reproduction_support;
