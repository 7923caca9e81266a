//! The page of the paper's experiment: which sections it has, in which order.

use super::{ideal, measured, tables, verdicts};
use crate::report::ReportError;
use crate::report::document::{Section, document};
use crate::report::sections::{number, quantity};
use hexagen_lab::reproduction::Reproduction;
use maud::{Markup, html};

/// Title of the page.
const TITLE: &str = "The paper's experiment, reproduced in fixed point";

/// Places of the two speeds.
const LOW: usize = 0;
const HIGH: usize = 1;

/// The whole page.
///
/// # Errors
/// A plot that cannot be drawn.
pub fn render(data: &Reproduction) -> Result<String, ReportError> {
    let section = |id, title, content| Section { id, title, content };
    let at = |speed: usize| {
        let rpm = number(data.speeds_rpm[speed], 0);
        html! { p.lead { (rpm) "\u{a0}rpm, " (quantity(data.torque, "Nm")) " demanded." } }
    };
    let with_speed = |speed, content: Markup| html! { (at(speed)) (content) };
    let sections = [
        section("claims", "Claims", verdicts::claims(data)),
        section("readings", "Readings", verdicts::readings(data)),
        section(
            "table-1",
            "Table 1: reference and EMF corners",
            tables::table_1(data),
        ),
        section("table-2", "Table 2: vectors", tables::table_2(data)),
        section("table-3", "Table 3: switching table", tables::table_3(data)),
        section(
            "figure-2",
            "Figure 2: EMF, currents, Hall signals",
            ideal::figure_2(data)?,
        ),
        section(
            "figure-3",
            "Figure 3: trajectories of EMF and current",
            ideal::figure_3(data)?,
        ),
        section(
            "figure-4",
            "Figure 4: real trajectories",
            measured::figure_4(data)?,
        ),
        section(
            "figure-9",
            "Figure 9: twelve sectors",
            ideal::figure_9(data)?,
        ),
        section(
            "figure-12",
            "Figures 12, 13: ideal current",
            ideal::figures_12_13(data)?,
        ),
        section(
            "figure-14",
            "Figure 14: phase current, low speed",
            with_speed(LOW, measured::currents(data, LOW)?),
        ),
        section(
            "figure-15",
            "Figure 15: phase current, high speed",
            with_speed(HIGH, measured::currents(data, HIGH)?),
        ),
        section(
            "figure-16",
            "Figure 16: torque, low speed",
            with_speed(LOW, measured::torques(data, LOW)?),
        ),
        section(
            "figure-17",
            "Figure 17: torque, high speed",
            with_speed(HIGH, measured::torques(data, HIGH)?),
        ),
        section(
            "figure-18",
            "Figure 18: trajectories, low speed",
            with_speed(LOW, measured::trajectories(data, LOW)?),
        ),
        section(
            "figure-19",
            "Figure 19: trajectories, high speed",
            with_speed(HIGH, measured::trajectories(data, HIGH)?),
        ),
        section(
            "figure-20",
            "Figure 20: torque over speed",
            measured::figure_20(data)?,
        ),
        section(
            "table-5",
            "Table 5: computation time and switching",
            tables::table_5(data),
        ),
    ];
    Ok(document(TITLE, &heading(data), &sections, &data.generator))
}

fn heading(data: &Reproduction) -> Markup {
    html! {
        h1 { (TITLE) }
        p.lead {
            "M. S. Trivedi, R. K. Keshri, \u{201c}Evaluation of Predictive Current Control Techniques for PM BLDC Motor in Stationary Plane\u{201d}, IEEE Access 2020, doi 10.1109/ACCESS.2020.2978695: "
            "its tables, figures and claims in its order, from generated controllers in closed loop."
        }
        p {
            (data.motor.description) ": " (quantity(data.torque, "Nm")) ", " (quantity(data.inverter.v_bus, "V")) " bus, control period "
            (quantity(data.inverter.t_s, "s")) ", " (data.inverter.adc_bits) "-bit current converters, one period of delay; the shaft is held at its speed. "
            "Ripple and harmonics are means of three starts (peak-to-peak ripple: the worst of them) over six electrical turns."
        }
    }
}
