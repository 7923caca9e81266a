//! The fields with their kinds of values and limits.
//!
//! The limits catch wrong units and decimal points; they are wider than any motor that this crate
//! is made for. The reference table for users is the documentation of [`crate::spec`].

use super::ast::Basis;
use super::controller;
use super::rule::{Kind, Rule, integer, plain, quantity, text, word};
use super::units::Dimension as D;

/// 1 rpm in rad/s.
const RPM: f64 = std::f64::consts::PI / 30.0;

const EMF: &[D] = &[D::EmfConstant, D::SpeedConstant, D::FluxLinkage];

/// Fields of the motor. The limits of `back_emf` apply to its phase constant.
pub(crate) const MOTOR: &[Rule] = &[
    text("name", "\"HubDrive\""),
    text("description", "\"Rear hub drive\""),
    integer("pole_pairs", 1, 64, "4"),
    integer("poles", 2, 128, "8"),
    quantity(
        "resistance",
        &[D::Resistance],
        1e-4,
        1e3,
        "135 mohm per_phase",
    ),
    quantity(
        "inductance",
        &[D::Inductance],
        1e-7,
        1.0,
        "0.22 mH per_phase",
    ),
    word("winding", "star"),
    quantity(
        "back_emf",
        EMF,
        f64::MIN_POSITIVE,
        f64::MAX,
        "17.3 V/krpm line_to_line peak",
    ),
    quantity(
        "speed_constant",
        &[D::SpeedConstant],
        f64::MIN_POSITIVE,
        f64::MAX,
        "58 rpm/V",
    ),
    word("emf_shape", "trapezoidal"),
    quantity("flat_top", &[D::Angle], 1.0, 179.0, "120 deg"),
    quantity("rated_current", &[D::Current], 0.01, 1e4, "20 A"),
    quantity("rated_torque", &[D::Torque], 1e-5, 1e5, "3.3 Nm"),
    quantity(
        "torque_constant",
        &[D::TorqueConstant],
        1e-5,
        100.0,
        "0.16 Nm/A block_mean",
    ),
    quantity("rated_speed", &[D::Speed], RPM, 2e5 * RPM, "2000 rpm"),
    quantity("no_load_speed", &[D::Speed], RPM, 3e5 * RPM, "5000 rpm"),
    quantity("nominal_voltage", &[D::Voltage], 0.5, 2000.0, "24 V"),
    quantity("inertia", &[D::Inertia], 1e-9, 100.0, "24 g cm2"),
    quantity("inductance_tolerance", &[D::Ratio], 0.0, 0.9, "10 %"),
    quantity("resistance_tolerance", &[D::Ratio], 0.0, 0.9, "30 %"),
    Rule::of("hall_codes", Kind::Integers, "[1, 5, 4, 6, 2, 3]"),
    quantity(
        "hall_angles",
        &[D::Angle],
        -360.0,
        360.0,
        "[-26 deg, 31 deg, 90 deg, 150 deg, 212 deg, 270 deg]",
    ),
];

/// Fields of the inverter.
pub(crate) const INVERTER: &[Rule] = &[
    quantity("bus_voltage", &[D::Voltage], 1.0, 2000.0, "48 V"),
    word("v_bus", "fixed"),
    integer("bus_adc_bits", 8, 16, "12"),
    quantity("bus_adc_range", &[D::Voltage], 1.0, 4000.0, "80 V"),
    quantity("bus_min", &[D::Voltage], 0.5, 2000.0, "36 V"),
    quantity("bus_max", &[D::Voltage], 1.0, 4000.0, "60 V"),
    quantity("over_voltage", &[D::Voltage], 0.0, 4000.0, "58 V"),
    quantity("under_voltage", &[D::Voltage], 0.0, 2000.0, "38 V"),
    quantity("braking_fade", &[D::Voltage], 0.0, 2000.0, "4 V"),
    quantity("motoring_fade", &[D::Voltage], 0.0, 2000.0, "4 V"),
    quantity("f_pwm", &[D::Frequency], 500.0, 500e3, "20 kHz"),
    quantity("sampling_time", &[D::Time], 2e-6, 2e-3, "50 us"),
    quantity("timer_clock", &[D::Frequency], 100e3, 1e9, "72 MHz"),
    integer("timer_period", 100, 65535, "1800"),
    quantity("dead_time", &[D::Time], 0.0, 20e-6, "500 ns"),
    integer("adc_bits", 8, 16, "12"),
    quantity("adc_range", &[D::Current], 0.01, 2e4, "40 A"),
    quantity(
        "adc_gain",
        &[D::CurrentPerCount],
        1e-7,
        100.0,
        "19.5 mA/count",
    ),
    integer("adc_offset", 0, 65535, "2048"),
    word("adc_inverted", "off"),
    quantity("shunt", &[D::Resistance], 1e-6, 100.0, "1 mohm"),
    plain("amplifier_gain", 1e-2, 1e4, "20"),
    quantity("adc_reference", &[D::Voltage], 0.1, 20.0, "3.3 V"),
    word("current_sensing", "low_side"),
    word("sensed_phases", "ab"),
    quantity("settling_time", &[D::Time], 0.0, 1e-4, "1 us"),
    quantity("aperture_time", &[D::Time], 0.0, 1e-4, "200 ns"),
    quantity("conversion_time", &[D::Time], 0.0, 1e-4, "0 us"),
    quantity("sampling_lead", &[D::Time], 0.0, 1e-4, "500 ns"),
    quantity("minimum_low_time", &[D::Time], 0.0, 1e-3, "2 us"),
    integer("pwm_per_control", 1, 16, "3"),
    quantity("offset_tolerance", &[D::Current], 1e-5, 2e4, "2 A"),
    quantity("trip_current", &[D::Current], 0.01, 2e4, "38 A"),
    quantity("max_current", &[D::Current], 0.01, 2e4, "20 A"),
    quantity("bus_current_limit", &[D::Current], 1e-3, 2e4, "10 A"),
    quantity("return_current_limit", &[D::Current], 1e-3, 2e4, "5 A"),
    quantity("hall_timer_clock", &[D::Frequency], 1e3, 1e9, "1 MHz"),
    quantity(
        "minimum_speed",
        &[D::Speed],
        0.01 * RPM,
        1e5 * RPM,
        "40 rpm",
    ),
    quantity("maximum_speed", &[D::Speed], RPM, 3e5 * RPM, "3000 rpm"),
    quantity("stall_timeout", &[D::Time], 0.0, 60.0, "500 ms"),
    integer("hall_glitches", 0, 1000, "3"),
    integer("calibration_samples", 1, 4096, "256"),
    quantity("precharge", &[D::Time], 0.0, 10.0, "1 ms"),
];

/// All fields with their sections. Options with rules in several controllers are repeated.
fn fields() -> impl Iterator<Item = (&'static str, &'static Rule)> {
    let motor = MOTOR.iter().map(|rule| ("motor", rule));
    let inverter = INVERTER.iter().map(|rule| ("inverter", rule));
    let options = controller::rules().map(|rule| ("controller", rule));
    motor.chain(inverter).chain(options)
}

/// Fields that state one quantity in two ways.
const ALTERNATIVES: [[&str; 2]; 11] = [
    ["pole_pairs", "poles"],
    ["back_emf", "speed_constant"],
    ["f_pwm", "sampling_time"],
    ["timer_clock", "timer_period"],
    ["adc_range", "adc_gain"],
    ["adc_range", "shunt"],
    ["adc_range", "amplifier_gain"],
    ["adc_range", "adc_reference"],
    ["adc_gain", "shunt"],
    ["adc_gain", "amplifier_gain"],
    ["adc_gain", "adc_reference"],
];

/// Whether the field takes a list of values in brackets: one of each sensed phase in place of one for
/// all, or of each Hall edge.
pub(crate) fn takes_each(name: &str) -> bool {
    matches!(
        name,
        "adc_gain" | "adc_offset" | "adc_inverted" | "hall_angles"
    )
}

/// Whether the one field replaces the other.
pub(crate) fn same_quantity(one: &str, other: &str) -> bool {
    one == other
        || ALTERNATIVES
            .iter()
            .any(|pair| one != other && pair.contains(&one) && pair.contains(&other))
}

/// The rule of a field, in whichever section.
fn find(name: &str) -> Option<&'static Rule> {
    fields()
        .map(|(_, rule)| rule)
        .find(|rule| rule.name == name)
}

/// Whether the field takes free text.
pub(crate) fn is_text(name: &str) -> bool {
    find(name).is_some_and(|rule| matches!(rule.kind, Kind::Text))
}

/// The quantities that the field takes; none for other kinds.
pub(crate) fn dimensions(name: &str) -> &'static [D] {
    match find(name).map(|rule| rule.kind) {
        Some(Kind::Quantity { dimensions, .. }) => dimensions,
        _ => &[],
    }
}

/// A field that takes this quantity.
#[cfg(test)]
pub(crate) fn field_of(dimension: D) -> &'static str {
    let mut takers = fields().filter(|(_, rule)| dimensions(rule.name).contains(&dimension));
    takers.next().map_or("none", |(_, rule)| rule.name)
}

/// An example of the field's value.
pub(crate) fn example(name: &str) -> &'static str {
    find(name).map_or("20 A", |rule| rule.example)
}

/// Examples of the field's value, one for each possible basis, so that no basis is suggested over
/// another. `named`: the basis words of the given value.
pub(crate) fn examples(name: &str, named: &[Basis]) -> Vec<String> {
    let example = example(name);
    let references = references(name);
    let Some((own, _)) = references
        .iter()
        .find(|(basis, _)| example.contains(basis.word()))
    else {
        return vec![example.to_owned()];
    };
    let is_named = references.iter().any(|(basis, _)| named.contains(basis));
    references
        .iter()
        .filter(|(basis, _)| !is_named || named.contains(basis))
        .map(|(basis, _)| example.replace(own.word(), basis.word()))
        .collect()
}

/// The possible bases of the field's value with their meanings; empty where there is no choice.
pub(crate) fn references(name: &str) -> &'static [(Basis, &'static str)] {
    match name {
        "resistance" | "inductance" => &[
            (Basis::PerPhase, "of one winding"),
            (Basis::LineToLine, "between two terminals"),
        ],
        "back_emf" => &[
            (Basis::Phase, "of one phase"),
            (Basis::LineToLine, "between two terminals"),
        ],
        "torque_constant" => &[
            (Basis::BlockMean, "per ampere of block commutation"),
            (Basis::PerPeakAmpere, "per ampere of the current's peak"),
            (Basis::PerRmsAmpere, "per ampere of its root mean square"),
        ],
        _ => &[],
    }
}

/// The section that has a field of this name.
pub fn section_of(name: &str) -> Option<&'static str> {
    fields()
        .find(|(_, rule)| rule.name == name)
        .map(|(section, _)| section)
}

#[cfg(test)]
mod tests {
    use super::{example, fields, same_quantity, section_of};

    #[test]
    fn a_name_belongs_to_one_section() {
        for (section, rule) in fields() {
            let sections = fields().filter(|(_, other)| other.name == rule.name);
            let mut others = sections.map(|(other, _)| other);
            assert!(others.all(|other| other == section), "{}", rule.name);
        }
    }

    #[test]
    fn lookups() {
        assert_eq!(section_of("modulation"), Some("controller"));
        assert_eq!(example("bus_voltage"), "48 V");
        assert!(same_quantity("f_pwm", "sampling_time"));
        assert!(!same_quantity("f_pwm", "timer_clock"));
    }
}
