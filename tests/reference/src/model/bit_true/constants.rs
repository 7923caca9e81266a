//! Coefficients and constants, rounded from the specification (section "Words").

use super::hall_learning::Offset;
use super::parts::{Part, Parts};
use super::rise::Rise;
use super::scale::Scale;
use super::sectors::Sectors;
use super::tables::Table;
use crate::emf_motion::EmfMotion;
use crate::exact::{Coefficient, Shift, Word, floor_constant, pow2, round_half_up};
use crate::model::hall::HallClock;
use crate::model::variant::{Variant, emf_error_limit, emf_limit, reference_gain, stretch_mean};
use crate::{Controller, DiscretePhase, EmfShape, EmfSource, Error, Saturation, Spec, Switch};

/// All constants of a step besides state and set-point. Coefficients that the variant does not use
/// are zero.
#[derive(Clone, Debug)]
pub struct Constants<W> {
    pub parts: Parts,
    /// Ampere per current word.
    pub ampere: f64,
    /// Volt per voltage word.
    pub volt: f64,
    /// Current words per ADC count, 2^f_i.
    pub count: f64,
    /// 2^f_i / 2^CAL_LOG2.
    pub calibration: f64,
    /// 2^-f_v.
    pub to_counts: f64,
    /// 2^(f_v - 1).
    pub half_count: f64,
    /// HALF.
    pub half: f64,
    pub timer_period: f64,
    /// Voltage word of the nominal bus.
    pub v_bus_nominal: f64,
    pub i_trip: f64,
    pub i_comm: f64,
    pub di_limit: f64,
    pub i_max_bits: f64,
    pub t_max_bits: f64,
    pub comm_samples: f64,
    pub e_max: f64,
    /// V_LARGEST.
    pub v_largest: f64,
    /// LINE_MAX.
    pub line_max: f64,
    /// E_ERROR_MAX.
    pub emf_error_limit: f64,
    pub sectors: Sectors,
    /// Shift of the sums of products that correct the EMF error.
    pub observer: Shift,
    /// 2^q, where q is not below 0.
    pub line_scale: f64,
    /// -q, where q is.
    pub line_shift: u32,
    /// Products of two line EMFs, or of a turn and one, of which the upper word is used.
    pub line_product: Shift,
    pub emf_turns: bool,
    pub filtered: bool,
    pub advanced: bool,
    pub k_di: Coefficient<W>,
    pub k_r: Coefficient<W>,
    pub k_filter: Coefficient<W>,
    pub k_slope: Coefficient<W>,
    pub k_third: Coefficient<W>,
    pub k_set: Coefficient<W>,
    pub k_torque: Coefficient<W>,
    pub k_advance: Coefficient<W>,
    /// Ticks per period, if not an integer.
    pub k_ticks: Option<Coefficient<W>>,
    /// Where the intervals tell how the speed rises.
    pub rise: Option<Rise<W>>,
    /// Where the places of the Hall sensors are learnt.
    pub offset: Option<Offset<W>>,
    pub ratio_bits: u32,
    pub scale_dropped: u32,
    pub emf_product: Shift,
    pub bus: Option<BusWords<W>>,
    pub flux: Table<W>,
    /// 2^(f_v - flux).
    pub flux_to_voltage: f64,
    pub shape: Table<W>,
    pub shape_product: Shift,
    /// How much longer the EMF is than along the shape, where that counts.
    pub stretch: Option<(Table<W>, Shift)>,
}

/// Words of the bus voltage's measurement.
#[derive(Clone, Copy, Debug)]
pub struct BusWords<W> {
    pub k_bus: Coefficient<W>,
    pub count_max: f64,
    pub v_min: f64,
    pub v_max: f64,
}

impl<W: Word> Constants<W> {
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Self, Error> {
        let (motor, inverter) = (&spec.motor, &spec.inverter);
        let Scale {
            formats,
            variant,
            phase: phase @ DiscretePhase { b, .. },
            resistance,
            g,
            w,
            two_i,
            two_v,
            ohm,
            ..
        } = *scale;
        let timer_period = f64::from(inverter.timer_period);
        let Variant {
            options,
            rotor,
            commutation,
            floating,
            saturation,
            ..
        } = variant;
        let end = commutation.unwrap_or_default();
        let (estimated, filtered) = (variant.estimated(), variant.filtered());
        let advanced = rotor && options.advance > 0.0;
        let clock = HallClock::new(spec);
        let by_edges = rotor && inverter.angle_turns.is_none();
        let gain = reference_gain(spec);
        let bus = match inverter.bus_sense()? {
            None => None,
            Some(sense) => Some(BusWords {
                k_bus: scale.coefficient("k_bus", sense.gain / w * two_v)?,
                count_max: f64::from((1u32 << sense.adc_bits) - 1),
                v_min: round_half_up(sense.min / w * two_v),
                v_max: round_half_up(sense.max / w * two_v),
            }),
        };
        let i_max_bits = floor_constant(inverter.max_current * 65_536.0);
        let t_max_bits = floor_constant(inverter.max_current * motor.torque_constant * 65_536.0);

        let emf_shape = EmfShape::new(motor)?;
        let linkage = motor.emf_constant / (f64::from(motor.pole_pairs) * inverter.t_s) / w;
        let (flux, flux_to_voltage) =
            if matches!(variant.emf, Some(EmfSource::Model | EmfSource::Observer)) {
                let bits = formats.frac_bits("flux")?;
                if pow2(bits as i32) < two_v {
                    return Err(Error::Format {
                        name: "flux",
                        frac_bits: bits as i32,
                        expected: "expected at least the voltage's",
                    });
                }
                let segments = formats.segments("flux")?;
                let table = Table::new(segments, bits, |theta| {
                    linkage * emf_shape.zero_sum_integral(theta)
                });
                (table, two_v * pow2(-(bits as i32)))
            } else {
                (Table::default(), 0.0)
            };
        let torque_ratio = motor.torque_constant / motor.emf_constant;
        let (shape, shape_product) = if variant.shaped() {
            let bits = formats.frac_bits("shape")?;
            let table = Table::new(formats.segments("shape")?, bits, |theta| {
                2.0 / 3.0 * torque_ratio * emf_shape.zero_sum(theta)
                    / emf_shape.alpha_beta(theta).norm_squared()
            });
            (table, Shift::new(bits))
        } else {
            (Table::default(), Shift::default())
        };
        let observes = variant.emf == Some(EmfSource::Observer);
        let stretch = match stretch_mean(spec, emf_shape).filter(|_| observes) {
            Some(mean) => {
                let bits = formats.frac_bits("stretch")?;
                let stretch = |theta| emf_shape.stretch(mean, theta);
                let table = Table::new(formats.segments("stretch")?, bits, stretch);
                Some((table, Shift::new(bits)))
            }
            None => None,
        };
        let v_largest = bus.map_or(timer_period * two_v, |bus| bus.v_max);
        let motion = EmfMotion::new(spec)?;
        let line_max = floor_constant(motion.line_limit / w * two_v).min(v_largest);
        let word = options.word as i32;
        let q = (-31..=31)
            .rev()
            .find(|&q| line_max * pow2(q) < pow2(word - 1))
            .unwrap_or(0);
        let factors = if motion.turns { 1 } else { 2 };
        let slope = motion.per_product * w / two_v * pow2(word - factors * q);
        let limits_bus =
            inverter.bus_current_limit.is_some() || inverter.return_current_limit.is_some();
        let fades = inverter.braking_fade.is_some() || inverter.motoring_fade.is_some();
        Ok(Self {
            parts: Parts::new(&[
                (Part::Edges, by_edges || commutation.is_some() || fades),
                (
                    Part::Direction,
                    by_edges || (!rotor && (commutation.is_some() || fades)),
                ),
                (Part::Rotor, by_edges),
                (Part::Angle, rotor && !by_edges),
                (Part::Rise, by_edges && clock.tells_rise),
                (Part::HallLearning, options.hall_learning == Switch::On),
                (
                    Part::OverSpeed,
                    inverter.over_speed_turn.is_some() || inverter.over_speed_step.is_some(),
                ),
                (Part::Speed, variant.options.has_speed_loop()),
                (Part::Ramp, variant.options.acceleration_limit > 0.0),
                (Part::Slew, variant.options.slew_rate > 0.0),
                (Part::BusCurrent, limits_bus),
                (Part::LineCommand, limits_bus && variant.delayed()),
                (Part::Commutation, commutation.is_some()),
                (Part::SectorInForce, commutation.is_some() && advanced),
                (Part::Sight, variant.sees()),
                (
                    Part::VoltageCommand,
                    variant.applied_now && !floating && !variant.observes(),
                ),
                (Part::TerminalCommand, variant.applied_now && floating),
                (Part::OffMemory, variant.unseen()),
                (Part::VoltageMemory, variant.estimated()),
                (Part::EmfMemory, filtered),
                (
                    Part::EmfNext,
                    variant.observes() && variant.delayed() && floating,
                ),
                (Part::NetMemory, variant.observes()),
                (
                    Part::NetNext,
                    variant.observes() && variant.delayed() && !floating,
                ),
                (Part::EmfError, variant.observes()),
                (Part::Weakening, spec.weakening_share().is_some()),
                (Part::Residual, variant.options.residual_periods > 0),
                (Part::TorqueLearning, options.torque_learning == Switch::On),
                (Part::Integral, variant.six_step == Some(Switch::Off)),
                (Part::PairIntegral, variant.six_step == Some(Switch::On)),
                (
                    Part::ReferenceNext,
                    variant.turns_reference() && variant.delayed(),
                ),
                (Part::ReferenceDue, variant.turns_reference()),
                (
                    Part::Hysteresis,
                    matches!(spec.controller, Controller::Phcc(_)) && !variant.folds_wishes(),
                ),
                (Part::VectorMemory, variant.counts_changes == Switch::On),
                (Part::Due, variant.holds()),
                (Part::Later, variant.holds() && variant.delayed()),
            ]),
            ampere: g / two_i,
            volt: w / two_v,
            count: two_i,
            calibration: two_i * pow2(-(inverter.calibration_log2 as i32)),
            to_counts: 1.0 / two_v,
            half_count: two_v / 2.0,
            half: timer_period * two_v / 2.0,
            timer_period,
            v_bus_nominal: timer_period * two_v,
            i_trip: round_half_up(inverter.trip_current / g * two_i),
            i_comm: round_half_up(end.threshold / g * two_i),
            di_limit: phase.di_limit(inverter)? * two_i,
            i_max_bits,
            t_max_bits,
            comm_samples: f64::from(end.timeout) + 1.0,
            e_max: emf_limit(spec) * two_v,
            v_largest,
            line_max,
            emf_error_limit: emf_error_limit(spec)? * two_v,
            sectors: Sectors::new(motor.hall_angles),
            observer: Shift::new(shape_product.bits() + 4),
            line_scale: pow2(q.max(0)),
            line_shift: (-q).max(0) as u32,
            line_product: Shift::new(options.word),
            emf_turns: motion.turns,
            filtered,
            advanced,
            k_di: scale.only_if(variant.sees(), "k_di", ohm / b)?,
            k_r: scale.only_if(variant.sees(), "k_r", ohm * resistance)?,
            k_filter: scale.only_if(filtered, "k_filter", options.emf_filter)?,
            k_slope: scale.only_if(estimated, "k_slope", slope)?,
            k_third: scale.only_if(
                (floating && variant.applied())
                    || variant.modulated == Switch::On
                    || variant.has_intervals()
                    || saturation.is_some()
                    || spec.spares_highest()?,
                "k_third",
                1.0 / 3.0,
            )?,
            k_set: scale.coefficient("k_set", two_v * gain / w / 65_536.0)?,
            k_torque: scale.coefficient(
                "k_torque",
                two_v * gain / w / motor.torque_constant / 65_536.0,
            )?,
            k_advance: scale.only_if(advanced, "k_advance", options.advance)?,
            k_ticks: if by_edges && inverter.ticks.fract() != 0.0 {
                Some(scale.coefficient("k_ticks", inverter.ticks)?)
            } else {
                None
            },
            offset: (options.hall_learning == Switch::On)
                .then(|| Offset::new(spec, scale))
                .transpose()?,
            rise: if by_edges && clock.tells_rise {
                Some(Rise::new(scale, &clock)?)
            } else {
                None
            },
            // Only pulses narrower than the period depend on the measured bus.
            ratio_bits: scale.bits_if(bus.is_some() && variant.pulsed(), "ratio")?,
            scale_dropped: if saturation == Some(Saturation::KeepAngle) {
                // Below 0 with more than 65535 timer counts.
                let bits = scale.signed_bits("scale_volts")?;
                (scale.signed_bits("voltage")? - bits).max(0) as u32
            } else {
                0
            },
            emf_product: scale.product_if(
                saturation == Some(Saturation::TorquePriority),
                "emf_product",
            )?,
            bus,
            flux,
            flux_to_voltage,
            shape,
            shape_product,
            stretch,
        })
    }
}
