//! Options of PI control, and how they are read.

use super::common::{
    LimitRule, LoopOptions, Surroundings, read_common, read_dead_time_compensation,
    read_saturation, refuse, refuse_held,
};
use crate::diagnostics::Collector;
use crate::diagnostics::catalogue;
use crate::spec::check::reader::Reader;
use crate::spec::{MotorSpec, Spec};
use std::f64::consts::TAU;

/// Bandwidth where none is stated, hertz.
const BANDWIDTH: f64 = 1000.0;

/// Options of PI control with pulse-width modulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiPwmSpec {
    /// Bandwidth of the current loop, hertz.
    pub bandwidth: f64,
    /// Integral time, second.
    pub integral_time: f64,
    /// Whether the EMF is added to the voltage.
    pub feed_forward: bool,
    /// Whether one regulator holds the current of the conducting pair, instead of one per axis.
    pub six_step: bool,
    /// Saturation rule; of no effect with [`Self::six_step`].
    pub saturation: LimitRule,
    /// Whether compare values are shifted against the dead time.
    pub dead_time_compensation: bool,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl PiPwmSpec {
    /// Proportional gain 2 pi f L, V/A.
    pub fn proportional_gain(&self, motor: &MotorSpec) -> f64 {
        TAU * self.bandwidth * motor.inductance
    }

    /// Share of the proportional voltage that one period integrates: T_s/T_i.
    pub fn integral_share(&self, spec: &Spec) -> f64 {
        spec.inverter.t_s / self.integral_time
    }
}

/// Reads and checks the options. None only together with an error.
pub(crate) fn check_options(
    reader: &Reader,
    surroundings: &Surroundings,
    errors: &mut Collector,
) -> Option<PiPwmSpec> {
    let bandwidth = reader.plain_quantity(errors, "bandwidth");
    let integral_time = reader.plain_quantity(errors, "integral_time");
    let six_step = reader.switch(errors, "six_step").unwrap_or(false);
    let feed_forward = reader.switch(errors, "feed_forward").unwrap_or(!six_step);
    let modulation = reader.word(
        errors,
        "modulation",
        &[("three_phase", true), ("pair", false), ("table2", false)],
    );
    if modulation == Some(false)
        && let Some(field) = reader.field("modulation")
    {
        let given = field.value.to_string();
        errors.push(catalogue::option_unavailable(
            &field.location,
            "modulation",
            &given,
            &["three_phase"],
        ));
    }
    let saturation = read_saturation(reader, errors).unwrap_or(LimitRule::Nearest);
    if saturation == LimitRule::TorquePriority && !feed_forward {
        let why =
            "it keeps the component along the EMF, which is known with `feed_forward: on` only";
        refuse(reader, "saturation", ["feed_forward", "off"], why, errors);
    }
    if six_step {
        check_six_step(reader, errors);
    }
    if !feed_forward {
        for name in ["emf", "emf_filter"] {
            let Some(field) = reader.field(name) else {
                continue;
            };
            errors.push(catalogue::option_without_effect(
                &field.location,
                name,
                &field.value.to_string(),
                reader
                    .field("feed_forward")
                    .map_or(reader.location(), |field| &field.location),
                "feed_forward: off",
                "the regulator needs no EMF then",
            ));
        }
    }
    let common = read_common(reader, surroundings, true, errors)?;
    refuse_held(reader, &common, errors);
    let time_constant = surroundings.inductance? / surroundings.resistance?;
    Some(PiPwmSpec {
        bandwidth: bandwidth.map_or(BANDWIDTH, |given| given.si),
        integral_time: integral_time.map_or(time_constant, |given| given.si),
        feed_forward: feed_forward && !six_step,
        six_step,
        saturation,
        dead_time_compensation: read_dead_time_compensation(reader, surroundings, errors),
        common,
    })
}

/// What a six-step drive has no use for.
fn check_six_step(reader: &Reader, errors: &mut Collector) {
    let idle = [
        (
            "saturation",
            None,
            "one line voltage has a size only, which the bus limits",
        ),
        (
            "feed_forward",
            Some("on"),
            "the leg that is off hides its EMF, and the regulator does without",
        ),
        (
            "reference",
            Some("proportional"),
            "one current through two windings is quasi-square",
        ),
    ];
    for (name, value, why) in idle {
        let Some(field) = reader.field(name) else {
            continue;
        };
        let given = field.value.to_string();
        if value.is_none_or(|value| value == given) {
            errors.push(catalogue::option_without_effect(
                &field.location,
                name,
                &given,
                reader
                    .field("six_step")
                    .map_or(reader.location(), |field| &field.location),
                "six_step: on",
                why,
            ));
        }
    }
}
