//! `hexagen advise`: tries the controllers on a motor and its board, and recommends one.

use crate::cli::{Bar, Failure, paragraph, print_json, print_table, print_text};
use clap::Args;
use hexagen_codegen::diagnostics::engineering;
use hexagen_lab::advise::{Advice, DEVIATING_AT, OWN, Point, SPEEDS, Tried, Worst, advise};
use hexagen_lab::engine::{PlantOptions, SelectedMotor};
use hexagen_lab::report::{Column, Table};
use hexagen_lab::text::{significant, without_place};
use std::fmt::Write as _;

/// Options of `advise`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor file, or name of a library motor
    #[arg(value_name = "MOTOR")]
    pub motor: String,
    /// Board, a name of the library or a file [default: the motor file's]
    #[arg(long, value_name = "BOARD")]
    pub board: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// No such motor or board, or a motor of which no controller can be generated.
pub fn run(options: &Options) -> Result<(), Failure> {
    let on_board = PlantOptions::on_board(options.board.as_deref());
    let motor = SelectedMotor::find(&options.motor, &on_board)?;
    let advice = advise(&motor, &Bar::default())?;
    if options.json {
        return print_json(&advice);
    }
    print_table(&table(&advice))?;
    let speeds = SPEEDS.map(|share| share.to_string()).join(", ");
    print_text(&paragraph(&format!(
        "Torque: of the rated {}, or of what a stated limit of the bus current leaves of it (the percentages of `check` and `report` are of what `max_current` allows), at {speeds} % of rated speed, the worst of \
         them. Varied: at {DEVIATING_AT} % with R x 1.4, L x 0.75, L x 1.3, k_b x 1.1 and the bus 15 % low, each alone. Copper: the \
         loss in the windings, and switch: turn-ons of a switch, both at rated speed. Holds to: speed up to which those that are alike else hold the torque. Cycles: of the longest step, on the core \
         that is named or assumed.",
        engineering(advice.rated_torque_nm, "Nm"),
    )))?;
    for line in refusals(&advice) {
        print_text(&paragraph(&line))?;
    }
    for text in &advice.far_off {
        print_text(&paragraph(text))?;
    }
    print_text(&paragraph(&verdict(&advice)))
}

/// The reasons of variants that the file does not allow as it stands, each once.
fn refusals(advice: &Advice) -> Vec<String> {
    let reasons = advice.tried.iter().filter_map(|tried| {
        let line = without_place(tried.refused.as_ref()?.lines().next()?);
        let (_, reason) = line.split_once("]: ").unwrap_or(("", line));
        let reason = reason.strip_prefix("`kind`: ").unwrap_or(reason);
        let code = tried.refused_by.as_deref().unwrap_or("refused");
        Some(format!("Not as the file stands ({code}): {reason}"))
    });
    let mut reasons: Vec<String> = reasons.collect();
    reasons.sort();
    reasons.dedup();
    reasons
}

fn verdict(advice: &Advice) -> String {
    let Some(recommended) = advice.recommended else {
        return format!("{}: {}", advice.motor, advice.reason);
    };
    let variant = advice.tried[recommended].variant;
    let (motor, mut reason) = (&advice.motor, advice.reason.clone());
    if let Some(periods) = advice.pwm_per_control {
        reason = format!(
            "no variant that fits the file's control period suits the motor, so all were tried with a command every {periods} \
             PWM periods; {reason}"
        );
    }
    if let Some(ripples) = &advice.ripples {
        let _ = write!(reason, "; {ripples}");
    }
    let slower = advice.pwm_per_control.map_or(String::new(), |periods| {
        format!("\n  [inverter]\n  pwm_per_control = {periods}")
    });
    if variant == OWN {
        let slower = if slower.is_empty() {
            slower
        } else {
            format!("\nIn the motor file:{slower}")
        };
        return format!("{motor}: the motor file's own controller. Why: {reason}.{slower}");
    }
    let (kind, options) = variant.split_once(':').unwrap_or((variant, ""));
    let options = options
        .split(',')
        .filter_map(|option| option.split_once('='));
    let lines: Vec<String> = [("kind", kind)]
        .into_iter()
        .chain(options)
        .chain(
            advice
                .kept
                .iter()
                .map(|(name, value)| (name.as_str(), value.as_str())),
        )
        .map(|(name, value)| match value.parse::<f64>() {
            Ok(_) => format!("  {name} = {value}"),
            Err(_) => format!("  {name} = \"{value}\""),
        })
        .collect();
    let left_out: Vec<String> = advice
        .left_out
        .iter()
        .map(|name| format!("`{name}`"))
        .collect();
    let left_out = if left_out.is_empty() {
        String::new()
    } else {
        format!(
            "\nTried without the file's {}: add what this controller takes.",
            left_out.join(", ")
        )
    };
    format!(
        "{motor}: {variant}. Why: {reason}.\nIn the motor file:{slower}\n  [controller]\n{}{left_out}",
        lines.join("\n")
    )
}

fn table(advice: &Advice) -> Table {
    let numbers = [
        "torque %",
        "ripple %",
        "varied torque %",
        "varied ripple %",
        "copper W",
        "switch kHz",
        "holds to %",
        "cycles",
    ];
    let numbers = numbers.map(|name| Column::number(name, ""));
    let columns = [Column::text("controller")].into_iter().chain(numbers);
    let mut table = Table::new("", columns.chain([Column::text("why not")]));
    for (place, tried) in advice.tried.iter().enumerate() {
        let why_not = if advice.recommended == Some(place) {
            "recommended".to_owned()
        } else {
            tried.why_not.clone().unwrap_or_default()
        };
        let mut row = vec![tried.variant.to_owned()];
        row.extend(figures(tried));
        row.push(why_not);
        table.row(row);
    }
    table
}

fn figures(tried: &Tried) -> [String; 8] {
    let shown = |value: Option<f64>| value.map_or("-".to_owned(), |value| significant(value, 3));
    let of = |points: &[Point]| {
        let worst = Worst::of(points);
        [
            shown(worst.map(|worst| worst.torque_pct)),
            shown(worst.map(|worst| worst.ripple_pct)),
        ]
    };
    let ([torque, ripple], [deviating, rough]) = (of(&tried.nominal), of(&tried.deviating));
    let rated = tried.nominal.last();
    [
        torque,
        ripple,
        deviating,
        rough,
        shown(rated.and_then(|point| point.copper_w)),
        shown(
            rated
                .and_then(|point| point.switching_hz)
                .map(|hz| hz / 1e3),
        ),
        shown(tried.limit_pct),
        tried
            .cycles
            .map_or("-".to_owned(), |count| count.to_string()),
    ]
}
