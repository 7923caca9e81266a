//! Set-point words and the functions that set them (semantics, "Set-point words").

use super::number::round_half_up;
use super::rotor::speed_word;
use super::{Bus, Lowering, product_bound, round_down};
use crate::diagnostics::{engineering, significant};
use crate::interface::Rounding;
use crate::ir::{Coefficient, Demand, Expr, Interval, Param, Setter, named};
use crate::spec::BusSource;
use std::f64::consts::TAU;

/// Fraction bits of the ratio of nominal to measured bus.
const RATIO_BITS: u32 = 28;

/// Set-point words of a program.
#[derive(Clone, Copy, Debug)]
pub struct SetPointWords<'b> {
    /// The current set-point times the gain, words of voltage.
    pub j: Param<'b>,
    bus: Option<BusWords<'b>>,
    /// The set-point's gain.
    pub gain: Gain,
    /// The greatest set-point word that a setter makes: `k_set` times `I_MAX_BITS`.
    pub top: i64,
    /// Words of the speed loop; with a speed loop only.
    pub speed: Option<SpeedWords<'b>>,
}

/// Words of a speed loop.
#[derive(Clone, Copy, Debug)]
pub struct SpeedWords<'b> {
    /// Speed set-point, in words of `omega`.
    pub reference: Param<'b>,
    /// Its greatest value.
    pub most: i64,
}

/// Words of a measured bus.
#[derive(Clone, Copy, Debug)]
struct BusWords<'b> {
    volts: Param<'b>,
    /// Nominal over measured bus voltage; with a modulator only.
    ratio: Option<Param<'b>>,
}

/// The greatest set-point word that a setter makes, `top`, as a constant.
pub fn largest_set_point<'b>(l: &Lowering<'b>, top: i64) -> Expr<'b> {
    l.number("j_largest", top, "The largest set-point, words of voltage.")
}

/// Gain from a current set-point to a voltage.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Its value, V/A.
    pub value: f64,
    /// Its symbol.
    pub symbol: &'static str,
    /// Formula of the symbol.
    pub formula: &'static str,
}

impl Gain {
    /// K = 1/b: the voltage per change of current in a period.
    pub fn stiffness(value: f64) -> Self {
        Self {
            value,
            symbol: "K",
            formula: "K = 1/b",
        }
    }

    /// Words of voltage per bit of a current set-point.
    fn of_current(self, l: &Lowering<'_>) -> Coefficient {
        let Self {
            value: stiffness,
            symbol,
            formula,
        } = self;
        let current = stiffness * l.scale.voltage() / 65536.0;
        l.scaled_coefficient(
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
        )
    }

    /// Words of voltage per bit of a torque set-point.
    fn of_torque(self, l: &Lowering<'_>) -> Coefficient {
        let (symbol, k_t) = (self.symbol, l.spec.torque_constant());
        let torque = self.value / k_t;
        l.scaled_coefficient(
            "k_torque",
            torque * l.scale.voltage() / 65536.0,
            32,
            [
                &format!(
                    "Set-point in newton metres (16 fraction bits) to words of voltage: {symbol}/k_t."
                ),
                &format!(
                    "{symbol}/k_t = {} with k_t = {}",
                    engineering(torque, "V/Nm"),
                    engineering(k_t, "Nm/A")
                ),
            ],
            [
                &format!("{symbol}/k_t/w 2^(f_v - 16)"),
                "words of voltage per bit of the set-point, 2^-16 Nm",
            ],
        )
    }
}

impl<'b> SetPointWords<'b> {
    /// Declares the words.
    pub fn new(l: &Lowering<'b>, gain: Gain) -> Self {
        let inverter = &l.spec.inverter;
        let stiffness = gain.value;
        let most = (inverter.max_current * stiffness * l.scale.voltage()).ceil() as i64 + 1;
        let has_speed = l.spec.controller.common().speed.is_some();
        let what = if has_speed {
            "Greatest set-point of the speed regulator"
        } else {
            "Set-point"
        };
        let symbol = gain.symbol;
        let doc = format!("{what} as the voltage {symbol} i_ref, words of voltage.");
        let bits = round_down(inverter.max_current * 65536.0) as i64;
        let top = product_bound(stiffness * l.scale.voltage() / 65536.0, 32, bits);
        let initial = if has_speed { top as i32 } else { 0 };
        let j = l.b.param(
            Demand::Current,
            "j",
            initial,
            Interval::symmetric(most),
            &doc,
        );
        let bus = BusWords::new(l);
        let speed = has_speed.then(|| {
            let most = (inverter.maximum_speed / speed_word(l.spec)).ceil() as i64 + 1;
            let doc = "Speed set-point, electrical angle per tick, 2^32 a turn.";
            let range = Interval::symmetric(most);
            let reference = l.b.param(Demand::Speed, "speed_ref", 0, range, doc);
            SpeedWords { reference, most }
        });
        Self {
            j,
            bus,
            gain,
            top,
            speed,
        }
    }

    /// A measured bus voltage, words of voltage.
    pub fn told_bus(&self) -> Option<Expr<'b>> {
        self.bus.map(|bus| bus.volts.read())
    }

    /// The bus as the step sees it; call inside an open stage.
    pub fn read_bus(&self, l: &Lowering<'b>) -> Bus<'b> {
        let Some(BusWords { volts, ratio }) = self.bus else {
            let volts = engineering(l.spec.inverter.v_bus, "V");
            let doc = format!("Bus voltage, {volts}: the timer period in words of voltage.");
            return Bus {
                volts: l.number("v_bus", l.nominal_bus(), &doc),
                ratio: None,
            };
        };
        let ratio = ratio.map(|ratio| {
            let meaning = "nominal over measured bus voltage";
            l.format("ratio", 32, RATIO_BITS as i32, Rounding::Floor, meaning);
            (ratio.read(), RATIO_BITS)
        });
        Bus {
            volts: volts.read(),
            ratio,
        }
    }

    /// Adds the setters: of current and torque, and of speed and bus where the drive has them.
    pub fn add_setters(&self, l: &Lowering<'b>) {
        let spec = l.spec;
        let k_t = spec.torque_constant();
        let most = spec.inverter.max_current;
        let of_current = SetPoint {
            setter: Setter::Current,
            quantity: "current in amperes",
            unit: "ampere",
            input: "Current set-point",
            limit: ("i_max_bits", most, "Largest set-point"),
            physical: engineering(most, "A"),
            coefficient: self.gain.of_current(l),
        };
        let of_torque = SetPoint {
            setter: Setter::Torque,
            quantity: "torque in newton metres",
            unit: "Nm",
            input: "Torque set-point",
            limit: ("t_max_bits", most * k_t, "Largest torque set-point"),
            physical: engineering(most * k_t, "Nm"),
            coefficient: self.gain.of_torque(l),
        };
        of_current.add(l, self.j);
        of_torque.add(l, self.j);
        if let Some(speed) = self.speed {
            speed.add_setter(l);
        }
        if let Some(bus) = self.bus {
            bus.add_setter(l);
        }
    }
}

/// A set-point of the current, in amperes or newton metres.
struct SetPoint {
    setter: Setter,
    quantity: &'static str,
    unit: &'static str,
    input: &'static str,
    /// Name, value and meaning of the limit.
    limit: (&'static str, f64, &'static str),
    physical: String,
    coefficient: Coefficient,
}

impl SetPoint {
    fn add<'b>(&self, l: &Lowering<'b>, j: Param<'b>) {
        let greatest = match l.spec.controller.common().speed {
            Some(_) => "greatest ",
            None => "",
        };
        let (quantity, physical) = (self.quantity, &self.physical);
        let learns = l.spec.controller.common().learning.torque;
        let by = match self.setter {
            Setter::Torque if learns => " by the stated constant",
            _ => "",
        };
        let doc =
            format!("Set-point word of the {greatest}{quantity}; saturates at +-{physical}{by}.");
        let (limit, most, meaning) = self.limit;
        l.b.setter(self.setter, &[&doc], |b| {
            let doc = "Set-point word: the clamped set-point as a voltage.";
            b.stage(self.setter.name(), &[doc]);
            let (input, unit) = (self.input, self.unit);
            let doc = format!("{input}, bits of a number with 16 fraction bits, {unit}.");
            let bits = b.input("bits", Interval::WORD, &doc);
            let doc = format!("{meaning}: {physical}, 16 fraction bits.");
            named! {
                let j_new = self.coefficient * bits.within(limit_bits(l, limit, most, doc));
            }
            let range = j.interval();
            debug_assert!(j_new.interval().magnitude() <= range.magnitude() || range.bits() > 32);
            j.set(j_new);
        });
    }
}

/// A limit with 16 fraction bits.
fn limit_bits<'b>(l: &Lowering<'b>, name: &str, most: f64, doc: String) -> Expr<'b> {
    let bits = round_down(most * 65536.0).clamp(0.0, f64::from(i32::MAX));
    l.b.constant(name, bits as i32, &[doc])
}

impl<'b> SpeedWords<'b> {
    fn add_setter(&self, l: &Lowering<'b>) {
        let most = l.spec.inverter.maximum_speed * 60.0 / TAU;
        let word = speed_word(l.spec);
        let k_rpm = l.scaled_coefficient(
            "k_rpm",
            TAU / 60.0 / word / 65536.0,
            32,
            [
                "Speed in rpm (16 fraction bits) to electrical angle per tick.",
                &format!("W = {} per word", engineering(word, "rad/s")),
            ],
            [
                "2 pi/60/W 2^-16",
                "words of speed per bit of the set-point, 2^-16 rpm",
            ],
        );
        let physical = significant(most);
        let doc = format!("Set-point word of the speed in rpm; saturates at +-{physical} rpm.");
        l.b.setter(Setter::Speed, &[&doc], |b| {
            let doc = "Set-point word: the clamped speed as angle per tick.";
            b.stage(Setter::Speed.name(), &[doc]);
            let doc = "Speed, bits of a number with 16 fraction bits, rpm.";
            let bits = b.input("bits", Interval::WORD, doc);
            let doc = format!("Greatest speed, {physical} rpm, 16 fraction bits.");
            named! {
                let speed_ref_new = k_rpm * bits.within(limit_bits(l, "speed_max_bits", most, doc));
            }
            self.reference.set(speed_ref_new);
        });
    }
}

impl<'b> BusWords<'b> {
    fn new(l: &Lowering<'b>) -> Option<Self> {
        let BusSource::Measured { min, max, .. } = l.spec.inverter.bus else {
            return None;
        };
        let nominal = l.nominal_bus();
        let word = |volts: f64| round_half_up(volts * l.scale.voltage()) as i64;
        let (low, high) = (word(min), word(max));
        let range = Interval::new(low, high);
        let doc = "Bus voltage, words of voltage.";
        let volts = l.b.param(Demand::Bus, "v_bus", nominal as i32, range, doc);
        let ratio = l.spec.controller.modulates().then(|| {
            let ratio = |volts: i64| {
                ((i128::from(nominal) << RATIO_BITS) / i128::from(volts.max(1))) as i64
            };
            let range = Interval::new(ratio(high), ratio(low));
            let doc = "Nominal over measured bus voltage.";
            l.b.param(Demand::BusRatio, "ratio", 1 << RATIO_BITS, range, doc)
        });
        Some(Self { volts, ratio })
    }

    fn add_setter(&self, l: &Lowering<'b>) {
        let BusSource::Measured {
            gain,
            adc_bits,
            min,
            max,
            ..
        } = l.spec.inverter.bus
        else {
            return;
        };
        let k_bus = words_per_count(l, gain);
        let [doc, stage_doc] = match self.ratio {
            Some(_) => [
                "Words of the bus voltage from its ADC count.",
                "Bus voltage, and the ratio that scales voltages to timer counts.",
            ],
            None => [
                "Word of the bus voltage from its ADC count.",
                "Bus voltage from its ADC count.",
            ],
        };
        let limits = format!(
            "The voltage is clamped to {} to {}, that of a dead sensor too.",
            engineering(min, "V"),
            engineering(max, "V"),
        );
        l.b.setter(Setter::Bus, &[doc, &limits], |b| {
            b.stage(Setter::Bus.name(), &[stage_doc]);
            let range = Interval::new(0, i64::from(u16::MAX));
            let counts = b.input("counts", range, "Bus voltage, ADC count.");
            let top = ((1_u32 << adc_bits) - 1) as i32;
            let doc = "Largest count of the bus-voltage ADC.".to_owned();
            let counts = counts.min(b.constant("bus_adc_max", top, &[doc]));
            let limit = |name, meaning, volts| {
                let unit = engineering(volts, "V");
                let doc = format!("{meaning} bus voltage: {unit}, words of voltage.");
                b.constant(name, l.volts_word(volts) as i32, &[doc])
            };
            let measured = k_bus * counts;
            named! {
                let v_bus_new = measured.clamp(
                    limit("v_bus_min", "Least", min),
                    limit("v_bus_max", "Greatest", max),
                );
            }
            self.volts.set(v_bus_new);
            if let Some(ratio) = self.ratio {
                ratio.set(nominal_ratio(l, v_bus_new, ratio, min));
            }
        });
    }
}

/// Words of voltage per count of the bus voltage's ADC, of `gain` volt.
fn words_per_count(l: &Lowering<'_>, gain: f64) -> Coefficient {
    l.scaled_coefficient(
        "k_bus",
        gain * l.scale.voltage(),
        32,
        [
            "Bus-voltage ADC count to words of voltage.",
            &format!("u = {} per count", engineering(gain, "V")),
        ],
        ["u/w 2^f_v", "words of voltage per count"],
    )
}

/// Nominal over measured bus voltage, for a measured one of at least `min`.
fn nominal_ratio<'b>(l: &Lowering<'b>, volts: Expr<'b>, ratio: Param<'b>, min: f64) -> Expr<'b> {
    let v_bus = l.spec.inverter.v_bus;
    let doc = format!(
        "Nominal bus voltage, {}: the timer period in words of voltage.",
        engineering(v_bus, "V")
    );
    let nominal =
        l.b.constant("v_bus_nominal", l.nominal_bus() as i32, &[doc]);
    let doc = format!(
        "Nominal over minimum bus voltage: {}, {RATIO_BITS} fraction bits.",
        significant(v_bus / min)
    );
    let most =
        l.b.constant("ratio_max", ratio.interval().high as i32, &[doc]);
    named! {
        let ratio_new = nominal.divide(RATIO_BITS, volts, most);
    }
    ratio_new
}
