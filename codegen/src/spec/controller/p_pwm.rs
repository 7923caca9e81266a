//! Options of proportional control, and how they are read.

use super::Options;
use super::common::{
    self, CommonMode, LimitRule, LoopOptions, Surroundings, Traits, read_common, read_common_mode,
    refuse_held,
};
use crate::diagnostics::Collector;
use crate::spec::MotorSpec;
use crate::spec::option_row::{Row, number, word};
use crate::spec::reader::Reader;
use crate::spec::rule;
use crate::spec::units::Dimension as D;
use std::f64::consts::TAU;

/// Options of proportional control with pulse-width modulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PPwmSpec {
    /// Bandwidth of the current loop, hertz.
    pub bandwidth: f64,
    /// Saturation rule.
    pub saturation: LimitRule,
    /// Where the pulses of three legs lie.
    pub common_mode: CommonMode,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl PPwmSpec {
    /// Proportional gain 2 pi f L, V/A.
    pub fn proportional_gain(&self, motor: &MotorSpec) -> f64 {
        TAU * self.bandwidth * motor.inductance
    }
}

impl Options for PPwmSpec {
    const KIND: &'static str = "p-pwm";
    const TITLE: &'static str = "proportional control with pulse-width modulation";
    const NOTES: &'static str = "The smallest controller: EMF and proportional gain. Without an integral the current stays below its reference,\n\
         by the resistive drop over the gain.";
    const SHARED: &'static [&'static [Row<LoopOptions>]] = &[common::LOOP, common::LIMITED];
    const OWN: &'static [Row<Self>] = &[
        Row::of(
            rule::quantity("bandwidth", &[D::Frequency], 1.0, 1e5, "1 kHz")
                .preset("1 kHz")
                .about("Crossover of the current loop"),
            |options| Some(number(options.bandwidth)),
        ),
        Row::of(common::saturation().preset("nearest"), |options| {
            Some(word(options.saturation))
        }),
        Row::of(common::COMMON_MODE, |options| {
            common::common_mode_line(options.common_mode)
        }),
    ];

    fn read(reader: &Reader, surroundings: &Surroundings, errors: &mut Collector) -> Option<Self> {
        let bandwidth = reader.plain_quantity_or_preset(errors, "bandwidth");
        let saturation = reader.choice_or_preset(errors, "saturation", &[]);
        let common_mode = read_common_mode(reader, surroundings, None, errors);
        let traits = Traits {
            pulses_three_legs: true,
            advance_idle: true,
            uses_emf: true,
        };
        let common = read_common(reader, surroundings, traits, errors)?;
        refuse_held(reader, &common, errors);
        Some(Self {
            bandwidth,
            saturation,
            common_mode,
            common,
        })
    }

    fn common(&self) -> &LoopOptions {
        &self.common
    }

    fn common_mut(&mut self) -> &mut LoopOptions {
        &mut self.common
    }

    fn common_mode(&self) -> Option<CommonMode> {
        Some(self.common_mode)
    }

    fn modulates(&self) -> bool {
        true
    }
}
