//! The report's page: complete, self-contained, well nested, and the same for the same data.

use crate::{page_support, report_support};
use hexagen_host::render::{self, html, terminal};
use hexagen_lab::closed_loop::{Cause, FiguresOfMerit, Held, LimitOutcome, Side, SpeedLimit, Trip};
use hexagen_lab::report::{results_blocks, results_page, variants_table};
use hexagen_lab::results::{Expectation, Expected, ExpectedPoint, Results};
use std::path::Path;
use std::sync::LazyLock;

static DATA: LazyLock<Results> = LazyLock::new(report_support::data);
static PAGE: LazyLock<String> = LazyLock::new(|| render(&DATA));

fn render(data: &Results) -> String {
    html(&results_page(data)).expect("the page renders")
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
        ("robustness", "Robustness"),
        ("code", "Specification, formulas and emitted code"),
        ("data-sheet", "Data sheet"),
        ("spec", "Normalised specification"),
    ] {
        let section = format!("<section id=\"{id}\"><h2>{title}</h2>");
        assert!(PAGE.contains(&section), "{section}");
        assert!(PAGE.contains(&format!("href=\"#{id}\"")), "link to {id}");
    }
    assert!(!PAGE.contains("This report has no"), "nothing is missing");
    // The EMF. Two of a commutation. Two speeds: six currents, trajectories and torques each, four spectra, one torque-speed
    // curve, two stable ranges; and two histograms of errors.
    assert_eq!(PAGE.matches("<div class=\"plot\"").count(), 30);
}

#[test]
fn the_printed_table_of_variants_keeps_to_a_hundred_columns() {
    let table = terminal::table(&variants_table(&DATA));
    for line in table.lines() {
        assert!(line.chars().count() <= 100, "{line}");
    }
}

/// Held furthest first; of those that hold as far, the smoothest at the highest speed.
#[test]
fn the_printed_table_has_a_row_per_variant_best_first() {
    let mut data = DATA.clone();
    data.variants.retain(|variant| !variant.runs.is_empty());
    let count = data.variants.len();
    assert!(count > 2, "{count} variants have no order");
    for (place, variant) in data.variants.iter_mut().enumerate() {
        let run = &mut variant.runs[0];
        let limit = run.limit.as_mut().expect("was scanned");
        // The last holds furthest and ripples most, the others hold as far, ever smoother.
        limit.limit_pct = Some(if place + 1 == count { 150.0 } else { 100.0 });
        let top = run.points.last_mut().expect("was run");
        let ripple = if place + 1 == count {
            90.0
        } else {
            50.0 - place as f64
        };
        top.figures.ripple_pp_pct = Some(ripple);
    }
    let mut expected: Vec<String> = data
        .variants
        .iter()
        .rev()
        .map(|of| of.label.clone())
        .collect();
    let rows = |data: &Results| -> Vec<String> {
        let table = variants_table(data);
        let rows = table.groups.iter().flat_map(|group| &group.rows);
        rows.map(|row| row[0].text.clone()).collect()
    };
    assert_eq!(rows(&data), expected);
    // The order is not that of the data.
    data.variants.reverse();
    assert_eq!(rows(&data), expected);
    // One that does not hold the torque at all is the last.
    let worst = &mut data.variants[0].runs[0];
    worst.limit.as_mut().expect("was scanned").limit_pct = None;
    expected.rotate_left(1);
    assert_eq!(rows(&data), expected);
}

#[test]
fn page_is_complete_in_itself_and_well_formed() {
    page_support::assert_refers_to_nothing_outside(&PAGE);
    page_support::assert_well_nested(&PAGE);
    page_support::assert_plots_stay_inside_their_frames(&PAGE);
}

/// Three of the seven plotted variants of a library motor are on this page: the largest page of a
/// motor is 1.85 times its size, which `in_browser` measures each night.
#[test]
fn the_page_stays_small() {
    let most = 440_000;
    let size = PAGE.len();
    assert!(
        size < most,
        "{size} bytes of at most {most}: a motor's page would pass 850 kB; draw fewer columns or points"
    );
}

#[test]
fn same_data_give_the_same_bytes() {
    assert_eq!(render(&DATA), *PAGE);
}

#[test]
fn the_page_as_json_has_its_sections_tables_and_plots() {
    let page = serde_json::to_value(results_page(&DATA)).expect("all of it is data");
    let sections = page["sections"].as_array().expect("a list");
    assert_eq!(sections.len(), PAGE.matches("<section ").count());
    let text = page.to_string();
    assert_eq!(text.matches("\"elements\":").count(), 30, "plots");
    let rows = &page["sections"][1]["blocks"][2]["table"]["groups"][0]["rows"];
    assert_eq!(rows[0][2]["text"], "3.30", "the first mean: {rows}");
}

#[test]
fn the_result_table_in_the_terminal_says_what_the_page_says() {
    let text = terminal::text(&results_blocks(&DATA));
    for part in [
        "| Variant ",
        "All 21 expected figures are met.",
        " 3.30 (3.30) |",
        "| ideal ",
    ] {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
}

#[test]
fn texts_of_the_data_are_escaped() {
    assert!(PAGE.contains("&lt;text &amp; &quot;quotes&quot;&gt;"));
    assert!(!PAGE.contains("<text & "));
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
        limit: Some(Expectation::In(120.0.into())),
    });
    run.limit = Some(SpeedLimit {
        limit_rpm: None,
        limit_pct: None,
        outcome: LimitOutcome::NeverHeld,
        lost: Some(Side::Above),
        tripped: None,
        curve: Vec::new(),
    });
    let page = render(&data);
    assert!(page.contains("\u{2260}\u{a0}3.30"), "the mean differs");
    assert!(page.contains("2.0\u{2013}3.0"), "a band is shown as one");
    let limit = "missed\">\u{2260}\u{a0}never held, torque above";
    assert!(page.contains(limit), "so does the limit, with its side");
    assert!(page.contains("expected figures are met; the others are marked"));
}

#[test]
fn a_drive_that_tripped_has_no_figures_and_no_plots() {
    let trip = Trip {
        fault: Cause::OverCurrent,
        time_s: 0.01,
        rpm: 400.0,
    };
    let mut data = DATA.clone();
    let variant = &mut data.variants[0];
    for point in variant.runs.iter_mut().map(|run| &mut run.points[0]) {
        (point.figures, point.tripped) = (FiguresOfMerit::default(), Some(trip));
    }
    variant.records.remove(0);
    let limit = variant.runs[0].limit.as_mut().expect("was searched");
    (limit.tripped, limit.lost) = (Some(trip), None);
    let page = render(&data);
    let cell = "<td class=\"number edge missed\" colspan=\"3\">trips</td>";
    assert_eq!(page.matches(cell).count(), 2, "fixed and ideal");
    assert!(page.contains("rpm: the drive trips at 400 rpm)"));
    // Currents, trajectory and torque of the record that is gone.
    assert_eq!(page.matches("<div class=\"plot\"").count(), 30 - 3);
}

#[test]
fn the_page_says_where_the_demand_is_limited() {
    assert!(!PAGE.contains(", limited to "));
    let mut data = DATA.clone();
    data.torque = 5.0;
    let own = data.own.as_mut().expect("the motor file's own");
    own.judgement.greatest_torque_nm = 3.5;
    let page = render(&data);
    let told = "5\u{a0}Nm, limited to 3.5\u{a0}Nm, demanded.";
    assert!(page.contains(told));
}

#[test]
fn the_page_says_which_torque_counts_as_held() {
    assert!(
        PAGE.contains("falls below 97\u{a0}% of the demand, as in the design document's table")
    );
    assert!(PAGE.contains("\"97 % of demand\"") && !PAGE.contains("\"103 % of demand\""));
    let mut data = DATA.clone();
    data.held = Held::Within;
    let page = render(&data);
    assert!(page.contains("is no longer within 3\u{a0}% of the demand, on either side"));
    page_support::assert_plots_stay_inside_their_frames(&page);
    assert!(page.contains("\"97 % of demand\"") && page.contains("\"103 % of demand\""));
}

#[test]
fn the_heat_table_has_a_cell_per_controller_disturbance_and_speed() {
    let (_, sheet) = PAGE
        .split_once("<section id=\"robustness\">")
        .expect("the section");
    let (sheet, _) = sheet.split_once("</section>").expect("its end");
    // Five disturbances at two speeds; of three controllers one is missing.
    assert_eq!(sheet.matches("<td").count(), 5 * 2 * 2);
    for (class, count) in [
        ("number", 4),
        ("number muted", 2),
        ("number slight", 4),
        ("number marked", 4),
        ("number strong", 2),
        ("number broken", 4),
    ] {
        let cells = sheet.matches(&format!("<td class=\"{class}\">")).count();
        assert_eq!(cells, count, "{class}");
    }
    for text in [
        ">trips</td>",
        ">oscillates</td>",
        "3.30 <small>12.0 / 2.5</small>",
        "R x 2",
        "L x 0.75",
        "dead time 1 \u{b5}s",
        "10-bit ADC, 200 mA off",
        "<code>phcc</code> is missing: one vector moves the current too far",
        "<code>pdcc</code>, dead time 1 \u{b5}s: the dead time is too long",
        "A run oscillates if",
    ] {
        assert!(sheet.contains(text), "no `{text}` in {sheet}");
    }
}

#[test]
fn histograms_stand_against_the_bound() {
    let (_, errors) = PAGE
        .split_once("Errors of single steps against the proven bound")
        .expect("the part");
    let (errors, _) = errors.split_once("</section>").expect("its end");
    for text in [
        "<strong>32\u{a0}bits</strong>: 6.956 \u{b5}V of 9.4 \u{b5}V",
        "\"error in \u{b5}V\"",
        "\"error in mV\"",
        "\"\u{2212}bound\"",
        "Errors of phcc with 16-bit words: 177.6 mV at most, proven 240 mV",
    ] {
        let flat = errors.replace('\n', "");
        assert!(flat.contains(text), "no `{text}` in {flat}");
    }
}

#[test]
fn page_without_runs_says_so_instead_of_failing() {
    let mut data = DATA.clone();
    let variant = &mut data.variants[0];
    variant.runs.clear();
    variant.records.clear();
    variant.torque_speed.clear();
    variant.signal_errors.clear();
    variant.stability = None;
    variant.generated = None;
    data.variants.truncate(1);
    data.verification = None;
    data.marks.clear();
    data.robustness = None;
    data.errors.clear();
    let page = render(&data);
    for what in [
        "records",
        "torque-speed curves",
        "formats",
        "robustness sheet",
        "emitted code",
    ] {
        let sentence = format!("This report has no {what}.");
        assert!(page.contains(&sentence), "{sentence}");
    }
}

/// Also leaves the page where a person can look at it: the folder for files of integration tests.
#[test]
fn page_is_written_whole_under_the_motors_name() {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    let path = render::write(&results_page(&DATA), &dir).expect("the page is written");
    assert_eq!(path, dir.join("report-trivedi-keshri-660w.html"));
    assert_eq!(std::fs::read_to_string(&path).expect("it is there"), *PAGE);
    let left: Vec<_> = std::fs::read_dir(&dir)
        .expect("the folder is there")
        .filter_map(|entry| Some(entry.ok()?.file_name()))
        .collect();
    assert_eq!(left, ["report-trivedi-keshri-660w.html"]);
}

#[test]
fn a_speed_at_which_the_drive_tripped_has_no_row_of_dashes() {
    let mut data = DATA.clone();
    let tripped = &mut data.variants[0].same_words[0];
    let figures = FiguresOfMerit::default();
    (tripped.fixed, tripped.ideal) = (figures, figures);
    let errors = |page: &str| {
        let table = page
            .split("<table class=\"errors\">")
            .nth(1)
            .expect("is there");
        let table = table.split("</table>").next().unwrap_or_default();
        table.matches("<tr>").count()
    };
    assert_eq!(errors(&render(&data)) + 1, errors(&PAGE));
}
