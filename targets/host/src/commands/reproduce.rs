//! `hexagen reproduce`: the paper's experiment, its claims and a page with its figures.
//!
//! Both readings of each controller are generated drives in closed loop on the paper's motor.

use super::report::FOLDER;
use crate::cli::{Bar, Failure, TextTable, print_text};
use crate::report;
use crate::report::reproduction;
use clap::Args;
use hexagen_lab::reproduction::{
    CLOCK_HZ, Effort, Method, Reading, Reproduction, TIMES_TEXT, reproduce,
};
use hexagen_lab::text::significant;
use std::path::PathBuf;

/// Options of `reproduce`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// Folder of the page [default: target/hexagen]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// A drive or its plant that cannot be, or a page that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let folder = options.out.clone().unwrap_or_else(|| PathBuf::from(FOLDER));
    report::prepare_folder(&folder)?;
    let data = reproduce(&Effort::full(), &Bar::default())?;
    print_text(&summary(&data))?;
    let page = reproduction::write(&data, &folder)?;
    print_text(&format!("Page: {}", page.display()))
}

/// The claims and Table 5, as text.
pub fn summary(data: &Reproduction) -> String {
    let head = format!(
        "{}: {} Nm, {} V bus, Ts {} us, {}-bit ADC; figures are FCS-MPC / PDCC / PHCC / PI-PWM",
        data.motor.description,
        significant(data.torque, 3),
        significant(data.inverter.v_bus, 3),
        significant(data.inverter.t_s * 1e6, 3),
        data.inverter.adc_bits
    );
    let claims = data.claims();
    let header = ["claim", "literal reading", "corrected reading", "verdict"];
    let mut table = TextTable::new(4, header);
    for claim in &claims {
        let [literal, corrected] = claim.figures.clone();
        table.row([
            format!("({}) {}", claim.letter, claim.text),
            literal.replace("; ", "\n"),
            corrected.replace("; ", "\n"),
            claim.verdict().text().to_owned(),
        ]);
    }
    let reasons = claims
        .iter()
        .map(|claim| format!("({}) {}", claim.letter, claim.reason()));
    let parts = [table.wrapped(0, 48).render()].into_iter().chain(reasons);
    let parts: Vec<String> = [head].into_iter().chain(parts).collect();
    format!("{}\n\n{}", parts.join("\n"), table_5(data))
}

/// Table 5 and what its times are reckoned from.
fn table_5(data: &Reproduction) -> String {
    let [low, high] = data.speeds_rpm;
    let mut table = TextTable::new(
        2,
        [
            "method".to_owned(),
            "reading".to_owned(),
            "instructions".to_owned(),
            "worst".to_owned(),
            "T_c us".to_owned(),
            "worst".to_owned(),
            "T_f us".to_owned(),
            format!("f_sw kHz, {low:.0} rpm"),
            format!("{high:.0} rpm"),
        ],
    );
    for method in Method::ALL {
        for reading in Reading::ALL {
            let run = data.methods[method.index()].of(reading);
            let times = run.times(data.inverter.t_s);
            let microseconds = |time: f64| format!("{:.1}", 1e6 * time);
            let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
            let switching = run.points.iter().map(|point| {
                let kilohertz = point.figures.switching_hz.map(|hertz| hertz / 1e3);
                or_dash(kilohertz.map(|figure| format!("{figure:.1}")))
            });
            let cells = [
                method.name().to_owned(),
                reading.name().to_owned(),
                or_dash(run.usual_instructions().map(|count| count.to_string())),
                run.cost.worst.to_string(),
                or_dash(times.usual.map(microseconds)),
                microseconds(times.worst),
                microseconds(times.free),
            ];
            table.row(cells.into_iter().chain(switching));
        }
    }
    format!("{}\n{TIMES_TEXT}; {} MHz.", table.render(), CLOCK_HZ / 1e6)
}
