//! Every option of a deadbeat drive with the values that are tested: the axes of the full product
//! and of the covering array.

use crate::library::Motor;
use hexagen_codegen::diagnostics::Diagnostics;
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{Spec, check, parse_toml};
use toml_edit::{DocumentMut, Item};

/// What an option value sets: section, field, TOML value.
type Setting = (&'static str, &'static str, &'static str);

/// One option and its values.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Name of the option.
    pub name: &'static str,
    /// Values: a short name, and the fields that it sets.
    pub values: &'static [(&'static str, &'static [Setting])],
}

/// Stands for a voltage of 1.6 times the motor's bus.
const BUS_RANGE: &str = "\"bus range\"";

/// The options of the drive: those of the controller, then those of the inverter.
pub const AXES: &[Axis] = &[
    Axis {
        name: "modulation",
        values: &[
            (
                "three_phase",
                &[("controller", "modulation", "\"three_phase\"")],
            ),
            ("pair", &[("controller", "modulation", "\"pair\"")]),
        ],
    },
    Axis {
        name: "saturation",
        values: &[
            (
                "keep_angle",
                &[("controller", "saturation", "\"keep_angle\"")],
            ),
            ("nearest", &[("controller", "saturation", "\"nearest\"")]),
            (
                "torque_priority",
                &[("controller", "saturation", "\"torque_priority\"")],
            ),
        ],
    },
    Axis {
        name: "emf",
        values: &[
            ("estimated", &[("controller", "emf", "\"estimated\"")]),
            (
                "filtered",
                &[
                    ("controller", "emf", "\"estimated\""),
                    ("controller", "emf_filter", "0.6"),
                ],
            ),
            ("model", &[("controller", "emf", "\"model\"")]),
        ],
    },
    Axis {
        name: "reference",
        values: &[
            (
                "quasi_square",
                &[("controller", "reference", "\"quasi_square\"")],
            ),
            (
                "proportional",
                &[("controller", "reference", "\"proportional\"")],
            ),
        ],
    },
    Axis {
        name: "advance",
        values: &[
            ("0", &[("controller", "advance", "0")]),
            ("1.5", &[("controller", "advance", "1.5")]),
            ("2", &[("controller", "advance", "2")]),
        ],
    },
    Axis {
        name: "delay",
        values: &[
            ("1", &[("controller", "delay", "1")]),
            ("0", &[("controller", "delay", "0")]),
        ],
    },
    Axis {
        name: "discretisation",
        values: &[
            ("exact", &[("controller", "discretisation", "\"exact\"")]),
            ("euler", &[("controller", "discretisation", "\"euler\"")]),
        ],
    },
    Axis {
        name: "word",
        values: &[
            ("32", &[("controller", "word", "32")]),
            ("16", &[("controller", "word", "16")]),
        ],
    },
    Axis {
        name: "hall_capture",
        values: &[
            ("sampled", &[("controller", "hall_capture", "\"sampled\"")]),
            ("timer", &[("controller", "hall_capture", "\"timer\"")]),
        ],
    },
    Axis {
        name: "v_bus",
        values: &[
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
    },
    Axis {
        name: "stall_timeout",
        values: &[
            ("none", &[]),
            ("100ms", &[("inverter", "stall_timeout", "\"100 ms\"")]),
        ],
    },
    Axis {
        name: "adc_inverted",
        values: &[
            ("off", &[]),
            ("on", &[("inverter", "adc_inverted", "\"on\"")]),
        ],
    },
    Axis {
        name: "start_up",
        values: &[
            ("plain", &[]),
            (
                "short",
                &[
                    ("inverter", "calibration_samples", "16"),
                    ("inverter", "precharge", "\"0 ms\""),
                ],
            ),
        ],
    },
];

/// One value per axis, as indices into [`AXES`].
pub type Choice = Vec<usize>;

/// The last so many axes are the inverter's; those before them are options of the controller.
pub const INVERTER_AXES: usize = 3;

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

/// The number of elements of the full product of the controller's options.
pub fn product_len() -> usize {
    combinations(&AXES[..AXES.len() - INVERTER_AXES])
}

/// Element `index` of the full product of the controller's options. The inverter's axes take a
/// combination each, in turn by the sum of the element's values, so that each of their combinations
/// meets every value of every other axis.
pub fn product_element(index: usize) -> Choice {
    let (controller, inverter) = AXES.split_at(AXES.len() - INVERTER_AXES);
    let mut choice = digits(controller, index);
    let turn = choice.iter().sum::<usize>() % combinations(inverter);
    choice.extend(digits(inverter, turn));
    choice
}

/// Number of the combination of the inverter's axes in a choice.
pub fn inverter_combination(choice: &[usize]) -> usize {
    let axes = AXES.iter().zip(choice).skip(AXES.len() - INVERTER_AXES);
    axes.fold(0, |number, (axis, value)| {
        number * axis.values.len() + value
    })
}

/// The choice with the first value of every axis but those named: `[("emf", "model")]`.
///
/// # Panics
/// When there is no such axis or value.
pub fn choice_of(settings: &[(&str, &str)]) -> Choice {
    let mut choice = default_choice();
    for (name, value) in settings {
        let axis = AXES
            .iter()
            .position(|axis| axis.name == *name)
            .expect("an axis of this name");
        choice[axis] = AXES[axis]
            .values
            .iter()
            .position(|(known, _)| known == value)
            .expect("a value of this name");
    }
    choice
}

/// The drive with all options at their defaults.
pub fn default_choice() -> Choice {
    AXES.iter()
        .map(|axis| {
            let default = match axis.name {
                "saturation" => "torque_priority",
                _ => axis.values[0].0,
            };
            axis.values
                .iter()
                .position(|(name, _)| *name == default)
                .unwrap_or(0)
        })
        .collect()
}

/// `modulation=pair saturation=nearest …`
pub fn describe(choice: &[usize]) -> String {
    let values = AXES
        .iter()
        .zip(choice)
        .map(|(axis, &value)| format!("{}={}", axis.name, axis.values[value].0));
    values.collect::<Vec<_>>().join(" ")
}

/// The motor's file with the options set and the type name replaced.
///
/// # Panics
/// When the motor file is no TOML or has no inverter.
pub fn drive_toml(motor: &Motor, choice: &[usize], type_name: Option<&str>) -> String {
    let mut document: DocumentMut = motor.text.parse().expect("a TOML file");
    let text = |value: &str| -> Item {
        format!("x = {value}")
            .parse::<DocumentMut>()
            .expect("a TOML value")["x"]
            .clone()
    };
    let bus_range = document_bus(&document) * 1.6;
    for (axis, &value) in AXES.iter().zip(choice) {
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
