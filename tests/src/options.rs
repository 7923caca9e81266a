//! Every option of a drive with its tested values, by kind of controller: the axes of the full
//! products and of the covering arrays.
//!
//! Kinds, their options and the options' words come from the generator's own table: a new kind or
//! word has its axis at once. Listed here are the tested numbers and combinations.

use crate::library::{Motor, motor};
use hexagen_codegen::diagnostics::Diagnostics;
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{KINDS, Rule, Spec, check, parse_toml};
use std::cell::LazyCell;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::Mutex;
use toml_edit::{DocumentMut, Item, Table};

/// Setting of an option's value: section, field, TOML value.
type Setting = (&'static str, &'static str, &'static str);

/// An option listed here: short names of its values, and the fields that they set.
type Row = (&'static str, &'static [(&'static str, &'static [Setting])]);

/// A value of an option.
#[derive(Clone, Debug)]
pub struct Value {
    /// Short name.
    pub name: &'static str,
    /// Its settings: section, field, TOML value.
    settings: Vec<(&'static str, &'static str, String)>,
}

/// One option and its values.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name of the option.
    pub name: &'static str,
    /// Its values.
    pub values: Vec<Value>,
}

/// A kind of controller.
#[derive(Clone, Debug)]
pub struct Kind {
    /// Its name in a specification.
    pub name: &'static str,
    /// The options that depend on each other, then the independent ones.
    pub axes: Vec<Axis>,
    /// The number of independent ones.
    loose: usize,
}

/// One value per axis of a kind, as indices.
pub type Choice = Vec<usize>;

/// An independent option with its value, and another option with its value, all by index.
pub type Meeting = ((usize, usize), (usize, usize));

/// Fields that an angle sensor excludes.
const OF_HALLS: [(&str, &str); 5] = [
    ("motor", "hall_codes"),
    ("motor", "hall_angles"),
    ("inverter", "hall_glitches"),
    ("controller", "hall_capture"),
    ("controller", "hall_learning"),
];

/// Placeholder of a voltage of 1.6 times the motor's bus.
const BUS_RANGE: &str = "\"bus range\"";

/// Placeholder of a voltage of a quarter of the motor's bus; on a board, whose limits are nearer, of a twentieth.
const FADE: &str = "\"fade\"";
/// A tenth and a twenty-fifth of the ADC's range, which every motor draws and returns more than.
const DRAWN: &str = "\"drawn\"";
const RETURNED: &str = "\"returned\"";
/// Placeholder of 1.25 times the rated speed.
const OVER_SPEED: &str = "\"over-speed\"";

/// Values rejected by every drive of a kind: kind, option, value.
const REFUSED: [(&str, &str, &str); 3] = [
    ("p-pwm", "emf", "held"),
    ("pi-pwm", "emf", "held"),
    ("pi-pwm", "modulation", "pair"),
];

/// Values of independent options that the second option's value rules out: intervals have no pulses to shift, and the bus
/// current of them is not computed. Rounding is predicted for three pulsed legs, and with a delay.
const APART: [[(&str, &str); 2]; 10] = [
    [("dead_time", "compensated"), ("modulation", "table2")],
    [
        ("dead_time", "compensated"),
        ("modulation", "table2_pair_low"),
    ],
    [("supply", "limited"), ("modulation", "table2")],
    [("supply", "limited"), ("modulation", "table2_pair_low")],
    [("supply", "limited_both_ways"), ("modulation", "table2")],
    [
        ("supply", "limited_both_ways"),
        ("modulation", "table2_pair_low"),
    ],
    [("rounding", "predicted"), ("modulation", "pair")],
    [("rounding", "predicted"), ("modulation", "table2")],
    [("rounding", "predicted"), ("modulation", "table2_pair_low")],
    [("rounding", "predicted"), ("delay", "0")],
];

/// A switching table that no derivation gives, with every vector.
const SWITCHING_TABLE: &str = "[0, 3, 5, 12, 9, 15, 2, 6, 13, 8, 11, 1, 14, 7, 4, 10, \
    2, 2, 9, 9, 0, 13, 6, 12, 3, 8, 1, 11, 10, 5, 14, 7, 4, 0, 15, 3, 12, 6, 8, 1, 9, 10, 13, 2, 5, 11, 7, 4]";

/// Options of some kinds, besides those of the table: the default value first.
const OWN: &[Row] = &[
    (
        // Candidates and cost.
        "choice",
        &[
            ("one", &[("controller", "modulated", "\"off\"")]),
            ("two", &[("controller", "modulated", "\"on\"")]),
            (
                "fewer_changes",
                &[("controller", "switching_weight", "\"0.1 A\"")],
            ),
            ("torque", &[("controller", "torque_weight", "1.7")]),
            (
                "weighted",
                &[
                    ("controller", "switching_weight", "\"0.06 A\""),
                    ("controller", "torque_weight", "0.6"),
                ],
            ),
            ("two_steps", &[("controller", "horizon", "2")]),
        ],
    ),
    (
        "modulation",
        &[
            ("three_phase", &[]),
            ("pair", &[("controller", "modulation", "\"pair\"")]),
            ("table2", &[("controller", "modulation", "\"table2\"")]),
            (
                "table2_pair_low",
                &[
                    ("controller", "modulation", "\"table2\""),
                    ("controller", "zero", "\"pair_low\""),
                ],
            ),
        ],
    ),
    (
        "table",
        &[
            ("derived", &[]),
            ("printed", &[("controller", "table", "\"printed\"")]),
            ("given", &[("controller", "table", SWITCHING_TABLE)]),
        ],
    ),
];

/// Options of all kinds, besides those of the table.
const SHARED: &[Row] = &[
    (
        "reference",
        &[
            (
                "quasi_square",
                &[("controller", "reference", "\"quasi_square\"")],
            ),
            (
                "proportional",
                &[("controller", "reference", "\"proportional\"")],
            ),
            (
                "weakened",
                &[
                    ("controller", "reference", "\"proportional\""),
                    ("controller", "field_weakening", "\"on\""),
                    ("inverter", "bus_clamp", "\"2 kV\""),
                ],
            ),
        ],
    ),
    (
        "hall_capture",
        &[
            ("sampled", &[("controller", "hall_capture", "\"sampled\"")]),
            ("timer", &[("controller", "hall_capture", "\"timer\"")]),
        ],
    ),
    (
        "emf",
        &[
            // Not stated: it has no effect on a PI loop without feed-forward.
            ("by_default", &[]),
            ("estimated", &[("controller", "emf", "\"estimated\"")]),
            ("unfiltered", &[("controller", "emf_filter", "1")]),
            ("model", &[("controller", "emf", "\"model\"")]),
            ("held", &[("controller", "emf", "\"held\"")]),
            ("observer", &[("controller", "emf", "\"observer\"")]),
            (
                "watched",
                &[
                    ("controller", "emf", "\"observer\""),
                    ("controller", "residual_timeout", "\"4 ms\""),
                ],
            ),
            (
                "learning",
                &[
                    ("controller", "emf", "\"observer\""),
                    ("controller", "hall_learning", "\"on\""),
                ],
            ),
            (
                "torque",
                &[
                    ("controller", "emf", "\"observer\""),
                    ("controller", "torque_learning", "\"on\""),
                ],
            ),
        ],
    ),
    (
        "advance",
        &[
            ("0", &[("controller", "advance", "0")]),
            ("1.5", &[("controller", "advance", "1.5")]),
            ("2", &[("controller", "advance", "2")]),
        ],
    ),
    (
        "delay",
        &[
            ("1", &[("controller", "delay", "1")]),
            ("0", &[("controller", "delay", "0")]),
        ],
    ),
    (
        "word",
        &[
            ("32", &[("controller", "word", "32")]),
            ("16", &[("controller", "word", "16")]),
        ],
    ),
    (
        // For how long a leg must be low.
        "legs",
        &[
            ("free", &[]),
            (
                "sensed",
                &[
                    ("inverter", "current_sensing", "\"low_side\""),
                    ("inverter", "settling_time", "\"1 us\""),
                    ("inverter", "aperture_time", "\"200 ns\""),
                    ("inverter", "conversion_time", "\"400 ns\""),
                ],
            ),
            ("bootstrap", &[("inverter", "minimum_low_time", "\"4 us\"")]),
        ],
    ),
    (
        "v_bus",
        &[
            ("fixed", &[]),
            (
                "measured",
                &[
                    ("inverter", "v_bus", "\"measured\""),
                    ("inverter", "bus_adc_bits", "12"),
                    ("inverter", "bus_adc_range", BUS_RANGE),
                ],
            ),
            (
                "untripped",
                &[
                    ("inverter", "v_bus", "\"measured\""),
                    ("inverter", "bus_adc_bits", "12"),
                    ("inverter", "bus_adc_range", BUS_RANGE),
                    ("inverter", "over_voltage", "\"0 V\""),
                    ("inverter", "under_voltage", "\"0 V\""),
                ],
            ),
            (
                "fading",
                &[
                    ("inverter", "v_bus", "\"measured\""),
                    ("inverter", "bus_adc_bits", "12"),
                    ("inverter", "bus_adc_range", BUS_RANGE),
                    ("inverter", "braking_fade", FADE),
                    ("inverter", "motoring_fade", FADE),
                ],
            ),
        ],
    ),
];

/// Independent options, of the inverter and of the controllers that have them.
const LOOSE: &[Row] = &[
    (
        "tuning",
        &[
            ("default", &[]),
            ("slow", &[("controller", "bandwidth", "\"700 Hz\"")]),
            (
                "slow_integral",
                &[
                    ("controller", "bandwidth", "\"700 Hz\""),
                    ("controller", "integral_time", "\"0.5 ms\""),
                ],
            ),
        ],
    ),
    (
        "band",
        &[
            ("default", &[]),
            ("narrow", &[("controller", "band", "\"20 mA\"")]),
        ],
    ),
    (
        "dead_time",
        &[
            ("ignored", &[]),
            (
                "compensated",
                &[
                    ("inverter", "dead_time", "\"900 ns\""),
                    ("controller", "dead_time_compensation", "\"on\""),
                ],
            ),
        ],
    ),
    (
        "rounding",
        &[
            ("ignored", &[]),
            (
                "predicted",
                &[("controller", "rounding_prediction", "\"on\"")],
            ),
        ],
    ),
    (
        "stall_timeout",
        &[
            ("none", &[]),
            // With a timer, also a clock whose ticks do not divide the period.
            (
                "100ms",
                &[
                    ("inverter", "stall_timeout", "\"100 ms\""),
                    ("inverter", "hall_timer_clock", "\"505 kHz\""),
                ],
            ),
        ],
    ),
    (
        "over_speed",
        &[
            ("none", &[]),
            ("watched", &[("inverter", "over_speed", OVER_SPEED)]),
        ],
    ),
    (
        "halls",
        &[
            ("plain", &[]),
            ("bridged", &[("inverter", "hall_glitches", "3")]),
            (
                "60_degrees",
                &[("motor", "hall_codes", "[0, 1, 3, 7, 6, 4]")],
            ),
            (
                "out_of_place",
                &[(
                    "motor",
                    "hall_angles",
                    "[\"-38 deg\", \"34 deg\", \"88 deg\", \"143 deg\", \"215 deg\", \"270 deg\"]",
                )],
            ),
            (
                "bridged_60_degrees",
                &[
                    ("motor", "hall_codes", "[7, 3, 1, 0, 4, 6]"),
                    ("inverter", "hall_glitches", "1"),
                ],
            ),
            // In place of Hall sensors.
            (
                "angle",
                &[
                    ("motor", "rotor", "\"angle\""),
                    ("motor", "angle_pole_pairs", "1"),
                    ("motor", "angle_direction", "\"backward\""),
                    ("motor", "angle_offset", "\"-73.5 deg\""),
                    ("motor", "angle_bits", "14"),
                ],
            ),
        ],
    ),
    (
        "emf_shape",
        &[
            ("motor's", &[]),
            (
                "harmonics",
                &[
                    ("motor", "emf_shape", "\"harmonics\""),
                    ("motor", "emf_orders", "[3, 5, 7, 23]"),
                    (
                        "motor",
                        "emf_amplitudes",
                        "[\"15 %\", \"5 %\", \"-2 %\", \"0.5 %\"]",
                    ),
                    (
                        "motor",
                        "emf_phases",
                        "[\"0 deg\", \"20 deg\", \"0 deg\", \"45 deg\"]",
                    ),
                ],
            ),
        ],
    ),
    (
        "speed_loop",
        &[
            ("off", &[]),
            (
                "on",
                &[
                    ("controller", "speed_loop", "\"on\""),
                    ("motor", "inertia", "\"3 kg cm2\""),
                ],
            ),
            (
                "ramped",
                &[
                    ("controller", "speed_loop", "\"on\""),
                    ("controller", "acceleration_limit", "\"20000 rpm/s\""),
                    ("motor", "inertia", "\"3 kg cm2\""),
                ],
            ),
            ("slewed", &[("controller", "slew_rate", "\"500 A/s\"")]),
        ],
    ),
    (
        "adc_inverted",
        &[
            ("off", &[]),
            ("on", &[("inverter", "adc_inverted", "\"on\"")]),
        ],
    ),
    (
        "start_up",
        &[
            ("plain", &[]),
            (
                "short",
                &[
                    ("inverter", "calibration_samples", "16"),
                    ("inverter", "precharge", "\"0 ms\""),
                ],
            ),
            // Short enough for many start-ups.
            (
                "brief",
                &[
                    ("inverter", "calibration_samples", "16"),
                    ("inverter", "precharge", "\"0.2 ms\""),
                ],
            ),
        ],
    ),
    (
        "supply",
        &[
            ("default", &[]),
            ("limited", &[("inverter", "bus_current_limit", DRAWN)]),
            (
                "limited_both_ways",
                &[
                    ("inverter", "bus_current_limit", DRAWN),
                    ("inverter", "return_current_limit", RETURNED),
                ],
            ),
        ],
    ),
];

/// A drive of the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Drive {
    /// Kind of controller.
    pub kind: &'static str,
    /// Name of the motor.
    pub motor: &'static str,
    /// Options without the first value of their axis.
    pub settings: &'static [(&'static str, &'static str)],
}

impl Drive {
    /// Kind and motor.
    pub fn name(&self) -> String {
        format!("{} {}", self.kind, self.motor)
    }

    /// Its motor's file with its options, and another type name, if given.
    pub fn toml(&self, type_name: Option<&str>) -> String {
        let kind = kind(self.kind);
        kind.drive_toml(
            &motor(self.motor),
            &kind.choice_of(self.settings),
            type_name,
        )
    }
}

/// Options without an axis, with the tests that cover them.
const TRIED_ELSEWHERE: [(&str, &str); 5] = [
    (
        "commutation_threshold",
        "constants of a drive: the motors of the library differ in it by default",
    ),
    (
        "commutation_timeout",
        "constants of a drive: the motors of the library differ in it by default",
    ),
    (
        "speed_bandwidth",
        "a coefficient of the speed loop: the motors of the library differ in it by default",
    ),
    (
        "core_clock",
        "changes no code (`timing/mod.rs` tests what it tells)",
    ),
    (
        "target",
        "chooses `word`, which has an axis (`pipeline.rs` tests the choice)",
    ),
];

/// All kinds of controllers.
pub fn kinds() -> Vec<Kind> {
    KINDS.iter().map(|known| kind(known.name)).collect()
}

/// The kind of this name.
///
/// # Panics
/// If there is none.
pub fn kind(name: &str) -> Kind {
    let known = KINDS.iter().find(|known| known.name == name);
    let known = known.expect("a kind of controller");
    let rules = known.rules();
    let is_written = |option: &str| {
        let rows = OWN.iter().chain(SHARED).chain(LOOSE);
        let mut settings = rows
            .flat_map(|(_, values)| *values)
            .flat_map(|(_, settings)| *settings);
        settings.any(|(section, field, _)| *section == "controller" && *field == option)
    };
    let elsewhere = |option: &str| TRIED_ELSEWHERE.iter().any(|(name, _)| *name == option);
    let of_table = rules
        .iter()
        .filter(|rule| rule.words().len() > 1 && !is_written(rule.name) && !elsewhere(rule.name));
    let written = |rows: &'static [Row]| {
        let axes = rows.iter().map(|row| axis(known, row));
        axes.filter(|axis| axis.values.len() > 1)
    };
    let loose: Vec<Axis> = written(LOOSE).collect();
    Kind {
        name: known.name,
        loose: loose.len(),
        axes: of_table
            .map(|rule| axis_of_words(rule))
            .chain(written(OWN))
            .chain(written(SHARED))
            .chain(loose)
            .collect(),
    }
}

/// An option of the table, its default first; the default is not stated, as another option may
/// forbid stating it.
fn axis_of_words(rule: &'static Rule) -> Axis {
    let default = rule.preset_value().unwrap_or("by_default");
    let words = rule.words().iter().map(|word| word.word);
    let stated = |name| Value {
        name,
        settings: vec![("controller", rule.name, format!("\"{name}\""))],
    };
    let unstated = Value {
        name: default,
        settings: vec![],
    };
    Axis {
        name: rule.name,
        values: std::iter::once(unstated)
            .chain(words.filter(|word| *word != default).map(stated))
            .collect(),
    }
}

/// An option listed here, with those of its values that the kind accepts.
fn axis(kind: &hexagen_codegen::spec::Kind, (name, values): &'static Row) -> Axis {
    let rules = kind.rules();
    let is_taken = |(value, settings): &&(&str, &[Setting])| {
        !REFUSED.contains(&(kind.name, name, value))
            && settings.iter().all(|(section, field, _)| {
                *section != "controller" || rules.iter().any(|rule| rule.name == *field)
            })
    };
    let value = |(name, settings): &(&'static str, &'static [Setting])| Value {
        name,
        settings: settings
            .iter()
            .map(|(section, field, text)| (*section, *field, (*text).to_owned()))
            .collect(),
    };
    Axis {
        name,
        values: values.iter().filter(is_taken).map(value).collect(),
    }
}

/// Options of some kind without an axis.
pub fn untested_options() -> Vec<&'static str> {
    let mut untested: Vec<&str> = vec![];
    for known in &KINDS {
        let axes = kind(known.name).axes;
        let settings: Vec<_> = axes
            .iter()
            .flat_map(|axis| &axis.values)
            .flat_map(|value| &value.settings)
            .collect();
        let is_set = |option: &str| settings.iter().any(|(_, field, _)| *field == option);
        let elsewhere = |option: &str| TRIED_ELSEWHERE.iter().any(|(name, _)| *name == option);
        let choices = known
            .rules()
            .into_iter()
            .filter(|rule| rule.words().len() != 1);
        let options = choices.map(|rule| rule.name);
        untested.extend(options.filter(|option| !is_set(option) && !elsewhere(option)));
    }
    untested
}

impl Kind {
    fn bound(&self) -> &[Axis] {
        &self.axes[..self.axes.len() - self.loose]
    }

    fn loose(&self) -> &[Axis] {
        &self.axes[self.axes.len() - self.loose..]
    }

    /// The number of elements of the full product of the options that depend on each other.
    pub fn product_len(&self) -> usize {
        combinations(self.bound())
    }

    /// Element `index` of the full product of the options that depend on each other. The
    /// independent ones take a combination each, by a hash of the index, so that values of both
    /// meet in any order.
    pub fn product_element(&self, index: usize) -> Choice {
        // Knuth's multiplicative hash; its upper bits are the mixed ones.
        let hash = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        let turn = hash as usize % combinations(self.loose());
        [digits(self.bound(), index), digits(self.loose(), turn)].concat()
    }

    /// The values of independent options in a choice, each with every other option's value.
    pub fn meetings(&self, choice: &[usize]) -> Vec<Meeting> {
        let mut values: Vec<(usize, usize)> = choice.iter().copied().enumerate().collect();
        let loose = values.split_off(self.bound().len());
        let met = |of: (usize, usize)| values.iter().map(move |value| (of, *value));
        loose.into_iter().flat_map(met).collect()
    }

    /// All such pairs of values of this kind.
    pub fn all_meetings(&self) -> impl Iterator<Item = Meeting> {
        let values = |(axis, values): (usize, &Axis)| {
            (0..values.values.len()).map(move |value| (axis, value))
        };
        let axes = self.axes.iter().enumerate();
        let loose = axes.clone().skip(self.bound().len()).flat_map(values);
        let bound = axes.take(self.bound().len());
        let meetings = loose.flat_map(move |of| {
            let others = bound.clone().flat_map(values);
            others.map(move |value| (of, value))
        });
        let name = |(axis, value): (usize, usize)| {
            let axis = &self.axes[axis];
            (axis.name, axis.values[value].name)
        };
        meetings.filter(move |&(of, other)| !APART.contains(&[name(of), name(other)]))
    }

    /// The choice with the first value of every axis except the named ones: `[("emf", "model")]`.
    ///
    /// # Panics
    /// If there is no such axis or value.
    pub fn choice_of(&self, settings: &[(&str, &str)]) -> Choice {
        let mut choice = vec![0; self.axes.len()];
        for (name, value) in settings {
            let found = self.axes.iter().position(|axis| axis.name == *name);
            let axis = found.expect("an axis of this name");
            let mut values = self.axes[axis].values.iter();
            choice[axis] = values
                .position(|known| known.name == *value)
                .expect("a value of this name");
        }
        choice
    }

    /// `pdcc: modulation=pair saturation=nearest …`
    pub fn describe(&self, choice: &[usize]) -> String {
        let axes = self.axes.iter().zip(choice);
        let values =
            axes.map(|(axis, &value)| format!("{}={}", axis.name, axis.values[value].name));
        format!("{}: {}", self.name, values.collect::<Vec<_>>().join(" "))
    }

    /// The motor's file with this controller and its options, and another type name.
    ///
    /// # Panics
    /// If the motor file is no TOML or not right.
    pub fn drive_toml(&self, motor: &Motor, choice: &[usize], type_name: Option<&str>) -> String {
        let mut document: DocumentMut = motor.text.parse().expect("a TOML file");
        let text = |value: &str| -> Item {
            format!("x = {value}")
                .parse::<DocumentMut>()
                .expect("a TOML value")["x"]
                .clone()
        };
        let supply = LazyCell::new(|| Supply::known(&motor.text));
        let volts = |share: f64| text(&format!("\"{} V\"", supply.bus * share));
        let amperes = |share: f64| text(&format!("\"{} A\"", supply.range * share));
        document["controller"] = Item::Table(Table::new());
        document["controller"]["kind"] = text(&format!("\"{}\"", self.name));
        for (axis, &value) in self.axes.iter().zip(choice) {
            for (section, field, setting) in &axis.values[value].settings {
                // What a motor's file assumes is stated now.
                if let Some(assumed) = document.get_mut("assumed")
                    && let Some(table) = assumed[*section].as_table_like_mut()
                {
                    table.remove(field);
                }
                document[*section][*field] = match setting.as_str() {
                    BUS_RANGE => volts(1.6),
                    FADE => volts(supply.fade),
                    DRAWN => amperes(0.1),
                    RETURNED => amperes(0.04),
                    OVER_SPEED => text(&format!("\"{} rpm\"", 1.25 * supply.speed)),
                    _ => text(setting),
                };
            }
        }
        // With an angle nothing is to be said of Hall sensors.
        if document["motor"].get("rotor").is_some() {
            for (section, field) in OF_HALLS {
                let table = document[section].as_table_like_mut();
                table.expect("a table").remove(field);
            }
        }
        if let Some(name) = type_name {
            document["motor"]["name"] = text(&format!("\"{name}\""));
        }
        document.to_string()
    }
}

/// Values of the axes, by index: the last axis varies fastest.
fn digits(axes: &[Axis], mut index: usize) -> Choice {
    let mut choice: Choice = axes
        .iter()
        .rev()
        .map(|axis| {
            let value = index % axis.values.len();
            index /= axis.values.len();
            value
        })
        .collect();
    choice.reverse();
    choice
}

fn combinations(axes: &[Axis]) -> usize {
    axes.iter().map(|axis| axis.values.len()).product()
}

/// Supplies of the motor files so far; to check a file takes longer than all else.
static SUPPLIES: Mutex<BTreeMap<String, Supply>> = Mutex::new(BTreeMap::new());

/// Numbers of a motor file, of which its board may have written a part.
#[derive(Clone, Copy)]
struct Supply {
    /// Volt.
    bus: f64,
    /// Range of the ADCs, ampere.
    range: f64,
    /// [`FADE`] over the bus.
    fade: f64,
    /// Rated, rpm.
    speed: f64,
}

impl Supply {
    fn known(text: &str) -> Self {
        let known = || SUPPLIES.lock().expect("no thread panics with it");
        let found = known().get(text).copied();
        found.unwrap_or_else(|| {
            let supply = Self::of(text);
            known().insert(text.to_owned(), supply);
            supply
        })
    }

    fn of(text: &str) -> Self {
        let ast = parse_toml(text, "motor.toml");
        let has_board = ast.as_ref().is_ok_and(|ast| ast.board.is_some());
        let checked = ast.and_then(|ast| check(&ast));
        let (spec, _) = checked.unwrap_or_else(|errors| panic!("{errors}"));
        let inverter = spec.inverter;
        Self {
            bus: inverter.v_bus,
            range: inverter.adc_gain.abs() * f64::from(1_u32 << (inverter.adc_bits - 1)),
            fade: if has_board { 0.05 } else { 0.25 },
            speed: spec.motor.rated_speed * 60.0 / TAU,
        }
    }
}

/// The generator's result for a TOML text.
///
/// # Errors
/// Its diagnostics.
pub fn generate_toml(text: &str) -> Result<(Spec, Generated), Diagnostics> {
    let ast = parse_toml(text, "drive.toml")?;
    let (spec, origins) = check(&ast)?;
    let generated = generate(&spec, &origins)?;
    Ok((spec, generated))
}
