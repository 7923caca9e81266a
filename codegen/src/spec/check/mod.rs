//! The first barrier: from the syntax tree to a [`Spec`] in SI units, or all errors at once.
//!
//! Single fields first (`super::reader`), then motor, inverter and controller, then their relations
//! (`relations`, `consistency`). A value in error never causes a second error.

mod agreement;
mod angle;
mod consistency;
mod controller;
mod currents;
mod emf;
mod emf_shape;
mod inverter;
mod motor;
mod origins;
mod relations;
mod ripple;
mod sensing;
mod sensing_window;
mod trips;
mod whole_inverter;

pub(super) use inverter::FEWEST_COUNTS;
pub use origins::{Origin, Origins};

use self::inverter::Inverter;
use self::motor::Motor;
use super::reader::Reader;
use super::{Spec, SpecAst, fields};
use crate::diagnostics::{Code, Collector, Diagnostic, Diagnostics, catalogue};

/// Checks a specification and fills in every default.
///
/// # Errors
/// All errors, at the places where they were written.
pub fn check(ast: &SpecAst) -> Result<(Spec, Origins), Diagnostics> {
    let mut errors = Collector::new();
    errors.extend(ast.malformed.iter().cloned());
    check_name(ast, &mut errors);

    let fallback = &ast.name.location;
    let motor_reader = Reader::new("motor", &ast.motor, fields::MOTOR, fallback);
    let (whole_inverter, of_board) = ast.whole_inverter();
    errors.extend(of_board);
    let inverter_reader = Reader::new("inverter", &whole_inverter, fields::INVERTER, fallback);
    motor_reader.check_fields(&mut errors, |field, errors| {
        fields::misplaced("motor", field, errors)
    });
    let motor = motor::read(&motor_reader, &mut errors);
    inverter_reader.check_fields(&mut errors, |field, errors| {
        fields::misplaced("inverter", field, errors)
    });
    let mut inverter = inverter::read(&inverter_reader, &mut errors);
    let of_halls = ["hall_glitches", "minimum_speed"];
    angle::refuse_halls(&inverter_reader, motor.rotor, &of_halls, &mut errors);
    let whole_controller = ast.whole_controller();
    let (controller, capture) = controller::read(
        &whole_controller,
        fallback,
        (&motor, &inverter),
        in_error((&motor_reader, &motor), (&inverter_reader, &inverter)),
        &mut errors,
    );
    sensing::place_instant(
        &inverter_reader,
        &mut inverter,
        &motor,
        controller.as_ref(),
        &mut errors,
    );

    let mut warnings = vec![];
    let contradicts =
        consistency::check(&motor_reader, &motor, &inverter, &mut errors, &mut warnings);
    let decay = relations::check_period(&motor_reader, &motor, &inverter, &mut errors);
    check_gain(ast, &inverter, &mut warnings);
    relations::check_inertia(&motor_reader, &motor, &mut warnings);
    // A wrong R or L is told of once.
    if !contradicts && decay != Some(relations::Decay::Absurd) {
        // Torque and EMF in one wrong basis are one mistake.
        let context = (controller.as_ref(), ast.board_bus(), decay);
        relations::check_bus(&motor_reader, &motor, &inverter, context, &mut errors);
        if decay == Some(relations::Decay::ByResistance) && !errors.has(Code::BusTooLow) {
            relations::tell_long_period(&motor_reader, &motor, &inverter, &mut errors);
        }
    }
    sensing_window::check(
        &inverter_reader,
        &inverter,
        (controller.as_ref(), &whole_controller),
        &mut errors,
    );
    let finished = whole_inverter::inverter(
        &inverter_reader,
        &inverter,
        &motor,
        capture,
        controller.as_ref(),
        &mut errors,
        &mut warnings,
    );

    let period = inverter.period.as_ref().map(|period| &period.part);
    match (motor.finish(), finished, controller) {
        (Some(whole_motor), Some(inverter), Some(controller)) => {
            let spec = Spec {
                name: ast.name.text.clone(),
                motor: whole_motor,
                inverter,
                controller,
            };
            trips::check(&inverter_reader, &motor, &spec, &mut warnings);
            if let Some(period) = period {
                let reader = &inverter_reader;
                ripple::check(reader, &whole_controller, period, &spec, &mut warnings);
            }
            let origins = Origins::new(ast, &whole_inverter, &whole_controller, warnings);
            errors.into_result((spec, origins))
        }
        _ => Err(errors.finish().unwrap_or_else(|| {
            catalogue::internal(fallback, "a specification without errors is incomplete").into()
        })),
    }
}

/// A gain over that of the board from which on one of both is likely wrong.
const UNLIKE: f64 = 2.0;

/// Warns of a gain of the current sensors that is far from that of the board which the file names.
fn check_gain(ast: &SpecAst, inverter: &Inverter, warnings: &mut Vec<Diagnostic>) -> Option<()> {
    let board = ast.board.as_ref()?;
    let section = &board.file.as_ref()?.inverter;
    let reader = Reader::new("inverter", section, fields::INVERTER, &board.name.location);
    let of_board = inverter::gain(&reader, inverter.sensing.phases)?;
    let own = inverter.adc.as_ref()?;
    let ratio = own.gain / of_board.gain;
    if ratio.max(1.0 / ratio) > UNLIKE * (1.0 + 1e-9) {
        let gains = [own.gain, of_board.gain];
        warnings.push(catalogue::gain_unlike_board(
            &own.part,
            &of_board.part,
            gains,
        ));
    }
    Some(())
}

/// Fields that options need, and that are stated but in error.
fn in_error(
    (of_motor, motor): (&Reader, &Motor),
    (of_inverter, inverter): (&Reader, &Inverter),
) -> Vec<&'static str> {
    let is_read = [
        (of_motor, "inertia", motor.inertia.is_some()),
        (of_inverter, "dead_time", inverter.dead_time.is_some()),
    ];
    let is_wrong =
        |(reader, name, is_read): &(&Reader, &str, bool)| reader.field(name).is_some() && !is_read;
    let wrong = is_read.into_iter().filter(is_wrong);
    wrong.map(|(_, name, _)| name).collect()
}

fn check_name(ast: &SpecAst, errors: &mut Collector) {
    let name = &ast.name.text;
    let is_type_name = name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && name != "Self";
    if !is_type_name {
        errors.push(catalogue::invalid_name(&ast.name.location, name));
    }
}
