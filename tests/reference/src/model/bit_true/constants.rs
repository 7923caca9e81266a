//! Coefficients and constants, rounded from the specification (section "Words").

use super::state::{Part, Parts};
use super::tables::Table;
use crate::exact::{Coefficient, Shift, floor_constant, pow2, round_half_up};
use crate::model::hall::needs_rotor;
use crate::{
    DiscretePhase, EmfShape, EmfSource, Error, FormatTable, Modulation, Reference, Saturation, Spec,
};

/// Largest magnitude of a coefficient's word.
const WORD_MAX: f64 = 2_147_483_647.0;

/// Everything that a step needs besides state and set-point. Coefficients that the variant does
/// not use are zero.
#[derive(Clone, Debug)]
pub struct Constants {
    pub parts: Parts,
    /// Ampere per current word.
    pub ampere: f64,
    /// Volt per voltage word.
    pub volt: f64,
    /// Current words per ADC count, 2^f_i.
    pub count: f64,
    /// Sign of the ADC gain.
    pub polarity: f64,
    /// Initial offset word.
    pub offset: f64,
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
    pub di_max: f64,
    pub i_max_bits: f64,
    pub t_max_bits: f64,
    pub comm_timeout: f64,
    pub e_max: f64,
    pub filtered: bool,
    pub advanced: bool,
    pub k_di: Coefficient,
    pub k_r: Coefficient,
    pub k_hold: Coefficient,
    pub k_decay: Coefficient,
    pub k_filter: Coefficient,
    pub k_third: Coefficient,
    pub k_set: Coefficient,
    pub k_torque: Coefficient,
    pub k_advance: Coefficient,
    pub ratio_bits: u32,
    pub scale_bits: u32,
    pub emf_product: Shift,
    pub bus: Option<BusWords>,
    pub flux: Table,
    /// 2^(f_v - flux).
    pub flux_to_voltage: f64,
    pub shape: Table,
    pub shape_product: Shift,
}

/// Words of the bus voltage's measurement.
#[derive(Clone, Copy, Debug)]
pub struct BusWords {
    pub k_bus: Coefficient,
    pub count_max: f64,
    pub v_min: f64,
    pub v_max: f64,
}

impl Constants {
    pub fn new(spec: &Spec, formats: &FormatTable) -> Result<Self, Error> {
        let (motor, inverter, pdcc) = (&spec.motor, &spec.inverter, spec.pdcc());
        let f_i = formats.frac_bits("current")?;
        let f_v = formats.frac_bits("voltage")?;
        if f_v == 0 {
            return Err(Error::Format {
                name: "voltage",
                frac_bits: 0,
                expected: "expected 1 or more",
            });
        }
        let (two_i, two_v) = (pow2(f_i as i32), pow2(f_v as i32));
        let timer_period = f64::from(inverter.timer_period);
        let g = inverter.adc_gain.abs();
        let w = inverter.v_bus / timer_period;
        let DiscretePhase { a, b } = DiscretePhase::new(spec);
        // Voltage words per current word, times ohm.
        let ohm = g / w * pow2(f_v as i32 - f_i as i32);

        let word = |name, value: f64| {
            let raw = round_half_up(value * pow2(formats.frac_bits(name)? as i32));
            if raw.abs() <= WORD_MAX {
                Ok(raw)
            } else {
                Err(Error::Range { name, raw })
            }
        };
        let coefficient = |name, value| {
            Ok(Coefficient::new(
                word(name, value)?,
                formats.frac_bits(name)?,
            ))
        };
        let only_if = |used: bool, name, value| {
            if used {
                coefficient(name, value)
            } else {
                Ok(Coefficient::default())
            }
        };

        let rotor = needs_rotor(pdcc);
        let pair = pdcc.modulation == Modulation::Pair;
        let estimated = pdcc.emf == EmfSource::Estimated;
        let delayed = pdcc.delay == 1;
        let filtered = estimated && pdcc.emf_filter < 1.0;
        let advanced = rotor && pdcc.advance > 0.0;
        let adc_max = f64::from((1u32 << inverter.adc_bits) - 1);
        let bus = match inverter.bus_sense()? {
            None => None,
            Some(sense) => Some(BusWords {
                k_bus: coefficient("k_bus", sense.gain / w * two_v)?,
                count_max: f64::from((1u32 << sense.adc_bits) - 1),
                v_min: round_half_up(sense.min / w * two_v),
                v_max: round_half_up(sense.max / w * two_v),
            }),
        };
        let i_max_bits = floor_constant(inverter.max_current * 65_536.0);
        let t_max_bits = floor_constant(inverter.max_current * motor.torque_constant * 65_536.0);

        let emf_shape = EmfShape::new(motor)?;
        let linkage = motor.emf_constant / (f64::from(motor.pole_pairs) * inverter.t_s) / w;
        let (flux, flux_to_voltage) = if estimated {
            (Table::default(), 0.0)
        } else {
            let bits = formats.frac_bits("flux")?;
            if bits < f_v {
                return Err(Error::Format {
                    name: "flux",
                    frac_bits: bits as i32,
                    expected: "expected at least the voltage's",
                });
            }
            let segments = formats.segments("flux_segments")?;
            let table = Table::new(segments, bits, |theta| {
                linkage * emf_shape.zero_sum_integral(theta)
            });
            (table, pow2(f_v as i32 - bits as i32))
        };
        let torque_ratio = motor.torque_constant / motor.emf_constant;
        let (shape, shape_product) = if pdcc.reference == Reference::Proportional {
            let bits = formats.frac_bits("shape")?;
            let table = Table::new(formats.segments("shape_segments")?, bits, |theta| {
                2.0 / 3.0 * torque_ratio * emf_shape.zero_sum(theta)
                    / emf_shape.alpha_beta(theta).norm_squared()
            });
            (table, Shift::new(bits))
        } else {
            (Table::default(), Shift::default())
        };
        let bits_if = |used: bool, name| if used { formats.frac_bits(name) } else { Ok(0) };

        Ok(Self {
            parts: Parts::new(&[
                (Part::Stall, inverter.stall_periods > 0),
                (Part::Direction, rotor || pair),
                (Part::Rotor, rotor),
                (Part::Pair, pair),
                (Part::Estimated, estimated),
                (Part::VoltageCommand, delayed && !pair),
                (Part::TerminalCommand, delayed && pair),
                (
                    Part::EmfMemory,
                    filtered || (pair && (delayed || estimated)),
                ),
            ]),
            ampere: inverter.adc_gain.abs() / two_i,
            volt: w / two_v,
            count: two_i,
            polarity: inverter.adc_gain.signum(),
            offset: f64::from(inverter.adc_offset) * two_i,
            calibration: two_i * pow2(-(inverter.calibration_log2 as i32)),
            to_counts: 1.0 / two_v,
            half_count: two_v / 2.0,
            half: timer_period * two_v / 2.0,
            timer_period,
            v_bus_nominal: timer_period * two_v,
            i_trip: round_half_up(inverter.trip_current / g * two_i),
            i_comm: round_half_up(pdcc.commutation_threshold / g * two_i),
            di_max: floor_constant(
                (2.0 * adc_max).min(2.0 * b * 4.0 / 3.0 * inverter.v_bus_max()? / g) * two_i,
            ),
            i_max_bits,
            t_max_bits,
            comm_timeout: f64::from(pdcc.commutation_timeout),
            e_max: round_half_up(1.5 * motor.emf_constant * inverter.omega_max / w * two_v),
            filtered,
            advanced,
            k_di: only_if(estimated, "k_di", ohm / b)?,
            k_r: only_if(estimated, "k_r", ohm * motor.resistance)?,
            k_hold: coefficient(
                "k_hold",
                if delayed {
                    ohm * a * a / b
                } else {
                    ohm * a / b
                },
            )?,
            k_decay: only_if(delayed, "k_decay", b * motor.resistance)?,
            k_filter: only_if(filtered, "k_filter", pdcc.emf_filter)?,
            k_third: only_if(
                pair || pdcc.saturation != Saturation::KeepAngle,
                "k_third",
                1.0 / 3.0,
            )?,
            k_set: coefficient("k_set", two_v / (b * w) / 65_536.0)?,
            k_torque: coefficient(
                "k_torque",
                two_v / (b * w) / motor.torque_constant / 65_536.0,
            )?,
            k_advance: only_if(advanced, "k_advance", pdcc.advance)?,
            ratio_bits: bits_if(bus.is_some(), "ratio")?,
            scale_bits: bits_if(pdcc.saturation == Saturation::KeepAngle, "scale")?,
            emf_product: Shift::new(bits_if(
                pdcc.saturation == Saturation::TorquePriority,
                "emf_product",
            )?),
            bus,
            flux,
            flux_to_voltage,
            shape,
            shape_product,
        })
    }
}
