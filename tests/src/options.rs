//! Every option of a drive with the values that are tested, by kind of controller: the axes of the
//! full products and of the covering arrays.
//!
//! Which kinds there are and which options they take says the generator's own table: a new kind has
//! its axes at once.

use crate::library::{Motor, motor};
use hexagen_codegen::diagnostics::Diagnostics;
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::KINDS;
use hexagen_codegen::spec::{Spec, check, parse_toml};
use toml_edit::{DocumentMut, Item, Table};

/// What an option value sets: section, field, TOML value.
type Setting = (&'static str, &'static str, &'static str);

/// A value of an option: a short name, and the fields that it sets.
type Value = (&'static str, &'static [Setting]);

/// An option with values, as it is written down here.
type Row = (&'static str, &'static [Value]);

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
    /// The options that depend on each other, then the loose ones.
    pub axes: Vec<Axis>,
    /// The number of loose ones.
    loose: usize,
}

/// One value per axis of a kind, as indices.
pub type Choice = Vec<usize>;

/// Number of a combination of loose options, with the value of another axis (their numbers).
pub type Meeting = (usize, (usize, usize));

/// Stands for a voltage of 1.6 times the motor's bus.
const BUS_RANGE: &str = "\"bus range\"";

/// Values that a kind does not have in this version: kind, option, value.
const UNAVAILABLE: &[(&str, &str, &str)] = &[
    ("pi-pwm", "modulation", "pair"),
    ("phcc", "candidates", "all"),
    ("fcs-mpc", "emf", "integral"),
    ("phcc", "emf", "integral"),
    ("pi-pwm", "emf", "integral"),
    ("pi-pwm", "emf", "held"),
];

/// Defaults that are left unstated, because another option rules their statement out: kind, option, value.
const UNSTATED: &[(&str, &str, &str)] = &[
    ("pi-pwm", "feed_forward", "on"),
    ("pi-pwm", "saturation", "nearest"),
];

/// A switching table that no derivation gives: every vector occurs.
const SWITCHING_TABLE: &str = "[0, 3, 5, 12, 9, 15, 2, 6, 13, 8, 11, 1, 14, 7, 4, 10, \
    2, 2, 9, 9, 0, 13, 6, 12, 3, 8, 1, 11, 10, 5, 14, 7, 4, 0, 15, 3, 12, 6, 8, 1, 9, 10, 13, 2, 5, 11, 7, 4]";

/// Options that not all kinds take, the default value first, or the one that has most to compute.
const OWN: &[Row] = &[
    (
        "modulation",
        &[
            (
                "three_phase",
                &[("controller", "modulation", "\"three_phase\"")],
            ),
            ("pair", &[("controller", "modulation", "\"pair\"")]),
        ],
    ),
    (
        "saturation",
        &[
            (
                "torque_priority",
                &[("controller", "saturation", "\"torque_priority\"")],
            ),
            (
                "keep_angle",
                &[("controller", "saturation", "\"keep_angle\"")],
            ),
            ("nearest", &[("controller", "saturation", "\"nearest\"")]),
        ],
    ),
    (
        "candidates",
        &[
            ("table2", &[("controller", "candidates", "\"table2\"")]),
            (
                "three_phase",
                &[("controller", "candidates", "\"three_phase\"")],
            ),
            ("all", &[("controller", "candidates", "\"all\"")]),
        ],
    ),
    (
        "off_leg",
        &[
            // Not stated: without delay PHCC predicts nothing.
            ("physical", &[]),
            ("nominal", &[("controller", "off_leg", "\"nominal\"")]),
        ],
    ),
    (
        // What is chosen, and by which cost.
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
        "table",
        &[
            ("derived", &[]),
            ("printed", &[("controller", "table", "\"printed\"")]),
            ("given", &[("controller", "table", SWITCHING_TABLE)]),
        ],
    ),
    (
        "feed_forward",
        &[
            ("on", &[("controller", "feed_forward", "\"on\"")]),
            ("off", &[("controller", "feed_forward", "\"off\"")]),
        ],
    ),
    (
        "six_step",
        &[
            ("off", &[]),
            ("on", &[("controller", "six_step", "\"on\"")]),
        ],
    ),
];

/// Options that all kinds take.
const SHARED: &[Row] = &[
    (
        "emf",
        &[
            // Not stated: a PI loop without feed-forward has no say in it.
            ("estimated", &[]),
            ("unfiltered", &[("controller", "emf_filter", "1")]),
            ("model", &[("controller", "emf", "\"model\"")]),
            ("held", &[("controller", "emf", "\"held\"")]),
            (
                "integral",
                &[
                    ("controller", "emf", "\"model\""),
                    ("controller", "integral", "\"on\""),
                ],
            ),
        ],
    ),
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
        "discretisation",
        &[
            ("exact", &[("controller", "discretisation", "\"exact\"")]),
            ("euler", &[("controller", "discretisation", "\"euler\"")]),
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
        "hall_capture",
        &[
            ("sampled", &[("controller", "hall_capture", "\"sampled\"")]),
            ("timer", &[("controller", "hall_capture", "\"timer\"")]),
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
        ],
    ),
];

/// Options that no other option depends on, of the inverter and of the controllers that take them.
const LOOSE: &[Row] = &[
    (
        "tuning",
        &[
            ("default", &[]),
            (
                "slow",
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
        "stall_timeout",
        &[
            ("none", &[]),
            // And, where a timer tells the edges, a clock whose ticks do not divide the period.
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
            // Short enough for many a start-up.
            (
                "brief",
                &[
                    ("inverter", "calibration_samples", "16"),
                    ("inverter", "precharge", "\"0.2 ms\""),
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
    /// Options that have not the first value of their axis.
    pub settings: &'static [(&'static str, &'static str)],
}

impl Drive {
    /// Kind and motor.
    pub fn name(&self) -> String {
        format!("{} {}", self.kind, self.motor)
    }

    /// Its motor's file with its options, and another type name if one is given.
    pub fn toml(&self, type_name: Option<&str>) -> String {
        let kind = kind(self.kind);
        kind.drive_toml(
            &motor(self.motor),
            &kind.choice_of(self.settings),
            type_name,
        )
    }
}

/// All kinds of controllers.
pub fn kinds() -> Vec<Kind> {
    KINDS.iter().map(|(name, _)| kind(name)).collect()
}

/// The kind of this name.
///
/// # Panics
/// When there is none.
pub fn kind(name: &str) -> Kind {
    let known = KINDS.iter().find(|(known, _)| *known == name);
    let (name, own) = known.expect("a kind of controller");
    let is_taken = |row: &&Row| {
        let mut settings = row.1.iter().flat_map(|(_, settings)| *settings);
        settings.all(|(section, field, _)| {
            *section != "controller" || *field == "speed_loop" || own.contains(field)
        })
    };
    let loose = LOOSE.iter().filter(is_taken);
    let axes = OWN.iter().filter(is_taken).chain(SHARED);
    Kind {
        name,
        loose: loose.clone().count(),
        axes: axes.chain(loose).map(|row| axis(name, row)).collect(),
    }
}

fn axis(kind: &str, (name, values): &Row) -> Axis {
    let is_available = |value: &&Value| !UNAVAILABLE.contains(&(kind, *name, value.0));
    let stated = |value: &Value| {
        let is_unstated = UNSTATED.contains(&(kind, *name, value.0));
        if is_unstated {
            (value.0, &[][..])
        } else {
            *value
        }
    };
    Axis {
        name,
        values: values.iter().filter(is_available).map(stated).collect(),
    }
}

/// Options that no axis sets, but some kind takes.
pub fn untested_options() -> Vec<&'static str> {
    let rows = OWN
        .iter()
        .chain(SHARED)
        .chain(LOOSE)
        .flat_map(|(_, values)| *values);
    let settings: Vec<&Setting> = rows.flat_map(|(_, settings)| *settings).collect();
    let is_set = |option: &&str| settings.iter().any(|(_, field, _)| field == option);
    let options = KINDS.iter().flat_map(|(_, own)| *own).copied();
    options.filter(|option| !is_set(option)).collect()
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

    /// Element `index` of the full product of the options that depend on each other. The loose ones take a combination
    /// each, by a hash of the index, so that values of both meet in any order.
    pub fn product_element(&self, index: usize) -> Choice {
        // Knuth's multiplicative hash; its upper bits are the mixed ones.
        let hash = (index as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
        let turn = hash as usize % combinations(self.loose());
        self.with_loose(&digits(self.bound(), index), turn)
    }

    /// A choice with combination `number` of the loose options.
    pub fn with_loose(&self, choice: &[usize], number: usize) -> Choice {
        let bound = &choice[..self.bound().len()];
        [bound, &digits(self.loose(), number)].concat()
    }

    /// Number of the combination of the loose options in a choice, with every value of another
    /// axis that it meets there (number of the axis, and of the value).
    pub fn meetings(&self, choice: &[usize]) -> Vec<Meeting> {
        let (bound, loose) = choice.split_at(self.bound().len());
        let axes = self.loose().iter().zip(loose);
        let combination = axes.fold(0, |number, (axis, value)| {
            number * axis.values.len() + value
        });
        let values = bound.iter().copied().enumerate();
        values.map(|showing| (combination, showing)).collect()
    }

    /// All meetings.
    pub fn all_meetings(&self) -> impl Iterator<Item = Meeting> {
        let values = |(axis, values): (usize, &Axis)| {
            (0..values.values.len()).map(move |value| (axis, value))
        };
        (0..combinations(self.loose())).flat_map(move |combination| {
            let showings = self.bound().iter().enumerate().flat_map(values);
            showings.map(move |showing| (combination, showing))
        })
    }

    /// The choice with the first value of every axis but those named: `[("emf", "model")]`.
    ///
    /// # Panics
    /// When there is no such axis or value.
    pub fn choice_of(&self, settings: &[(&str, &str)]) -> Choice {
        let mut choice = vec![0; self.axes.len()];
        for (name, value) in settings {
            let found = self.axes.iter().position(|axis| axis.name == *name);
            let axis = found.expect("an axis of this name");
            let mut values = self.axes[axis].values.iter();
            choice[axis] = values
                .position(|(known, _)| known == value)
                .expect("a value of this name");
        }
        choice
    }

    /// `pdcc: modulation=pair saturation=nearest …`
    pub fn describe(&self, choice: &[usize]) -> String {
        let axes = self.axes.iter().zip(choice);
        let values = axes.map(|(axis, &value)| format!("{}={}", axis.name, axis.values[value].0));
        format!("{}: {}", self.name, values.collect::<Vec<_>>().join(" "))
    }

    /// The motor's file with this controller, the options set and the type name replaced.
    ///
    /// # Panics
    /// When the motor file is no TOML or has no bus voltage.
    pub fn drive_toml(&self, motor: &Motor, choice: &[usize], type_name: Option<&str>) -> String {
        let mut document: DocumentMut = motor.text.parse().expect("a TOML file");
        let text = |value: &str| -> Item {
            format!("x = {value}")
                .parse::<DocumentMut>()
                .expect("a TOML value")["x"]
                .clone()
        };
        let bus_range = document_bus(&document) * 1.6;
        document["controller"] = Item::Table(Table::new());
        document["controller"]["kind"] = text(&format!("\"{}\"", self.name));
        for (axis, &value) in self.axes.iter().zip(choice) {
            for (section, field, setting) in axis.values[value].1 {
                document[section][field] = if *setting == BUS_RANGE {
                    text(&format!("\"{bus_range} V\""))
                } else {
                    text(setting)
                };
            }
        }
        if let Some(name) = type_name {
            document["motor"]["name"] = text(&format!("\"{name}\""));
        }
        document.to_string()
    }
}

/// Values of the axes, by the number of their values: the last axis turns fastest.
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

/// The bus voltage of a motor file, volt.
fn document_bus(document: &DocumentMut) -> f64 {
    let stated = document
        .get("inverter")
        .and_then(|table| table.get("bus_voltage"));
    let assumed = || {
        let table = document.get("assumed")?.get("inverter")?;
        table.get("bus_voltage")?.get("value")
    };
    let text = stated
        .or_else(assumed)
        .and_then(Item::as_str)
        .expect("a bus voltage");
    let number = text.trim_end_matches('V').trim();
    number.parse().expect("a bus voltage in volt")
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
