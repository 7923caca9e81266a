//! Names of data sheets for what a field takes in its own way. Spelling says nothing about them:
//! a speed constant is nearer to `torque_constant` by its letters, and its reciprocal by its sense.

use crate::spec::ast::{Field, Value};
use crate::spec::toml_syntax::parse_board;
use crate::spec::units::Dimension;
use crate::spec::{BOARDS, LibraryBoard};

/// What encoders' sheets call the lines of a turn.
const LINES: &[&str] = &[
    "lines",
    "angle_lines",
    "encoder_lines",
    "lines_per_turn",
    "lines_per_revolution",
    "ppr",
    "encoder_ppr",
    "pulses",
    "pulses_per_turn",
    "pulses_per_revolution",
];

/// What they call the counts of a turn, four of each line.
const COUNTS: &[&str] = &[
    "counts",
    "angle_counts",
    "encoder_counts",
    "counts_per_turn",
    "counts_per_revolution",
    "cpr",
    "encoder_cpr",
];

/// Counts of some makers; cycles, that is lines, of others.
const CYCLES: &[&str] = &["cpr", "encoder_cpr"];

/// Fields, and what data sheets call them.
const NAMES: [(&str, &[&str]); 19] = [
    ("kind", &["type"]),
    ("angle_bits", LINES),
    ("angle_bits", COUNTS),
    (
        "poles",
        &[
            "pole_count",
            "pole_number",
            "number_of_poles",
            "magnet_poles",
            "magnets",
        ],
    ),
    (
        "speed_constant",
        &["velocity_constant", "kv", "k_v", "kv_rating"],
    ),
    ("torque_constant", &["kt", "k_t", "km", "k_m"]),
    (
        "back_emf",
        &[
            "emf_constant",
            "bemf_constant",
            "bemf",
            "voltage_constant",
            "generator_constant",
            "ke",
            "k_e",
        ],
    ),
    ("rated_speed", &["nominal_speed", "rated_rpm", "rpm"]),
    ("resistance", &["r", "r_s", "phase_resistance"]),
    ("winding", &["connection", "windings", "winding_type"]),
    ("inductance", &["l", "l_s", "phase_inductance"]),
    (
        "bus_voltage",
        &["supply_voltage", "battery_voltage", "dc_link_voltage"],
    ),
    (
        "f_pwm",
        &[
            "pwm_frequency",
            "pwm_freq",
            "switching_frequency",
            "switching_freq",
            "f_sw",
        ],
    ),
    (
        "bus_current_limit",
        &[
            "max_bus_current",
            "bus_max_current",
            "maximum_bus_current",
            "bus_current",
            "battery_current",
            "max_battery_current",
            "battery_current_limit",
        ],
    ),
    (
        "return_current_limit",
        &[
            "max_return_current",
            "regen_current",
            "max_regen_current",
            "regen_current_limit",
            "max_charge_current",
            "charge_current_limit",
        ],
    ),
    (
        "adc_gain",
        &[
            "gain",
            "sensitivity",
            "current_gain",
            "current_sensitivity",
            "sensor_sensitivity",
        ],
    ),
    ("rated_torque", &["nominal_torque", "continuous_torque"]),
    (
        "rated_current",
        &[
            "nominal_current",
            "continuous_current",
            "max_continuous_current",
        ],
    ),
    (
        "bus_adc_range",
        &[
            "bus_divider",
            "bus_adc_divider",
            "bus_voltage_divider",
            "voltage_divider",
        ],
    ),
];

/// What data sheets print and no controller here uses. Their letters are near to those of other fields:
/// `idle_current` to `rated_current`.
const UNUSED: [&str; 28] = [
    "power",
    "output_power",
    "idle_current",
    "no_load_current",
    "stall_current",
    "starting_current",
    "stall_torque",
    "starting_torque",
    "peak_torque",
    "max_torque",
    "cogging_torque",
    "detent_torque",
    "friction_torque",
    "efficiency",
    "max_efficiency",
    "rated_power",
    "nominal_power",
    "max_power",
    "thermal_resistance",
    "thermal_time_constant",
    "thermal_time_constant_winding",
    "mechanical_time_constant",
    "electrical_time_constant",
    "speed_torque_gradient",
    "motor_constant",
    "max_winding_temperature",
    "weight",
    "mass",
];

/// Words of data sheets and files for those that fields take.
const WORDS: [(&str, &str); 6] = [
    ("wye", "star"),
    ("y", "star"),
    ("sine", "sinusoidal"),
    ("trapezoid", "trapezoidal"),
    ("true", "on"),
    ("false", "off"),
];

/// Cores without figures of their own, and the core whose code they run.
const CORES: [(&str, &[&str]); 2] = [
    ("cortex_m0", &["cortex_m0plus", "cortex_m1", "cortex_m23"]),
    (
        "cortex_m4",
        &[
            "cortex_m3",
            "cortex_m4f",
            "cortex_m7",
            "cortex_m33",
            "cortex_m35p",
            "cortex_m52",
            "cortex_m55",
            "cortex_m85",
        ],
    ),
];

/// Sensors of the rotor's angle.
const ANGLE_SENSORS: [&str; 8] = [
    "encoder",
    "absolute_encoder",
    "magnetic_encoder",
    "incremental_encoder",
    "abz",
    "resolver",
    "sin_cos",
    "sincos",
];

/// What to write for a word without meaning here, a clause, if the field takes its kin.
pub(super) fn kin(given: &str, known: &[&str]) -> Option<String> {
    if ANGLE_SENSORS.contains(&given) && known.contains(&"angle") {
        return Some(
            "of such a sensor the program passes the angle: write `angle`, with `angle_pole_pairs`"
                .to_owned(),
        );
    }
    if ["a", "b", "c"].contains(&given) && known.contains(&"abc") {
        return Some("write the phases as one word".to_owned());
    }
    if known.contains(&"cortex_m4")
        && let Some((name, core)) = core_of(given)
    {
        return Some(format!("for {name} write `{core}`"));
    }
    let (core, _) = CORES
        .iter()
        .find(|(core, others)| others.contains(&given) && known.contains(core))?;
    Some(format!(
        "nothing is counted on it, the nearest is `{core}`, with your `core_clock`"
    ))
}

/// Fewest letters of a chip's name that tell its family, as `stm32g4`.
const FAMILY: usize = 7;

/// The core of a board of the library or of its chip, with its name; of a chip the beginning of its name is enough, and
/// more may follow.
fn core_of(given: &str) -> Option<(String, String)> {
    let plain = |name: &str| {
        let letters = name.chars().filter(char::is_ascii_alphanumeric);
        letters.collect::<String>().to_lowercase()
    };
    let given = plain(given);
    let is_chip = |name: &str| {
        let chip = plain(name);
        given.starts_with(&chip) || (given.len() >= FAMILY && chip.starts_with(&given))
    };
    let boards: Vec<[String; 3]> = BOARDS.iter().filter_map(core_of_board).collect();
    let chip = boards.iter().find(|[_, _, chip]| is_chip(chip));
    let chip = chip.map(|[_, core, chip]| (format!("the chip {chip}"), core.clone()));
    let board = boards.iter().find(|[board, ..]| plain(board) == given);
    chip.or_else(|| board.map(|[board, core, _]| (format!("the board {board}"), core.clone())))
}

/// The name of a board of the library, its core and its chip, of whose source the first words tell it.
fn core_of_board(board: &LibraryBoard) -> Option<[String; 3]> {
    const TARGET: &str = "target";
    let file = parse_board(board.text, board.name).ok()?;
    let core = file.core.field(TARGET)?.value.to_string();
    let chip = file.source_of(TARGET)?.split(',').next()?;
    Some([board.name.to_owned(), core, chip.to_owned()])
}

/// The word that another one stands for.
pub(super) fn word(given: &str) -> Option<&'static str> {
    let row = WORDS.iter().find(|(other, _)| *other == given)?;
    Some(row.1)
}

/// Fields that state an EMF, and the quantity of each.
const OF_EMF: [(&str, Dimension); 3] = [
    ("back_emf", Dimension::EmfConstant),
    ("speed_constant", Dimension::SpeedConstant),
    ("torque_constant", Dimension::TorqueConstant),
];

/// The other field that states an EMF by a quantity.
pub(super) fn of_emf(name: &str, dimension: Dimension) -> Option<&'static str> {
    let states_emf = OF_EMF.iter().any(|(field, _)| *field == name);
    let other = OF_EMF.iter().find(|(_, quantity)| *quantity == dimension);
    Some(other?.0).filter(|_| states_emf)
}

/// The field that takes what the name stands for.
pub(super) fn meant(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let row = NAMES
        .iter()
        .find(|(_, names)| names.contains(&name.as_str()));
    row.map(|(field, _)| *field)
}

/// Whether nothing takes a value of this name.
pub(super) fn is_unused(name: &str) -> bool {
    UNUSED.contains(&name.to_lowercase().as_str())
}

/// What to write in the field `meant` for the value of another one, a clause.
pub(super) fn remedy(meant: &str, field: &Field) -> String {
    if meant == "bus_adc_range" {
        return "write `bus_adc_range`, the bus voltage at the converter's last count: its reference times (R_high + R_low)/R_low".to_owned();
    }
    if meant == "adc_gain" {
        return "write `adc_gain` for what a count is worth (A/count, or mV/A with `adc_reference`), or `amplifier_gain` for the number by which an amplifier multiplies the voltage of the `shunt`".to_owned();
    }
    if meant == "angle_bits" {
        return remedy_of_encoder(field);
    }
    let Value::Number(number) = &field.value else {
        return format!("did you mean `{meant}`?");
    };
    let dimension = number.unit.as_ref().map(|unit| unit.dimension);
    match meant {
        "poles" => format!("write `poles: {number}`"),
        "speed_constant" if dimension == Some(Dimension::SpeedConstant) => {
            format!("write `speed_constant: {number}`")
        }
        "speed_constant" => "write `speed_constant` with the unit `rpm/V`".to_owned(),
        _ => format!("did you mean `{meant}`?"),
    }
}

/// Bits of what an encoder counts in a turn, a clause.
fn remedy_of_encoder(field: &Field) -> String {
    const FIELD: &str = "angle_bits";
    let name = field.name.to_lowercase();
    let is_lines = LINES.contains(&&*name);
    let factor = if is_lines { 4 } else { 1 };
    let counts = match &field.value {
        Value::Number(number) => number.digits.parse::<u32>().ok(),
        _ => None,
    };
    let counts = counts.and_then(|given| given.checked_mul(factor));
    // Other numbers are refused.
    let Some(counts) = counts.filter(|counts| *counts >= 256) else {
        return format!(
            "write `{FIELD}`, from 8 to 32: the base-2 logarithm of the counts in a turn, which are four of each line"
        );
    };
    let of_lines = if is_lines {
        ", four of each line"
    } else if CYCLES.contains(&&*name) {
        " (two bits more where the sheet counts lines by it)"
    } else {
        ""
    };
    let rounded = if counts.is_power_of_two() {
        ""
    } else {
        ", rounded down, and scale the count to 2^32 for a turn"
    };
    format!(
        "write `{FIELD}: {}`, the base-2 logarithm of {counts} counts in a turn{of_lines}{rounded}",
        counts.ilog2()
    )
}
