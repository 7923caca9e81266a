//! `hexagen new`: a commented motor file, from `FIELD=VALUE` arguments or from questions.
//!
//! On a terminal every field that has no default is asked for, unless it was given; elsewhere such a
//! field stands in the file to be filled in. On a board the inverter's fields that it states are left out.
//! Each answer and the file are checked before it is written.

mod template;

use crate::cli::{Failure, note, print_json, print_text};
use crate::files::write_new;
use clap::Args;
use hexagen_codegen::diagnostics::{Code, Diagnostic};
use hexagen_codegen::spec::{BOARDS, Board, check, parse_toml, section_of};
use hexagen_lab::LabError;
use hexagen_lab::text::without_place;
use serde::Serialize;
use std::fmt::Write as _;
use std::io::{self, BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};
use template::{ANGLE_POLE_PAIRS, Line, POLES, REFERENCE, SECTIONS};

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
    let asks = !options.json && std::io::stdin().is_terminal();
    if asks {
        // Before questions are asked in vain.
        checked(&draft.text(), &options.file, false).map_err(|wrong| refused(&wrong))?;
        draft.ask(&mut std::io::stdin().lock().lines(), &options.file)?;
    }
    let missing = draft.missing(&options.file);
    let text = draft.text();
    let wrong = checked(&text, &options.file, missing.is_empty());
    // Answers are not lost: what is wrong between them is corrected in the file.
    let wrong = match wrong {
        Err(wrong) if !asks => return Err(refused(&wrong)),
        wrong => wrong.err(),
    };
    write_new(&options.file, text.as_bytes(), options.force).map_err(|error| Failure::Write {
        path: options.file.clone(),
        reason: error.to_string(),
    })?;
    let file = options.file.display();
    if let Some(wrong) = wrong {
        note(&format!("{file} is written; correct it there:"));
        return Err(LabError::Specification(wrong).into());
    }
    if !options.json && !asks && !missing.is_empty() {
        note("nothing is asked without a terminal; give values as FIELD=VALUE arguments");
    }
    if let Some(assumed) = draft.assumed() {
        note(assumed);
    }
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

/// Lines of answers.
type Answers<'a> = dyn Iterator<Item = io::Result<String>> + 'a;

/// `FIELD=VALUE` arguments.
fn given(arguments: &[String]) -> Result<Values, Failure> {
    let mut values = Values::new();
    for argument in arguments {
        let Some((name, value)) = argument.split_once('=') else {
            return Err(Failure::Argument(format!(
                "cannot read `{argument}`; write FIELD=VALUE, for example poles=8"
            )));
        };
        let (name, value) = (name.trim(), unquoted(value));
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
    /// The name of a board or of its file, and the fields that it states with their values.
    board: Option<(String, Values)>,
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
            let fields = file.inverter.fields.into_iter().chain(file.core.fields);
            fields
                .map(|field| (field.name, field.value.to_string()))
                .collect()
        });
        self.board = Some((name.to_owned(), fields.unwrap_or_default()));
        Ok(())
    }

    /// The lines of a section: those that have a place beside the other values, but for those whose field
    /// the board states and nobody else.
    fn lines(&self, lines: &'static [Line]) -> impl Iterator<Item = &'static Line> {
        let has_place = |line: &Line| {
            line.only_with.is_none_or(|(field, value)| {
                let mut values = self.values.iter();
                values.any(|(name, given)| name == field && (value.is_empty() || given == value))
            }) || line.fields == REFERENCE && self.states_sensitivity()
        };
        lines.iter().filter(move |line| {
            let is_of_board = |(_, fields): &(String, Values)| {
                let states = |name: &&str| fields.iter().any(|(field, _)| field == name);
                line.fields.iter().any(states)
            };
            let is_stated = self.board.as_ref().is_some_and(is_of_board);
            self.values_of(line).next().is_some() || (has_place(line) && !is_stated)
        })
    }

    fn all_lines(&self) -> impl Iterator<Item = &'static Line> {
        SECTIONS.iter().flat_map(|(_, lines)| self.lines(lines))
    }

    /// What was given for a line: one of its fields, or several, as two constants of one EMF.
    fn values_of(&self, line: &Line) -> impl Iterator<Item = &(String, String)> {
        self.values
            .iter()
            .filter(|(name, _)| line.fields.contains(&name.as_str()))
    }

    /// A value for a line.
    fn example(&self, line: &Line) -> String {
        let motors = self
            .pole_pairs()
            .filter(|_| line.fields == [ANGLE_POLE_PAIRS]);
        motors.map_or_else(|| line.example.to_owned(), |pairs| pairs.to_string())
    }

    /// Pole pairs of the motor, if they are given.
    fn pole_pairs(&self) -> Option<u32> {
        self.values.iter().find_map(|(name, value)| {
            let number: u32 = value.parse().ok()?;
            match name.as_str() {
                "pole_pairs" => Some(number),
                "poles" => Some(number / 2),
                _ => None,
            }
        })
    }

    /// What stands for a field, in the file or in that of its board.
    fn value(&self, name: &str) -> Option<&str> {
        let of_board = self.board.iter().flat_map(|(_, fields)| fields);
        let mut values = self.values.iter().chain(of_board);
        let (_, value) = values.find(|(field, _)| field == name)?;
        Some(value)
    }

    /// Whether the gain of the current sensors is one in volt per ampere, which takes the ADC's reference.
    fn states_sensitivity(&self) -> bool {
        let mut values = self.values.iter();
        values.any(|(name, given)| name == "adc_gain" && given.ends_with("V/A"))
    }

    /// What the times of three sensors say of their ADCs without naming them.
    fn assumed(&self) -> Option<&'static str> {
        let conversion = self.value("conversion_time")?;
        let number = conversion.trim_end_matches(|c: char| !c.is_ascii_digit());
        let is_at_once = number.parse() == Ok(0.0) && self.value("current_adcs").is_none();
        (is_at_once && self.value("sensed_phases") == Some("abc")).then_some(
            "conversion_time 0 of three sensors: an ADC for each is assumed, which all sample at once; state the time, and \
             current_adcs, where sensors share one",
        )
    }

    /// Fields without value and default that a drive needs, or that those which are given call for: the `winding` of
    /// a value per phase.
    fn missing(&self, file: &Path) -> Vec<&'static str> {
        let missing = errors(&self.text(), file).into_iter();
        let missing = missing.filter(|error| error.code == Code::MissingField);
        let missing: Vec<String> = missing.map(|error| error.message).collect();
        let is_missing = |line: &&Line| {
            let lacks = format!("lacks the field `{}`", line.fields[0]);
            line.is_needed || missing.iter().any(|message| message.contains(&lacks))
        };
        self.all_lines()
            .filter(|line| line.default.is_none() && self.values_of(line).next().is_none())
            .filter(is_missing)
            .map(|line| line.fields[0])
            .collect()
    }

    /// Asks for what is missing; an empty answer leaves it to be filled in.
    fn ask(&mut self, answers: &mut Answers, file: &Path) -> Result<(), Failure> {
        if self.board.is_none() {
            let known: Vec<&str> = BOARDS.iter().map(|board| board.name).collect();
            note(&format!(
                "The board, or its file: {}; empty for none of them.",
                known.join(", ")
            ));
            loop {
                match answer(answers, "vesc-4")? {
                    None => return Ok(()),
                    Some(board) if board.is_empty() => break,
                    Some(board) => match self.put_on(&board, file) {
                        Ok(()) => break,
                        Err(error) => note(&error.to_string()),
                    },
                }
            }
        }
        let mut asked: Vec<&str> = Vec::new();
        while let Some(line) = self.next_question(&asked, file) {
            let about = line.about.replace("\n# ", " ");
            let optional = if line.is_asked {
                ", empty to leave it out"
            } else {
                ""
            };
            note(&format!("{about}\n  {}{optional} ", names(line)));
            let Some(answer) = answer(answers, &self.example(line))? else {
                return Ok(());
            };
            let named = answer.split_once('=');
            let (name, value) = match named {
                Some((name, value)) => (name.trim(), unquoted(value)),
                None => (line.fields[0], unquoted(&answer)),
            };
            let is_bare = named.is_none() && line.fields == POLES;
            let (name, value) = match of_poles(value).filter(|_| is_bare) {
                Some((meant, digits)) => {
                    if digits == value && meant != name {
                        note(&format!("{digits} is odd, so it is taken as pole pairs."));
                    }
                    (meant, digits)
                }
                _ => (name, value),
            };
            if !line.fields.contains(&name) {
                note(&format!(
                    "`{name}` is not asked for here; answer {}, and write that into the file later.",
                    names(line)
                ));
                continue;
            }
            if value.is_empty() || self.takes(name, value, file) {
                asked.push(line.fields[0]);
            }
        }
        Ok(())
    }

    /// The first line that is missing, or asked for where a sheet states it, and was not asked for yet.
    fn next_question(&self, asked: &[&str], file: &Path) -> Option<&'static Line> {
        let missing = self.missing(file);
        self.all_lines().find(|line| {
            let is_open = line.is_asked && self.values_of(line).next().is_none();
            let name = &line.fields[0];
            (is_open || missing.contains(name)) && !asked.contains(name)
        })
    }

    /// Takes an answer, unless it is wrong whatever else is given; says so then.
    fn takes(&mut self, name: &str, value: &str, file: &Path) -> bool {
        let before = self.wrong(file);
        self.values.push((name.to_owned(), value.to_owned()));
        let mut wrong = self.wrong(file);
        wrong.retain(|message| !before.contains(message));
        for message in &wrong {
            note(&format!(
                "{message}\n  Answer again; empty to fill it in later."
            ));
        }
        if !wrong.is_empty() {
            self.values.pop();
        }
        wrong.is_empty()
    }

    /// What is wrong whatever else is given. What a value needs beside it may be answered yet.
    fn wrong(&self, file: &Path) -> Vec<String> {
        let is_wrong = |code| !matches!(code, Code::MissingField | Code::DependentField);
        let all = errors(&self.text(), file).into_iter();
        let wrong = all.filter(|error| is_wrong(error.code));
        wrong.map(|error| error.message).collect()
    }

    /// The file.
    fn text(&self) -> String {
        let mut text = String::from(
            "# A motor and its drive, for hexagen. Write values as the data sheet states them, with unit and basis.\n",
        );
        if let Some((board, _)) = &self.board {
            let _ = write!(
                text,
                "\n# It states what [inverter] lacks but for bus_voltage; `hexagen boards` lists the library.\n{}\n",
                entry(BOARD, board)
            );
        }
        for (section, lines) in SECTIONS {
            let _ = write!(text, "\n[{section}]\n");
            text.push_str(&self.fields_of_board(section));
            for line in self.lines(lines) {
                let _ = writeln!(text, "# {}", line.about);
                let given = self.values_of(line).map(|(name, value)| entry(name, value));
                let mut entries: Vec<String> = given.collect();
                if entries.is_empty() {
                    entries.push(match line.default {
                        Some(default) => entry(line.fields[0], default),
                        None => format!("# {}", entry(line.fields[0], &self.example(line))),
                    });
                }
                text.push_str(&entries.join("\n"));
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

    /// What the board states of a section, but for what stands in the file itself, as comments.
    fn fields_of_board(&self, section: &str) -> String {
        let Some((board, fields)) = &self.board else {
            return String::new();
        };
        let is_shown = |(name, _): &&(String, String)| {
            let is_own = self.values.iter().any(|(own, _)| own == name);
            !is_own && section_of(name) == Some(section)
        };
        let stated = fields.iter().filter(is_shown);
        let entries: Vec<String> = stated.map(|(name, value)| entry(name, value)).collect();
        if entries.is_empty() {
            return String::new();
        }
        // A core and its clock are one statement.
        let overrides = if section == "controller" {
            "state both, or none, yourself"
        } else {
            "a line of your own overrides it"
        };
        let entries = entries.join("\n# ");
        format!("# {board} states these; {overrides}.\n# {entries}\n\n")
    }
}

/// The next answer to a prompt; none at the end of the input.
fn answer(answers: &mut Answers, example: &str) -> Result<Option<String>, Failure> {
    let mut prompt = std::io::stderr().lock();
    let _ = write!(prompt, "  (for example {example}): ").and_then(|()| prompt.flush());
    let answer = answers.next().transpose();
    let answer =
        answer.map_err(|error| Failure::Argument(format!("cannot read the answer: {error}")))?;
    Ok(answer.map(|answer| answer.trim().to_owned()))
}

/// The field and the number of an answer on the magnets: `8 pole pairs`, `16 poles`, and an odd number, which pairs
/// alone may be.
fn of_poles(value: &str) -> Option<(&'static str, &str)> {
    let end = value.find(|c: char| !c.is_ascii_digit());
    let (digits, unit) = value.split_at(end.unwrap_or(value.len()));
    let number: u32 = digits.parse().ok()?;
    let [poles, pairs] = [POLES[0], POLES[1]];
    match unit.trim().to_lowercase().as_str() {
        "" if number % 2 == 1 => Some((pairs, digits)),
        "pole pairs" | "pole pair" | "polepairs" | "pole-pairs" | "pole_pairs" | "pairs" => {
            Some((pairs, digits))
        }
        "poles" | "magnets" | "magnet poles" => Some((poles, digits)),
        _ => None,
    }
}

fn names(line: &Line) -> String {
    match line.fields {
        [one] => (*one).to_owned(),
        [one, others @ ..] => format!("{one}, or {}=…", others.join("=… or ")),
        [] => String::new(),
    }
}

/// A value without the quotes that it has in a file.
fn unquoted(value: &str) -> &str {
    let value = value.trim();
    let inner = value
        .strip_prefix('"')
        .and_then(|rest| rest.strip_suffix('"'));
    inner.unwrap_or(value)
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

/// What is wrong with a file.
fn errors(text: &str, file: &Path) -> Vec<Diagnostic> {
    let name = file.display().to_string();
    let read = parse_toml(text, &name).and_then(|mut ast| {
        ast.read_board(Path::new(""), &name, &mut vec![])?;
        check(&ast).map(drop)
    });
    read.err().into_iter().flatten().collect()
}

/// A failure by wrong values of which no file was made: without places in it.
fn refused(wrong: &str) -> Failure {
    let lines = wrong.lines().map(without_place);
    let lines: Vec<&str> = lines.chain(["Nothing was written."]).collect();
    LabError::Specification(lines.join("\n")).into()
}

/// Whether what was given is right: what is missing, and what waits for it, is not wrong.
fn checked(text: &str, file: &Path, is_complete: bool) -> Result<(), String> {
    let wrong: Vec<String> = errors(text, file)
        .into_iter()
        .filter(|error| {
            is_complete || !matches!(error.code, Code::MissingField | Code::DependentField)
        })
        .map(|error| error.to_string())
        .collect();
    if wrong.is_empty() {
        return Ok(());
    }
    Err(wrong.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::{Draft, errors};
    use std::path::Path;

    #[test]
    fn a_wrong_answer_is_asked_for_again_and_shunts_for_their_times() {
        let answers = include_str!("../../tests/answers.txt").lines();
        let mut draft = Draft::of(Vec::new(), Path::new("db42.toml")).expect("nothing is wrong");
        let mut given = answers.map(|answer| Ok(answer.to_owned()));
        let file = Path::new("db42.toml");
        draft.ask(&mut given, file).expect("answers are read");
        assert_eq!(given.count(), 0, "an answer was not asked for");
        let text = draft.text();
        assert!(!text.contains("\nspeed_constant"), "{text}");
        let lines = [
            "resistance = \"0.56 ohm terminal\"",
            "emf_shape = \"trapezoidal\"",
            "settling_time = \"1 us\"",
            "return_current_limit = \"2 A\"",
        ];
        assert_right(&text, file, &lines);
    }

    /// A text that has these lines, and in which nothing is wrong.
    fn assert_right(text: &str, file: &Path, lines: &[&str]) {
        for line in lines {
            assert!(text.contains(line), "{line} is not in {text}");
        }
        let told: Vec<String> = errors(text, file).iter().map(ToString::to_string).collect();
        assert!(told.is_empty(), "{told:#?}");
    }

    /// What is asked for beside a measured bus and a speed loop.
    #[test]
    fn braking_and_speed_control_are_asked_for() {
        let file = Path::new("hub.toml");
        let given = [
            ("poles", "30"),
            ("resistance", "0.4 ohm terminal"),
            ("inductance", "0.6 mH terminal"),
            ("emf_shape", "sinusoidal"),
            ("rated_current", "10 A peak"),
            ("rated_torque", "5.17 Nm"),
            ("rated_speed", "400 rpm"),
            ("no_load_speed", "660 rpm"),
            ("nominal_voltage", "36 V"),
            ("inertia", "2 kg cm2"),
            ("bus_voltage", "36 V"),
            ("timer_clock", "72 MHz"),
            ("adc_range", "30 A"),
            ("current_sensing", "in_phase"),
            ("v_bus", "measured"),
            ("dead_time", "500 ns"),
            ("hall_timer_clock", "100 kHz"),
        ];
        let given = given.map(|(name, value)| (name.to_owned(), value.to_owned()));
        let mut draft = Draft::of(given.to_vec(), file).expect("nothing is wrong");
        let answers = [
            "",
            // The basis of an outrunner's constant is asked for.
            "16 KV",
            "16 KV peak",
            "12",
            "60 V",
            "",
            "43 V",
            "3 V",
            "",
            "4 A",
            "on",
            "300 rpm/s",
        ];
        let mut answers = answers.iter().map(|answer| Ok((*answer).to_owned()));
        draft.ask(&mut answers, file).expect("answers are read");
        assert_eq!(answers.count(), 0, "an answer was not asked for");
        let text = draft.text();
        let lines = [
            "back_emf = \"16 KV peak\"",
            "bus_adc_range = \"60 V\"",
            "bus_max = \"43 V\"",
            "braking_fade = \"3 V\"",
            "return_current_limit = \"4 A\"",
            "speed_loop = \"on\"",
            "acceleration_limit = \"300 rpm/s\"",
        ];
        assert_right(&text, file, &lines);
    }

    #[test]
    fn a_value_per_phase_is_asked_for_its_winding() {
        let file = Path::new("own.toml");
        let mut draft = Draft::of(Vec::new(), file).expect("nothing is wrong");
        let answers = ["", "8", "0.28 ohm per_phase", "0.46 mH per_phase", "delta"];
        let mut given = answers.iter().map(|answer| Ok((*answer).to_owned()));
        draft.ask(&mut given, file).expect("answers are read");
        assert!(
            draft.text().contains("winding = \"delta\""),
            "{}",
            draft.text()
        );
    }

    #[test]
    fn poles_and_pole_pairs_are_answered_in_words_or_by_an_odd_number() {
        for (answer, line) in [
            ("8 pole pairs", "\npole_pairs = 8\n"),
            ("16 poles", "\npoles = 16\n"),
            ("7", "\npole_pairs = 7\n"),
            ("14", "\npoles = 14\n"),
            ("12N14P", "\npoles = \"12N14P\"\n"),
            ("pole_pairs=6", "\npole_pairs = 6\n"),
        ] {
            let file = Path::new("hub.toml");
            let mut draft = Draft::of(Vec::new(), file).expect("nothing is wrong");
            let mut answers = ["", answer].into_iter().map(|text| Ok(text.to_owned()));
            draft.ask(&mut answers, file).expect("answers are read");
            assert!(draft.text().contains(line), "{answer}: {}", draft.text());
        }
    }

    #[test]
    fn three_sensors_without_a_conversion_time_are_told_to_have_an_adc_each() {
        let told = |adcs: Option<&str>| {
            let given = [
                Some(("current_sensing", "low_side")),
                Some(("sensed_phases", "abc")),
                Some(("conversion_time", "0 us")),
                adcs.map(|adcs| ("current_adcs", adcs)),
            ];
            let given = given.into_iter().flatten();
            let given = given.map(|(name, value)| (name.to_owned(), value.to_owned()));
            let draft = Draft::of(given.collect(), Path::new("hub.toml")).expect("is right");
            // What the file proposes where nothing is said.
            let text = draft.text();
            assert_eq!(
                text.contains("\n# current_adcs = 2\n"),
                adcs.is_none(),
                "{text}"
            );
            assert!(text.contains("\n# adc_inverted = \"on\"\n"), "{text}");
            draft.assumed().is_some()
        };
        assert!(told(None));
        assert!(!told(Some("3")));
    }

    #[test]
    fn an_angle_sensor_is_proposed_on_the_shaft() {
        for (poles, pairs) in [(("poles", "42"), 21), (("pole_pairs", "7"), 7)] {
            let given = [poles, ("rotor", "angle")];
            let given = given.map(|(name, value)| (name.to_owned(), value.to_owned()));
            let draft = Draft::of(given.to_vec(), Path::new("joint.toml")).expect("is right");
            let proposed = format!("\n# angle_pole_pairs = {pairs}\n");
            assert!(draft.text().contains(&proposed), "{}", draft.text());
        }
    }

    #[test]
    fn all_that_is_given_for_one_line_is_written() {
        let given = [
            ("torque_constant", "33.5 mNm/A block_mean"),
            ("speed_constant", "285 rpm/V block_mean"),
        ];
        let given = given.map(|(name, value)| (name.to_owned(), value.to_owned()));
        let draft = Draft::of(given.to_vec(), Path::new("ec45.toml")).expect("nothing is wrong");
        let text = draft.text();
        for line in [
            "torque_constant = \"33.5 mNm/A block_mean\"\n",
            "speed_constant = \"285 rpm/V block_mean\"\n",
        ] {
            assert!(text.contains(line), "{line} is not in {text}");
        }
    }
}
