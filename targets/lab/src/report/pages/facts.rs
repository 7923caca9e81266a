//! Subject of the report: heading, motor, inverter, and derived quantities.

use super::phase_keys;
use super::shapes::emf_shape;
use crate::report::{Block, Cell, Column, Figure, Table};
use crate::results::Results;
use crate::text::{demanded, grouped, number, quantity};
use hexagen_codegen::spec::{BusSource, CurrentSensing, EmfShape};
use std::f64::consts::TAU;

/// The page's title.
pub fn title(data: &Results) -> String {
    format!("{}: current controllers in fixed point", motor_name(data))
}

/// The motor's name.
pub fn motor_name(data: &Results) -> &str {
    if data.motor.description.is_empty() {
        &data.name
    } else {
        &data.motor.description
    }
}

/// The sentences below the heading.
pub fn opening(data: &Results) -> Vec<Block> {
    let own = data.own.as_ref().map(|own| &own.judgement);
    let reach = own.map_or(data.torque, |own| own.greatest_torque_nm);
    let lead = format!(
        "Predictive current controllers for this motor, generated as fixed-point code and simulated in closed loop: \
         {}-bit current samples every {}, {} demanded.",
        data.inverter.adc_bits,
        quantity(data.inverter.t_s, "s"),
        demanded(data.torque, reach, |torque| quantity(torque, "Nm"))
    );
    let check = data.verification.as_ref().map(|check| {
        let (steps, engine) = (grouped(check.steps), &check.engine);
        if check.mismatches == 0 && check.steps > 0 {
            format!(
                "**Bit for bit verified:** {steps} steps of {engine} code, all controllers of this page together, equal the bit-true model in every output and state bit."
            )
        } else {
            format!(
                "**Not verified:** {engine} code of {} controllers differs from the bit-true model ({steps} steps compared).",
                grouped(check.mismatches)
            )
        }
    });
    let check = check.map(Block::Prose);
    [Block::Lead(lead)].into_iter().chain(check).collect()
}

/// Tables of specified and derived quantities.
pub fn facts(data: &Results) -> Vec<Block> {
    let tables = Block::Tables(vec![
        table("Motor, per phase of the star", motor(data)),
        table("Inverter and sensors", inverter(data)),
        table("Derived", derived(data)),
    ]);
    let source = data.source.as_ref();
    let source = source.map(|source| Block::Note(format!("Data: {source}")));
    let shape = Figure::new(
        None,
        "EMF of the phases, in units of the amplitude E",
        emf_shape(data.motor.emf_shape),
    );
    let drawn = [
        Block::Legend(phase_keys(["phase a", "phase b", "phase c"])),
        Block::Figures {
            columns: 2,
            figures: vec![shape],
        },
    ];
    [tables].into_iter().chain(source).chain(drawn).collect()
}

fn table(title: &str, rows: Vec<(&str, String)>) -> Table {
    let mut table = Table::new("", [Column::text("Quantity"), Column::number("Value", "")]);
    title.clone_into(&mut table.title);
    for (name, value) in rows {
        table.row([Cell::from(name), Cell::from(value)]);
    }
    table
}

fn motor(data: &Results) -> Vec<(&'static str, String)> {
    let motor = &data.motor;
    let shape = match motor.emf_shape {
        EmfShape::Trapezoidal { flat_top_deg } => {
            format!("trapezoidal, {}\u{b0} flat top", number(flat_top_deg, 0))
        }
        EmfShape::Sinusoidal => "sinusoidal".to_owned(),
        EmfShape::Harmonics(_) => "of harmonics".to_owned(),
    };
    let mut rows = vec![
        ("Pole pairs", motor.pole_pairs.to_string()),
        ("Resistance", quantity(motor.resistance, "ohm")),
        ("Inductance", quantity(motor.inductance, "H")),
        (
            "EMF constant, peak",
            quantity(motor.emf_constant, "V\u{b7}s/rad"),
        ),
        ("EMF shape", shape),
        ("Rated current, peak", quantity(motor.rated_current, "A")),
    ];
    if let Some(torque) = motor.rated_torque {
        rows.push(("Rated torque", quantity(torque, "Nm")));
    }
    let rpm = motor.rated_speed * 60.0 / TAU;
    rows.push(("Rated speed", format!("{}\u{a0}rpm", number(rpm, 0))));
    if let Some(inertia) = motor.inertia {
        // Engineering prefixes do not combine with squares of kilograms and metres.
        rows.push(("Inertia", format!("{inertia:.3e}\u{a0}kg\u{b7}m\u{b2}")));
    }
    rows
}

fn inverter(data: &Results) -> Vec<(&'static str, String)> {
    let inverter = &data.inverter;
    let bus = match inverter.bus {
        BusSource::Fixed => quantity(inverter.v_bus, "V"),
        BusSource::Measured { min, max, .. } => format!(
            "{}, measured, {} to {}",
            quantity(inverter.v_bus, "V"),
            quantity(min, "V"),
            quantity(max, "V")
        ),
    };
    let half_range = inverter.adc_gain.abs() * f64::from(1_u32 << (inverter.adc_bits - 1));
    let sensors = match inverter.current_sensing {
        CurrentSensing::InPhase => "in the phases",
        CurrentSensing::LowSide(_) => "in the low legs",
    };
    let board = data.board.iter().map(|board| ("Board", board.clone()));
    let rows = [
        ("Bus voltage", bus),
        ("Control period", quantity(inverter.t_s, "s")),
        ("PWM frequency", quantity(1.0 / inverter.pwm_period(), "Hz")),
        (
            "Timer counts for full duty",
            inverter.timer_period.to_string(),
        ),
        ("Dead time", quantity(inverter.dead_time, "s")),
        ("Current sensors", sensors.to_owned()),
        (
            "Current ADCs",
            format!(
                "{} bits, \u{b1}{}",
                inverter.adc_bits,
                quantity(half_range, "A")
            ),
        ),
        ("One count", quantity(inverter.adc_gain.abs(), "A")),
        ("Trip level", quantity(inverter.trip_current, "A")),
    ];
    board.chain(rows).collect()
}

fn derived(data: &Results) -> Vec<(&'static str, String)> {
    let (motor, inverter) = (&data.motor, &data.inverter);
    let pole_pairs = f64::from(motor.pole_pairs);
    let per_volt = inverter.t_s / motor.inductance;
    let emf = motor.emf_shape.line_to_line_peak() * motor.emf_constant * motor.rated_speed;
    let degrees = motor.rated_turn(inverter.t_s);
    vec![
        ("Current for the demand", quantity(data.current, "A")),
        (
            "Torque per ampere",
            quantity(data.torque / data.current, "Nm/A"),
        ),
        (
            "Time constant L/R",
            quantity(motor.inductance / motor.resistance, "s"),
        ),
        (
            "Current change per volt and period",
            quantity(per_volt, "A"),
        ),
        (
            "Frequency at rated speed",
            quantity(motor.rated_speed * pole_pairs / TAU, "Hz"),
        ),
        (
            "Line EMF at rated speed",
            format!(
                "{} ({}\u{a0}% of bus)",
                quantity(emf, "V"),
                number(100.0 * emf / inverter.v_bus, 0)
            ),
        ),
        (
            "Angle per period, rated",
            format!("{}\u{b0} el.", number(degrees, 2)),
        ),
    ]
}
