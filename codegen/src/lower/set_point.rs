//! The functions outside the step that set its words (semantics, "Set-point words").

use super::number::round_half_up;
use super::speed::speed_word;
use super::{Bus, Coefficient, Lowering, Scale, product_bound, round_down};
use crate::diagnostics::{engineering, significant};
use crate::interface::Rounding;
use crate::ir::{Function, FunctionBuilder, Interval, ParamId, Program, Value};
use crate::spec::{BusSource, ControllerSpec, Spec};
use std::f64::consts::TAU;

/// Fraction bits of the ratio of nominal to measured bus.
const RATIO_BITS: u32 = 28;

/// Set-point words of a program.
#[derive(Clone, Copy, Debug)]
pub struct SetPointWords {
    /// The current set-point times its gain, words of voltage.
    pub j: ParamId,
    bus: Option<BusWords>,
    /// The set-point's gain, V/A.
    pub stiffness: f64,
    /// With a speed loop.
    pub speed: Option<SpeedWords>,
}

/// Words of a speed loop.
#[derive(Clone, Copy, Debug)]
pub struct SpeedWords {
    /// The speed that is wanted, in words of `omega`.
    pub reference: ParamId,
    /// The greatest set-point, `mul(k_set, I_MAX_BITS)`.
    pub top: i64,
}

/// Symbol and formula of the gain that makes a voltage of a current set-point.
fn gain(spec: &Spec) -> (&'static str, &'static str) {
    match spec.controller {
        ControllerSpec::PiPwm(_) => ("k_p", "k_p = 2 pi f L"),
        _ => ("K", "K = 1/b"),
    }
}

/// Words of a measured bus.
#[derive(Clone, Copy, Debug)]
struct BusWords {
    volts: ParamId,
    /// For a modulator, whose duties are shares of the bus.
    ratio: Option<ParamId>,
}

impl SetPointWords {
    /// Declares the words; `stiffness` is the set-point's gain in V/A.
    pub fn new(program: &mut Program, spec: &Spec, scale: Scale, stiffness: f64) -> Self {
        let most = (spec.inverter.max_current * stiffness * scale.voltage()).ceil() as i64 + 1;
        let has_speed = spec.controller.common().speed.is_some();
        let doc = format!(
            "{} as the voltage {} i_ref, words of voltage.",
            if has_speed {
                "Greatest set-point of the speed regulator"
            } else {
                "Set-point"
            },
            gain(spec).0
        );
        let top = set_point_top(spec, scale, stiffness);
        let initial = if has_speed { top as i32 } else { 0 };
        let j = program.param("j", initial, Interval::symmetric(most), &doc);
        let bus = match spec.inverter.bus {
            BusSource::Fixed => None,
            BusSource::Measured { min, max, .. } => {
                let nominal = i64::from(spec.inverter.timer_period) << scale.voltage_bits;
                let word = |volts: f64| round_half_up(volts * scale.voltage()) as i64;
                let (low, high) = (word(min), word(max));
                let volts = program.param(
                    "v_bus",
                    nominal as i32,
                    Interval::new(low, high),
                    "Bus voltage, words of voltage.",
                );
                let ratio = spec.controller.modulates().then(|| {
                    let ratio = |volts: i64| {
                        ((i128::from(nominal) << RATIO_BITS) / i128::from(volts.max(1))) as i64
                    };
                    program.param(
                        "ratio",
                        1 << RATIO_BITS,
                        Interval::new(ratio(high), ratio(low)),
                        "Nominal over measured bus voltage.",
                    )
                });
                Some(BusWords { volts, ratio })
            }
        };
        let speed = has_speed.then(|| {
            let most = (spec.inverter.maximum_speed / speed_word(spec)).ceil() as i64 + 1;
            let doc = "Speed that is wanted, electrical angle per tick, 2^32 a turn.";
            SpeedWords {
                reference: program.param("speed_ref", 0, Interval::symmetric(most), doc),
                top,
            }
        });
        Self {
            j,
            bus,
            stiffness,
            speed,
        }
    }
}

/// `mul(k_set, I_MAX_BITS)`.
fn set_point_top(spec: &Spec, scale: Scale, stiffness: f64) -> i64 {
    let current = stiffness * scale.voltage() / 65536.0;
    let bits = round_down(spec.inverter.max_current * 65536.0);
    product_bound(current, 32, bits as i64)
}

impl Lowering<'_> {
    /// The bus as the step sees it; call inside an open stage.
    pub fn read_bus(&mut self, words: SetPointWords) -> Bus {
        match words.bus {
            None => {
                let volts = self.number(
                    "v_bus",
                    self.nominal_bus(),
                    &format!(
                        "Bus voltage, {}: the timer period in words of voltage.",
                        engineering(self.spec.inverter.v_bus, "V")
                    ),
                );
                Bus { volts, ratio: None }
            }
            Some(BusWords { volts, ratio }) => {
                let volts = self.b.param(volts);
                let ratio = ratio.map(|ratio| {
                    self.format(
                        "ratio",
                        32,
                        RATIO_BITS as i32,
                        Rounding::Floor,
                        "nominal over measured bus voltage",
                    );
                    (self.b.param(ratio), RATIO_BITS)
                });
                Bus { volts, ratio }
            }
        }
    }
}

/// Builds `set_current`, `set_torque` and, with a measured bus, `set_bus`. `lowering` supplies rounding of
/// coefficients and collects their formats; its own function is not touched.
pub fn setters(lowering: &mut Lowering<'_>, words: SetPointWords) -> Vec<Function> {
    let (spec, stiffness) = (lowering.spec, words.stiffness);
    let voltage = lowering.scale.voltage();
    let k_t = spec.torque_constant();
    let current = stiffness * voltage / 65536.0;
    let (symbol, formula) = gain(spec);
    let k_set = lowering.scaled_coefficient(
        "k_set",
        current,
        32,
        [
            &format!("Set-point in amperes (16 fraction bits) to words of voltage: {formula}."),
            &format!("{symbol} = {}", engineering(stiffness, "V/A")),
        ],
        [
            &format!("{symbol}/w 2^(f_v - 16)"),
            "words of voltage per bit of the set-point, 2^-16 A",
        ],
    );
    let k_torque = lowering.scaled_coefficient(
        "k_torque",
        current / k_t,
        32,
        [
            &format!(
                "Set-point in newton metres (16 fraction bits) to words of voltage: {symbol}/k_t."
            ),
            &format!(
                "{symbol}/k_t = {} with k_t = {}",
                engineering(stiffness / k_t, "V/Nm"),
                engineering(k_t, "Nm/A")
            ),
        ],
        [
            &format!("{symbol}/k_t/w 2^(f_v - 16)"),
            "words of voltage per bit of the set-point, 2^-16 Nm",
        ],
    );
    let most = spec.inverter.max_current;
    let limits = [
        (
            "i_max_bits",
            round_down(most * 65536.0),
            "Largest set-point",
            engineering(most, "A"),
        ),
        (
            "t_max_bits",
            round_down(most * k_t * 65536.0),
            "Largest torque set-point",
            engineering(most * k_t, "Nm"),
        ),
    ];
    let mut functions = vec![
        set_j(
            lowering,
            "set_current",
            words.j,
            k_set,
            &limits[0],
            "Current set-point, bits of a number with 16 fraction bits, ampere.",
        ),
        set_j(
            lowering,
            "set_torque",
            words.j,
            k_torque,
            &limits[1],
            "Torque set-point, bits of a number with 16 fraction bits, Nm.",
        ),
    ];
    if let Some(speed) = words.speed {
        functions.push(set_speed(lowering, speed));
    }
    if let (
        Some(words),
        BusSource::Measured {
            gain,
            adc_bits,
            min,
            max,
        },
    ) = (words.bus, spec.inverter.bus)
    {
        functions.push(set_bus(lowering, words, gain, adc_bits, [min, max]));
    }
    functions
}

fn set_j(
    lowering: &mut Lowering<'_>,
    name: &str,
    j: ParamId,
    coefficient: Coefficient,
    (limit, bits, meaning, physical): &(&str, f64, &str, String),
    input_doc: &str,
) -> Function {
    let range = lowering.b.program.params[j.index()].interval;
    let quantity = match name {
        "set_torque" => "torque in newton metres",
        _ => "current in amperes",
    };
    let greatest = match lowering.spec.controller.common().speed {
        Some(_) => "greatest ",
        None => "",
    };
    let doc = format!(
        "Set-point word of the {greatest}{quantity}; saturates at {physical} to both sides."
    );
    let mut b = FunctionBuilder::new(lowering.b.program, name, &[&doc]);
    b.stage(name, &["Clamps the set-point and turns it into a voltage."]);
    let input = b.input("bits", Interval::WORD, input_doc);
    let doc = format!("{meaning}: {physical}, 16 fraction bits.");
    let volts = limited_product(&mut b, input, (limit, *bits, doc), coefficient);
    b.name("j_new", volts);
    debug_assert!(b.interval(volts).magnitude() <= range.magnitude() || range.bits() > 32);
    b.set_param(j, volts);
    b.finish()
}

fn set_speed(lowering: &mut Lowering<'_>, words: SpeedWords) -> Function {
    let spec = lowering.spec;
    let most = spec.inverter.maximum_speed * 60.0 / TAU;
    let k_rpm = lowering.scaled_coefficient(
        "k_rpm",
        TAU / 60.0 / speed_word(spec) / 65536.0,
        32,
        [
            "Speed in rpm (16 fraction bits) to electrical angle per tick.",
            &format!("W = {} per word", engineering(speed_word(spec), "rad/s")),
        ],
        [
            "2 pi/60/W 2^-16",
            "words of speed per bit of the set-point, 2^-16 rpm",
        ],
    );
    let physical = significant(most);
    let doc =
        format!("Set-point word of the speed in rpm; saturates at {physical} rpm to both sides.");
    let mut b = FunctionBuilder::new(lowering.b.program, "set_speed", &[&doc]);
    b.stage(
        "set_speed",
        &["Clamps the speed and turns it into angle per tick."],
    );
    let input = b.input(
        "bits",
        Interval::WORD,
        "Speed, bits of a number with 16 fraction bits, rpm.",
    );
    let doc = format!("Greatest speed, {physical} rpm, 16 fraction bits.");
    let limit = ("speed_max_bits", round_down(most * 65536.0), doc);
    let speed = limited_product(&mut b, input, limit, k_rpm);
    b.name("speed_ref_new", speed);
    b.set_param(words.reference, speed);
    b.finish()
}

/// A coefficient times `input` within `bits` to both sides. `limit` names the constant of the limit, `doc` is its own.
fn limited_product(
    b: &mut FunctionBuilder<'_>,
    input: Value,
    (limit, bits, doc): (&str, f64, String),
    coefficient: Coefficient,
) -> Value {
    let bits = bits.clamp(0.0, f64::from(i32::MAX)) as i32;
    let most = b.program.constant(limit, bits, &[doc]);
    let most = b.constant(most);
    let clamped = b.clamp_both(input, most);
    let factor = b.constant(coefficient.id);
    b.mul(factor, clamped, coefficient.shift)
}

fn set_bus(
    lowering: &mut Lowering<'_>,
    words: BusWords,
    gain: f64,
    adc_bits: u32,
    [min, max]: [f64; 2],
) -> Function {
    let nominal = lowering.nominal_bus();
    let v_bus = lowering.spec.inverter.v_bus;
    let limits = [lowering.volts_word(min), lowering.volts_word(max)];
    let k_bus = lowering.scaled_coefficient(
        "k_bus",
        gain * lowering.scale.voltage(),
        32,
        [
            "Bus-voltage ADC count to words of voltage.",
            &format!("u = {} per count", engineering(gain, "V")),
        ],
        ["u/w 2^f_v", "words of voltage per count"],
    );
    let [doc, stage_doc] = match words.ratio {
        Some(_) => [
            "Words of the bus voltage, an ADC count; the only division of the set-point path is here.",
            "Bus voltage from its ADC count, and the ratio that scales voltages to timer counts.",
        ],
        None => [
            "Word of the bus voltage, an ADC count.",
            "Bus voltage from its ADC count.",
        ],
    };
    let limits_doc = format!(
        "A voltage outside {} to {}, that of a dead sensor too, counts as the nearer of these.",
        engineering(min, "V"),
        engineering(max, "V"),
    );
    let doc = [doc, &limits_doc];
    let mut b = FunctionBuilder::new(lowering.b.program, "set_bus", &doc);
    b.stage("set_bus", &[stage_doc]);
    let counts = b.input(
        "counts",
        Interval::new(0, i64::from(u16::MAX)),
        "Bus voltage, ADC count.",
    );
    let top = b.program.constant(
        "bus_adc_max",
        ((1_u32 << adc_bits) - 1) as i32,
        &["Largest count of the bus-voltage converter.".to_owned()],
    );
    let top = b.constant(top);
    let counts = b.min(counts, top);
    let factor = b.constant(k_bus.id);
    let measured = b.mul(factor, counts, k_bus.shift);
    let names = ["v_bus_min", "v_bus_max"];
    let [low, high] = [0, 1].map(|k| {
        let meaning = ["Least", "Greatest"][k];
        let id = b.program.constant(
            names[k],
            limits[k] as i32,
            &[format!(
                "{meaning} bus voltage that is taken: {}, words of voltage.",
                engineering([min, max][k], "V")
            )],
        );
        b.constant(id)
    });
    let clamped = b.clamp(measured, low, high);
    b.name("v_bus_new", clamped);
    b.set_param(words.volts, clamped);
    if let Some(ratio) = words.ratio {
        let nominal = b.program.constant(
            "v_bus_nominal",
            nominal as i32,
            &[format!(
                "Nominal bus voltage, {}: the timer period in words of voltage.",
                engineering(v_bus, "V")
            )],
        );
        let nominal = b.constant(nominal);
        let most = b.program.params[ratio.index()].interval.high;
        let most = b.program.constant(
            "ratio_max",
            most as i32,
            &[format!(
                "Nominal over least bus voltage: {}, {RATIO_BITS} fraction bits.",
                significant(v_bus / min)
            )],
        );
        let most = b.constant(most);
        let quotient = b.divide(nominal, RATIO_BITS, clamped, most);
        b.name("ratio_new", quotient);
        b.set_param(ratio, quotient);
    }
    b.finish()
}
