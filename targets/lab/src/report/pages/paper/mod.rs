//! The page of the paper's experiment: its tables, figures and claims, in its order.

mod ideal;
mod measured;
mod tables;
mod verdicts;

use super::{Block, Page, Section};
use crate::reproduction::Reproduction;
use crate::text::{number, quantity};

/// Title of the page.
const TITLE: &str = "The paper's experiment, reproduced in fixed point";

/// The reproduced paper.
const PAPER: &str = "M. S. Trivedi, R. K. Keshri, \u{201c}Evaluation of Predictive Current Control Techniques for PM BLDC Motor in \
                     Stationary Plane\u{201d}, IEEE Access 2020, doi 10.1109/ACCESS.2020.2978695: its tables, figures and claims in \
                     its order, from generated controllers in closed loop.";

/// Indices of the two speeds.
const LOW: usize = 0;
const HIGH: usize = 1;

/// The page of the paper's experiment.
pub fn reproduction_page(data: &Reproduction) -> Page {
    Page {
        file: "reproduction".to_owned(),
        title: TITLE.to_owned(),
        heading: TITLE.to_owned(),
        opening: opening(data).to_vec(),
        sections: sections(data),
        generator: data.generator.clone(),
    }
}

/// Summary without a page: the claims with verdicts and reasons, the improvements, and Table 5.
pub fn reproduction_blocks(data: &Reproduction) -> Vec<Block> {
    let [_, setting] = opening(data);
    let verdicts = verdicts::summary(data);
    let all = [setting].into_iter().chain(verdicts);
    all.chain(verdicts::improvements(data))
        .chain(tables::table_5(data))
        .collect()
}

/// Tables and figures in the paper's order.
fn sections(data: &Reproduction) -> Vec<Section> {
    let computed = vec![
        Section::new("readings", "Readings", verdicts::readings(data)),
        Section::new("claims", "Claims", verdicts::claims(data)),
        Section::new(
            "table-1",
            "Table 1: reference and EMF corners",
            tables::table_1(data),
        ),
        Section::new("table-2", "Table 2: vectors", tables::table_2(data)),
        Section::new("table-3", "Table 3: switching table", tables::table_3(data)),
        Section::new("table-4", "Table 4: the motor", tables::table_4(data)),
        Section::new(
            "figure-2",
            "Figure 2: EMF, currents, Hall signals",
            ideal::figure_2(data),
        ),
        Section::new(
            "figure-3",
            "Figure 3: trajectories of EMF and current",
            ideal::figure_3(data),
        ),
        Section::new(
            "figure-4",
            "Figure 4: real trajectories",
            measured::figure_4(data),
        ),
        Section::new("figure-5", "Figure 5: vectors", ideal::figure_5(data)),
        Section::new(
            "figure-9",
            "Figure 9: twelve sectors",
            ideal::figure_9(data),
        ),
        Section::new(
            "figure-12",
            "Figures 12, 13: ideal current",
            ideal::figures_12_13(data),
        ),
    ];
    computed.into_iter().chain(of_runs(data)).collect()
}

/// Figures 14 to 20 and Table 5.
fn of_runs(data: &Reproduction) -> Vec<Section> {
    let at = |speed: usize, of: fn(&Reproduction, usize) -> Vec<Block>| {
        let (rpm, torque) = (
            number(data.speeds_rpm[speed], 0),
            quantity(data.torque, "Nm"),
        );
        let lead = Block::Lead(format!("{rpm}\u{a0}rpm, {torque} demanded."));
        [lead]
            .into_iter()
            .chain(of(data, speed))
            .collect::<Vec<_>>()
    };
    let (currents, torques) = (measured::currents, measured::torques);
    let trajectories = measured::trajectories;
    vec![
        Section::new(
            "figure-14",
            "Figure 14: phase current, low speed",
            at(LOW, currents),
        ),
        Section::new(
            "figure-15",
            "Figure 15: phase current, high speed",
            at(HIGH, currents),
        ),
        Section::new(
            "figure-16",
            "Figure 16: torque, low speed",
            at(LOW, torques),
        ),
        Section::new(
            "figure-17",
            "Figure 17: torque, high speed",
            at(HIGH, torques),
        ),
        Section::new(
            "figure-18",
            "Figure 18: trajectories, low speed",
            at(LOW, trajectories),
        ),
        Section::new(
            "figure-19",
            "Figure 19: trajectories, high speed",
            at(HIGH, trajectories),
        ),
        Section::new(
            "figure-20",
            "Figure 20: torque over speed",
            measured::figure_20(data),
        ),
        Section::new(
            "table-5",
            "Table 5: computation time and switching",
            tables::table_5(data),
        ),
        Section::new(
            "improvements",
            "Beyond the paper",
            verdicts::improvements(data),
        ),
    ]
}

fn opening(data: &Reproduction) -> [Block; 2] {
    let inverter = &data.inverter;
    let setting = format!(
        "{}: {}, {} bus, control period {}, {}-bit current ADCs, one period of delay; the shaft is held at its speed. Ripple and \
         harmonics are means of three starts (peak-to-peak ripple: the worst of them) over six electrical turns.",
        data.motor.description,
        quantity(data.torque, "Nm"),
        quantity(inverter.v_bus, "V"),
        quantity(inverter.t_s, "s"),
        inverter.adc_bits
    );
    [Block::Lead(PAPER.to_owned()), Block::Prose(setting)]
}
