//! `hexagen new`: a commented motor file, from `FIELD=VALUE` arguments or from questions.
//!
//! On a terminal every field that has no default is asked for, unless it was given; elsewhere such a
//! field stands in the file to be filled in. On a board the inverter's fields that it states are left out.
//! The file is checked before it is written.

use crate::cli::{Failure, note, print_json, print_text};
use crate::files::write_new;
use clap::Args;
use hexagen_codegen::diagnostics::Code;
use hexagen_codegen::spec::{BOARDS, Board, check, parse_toml, section_of};
use hexagen_lab::LabError;
use serde::Serialize;
use std::fmt::Write as _;
use std::io::{BufRead, IsTerminal, Lines, StdinLock, Write};
use std::path::{Path, PathBuf};

/// Options of `new`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// The file to make, such as motors/hub.toml
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Values as the data sheet states them, such as `poles=16` or `"resistance=0.57 ohm terminal"`;
    /// `board=vesc-4` takes the inverter from a board of the library, or from a file whose path is
    /// relative to the new one
    #[arg(value_name = "FIELD=VALUE")]
    pub values: Vec<String>,
    /// Replace the file if it is there
    #[arg(long)]
    pub force: bool,
    /// Print one JSON object; asks nothing
    #[arg(long)]
    pub json: bool,
}

/// A line of the template.
struct Line {
    /// The fields that state it, the usual one first.
    fields: &'static [&'static str],
    about: &'static str,
    example: &'static str,
    is_needed: bool,
    default: Option<&'static str>,
}

const fn needed(
    fields: &'static [&'static str],
    about: &'static str,
    example: &'static str,
) -> Line {
    Line {
        fields,
        about,
        example,
        is_needed: true,
        default: None,
    }
}

impl Line {
    const fn optional(self) -> Self {
        Self {
            is_needed: false,
            ..self
        }
    }

    const fn or(self, default: &'static str) -> Self {
        Self {
            default: Some(default),
            ..self
        }
    }
}

const MOTOR: &[Line] = &[
    needed(&["description"], "Free text for the documentation.", "Rear hub drive").optional(),
    needed(
        &["poles", "pole_pairs"],
        "Magnet poles of the rotor; or pole_pairs, half as many.",
        "8",
    ),
    needed(
        &["resistance"],
        "per_phase (one winding) or terminal (between two terminals, \"phase to phase\").",
        "0.27 ohm terminal",
    ),
    needed(&["inductance"], "As the resistance.", "0.44 mH terminal"),
    needed(
        &["winding"],
        "star (wye) or delta; of use only where a value is per_phase.",
        "star",
    )
    .optional(),
    needed(
        &["back_emf", "speed_constant", "torque_constant"],
        "The EMF: back_emf with line_to_line or phase, and peak or rms; or speed_constant (rpm/V);\n\
         # or torque_constant with per_peak_ampere, per_rms_ampere or block_mean (Maxon).",
        "17.3 V/krpm line_to_line peak",
    ),
    needed(&["emf_shape"], "trapezoidal or sinusoidal.", "trapezoidal"),
    needed(
        &["rated_current"],
        "Continuous current of a phase: its peak, or rms.",
        "20 A",
    ),
    needed(
        &["rated_torque"],
        "Torque at rated current; checked against the EMF.",
        "3.3 Nm",
    )
    .optional(),
    needed(&["rated_speed"], "Speed under load at rated torque.", "2000 rpm"),
    needed(
        &["no_load_speed"],
        "Speed without load, with nominal_voltage where that is not the bus; checked against the EMF.",
        "2700 rpm",
    )
    .optional(),
    needed(&["nominal_voltage"], "Voltage of the no-load speed.", "48 V").optional(),
    needed(&["inertia"], "Of the rotor; needed for speed control.", "24 g cm2").optional(),
];

const INVERTER: &[Line] = &[
    needed(&["bus_voltage"], "Nominal supply of the inverter.", "48 V"),
    needed(
        &["f_pwm", "sampling_time"],
        "PWM frequency = control frequency.",
        "20 kHz",
    )
    .or("20 kHz"),
    needed(
        &["timer_clock", "timer_period"],
        "Clock of the centre-aligned PWM timer.",
        "72 MHz",
    ),
    needed(&["adc_bits"], "Bits of the phase-current ADCs.", "12").or("12"),
    needed(
        &["adc_range", "adc_gain", "shunt"],
        "Largest current of either sign that the ADC shows; or adc_gain, as 20 mA/LSB; or shunt with\n\
         # amplifier_gain and adc_reference.",
        "40 A",
    ),
    needed(
        &["current_sensing"],
        "in_phase (between legs and motor, as Hall-effect sensors are) or low_side (shunts below the low switches).",
        "in_phase",
    ),
    needed(&["dead_time"], "Of the gate driver, per edge.", "500 ns").optional(),
    needed(
        &["hall_timer_clock"],
        "Clock of a timer that captures Hall edges, if the board has one.",
        "1 MHz",
    )
    .optional(),
];

const CONTROLLER: &[Line] = &[needed(
    &["kind"],
    "pdcc, pi-pwm, fcs-mpc, phcc or p-pwm; `hexagen --help` lists their options.",
    "pdcc",
)
.or("pdcc")];

const SECTIONS: [(&str, &[Line]); 3] = [
    ("motor", MOTOR),
    ("inverter", INVERTER),
    ("controller", CONTROLLER),
];

/// The value that names a board; it stands above the sections.
const BOARD: &str = "board";

#[derive(Serialize)]
struct Made {
    file: PathBuf,
    missing: Vec<&'static str>,
    complete: bool,
}

/// Runs the command.
///
/// # Errors
/// A value in error; a file that is there, or cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    refuse_present(&options.file, options.force)?;
    let mut draft = Draft::of(given(&options.values)?, &options.file)?;
    if !options.json && std::io::stdin().is_terminal() {
        draft.ask(&options.file)?;
    }
    let missing = draft.missing();
    let text = draft.text();
    checked(&text, &options.file, missing.is_empty())?;
    write_new(&options.file, text.as_bytes(), options.force).map_err(|error| Failure::Write {
        path: options.file.clone(),
        reason: error.to_string(),
    })?;
    let file = options.file.display();
    if options.json {
        return print_json(&Made {
            file: options.file.clone(),
            complete: missing.is_empty(),
            missing,
        });
    }
    if missing.is_empty() {
        print_text(&format!("{file} is written; next: hexagen check {file}"))
    } else {
        print_text(&format!(
            "{file} is written; fill in {}, then: hexagen check {file}",
            missing.join(", ")
        ))
    }
}

fn refuse_present(file: &Path, force: bool) -> Result<(), Failure> {
    if file.exists() && !force {
        return Err(Failure::Argument(format!(
            "{} is there already; give another name, or --force to replace it",
            file.display()
        )));
    }
    Ok(())
}

type Values = Vec<(String, String)>;

/// `FIELD=VALUE` arguments.
fn given(arguments: &[String]) -> Result<Values, Failure> {
    let mut values = Values::new();
    for argument in arguments {
        let Some((name, value)) = argument.split_once('=') else {
            return Err(Failure::Argument(format!(
                "cannot read `{argument}`; write FIELD=VALUE, for example poles=8"
            )));
        };
        let (name, value) = (name.trim(), value.trim());
        if values.iter().any(|(other, _)| other == name) {
            return Err(Failure::Argument(format!(
                "`{name}` is given twice; keep one of the two"
            )));
        }
        values.push((name.to_owned(), value.to_owned()));
    }
    Ok(values)
}

/// A file in the making.
struct Draft {
    /// The name of a board or of its file, and the fields that it states.
    board: Option<(String, Vec<String>)>,
    values: Values,
}

impl Draft {
    /// A draft with these values; one may name a board.
    fn of(values: Values, file: &Path) -> Result<Self, Failure> {
        let (boards, values): (Values, Values) =
            values.into_iter().partition(|(name, _)| name == BOARD);
        let mut draft = Self {
            board: None,
            values,
        };
        if let Some((_, name)) = boards.into_iter().next() {
            draft.put_on(&name, file)?;
        }
        Ok(draft)
    }

    /// Takes the fields of a board of the library, or of a file beside the new one.
    fn put_on(&mut self, name: &str, file: &Path) -> Result<(), LabError> {
        let folder = file.parent().unwrap_or(Path::new(""));
        let mut board = Board::named(name.into())?;
        board.read(Path::new(""), folder)?;
        let fields = board.file.map(|file| {
            let fields = file.inverter.fields.into_iter();
            fields.map(|field| field.name).collect()
        });
        self.board = Some((name.to_owned(), fields.unwrap_or_default()));
        Ok(())
    }

    /// The lines of a section: all but those whose field the board states and nobody else.
    fn lines(&self, lines: &'static [Line]) -> impl Iterator<Item = &'static Line> {
        lines.iter().filter(|line| {
            let is_of_board = |(_, fields): &(String, Vec<String>)| {
                let states = |name: &&str| fields.iter().any(|field| field == name);
                line.fields.iter().any(states)
            };
            self.value_of(line).is_some() || !self.board.as_ref().is_some_and(is_of_board)
        })
    }

    fn all_lines(&self) -> impl Iterator<Item = &'static Line> {
        SECTIONS.iter().flat_map(|(_, lines)| self.lines(lines))
    }

    fn value_of(&self, line: &Line) -> Option<&(String, String)> {
        self.values
            .iter()
            .find(|(name, _)| line.fields.contains(&name.as_str()))
    }

    /// Needed fields without value and default.
    fn missing(&self) -> Vec<&'static str> {
        self.all_lines()
            .filter(|line| line.is_needed && line.default.is_none())
            .filter(|line| self.value_of(line).is_none())
            .map(|line| line.fields[0])
            .collect()
    }

    /// Asks for what is missing; an empty answer leaves it to be filled in.
    fn ask(&mut self, file: &Path) -> Result<(), Failure> {
        let mut answers = std::io::stdin().lock().lines();
        if self.board.is_none() {
            let known: Vec<&str> = BOARDS.iter().map(|board| board.name).collect();
            note(&format!(
                "The board, or its file: {}; empty for none of them.",
                known.join(", ")
            ));
            loop {
                match answer(&mut answers, "vesc-4")? {
                    None => return Ok(()),
                    Some(board) if board.is_empty() => break,
                    Some(board) => match self.put_on(&board, file) {
                        Ok(()) => break,
                        Err(error) => note(&error.to_string()),
                    },
                }
            }
        }
        let lines: Vec<&Line> = self.all_lines().collect();
        for line in lines {
            if !line.is_needed || line.default.is_some() || self.value_of(line).is_some() {
                continue;
            }
            note(&format!(
                "{}\n  {} ",
                line.about.replace("\n# ", " "),
                names(line)
            ));
            let Some(answer) = answer(&mut answers, line.example)? else {
                return Ok(());
            };
            let (name, value) = match answer.split_once('=') {
                Some((name, value)) => (name.trim(), value.trim()),
                None => (line.fields[0], answer.as_str()),
            };
            if !value.is_empty() {
                self.values.push((name.to_owned(), value.to_owned()));
            }
        }
        Ok(())
    }

    /// The file.
    fn text(&self) -> String {
        let mut text = String::from(
            "# A motor and its drive, for hexagen. Write values as the data sheet states them, with unit and basis.\n",
        );
        if let Some((board, _)) = &self.board {
            let _ = write!(
                text,
                "\n# Its fields stand in place of those that [inverter] lacks; `hexagen boards` lists the library.\n{}\n",
                entry(BOARD, board)
            );
        }
        for (section, lines) in SECTIONS {
            let _ = write!(text, "\n[{section}]\n");
            for line in self.lines(lines) {
                let _ = writeln!(text, "# {}", line.about);
                let entry = match (self.value_of(line), line.default) {
                    (Some((name, value)), _) => entry(name, value),
                    (None, Some(default)) => entry(line.fields[0], default),
                    (None, None) => format!("# {}", entry(line.fields[0], line.example)),
                };
                text.push_str(&entry);
                text.push('\n');
            }
            // What the template has no line for; an unknown field is told of as one of the motor.
            let more = self.values.iter().filter(|(name, _)| {
                let is_listed = self
                    .all_lines()
                    .any(|line| line.fields.contains(&name.as_str()));
                !is_listed && section_of(name).unwrap_or("motor") == section
            });
            for (name, value) in more {
                text.push_str(&entry(name, value));
                text.push('\n');
            }
        }
        text
    }
}

/// The next answer to a prompt; none at the end of the input.
fn answer(answers: &mut Lines<StdinLock>, example: &str) -> Result<Option<String>, Failure> {
    let mut prompt = std::io::stderr().lock();
    let _ = write!(prompt, "  (as {example}): ").and_then(|()| prompt.flush());
    let answer = answers.next().transpose();
    let answer =
        answer.map_err(|error| Failure::Argument(format!("cannot read the answer: {error}")))?;
    Ok(answer.map(|answer| answer.trim().to_owned()))
}

fn names(line: &Line) -> String {
    match line.fields {
        [one] => (*one).to_owned(),
        [one, others @ ..] => format!("{one}, or {}=…", others.join("=… or ")),
        [] => String::new(),
    }
}

/// `name = value`; numbers, flags and lists stand without quotes.
fn entry(name: &str, value: &str) -> String {
    let is_bare = value.parse::<i64>().is_ok()
        || value.parse::<f64>().is_ok_and(f64::is_finite)
        || ["true", "false"].contains(&value)
        || value.starts_with('[');
    if is_bare {
        format!("{name} = {value}")
    } else {
        format!("{name} = {}", toml_text(value))
    }
}

fn toml_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if letter.is_control() => quoted.push(' '),
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}

/// Whether what was given is right: what is missing is not wrong.
fn checked(text: &str, file: &Path, is_complete: bool) -> Result<(), Failure> {
    let name = file.display().to_string();
    let read = parse_toml(text, &name).and_then(|mut ast| {
        ast.read_board(Path::new(""), &name, &mut vec![])?;
        check(&ast).map(drop)
    });
    let Err(errors) = read else {
        return Ok(());
    };
    let wrong: Vec<String> = errors
        .into_iter()
        .filter(|error| is_complete || error.code != Code::MissingField)
        .map(|error| error.to_string())
        .collect();
    if wrong.is_empty() {
        return Ok(());
    }
    Err(LabError::Specification(format!("{}\nNothing was written.", wrong.join("\n"))).into())
}
