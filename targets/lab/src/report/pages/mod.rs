//! The pages: contents of the motor's report and of the paper's experiment, in order.

mod accuracy;
mod commutation;
mod facts;
mod paper;
mod robustness;
mod shapes;
mod spectra;
mod stability;
mod table;
mod texts;
mod torque_speed;
mod verdict;
mod waves;

pub use paper::{reproduction_blocks, reproduction_page};
pub use robustness::robustness_blocks;
pub use table::{results_blocks, variants_table};
pub use verdict::verdict;

use super::{Block, Color, Key, PHASES, Page, Section, Sign, Switch, variant};
use crate::results::{Capture, Results, Variant};
use hexagen_codegen::spec::Reference;

/// The report of a motor.
pub fn results_page(data: &Results) -> Page {
    let robustness = match &data.robustness {
        Some(sheet) => robustness_blocks(sheet),
        None => Block::nothing("robustness sheet"),
    };
    Page {
        file: format!("report-{}", file_stem(&data.file)),
        title: facts::title(data),
        heading: facts::motor_name(data).to_owned(),
        opening: [
            verdict::verdict_blocks(data),
            commutation::blocks(data),
            facts::opening(data),
        ]
        .concat(),
        sections: vec![
            Section::new("motor", "Motor and inverter", facts::facts(data)),
            Section::new("results", "Results", results_blocks(data)),
            Section::new("currents", "Phase currents", waves::currents(data)),
            Section::new(
                "trajectory",
                "Current in the alpha-beta plane",
                waves::trajectories(data),
            ),
            Section::new("torque", "Torque", waves::torque(data)),
            Section::new("spectra", "Spectra", spectra::blocks(data)),
            Section::new(
                "torque-speed",
                "Torque over speed",
                torque_speed::blocks(data),
            ),
            Section::new("formats", "Formats", accuracy::formats(data)),
            Section::new(
                "errors",
                "Fixed point against float",
                accuracy::errors(data),
            ),
            Section::new("stability", "Stable ranges", stability::blocks(data)),
            Section::new("robustness", "Robustness", robustness),
            Section::new(
                "code",
                "Specification, formulas and emitted code",
                texts::linked(data),
            ),
            Section::new("data-sheet", "Data sheet", texts::data_sheet(data)),
            Section::new("spec", "Normalised specification", texts::spec(data)),
        ],
        generator: data.generator.clone(),
    }
}

/// A name as part of a file name: characters other than letters and digits of any script, `-`, `_`
/// and `.` become `-`.
fn file_stem(name: &str) -> String {
    let kept = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let stem: String = name
        .chars()
        .map(|c| if kept(c) { c } else { '-' })
        .collect();
    let stem = stem.trim_matches(['-', '.']);
    if stem.is_empty() { "motor" } else { stem }.to_owned()
}

/// The symbol of a variant by its index in the table.
fn variant_sign(index: usize) -> Sign {
    as_line(variant(index))
}

/// Switches of the plotted variants.
fn switches(data: &Results, sign: fn(Color) -> Sign) -> Block {
    let switches = plotted(data).map(|(index, of)| Switch {
        variant: index,
        key: sign(variant(index)).means(of.label.clone()),
    });
    Block::Switches(switches.collect())
}

/// A line as the symbol of a variant.
fn as_line(color: Color) -> Sign {
    Sign::line(color, 3.0)
}

/// Key of the phases' colours.
fn phase_keys(names: [&str; 3]) -> Vec<Key> {
    let phases = PHASES.into_iter().zip(names);
    phases
        .map(|(color, name)| Sign::line(color, 2.5).means(name))
        .collect()
}

/// The variants with records, with their index in the table.
fn plotted(data: &Results) -> impl Iterator<Item = (usize, &Variant)> {
    let variants = data.variants.iter().enumerate();
    variants.filter(|(_, variant)| !variant.records.is_empty())
}

/// Whether a plotted current is demanded in proportion to the EMF, a sine where that is one.
fn has_proportional(data: &Results) -> bool {
    plotted(data).any(|(_, variant)| variant.reference == Reference::Proportional)
}

/// What tells the rotor's position.
fn sensor_name(capture: Capture) -> &'static str {
    match capture {
        Capture::Sampled => "Hall edges at samples",
        Capture::Timer => "Hall edges captured by a timer",
        Capture::Angle => "angle sensor",
    }
}

/// Name of a capture.
fn capture_name(capture: Capture) -> &'static str {
    match capture {
        Capture::Sampled => "sampled",
        Capture::Timer => "timer",
        Capture::Angle => "angle",
    }
}

#[cfg(test)]
mod tests {
    use super::file_stem;

    #[test]
    fn names_make_valid_file_names() {
        for (name, stem) in [
            ("trivedi-keshri-660w", "trivedi-keshri-660w"),
            ("Hub_2.1", "Hub_2.1"),
            ("../etc/x", "etc-x"),
            ("", "motor"),
            ("A B", "A-B"),
        ] {
            assert_eq!(file_stem(name), stem);
        }
    }
}
