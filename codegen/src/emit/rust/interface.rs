//! The emitted type: its constants, its state, and its implementation of the runtime's traits.

use super::function::{SetterCode, StepCode, command_type};
use super::imports::unsettled;
use super::names::{doc, docs, fixed_type, number, raw_text, screaming, snake, storage_type};
use super::source::{Source, quote};
use crate::interface::{
    FormatEntry, Interface, Limits, PublicConstant, PublicValue, Rounding, SensedPhases, Sensor,
    Sensors, ThirdSensor, Unit, Watch,
};
use crate::ir::{Demand, Program, Setter};

/// Input of the type's code.
pub(super) struct Types<'a> {
    pub program: &'a Program,
    pub interface: &'a Interface,
    /// The type's name.
    pub name: &'a str,
}

impl Types<'_> {
    /// The constants of the type.
    pub(super) fn constants(&self) -> Source {
        let name = unsettled(self.name);
        let constants = self.interface.constants.iter().map(public_constant);
        quote! {
            impl #name {
                #(#constants)*
            }
        }
    }

    /// The state words.
    pub(super) fn state(&self) -> Source {
        let mut before = String::new();
        let fields = self.program.states.iter().map(|word| {
            let (name, kind) = (snake(&word.name), storage_type(word));
            let text = format!("{} In `{}`.", word.doc, word.interval);
            // Phases of one quantity stand together.
            let doc = (text != before).then(|| doc(&text));
            before = text;
            let initial = (word.initial != 0).then(|| {
                let initial = number(i64::from(word.initial));
                quote!(# [initial(#initial)])
            });
            quote!(#doc #initial #name: #kind)
        });
        quote! {
            /// State kept from one control period to the next.
            #[derive(::hexagen::State)]
            pub struct State {
                #(#fields),*
            }
        }
    }

    /// Implementations of the runtime's traits.
    pub(super) fn control(&self, step: &StepCode, setters: &[(Setter, SetterCode)]) -> Source {
        let name = unsettled(self.name);
        let text = self.name;
        let Interface {
            spec_toml,
            formats,
            residual,
            over_speed,
            hall_shifts,
            torque_ratio,
            limits,
            units,
            ..
        } = self.interface;
        let spec = raw_text(spec_toml);
        let formats = formats.iter().map(format);
        let sensors = (limits.sensors != Sensors::AB).then(|| {
            let sensors = sensors_of(limits.sensors);
            quote!(const SENSORS: Sensors = #sensors;)
        });
        let angle = limits.angle.map(|sensor| {
            let (turns, offset) = (number(sensor.turns.into()), number(sensor.offset.into()));
            quote! {
                const ANGLE: Option<AngleSensor> = Some(AngleSensor {
                    turns: #turns,
                    offset: #offset,
                });
            }
        });
        let limits = limits_of(limits);
        let watch = |name: Source, watch: Option<Watch>| {
            watch.map(|Watch { word, most }| {
                let (word, most) = (snake(word), number(i64::from(most)));
                quote! {
                    const #name: Option<fn(&State) -> bool> = Some(|state| state.#word >= #most);
                }
            })
        };
        let residual = watch(quote!(HAS_LOST_CURRENTS), *residual);
        let over_speed = watch(quote!(IS_TOO_FAST), *over_speed);
        let hall_shifts = hall_shifts.map(|words| {
            let words = words.map(snake);
            quote! {
                const HALL_SHIFTS: Option<fn(&State) -> [Word; 3]> =
                    Some(|state| [#(state.#words),*]);
            }
        });
        let torque_ratio = torque_ratio.map(|word| {
            let word = snake(word);
            quote! {
                const TORQUE_RATIO: Option<fn(&State) -> Word> = Some(|state| state.#word);
            }
        });
        let [ampere, volt, volt_per_count, rpm] =
            [units.ampere, units.volt, units.volt_per_count, units.rpm].map(unit);
        let sectors = units
            .sectors
            .iter()
            .map(|&sector| number(i64::from(sector)));
        let (bus_type, bus) = self.bus();
        let demand = self
            .program
            .param(Demand::Current)
            .map_or(0, |word| word.initial);
        let demand = number(i64::from(demand));
        let of = |wanted: Setter| {
            let mut setters = setters.iter();
            setters
                .find(|(set, _)| *set == wanted)
                .map(|(_, setter)| &setter.function)
        };
        let (current, torque) = (of(Setter::Current), of(Setter::Torque));
        let speed_word = of(Setter::Speed).map(|_| {
            quote!(
                const SPEED: Option<fn(Word) -> Word> = Some(<Self as SpeedLoop>::speed);
            )
        });
        let told_words = of(Setter::Bus).map(|_| {
            let count = self.bus_words().len();
            quote! {
                const TOLD_BUS: Option<fn(Word) -> [Word; #count]> = Some(<Self as MeasuredBus>::bus);
            }
        });
        let speed =
            of(Setter::Speed).map(|function| quote!(impl SpeedLoop for #name { #function }));
        let told = of(Setter::Bus).map(|function| quote!(impl MeasuredBus for #name { #function }));
        let command = command_type(self.program);
        let StepCode { entries, rotor, .. } = step;
        quote! {
            impl Control for #name {
                type State = State;
                type Rotor = #rotor;
                type Command = #command;
                type Bus = #bus_type;

                const NAME: &'static str = #text;
                const SPEC: &'static str = #spec;
                const FORMATS: &'static [Format] = &[#(#formats),*];
                const LIMITS: Limits = #limits;
                #sensors
                #angle
                const UNITS: Units = Units {
                    ampere: #ampere,
                    volt: #volt,
                    volt_per_count: #volt_per_count,
                    rpm: #rpm,
                    sectors: [#(#sectors),*],
                };
                const SET_POINT: Word = Word(#demand);
                const BUS: #bus_type = #bus;
                #speed_word
                #told_words
                #residual
                #over_speed
                #hall_shifts
                #torque_ratio

                #current
                #torque
                #entries
            }

            #speed
            #told
        }
    }

    /// Initial words of a measured bus voltage.
    fn bus_words(&self) -> Vec<Source> {
        let words = Demand::OF_BUS.into_iter();
        let words = words.filter_map(|demand| self.program.param(demand));
        words.map(|word| number(i64::from(word.initial))).collect()
    }

    /// Type and initial value of the bus voltage.
    fn bus(&self) -> (Source, Source) {
        let words = self.bus_words();
        let Some(periods) = self.interface.bus_periods else {
            return (quote!(FixedBus), quote!(FixedBus));
        };
        let (count, periods) = (words.len(), number(i64::from(periods)));
        (
            quote!(ToldBus<#count, #periods>),
            quote!(ToldBus::new([#(Word(#words)),*])),
        )
    }
}

fn format(entry: &FormatEntry) -> Source {
    let FormatEntry {
        name,
        storage_bits,
        frac_bits,
        rounding,
        segments,
        ..
    } = entry;
    let storage = number(i64::from(*storage_bits));
    let frac = number(i64::from(*frac_bits));
    let rounding = match rounding {
        Rounding::Floor => quote!(Rounding::Floor),
        Rounding::RoundHalfUp => quote!(Rounding::RoundHalfUp),
    };
    let over = segments.map(|segments| {
        let segments = number(i64::from(segments));
        quote!(.over(#segments))
    });
    quote!(Format::new(#name, #storage, #frac, #rounding) #over)
}

fn limits_of(limits: &Limits) -> Source {
    let n = |value: i64| number(value);
    let adc_max = n(limits.adc_max.into());
    let inverted = Source::of(limits.adc_inverted.to_string());
    let bits = n(limits.current_bits.into());
    let offset = n(limits.offset.into());
    let [least, most] = limits.offsets.map(|offset| n(offset.into()));
    let trip = n(limits.trip.into());
    let [low, high] = limits.currents.map(|current| n(current.into()));
    let log2 = n(limits.calibration_log2.into());
    let precharge = n(limits.precharge_periods.into());
    let stall = n(limits.stall_periods.into());
    let hall_inverted = n(limits.hall_inverted.into());
    let hall_glitches = n(limits.hall_glitches.into());
    let sectors = n(limits.sectors.into());
    let brake = n(limits.brake_periods.into());
    let start = n(limits.start_periods.into());
    let [bus_least, bus_most] = limits.bus_counts.map(|count| n(count.into()));
    quote! {
        Limits {
            adc_max: #adc_max,
            adc_inverted: #inverted,
            current_bits: #bits,
            offset: #offset,
            offsets: [#least, #most],
            trip: #trip,
            currents: [#low, #high],
            calibration_log2: #log2,
            precharge_periods: #precharge,
            stall_periods: #stall,
            hall_inverted: #hall_inverted,
            hall_glitches: #hall_glitches,
            sectors: #sectors,
            brake_periods: #brake,
            start_periods: #start,
            bus_counts: [#bus_least, #bus_most],
        }
    }
}

fn sensors_of(sensors: Sensors) -> Source {
    let phases = match sensors.phases {
        SensedPhases::Ab => quote!(Ab),
        SensedPhases::Bc => quote!(Bc),
        SensedPhases::Ca => quote!(Ca),
    };
    let second = optional(sensors.second, sensor_of);
    let third = optional(sensors.third, third_of);
    quote! {
        Sensors {
            phases: SensedPhases::#phases,
            second: #second,
            third: #third,
        }
    }
}

fn optional<T>(value: Option<T>, source: impl FnOnce(T) -> Source) -> Source {
    match value.map(source) {
        None => quote!(None),
        Some(value) => quote!(Some(#value)),
    }
}

fn sensor_of(sensor: Sensor) -> Source {
    let Sensor {
        adc_inverted,
        offset,
        offsets,
        ratio,
    } = sensor;
    let inverted = Source::of(adc_inverted.to_string());
    let offset = number(offset.into());
    let [least, most] = offsets.map(|offset| number(offset.into()));
    let ratio = if ratio == Sensor::ALIKE {
        quote!(Sensor::ALIKE)
    } else {
        number(ratio.into())
    };
    quote! {
        Sensor {
            adc_inverted: #inverted,
            offset: #offset,
            offsets: [#least, #most],
            ratio: #ratio,
        }
    }
}

fn third_of(third: ThirdSensor) -> Source {
    let sensor = sensor_of(third.sensor);
    let readable = optional(third.readable, |top| number(top.into()));
    let is_delayed = Source::of(third.is_delayed.to_string());
    let tolerance = number(third.sum_tolerance.into());
    let samples = number(third.sum_samples.into());
    quote! {
        ThirdSensor {
            sensor: #sensor,
            readable: #readable,
            is_delayed: #is_delayed,
            sum_tolerance: #tolerance,
            sum_samples: #samples,
        }
    }
}

fn unit(unit: Unit) -> Source {
    let (factor, shift) = (
        number(i64::from(unit.factor)),
        number(i64::from(unit.shift)),
    );
    quote!(Unit { factor: #factor, shift: #shift })
}

fn public_constant(constant: &PublicConstant) -> Source {
    let name = screaming(&constant.name);
    let doc = docs(&constant.doc);
    let (kind, value) = match &constant.value {
        PublicValue::Integer { rust_type, value } => {
            let kind = Source::of(*rust_type);
            (quote!(#kind), number(*value))
        }
        PublicValue::Fixed { bits, frac_bits } => {
            let kind = fixed_type(*frac_bits);
            let bits = number(i64::from(*bits));
            (quote!(#kind), quote!(#kind::from_bits(#bits)))
        }
        PublicValue::Vectors { bits, frac_bits } => {
            let kind = fixed_type(*frac_bits);
            let count = bits.len();
            let vectors = bits.iter().map(|vector| {
                let [alpha, beta] = vector.map(|bits| number(i64::from(bits)));
                quote!([#alpha, #beta])
            });
            (
                quote!([[#kind; 2]; #count]),
                quote!(pairs_from_bits([#(#vectors),*])),
            )
        }
        PublicValue::Integers { rust_type, values } => {
            let kind = Source::of(*rust_type);
            let count = values.len();
            let values = values.iter().map(|&value| number(value));
            (quote!([#kind; #count]), quote!([#(#values),*]))
        }
        PublicValue::Text(text) => (quote!(&'static str), quote!(#text)),
    };
    quote!(#doc pub const #name: #kind = #value;)
}
