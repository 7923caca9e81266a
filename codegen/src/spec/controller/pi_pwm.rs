//! Options of PI control, and how they are read.

use super::common::{
    self, CommonMode, DEAD_TIME_COMPENSATION, LimitRule, LoopOptions, Surroundings, Traits,
    compensates_by_default, read_common, read_common_mode, read_dead_time_compensation, refuse,
    refuse_commutation, refuse_held,
};
use super::table2::{TABLE2, ZERO, ZeroVector, read_zero, refuse_pulse_options, refuse_turned};
use super::{Options, TurnsOff};
use crate::diagnostics::Collector;
use crate::spec::option_row::{Row, if_on, number, word};
use crate::spec::reader::Reader;
use crate::spec::rule;
use crate::spec::units::Dimension as D;
use crate::spec::words::{Words as _, words};
use crate::spec::{MotorSpec, Reference, Spec};
use std::f64::consts::TAU;

words! {
    /// Modulation of the regulators' voltage.
    pub enum PiModulation {
        "three_phase" = ThreePhase: "three duties in every period",
        "table2" = Table2: "the paper's: two neighbouring vectors and a zero vector, three-phase ones in commutation, else pair vectors; a command of three intervals, for boards that turn legs on and off within a period",
    }
}

/// Options of PI control with pulse-width modulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiPwmSpec {
    /// Bandwidth of the current loop, hertz.
    pub bandwidth: f64,
    /// Integral time, second.
    pub integral_time: f64,
    /// EMF feed-forward.
    pub feed_forward: bool,
    /// Whether one PI controller holds the current of the conducting pair, instead of one per axis.
    pub six_step: bool,
    /// Modulation; of no effect with [`Self::six_step`].
    pub modulation: PiModulation,
    /// Zero vector outside commutations; of effect with [`PiModulation::Table2`] only.
    pub zero: ZeroVector,
    /// Saturation rule; of no effect with [`Self::six_step`].
    pub saturation: LimitRule,
    /// Whether compare values are compensated for the dead time.
    pub dead_time_compensation: bool,
    /// Where the pulses of three legs lie; of effect with three duties only.
    pub common_mode: CommonMode,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl PiPwmSpec {
    /// Proportional gain 2 pi f L, V/A.
    pub fn proportional_gain(&self, motor: &MotorSpec) -> f64 {
        TAU * self.bandwidth * motor.inductance
    }

    /// Whether the voltage that turns the reference is fed forward: that of a proportional one.
    pub fn turns_reference(&self) -> bool {
        self.feed_forward && self.common.reference == Reference::Proportional
    }

    /// Share of the proportional voltage that one period integrates: T_s/T_i.
    pub fn integral_share(&self, spec: &Spec) -> f64 {
        spec.inverter.t_s / self.integral_time
    }
}

impl Options for PiPwmSpec {
    const KIND: &'static str = "pi-pwm";
    const TITLE: &'static str = "PI control with pulse-width modulation";
    const SHARED: &'static [&'static [Row<LoopOptions>]] = &[common::LOOP, common::LIMITED];
    const OWN: &'static [Row<Self>] = &[
        Row::of(
            rule::quantity("bandwidth", &[D::Frequency], 1.0, 1e5, "1 kHz")
                .by_default(
                    "1/20 of the control frequency",
                    &[("", "settles in the fewest periods with the delay of a step")],
                )
                .about("Crossover of the current loop"),
            |options| Some(number(options.bandwidth)),
        ),
        Row::of(
            rule::quantity("integral_time", &[D::Time], 1e-6, 10.0, "1.6 ms")
                .by_default("L/R", &[("", "cancels the winding's time constant")])
                .about("Integral time; also that of the anti-windup"),
            |options| Some(number(options.integral_time)),
        ),
        Row::of(
            rule::choice::<bool>("feed_forward", "on")
                .by_default(
                    "`on`; with `six_step: on` `off`",
                    &[
                        ("on", "the integral need not follow the EMF"),
                        ("off", "the conventional drive has none"),
                    ],
                )
                .about("EMF feed-forward"),
            |options| Some(word(options.feed_forward)),
        ),
        Row::of(
            rule::choice::<bool>("six_step", "off")
                .preset("off")
                .about("Conventional six-step drive: one PI controller of the conducting pair's current; without `saturation` and feed-forward, with `quasi_square` only"),
            |options| Some(word(options.six_step)),
        ),
        Row::of(
            rule::choice::<PiModulation>("modulation", "three_phase")
                .preset("three_phase")
                .about("Modulation"),
            |options| if_table2(options, word(options.modulation)),
        ),
        Row::of(ZERO, |options| if_table2(options, word(options.zero))),
        Row::of(common::saturation().preset("nearest"), |options| {
            Some(word(options.saturation))
        }),
        Row::of(DEAD_TIME_COMPENSATION, |options| {
            if_on(options.dead_time_compensation)
        }),
        Row::of(common::COMMON_MODE, |options| {
            common::common_mode_line(options.common_mode)
        }),
        Row::of(common::COMMUTATION_ENDS, |options| {
            if_table2(options, number(options.common.commutation_threshold))
        }),
        Row::of(common::COMMUTATION_TIMEOUT, |options| {
            if_table2(options, number(options.common.commutation_timeout))
        }),
    ];

    /// Modulations of other controllers are known, but not available.
    fn read(reader: &Reader, surroundings: &Surroundings, errors: &mut Collector) -> Option<Self> {
        let bandwidth = reader.plain_quantity(errors, "bandwidth");
        let integral_time = reader.plain_quantity(errors, "integral_time");
        let six_step: bool = reader.choice_or_preset(errors, "six_step", &[]);
        let feed_forward = reader.switch(errors, "feed_forward").unwrap_or(!six_step);
        let modulation: PiModulation = reader.choice_or_preset(errors, "modulation", &["pair"]);
        let is_table2 = modulation == PiModulation::Table2;
        let zero = read_zero(reader, modulation.word(), errors);
        if is_table2 {
            refuse_pulse_options(reader, errors);
        } else {
            refuse_commutation(reader, ["modulation", modulation.word()], errors);
        }
        let saturation = reader.choice_or_preset(errors, "saturation", &[]);
        if saturation == LimitRule::TorquePriority && !feed_forward {
            let why =
                "it keeps the component along the EMF, which is known only with `feed_forward: on`";
            refuse(reader, "saturation", ["feed_forward", "off"], why, errors);
        }
        if six_step {
            check_six_step(reader, errors);
        }
        if !feed_forward {
            for name in [
                "emf",
                "emf_filter",
                "residual_timeout",
                "hall_learning",
                "torque_learning",
            ] {
                let why = "the EMF is used only for feed-forward";
                refuse(reader, name, ["feed_forward", "off"], why, errors);
            }
        }
        let why = "one leg of the pair is low throughout and the third is off";
        let pair = six_step.then_some((["six_step", "on"], why));
        let common_mode = read_common_mode(reader, surroundings, pair, errors);
        let traits = Traits {
            pulses_three_legs: !six_step && !is_table2,
            advance_idle: !is_table2,
            uses_emf: feed_forward,
        };
        let common = read_common(reader, surroundings, traits, errors)?;
        refuse_held(reader, &common, errors);
        if is_table2 {
            refuse_turned(reader, common.reference, TABLE2, errors);
        }
        let time_constant = surroundings.inductance? / surroundings.resistance?;
        let frequency = 1.0 / surroundings.t_s?;
        Some(Self {
            bandwidth: bandwidth.map_or(frequency / 20.0, |given| given.si),
            integral_time: integral_time.map_or(time_constant, |given| given.si),
            feed_forward: feed_forward && !six_step,
            six_step,
            modulation,
            zero,
            saturation,
            dead_time_compensation: read_dead_time_compensation(reader, surroundings, errors)
                .unwrap_or_else(|| compensates_by_default(surroundings, traits, &common)),
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

    fn turns_off(&self) -> Option<TurnsOff> {
        if self.has_intervals() {
            return Some(TurnsOff {
                option: "modulation",
                value: TABLE2,
                instead: "modulation: three_phase",
            });
        }
        self.six_step.then_some(TurnsOff {
            option: "six_step",
            value: "on",
            instead: "six_step: off",
        })
    }

    fn common_mode(&self) -> Option<CommonMode> {
        (!self.six_step && !self.has_intervals()).then_some(self.common_mode)
    }

    fn has_intervals(&self) -> bool {
        self.modulation == PiModulation::Table2
    }

    fn modulates(&self) -> bool {
        true
    }
}

/// A line of the normalised specification that only `modulation: table2` has.
fn if_table2(options: &PiPwmSpec, line: String) -> Option<String> {
    options.has_intervals().then_some(line)
}

/// Refuses options without effect on a six-step drive.
fn check_six_step(reader: &Reader, errors: &mut Collector) {
    let idle = [
        (
            "saturation",
            None,
            "a single line voltage is limited by the bus voltage alone",
        ),
        (
            common::FIELD_WEAKENING,
            Some("on"),
            "the current through two windings is quasi-square",
        ),
        (
            "modulation",
            Some(TABLE2),
            "one leg of the pair is pulsed in every period",
        ),
        (
            "feed_forward",
            Some("on"),
            "the EMF of the off leg cannot be seen, and the controller works without it",
        ),
        (
            "reference",
            Some("proportional"),
            "the current through two windings is quasi-square",
        ),
    ];
    for (name, value, why) in idle {
        let Some(field) = reader.field(name) else {
            continue;
        };
        if value.is_none_or(|value| value == field.value.to_string()) {
            refuse(reader, name, ["six_step", "on"], why, errors);
        }
    }
}
