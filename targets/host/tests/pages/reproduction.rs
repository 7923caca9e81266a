//! The page of the paper's experiment, from short runs of the real drives.

use crate::{page_support, reproduction_support};
use hexagen_host::render::{html, terminal, write};
use hexagen_lab::READINGS;
use hexagen_lab::closed_loop::FiguresOfMerit;
use hexagen_lab::report::{Block, reproduction_blocks, reproduction_page};
use hexagen_lab::reproduction::{Method, Reading, Reproduction, Verdict, distance_rms};
use std::path::Path;
use std::sync::LazyLock;

static DATA: LazyLock<Reproduction> = LazyLock::new(reproduction_support::data);
static PAGE: LazyLock<String> = LazyLock::new(render);

fn render() -> String {
    html(&reproduction_page(&DATA)).expect("the page renders")
}

#[test]
fn tables_and_figures_are_there_in_the_papers_order() {
    let ids = [
        "readings",
        "claims",
        "table-1",
        "table-2",
        "table-3",
        "table-4",
        "figure-2",
        "figure-3",
        "figure-4",
        "figure-5",
        "figure-9",
        "figure-12",
        "figure-14",
        "figure-15",
        "figure-16",
        "figure-17",
        "figure-18",
        "figure-19",
        "figure-20",
        "table-5",
    ];
    let places: Vec<usize> = ids
        .iter()
        .map(|id| {
            assert!(PAGE.contains(&format!("href=\"#{id}\"")), "link to {id}");
            let section = format!("<section id=\"{id}\">");
            PAGE.find(&section).unwrap_or_else(|| panic!("no {id}"))
        })
        .collect();
    assert!(places.is_sorted(), "{places:?}");
    // Figures 2, 3, 4, 5, 9, 12 and 13; per speed seven runs (one drive trips) as current, torque and
    // trajectory, four spectra and two harmonics; two torque-speed plots.
    let plots = PAGE.matches("<div class=\"plot\"").count();
    assert_eq!(plots, 10 + 2 * (3 * 7 + 4 + 2) + 2);
    // The drive that tripped at both speeds.
    assert_eq!(PAGE.matches("tripped</td>").count(), 2);
}

#[test]
fn page_is_complete_in_itself_and_well_formed() {
    page_support::assert_refers_to_nothing_outside(&PAGE);
    page_support::assert_well_nested(&PAGE);
    page_support::assert_plots_stay_inside_their_frames(&PAGE);
    assert_eq!(render(), *PAGE);
}

#[test]
fn readings_are_compiled_drives_of_the_four_methods() {
    for (method, readings) in Method::ALL.into_iter().zip(READINGS) {
        let runs = &DATA.methods[method.index()];
        assert_eq!(runs.literal.variant, readings.literal);
        assert_eq!(runs.corrected.variant, readings.corrected);
        let kind = method.name().to_lowercase();
        for run in Reading::ALL.map(|reading| runs.of(reading)) {
            assert!(run.variant.starts_with(&kind), "{}", run.variant);
            assert_eq!(run.engine, "compiled", "{}", run.variant);
            assert!(run.cost.worst >= run.cost.normal);
        }
    }
}

#[test]
fn improvements_hold_more_torque_and_have_rows_of_their_own() {
    let ripples = DATA.improvements.iter().map(|improved| {
        let [_, high] = &improved.run.points;
        assert_eq!(high.trip, None);
        assert_eq!(improved.run.engine, "compiled", "{}", improved.run.variant);
        assert!(PAGE.contains(improved.about), "{}", improved.about);
        high.figures.ripple_pp_pct.expect("it runs")
    });
    let ripples: Vec<f64> = ripples.collect();
    let [pdcc, _, default] = ripples[..] else {
        panic!("three of them: {ripples:?}");
    };
    let corrected = &DATA.methods[Method::Pdcc.index()].corrected.points[1];
    let corrected = corrected.figures.ripple_pp_pct.expect("it runs");
    assert!(default < pdcc && pdcc < corrected / 3.0, "{ripples:?}");
}

#[test]
fn printed_switching_row_trips_and_the_derived_one_does_not() {
    let phcc = &DATA.methods[Method::Phcc.index()];
    for (literal, corrected) in phcc.literal.points.iter().zip(&phcc.corrected.points) {
        let trip = literal.trip.expect("it loses its current");
        assert!(trip.time_s > 0.0 && literal.figures == FiguresOfMerit::default());
        assert_eq!(corrected.trip, None);
        let torque = corrected.figures.mean_torque_nm.expect("it runs");
        assert!((torque / DATA.torque - 1.0).abs() < 0.1);
    }
    assert_eq!(DATA.tables.printed[0], [0, 7, 12, 7, 0, 2, 1, 2]);
    assert_ne!(DATA.tables.derived[0], DATA.tables.printed[0]);
    assert!(PAGE.contains("No plot: the drive tripped"));
}

#[test]
fn experiment_tells_what_the_paper_could_not_have_seen() {
    let claims = DATA.claims();
    let letters: String = claims.iter().map(|claim| claim.letter).collect();
    assert_eq!(letters, "abcdefgh");
    let verdict = |letter: char| {
        let claim = claims.iter().find(|claim| claim.letter == letter);
        claim.expect("it is judged").verdict()
    };
    // Vectors held for whole periods switch several times less than pulsed legs, in both readings.
    assert_eq!(verdict('g'), Verdict::DoesNotHold);
    assert_eq!(verdict('h'), Verdict::DoesNotHold);
    // Time remains in all methods, and PDCC takes longest where its voltage is limited; in a usual step FCS-MPC does.
    assert_eq!(verdict('f'), Verdict::InPart);
    let corrected = &DATA.methods[Method::Pdcc.index()].corrected;
    // At the high speed the nearest voltage leaves the outline in commutations, torque priority does not.
    let improved = &DATA.improvements[0].run;
    assert!(improved.points[1].hexagon_rms_a < 0.2);
    for (point, most) in corrected.points.iter().zip([0.2, 0.6]) {
        assert!(point.hexagon_rms_a < most, "{}", point.hexagon_rms_a);
        let again = distance_rms(&point.trace, DATA.current);
        assert!((again - point.hexagon_rms_a).abs() < 1e-12, "one start");
        let twice = distance_rms(&point.trace, 2.0 * DATA.current);
        assert!(twice > 10.0, "{twice} from a hexagon of twice the size");
    }
}

#[test]
fn summary_has_claims_reasons_and_table_5() {
    let blocks = reproduction_blocks(&DATA);
    let text = terminal::text(&blocks);
    // Lines end at 100 columns.
    let unbroken = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let tables = blocks.iter().filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    });
    let rows = tables
        .flat_map(|table| &table.groups)
        .flat_map(|group| &group.rows);
    let cells: Vec<&str> = rows.flatten().map(|cell| &*cell.text).collect();
    for claim in DATA.claims() {
        let reason = format!("({}) {}", claim.letter, claim.reason());
        assert!(unbroken.contains(&reason), "{reason}");
        assert!(text.contains(claim.verdict().text()));
        let [literal, corrected] = &claim.figures;
        for part in literal.split("; ").chain(corrected.split("; ")) {
            assert!(cells.iter().any(|cell| cell.contains(part)), "{part}");
            // A cell may be broken between words.
            assert!(part.split(' ').all(|word| text.contains(word)), "{part}");
        }
    }
    for word in [
        "T_c",
        "T_f",
        "f_sw per device, kHz",
        "cargo xtask cost",
        "72 MHz",
    ] {
        let is_there = word.split(' ').all(|part| text.contains(part));
        assert!(is_there, "{word}");
    }
}

/// Also leaves the page where a person can look at it: the folder for files of integration tests.
#[test]
fn page_is_written_whole() {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reproduction");
    let path = write(&reproduction_page(&DATA), &dir).expect("the page is written");
    assert_eq!(path, dir.join("reproduction.html"));
    assert_eq!(std::fs::read_to_string(&path).expect("it is there"), *PAGE);
    let left = std::fs::read_dir(&dir)
        .expect("the folder is there")
        .count();
    assert_eq!(left, 1);
}
