//! 16-bit words over the library: the formats chosen per motor against one saturating format in SI
//! units for all motors.

use crate::cli::{
    Failure, PlantArguments, paragraph, print_json, print_table, print_text, spinner,
};
use hexagen_lab::accuracy::{LAW, compare_library};
use hexagen_lab::report::Table;
use hexagen_lab::text::significant;

/// Prints the comparison.
///
/// # Errors
/// A plant option out of range.
pub fn run(plant: &PlantArguments, json: bool) -> Result<(), Failure> {
    let progress = spinner("comparing");
    let library = compare_library(&plant.options());
    progress.finish_and_clear();
    let library = library.map_err(|error| plant.blame(error))?;
    if json {
        return print_json(&library);
    }
    let mut table = Table::listed(
        ["motor"],
        [
            "SNR dB",
            "largest V",
            "bound V",
            "ratio",
            "one format",
            "better by dB",
        ],
    );
    for row in &library.rows {
        let Some(own) = &row.one_step else {
            table.row([row.motor.as_str(), "refused"]);
            continue;
        };
        let decibel = |db: Option<f64>| db.map_or_else(String::new, |db| format!("{db:.1}"));
        table.row([
            row.motor.clone(),
            format!("{:.1}", own.snr_db),
            significant(own.largest_v, 3),
            significant(own.bound_v, 3),
            format!("{:.3}", own.seen_to_bound),
            decibel(row.uniform_snr_db),
            decibel(row.better_by_db),
        ]);
    }
    print_table(&table)?;
    for reason in library.rows.iter().filter_map(|row| row.refused.as_ref()) {
        print_text(&paragraph(reason))?;
    }
    print_text(&paragraph(&format!(
        "Deadbeat voltage of {LAW} with 16-bit words, one step from the same state, 20 and 75 % of rated speed: signal over error in the \
         formats chosen by the generator, and in one saturating 16-bit format in SI units with {} fraction bits, the most that holds bus \
         voltages, currents and coefficients of all these motors.\n\
         Words of 16 bits: formats of each motor's own are {:.1} dB nearer to floating point, on average, than one format for all.\n\
         Words of 32 bits: compared for one motor, `hexagen compare MOTOR`.",
        library.uniform_frac_bits, library.better_by_db
    )))
}
