//! Fields of motor and inverter that a file may leave to their defaults, with the values that they
//! have then.

use hexagen_codegen::spec::{BusSource, EmfShape, Spec, SpecAst, parse_toml};
use std::f64::consts::TAU;

/// A field with its value in a checked specification.
#[derive(Debug)]
pub struct Unstated {
    /// `motor` or `inverter`.
    pub section: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its value, as a file would state it.
    pub value: String,
    /// Lines of a file with another value, where none lies near: the default is 0, a word or a power
    /// of two.
    pub other: Option<String>,
}

impl Unstated {
    /// Whether the file states it, or its board's.
    pub fn is_stated_in(&self, ast: &SpecAst) -> bool {
        let board = ast.board.as_ref().and_then(|board| board.file.as_ref());
        let sections = [
            Some(&ast.motor),
            Some(&ast.inverter),
            board.map(|of| &of.inverter),
        ];
        let mut sections = sections.into_iter().flatten();
        sections.any(|of| of.field(self.name).is_some())
    }

    /// The specification with the default stated.
    pub fn stated(&self, ast: &SpecAst) -> SpecAst {
        stating(ast, self.section, &line(self.name, &self.value))
    }
}

/// A specification with further lines in a section.
pub fn stating(ast: &SpecAst, section: &str, lines: &str) -> SpecAst {
    let mut stated = ast.clone();
    if let Ok(more) = parse_toml(&format!("[{section}]\n{lines}"), "default.toml") {
        stated.motor.fields.extend(more.motor.fields);
        stated.inverter.fields.extend(more.inverter.fields);
    }
    stated
}

/// A field in a file. Lists stand there as they are, all else in quotes.
fn line(name: &str, value: &str) -> String {
    if value.starts_with('[') {
        format!("{name} = {value}\n")
    } else {
        format!("{name} = \"{value}\"\n")
    }
}

/// Fields of Hall sensors.
const OF_HALLS: [&str; 3] = ["hall_codes", "minimum_speed", "hall_glitches"];

/// The fields that have a default value; those without effect on this drive are left out.
pub fn unstated(spec: &Spec) -> Vec<Unstated> {
    let mut fields = of_motor(spec);
    fields.extend(of_inverter(spec));
    if spec.angle_sensor().is_some() {
        fields.retain(|field| !OF_HALLS.contains(&field.name));
    }
    fields
}

fn of_motor(spec: &Spec) -> Vec<Unstated> {
    let motor = &spec.motor;
    let percent = |share: f64| format!("{} %", rounded(100.0 * share));
    let field = |name, value| near("motor", name, value);
    let mut fields = vec![
        field("inductance_tolerance", percent(motor.inductance_tolerance)),
        field("resistance_tolerance", percent(motor.resistance_tolerance)),
        field("hall_codes", format!("{:?}", motor.hall_codes)),
    ];
    if let EmfShape::Trapezoidal { flat_top_deg } = motor.emf_shape {
        fields.push(field("flat_top", format!("{flat_top_deg} deg")));
    }
    fields
}

fn of_inverter(spec: &Spec) -> Vec<Unstated> {
    let inverter = &spec.inverter;
    let field = |name, value| near("inverter", name, value);
    let ampere = |name, value: f64| field(name, format!("{value} A"));
    let rpm = |name, speed: f64| field(name, format!("{} rpm", rounded(speed * 60.0 / TAU)));
    let time = |name, value: f64, other| of_zero(field(name, format!("{value} s")), value, other);
    let tolerance = f64::from(inverter.offset_tolerance) * inverter.adc_gain.abs();
    let samples = 1_u32 << inverter.calibration_log2;
    let mut fields = vec![
        field("pwm_per_control", inverter.pwm_per_control.to_string()),
        time("dead_time", inverter.dead_time, "500 ns"),
        time("minimum_low_time", inverter.minimum_low_time, "1 us"),
        field("adc_offset", inverter.adc_offset.to_string()),
        far(field("sensed_phases", "ab".to_owned()), "bc"),
        ampere("offset_tolerance", tolerance),
        ampere("trip_current", inverter.trip_current),
        ampere("max_current", inverter.max_current),
        rpm("minimum_speed", inverter.minimum_speed),
        rpm("maximum_speed", inverter.maximum_speed),
        time(
            "stall_timeout",
            f64::from(inverter.stall_periods) * inverter.t_s,
            "500 ms",
        ),
        field("hall_glitches", inverter.hall_glitches.to_string()),
        far(
            field("calibration_samples", samples.to_string()),
            &(2 * samples).to_string(),
        ),
        time(
            "precharge",
            f64::from(inverter.precharge_periods) * inverter.t_s,
            "1 ms",
        ),
    ];
    if let BusSource::Fixed = inverter.bus {
        let range = format!("{} V", 2.0 * inverter.v_bus);
        let more = line("bus_adc_bits", "12") + &line("bus_adc_range", &range);
        let mut bus = far(field("v_bus", "fixed".to_owned()), "measured");
        bus.other = bus.other.map(|other| other + &more);
        fields.push(bus);
    }
    fields
}

/// A number without the last digits of its conversion.
fn rounded(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

/// A field whose value can be changed a little.
fn near(section: &'static str, name: &'static str, value: String) -> Unstated {
    Unstated {
        section,
        name,
        value,
        other: None,
    }
}

/// A field with another value that is not near.
fn far(field: Unstated, other: &str) -> Unstated {
    Unstated {
        other: Some(line(field.name, other)),
        ..field
    }
}

/// A field with another value for a default of 0.
fn of_zero(field: Unstated, value: f64, other: &str) -> Unstated {
    if value == 0.0 {
        far(field, other)
    } else {
        field
    }
}
