//! The fields of motor and inverter, each with its quantity, least and greatest value; those of the
//! controller are its options ([`controller`]).
//!
//! The limits catch wrong units and decimal points; they are wider than any motor that this crate
//! is made for. The reference table for users is the documentation of [`crate::spec`].

use super::ast::Field;
use super::controller;
use super::field_rule::FieldRule;
use super::rule::{Kind, Rule, integer, plain, quantity, text, word};
use super::units::Dimension as D;
use crate::diagnostics::{Collector, catalogue};

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
        "58 rpm/V block_mean",
    ),
    word("emf_shape", "trapezoidal"),
    quantity("flat_top", &[D::Angle], 1.0, 179.0, "120 deg"),
    Rule::of("emf_orders", Kind::Integers, "[5, 7]"),
    quantity("emf_amplitudes", &[D::Ratio], -1.0, 1.0, "[4 %, -2 %]"),
    quantity("emf_phases", &[D::Angle], -360.0, 360.0, "[0 deg, 10 deg]"),
    plain("emf_samples", -1e5, 1e5, "[0.0, 1.3, 2.4, …]"),
    quantity("emf_samples_speed", &[D::Speed], RPM, 3e5 * RPM, "1000 rpm"),
    quantity("rated_current", &[D::Current], 0.01, 1e4, "20 A peak"),
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
    word("rotor", "angle"),
    integer("angle_pole_pairs", 1, 64, "7"),
    quantity("angle_offset", &[D::Angle], -360.0, 360.0, "12 deg"),
    word("angle_direction", "backward"),
    integer("angle_bits", 8, 32, "14"),
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
    quantity("bus_clamp", &[D::Voltage], 1.0, 4000.0, "56 V"),
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
        &[D::CurrentPerCount, D::Sensitivity],
        1e-7,
        100.0,
        "19.5 mA/count",
    ),
    integer("adc_offset", 0, 65535, "2048"),
    word("adc_inverted", "off"),
    quantity("shunt", &[D::Resistance], 1e-6, 100.0, "1 mohm"),
    plain("amplifier_gain", 1e-2, 1e4, "20"),
    quantity("adc_reference", &[D::Voltage], 0.1, 20.0, "3.3 V"),
    quantity("amplifier_swing", &[D::Voltage], 0.01, 20.0, "1.35 V"),
    word("current_sensing", "low_side"),
    word("sensed_phases", "ab"),
    quantity("settling_time", &[D::Time], 0.0, 1e-4, "1 us"),
    quantity("aperture_time", &[D::Time], 0.0, 1e-4, "200 ns"),
    quantity("conversion_time", &[D::Time], 0.0, 1e-4, "400 ns"),
    integer("current_adcs", 1, 3, "2"),
    quantity("sampling_lead", &[D::Time], -1e-4, 1e-4, "500 ns"),
    quantity("current_sum_tolerance", &[D::Current], 1e-4, 2e4, "2 A"),
    integer("current_sum_samples", 0, 10_000, "20"),
    quantity("minimum_low_time", &[D::Time], 0.0, 1e-3, "2 us"),
    word("leg_enables", "per_period"),
    integer("pwm_per_control", 1, 16, "3"),
    quantity("offset_tolerance", &[D::Current], 1e-5, 2e4, "2 A"),
    quantity("trip_current", &[D::Current], 0.01, 2e4, "38 A"),
    quantity("max_current", &[D::Current], 0.01, 2e4, "20 A"),
    quantity("bus_current_limit", &[D::Current], 0.0, 2e4, "10 A"),
    quantity("return_current_limit", &[D::Current], 0.0, 2e4, "5 A"),
    quantity("hall_timer_clock", &[D::Frequency], 1e3, 1e9, "1 MHz"),
    quantity(
        "minimum_speed",
        &[D::Speed],
        0.01 * RPM,
        1e5 * RPM,
        "40 rpm",
    ),
    quantity("maximum_speed", &[D::Speed], RPM, 3e5 * RPM, "3000 rpm"),
    quantity("over_speed", &[D::Speed], RPM, 3e5 * RPM, "2600 rpm"),
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

/// A name with the rule of its field, in whichever section.
pub(crate) fn field(name: &str) -> FieldRule<'_> {
    let mut rules = fields().map(|(_, rule)| rule);
    FieldRule {
        name,
        rule: rules.find(|rule| rule.name == name),
    }
}

/// A field that takes this quantity.
#[cfg(test)]
pub(crate) fn field_of(dimension: D) -> &'static str {
    let mut takers =
        fields().filter(|(_, rule)| field(rule.name).dimensions().contains(&dimension));
    takers.next().map_or("none", |(_, rule)| rule.name)
}

/// The section that has a field of this name.
pub fn section_of(name: &str) -> Option<&'static str> {
    fields()
        .find(|(_, rule)| rule.name == name)
        .map(|(section, _)| section)
}

/// The section that has most of some names, if one has any.
pub(crate) fn section_of_most(names: &[&str]) -> Option<&'static str> {
    let count = |section: &&str| {
        let of_names = names.iter().filter_map(|name| section_of(name));
        of_names.filter(|of| of == section).count()
    };
    let sections = ["motor", "inverter", "controller"].into_iter();
    let most = sections.max_by_key(count)?;
    (count(&most) > 0).then_some(most)
}

/// Reports a field of another section than `section`; returns whether it did.
pub(crate) fn misplaced(section: &str, field: &Field, errors: &mut Collector) -> bool {
    let right = section_of(&field.name);
    if let Some(right) = right {
        let (at, name) = (&field.name_location, &field.name);
        errors.push(catalogue::misplaced_field(at, section, name, right));
    }
    right.is_some()
}

#[cfg(test)]
mod tests {
    use super::{FieldRule, field, fields, section_of};

    #[test]
    fn a_name_belongs_to_one_section() {
        for (section, rule) in fields() {
            let sections = fields().filter(|(_, other)| other.name == rule.name);
            let mut others = sections.map(|(other, _)| other);
            assert!(others.all(|other| other == section), "{}", rule.name);
        }
    }

    /// Messages about a controller's option are the same by its own rule and by the name alone.
    #[test]
    fn rules_of_a_name_have_one_example_and_kind() {
        for (_, rule) in fields() {
            let first = field(rule.name);
            assert_eq!(first.example(), rule.example, "{}", rule.name);
            let quantities = FieldRule {
                name: rule.name,
                rule: Some(rule),
            };
            assert_eq!(first.dimensions(), quantities.dimensions(), "{}", rule.name);
            assert_eq!(first.is_text(), quantities.is_text(), "{}", rule.name);
        }
    }

    #[test]
    fn lookups() {
        assert_eq!(section_of("modulation"), Some("controller"));
        assert_eq!(field("bus_voltage").example(), "48 V");
    }
}
