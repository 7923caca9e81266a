//! The program's arguments, as clap reads them.

use super::{Failure, quantity, tell_warnings, warn};
use crate::commands::{
    advise, boards, check, compare, completions, explain, faults, generate, halls, limit, motors,
    new, prove, replay, report, reproduce, simulate, verify,
};
use crate::render::lines::COLUMNS;
use clap::{Args, Parser, Subcommand};
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::{EmfShape, KINDS, option_help};
use hexagen_lab::LabError;
use hexagen_lab::engine::{Model, PerSensor, PlantOptions, Prepared, SelectedMotor, SetPoint};
use hexagen_lab::plant::{PlantError, PlantParams};
use std::str::FromStr;

const AFTER_HELP: &str = "Without a command: the report on the 660 W motor.\n\
    A motor is a TOML file or a name of the library (`hexagen motors`).\n\
    A controller is `name:key=value,key=value`, e.g. `pdcc:emf=model,advance=2`; its keys are \
    those of the motor file's [controller], which `hexagen --help` lists.\n\
    Exit code 0: success; 1: a check failed, or the drive tripped; 2: bad input. With --json, standard \
    output holds one JSON object, with code 2 `{\"error\": text}`; the text is on standard error, too.";

/// From a motor's data sheet to a verified fixed-point current controller
#[derive(Debug, Parser)]
#[command(
    name = "hexagen",
    version,
    max_term_width = COLUMNS,
    after_help = AFTER_HELP,
    args_conflicts_with_subcommands = true,
    after_long_help = format!("{AFTER_HELP}\n\nControllers and their options:\n{}", option_help())
)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Without a command: what the report prints and writes.
    #[command(flatten)]
    pub output: report::Output,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Designs, verifies and simulates the controllers of a motor, prints a verdict and writes a page;
    /// takes a minute or more on two cores
    Report(report::Options),
    /// Prints a controller's code, intermediate form or data sheet
    Generate(generate::Options),
    /// Runs a controller on the simulated motor and measures torque and currents
    Simulate(simulate::Options),
    /// Finds the highest speed at which a controller holds the torque
    Limit(limit::Options),
    /// Breaks one thing at a time, and says whether a controller trips and how large the current gets
    Faults(faults::Options),
    /// Computes every word of a drive again from a log of its samples and set-points
    Replay(replay::Options),
    /// Finds the Hall sensors' codes and edge angles from a log of the shorted motor turned by hand
    Halls(halls::Options),
    /// Compares generated code with the bit-true reference, bit for bit
    Verify(verify::Options),
    /// Proves the absence of overflow and the error bounds with Gappa
    Prove(prove::Options),
    /// Compares fixed-point with floating-point accuracy, per controller and word length
    Compare(compare::Options),
    /// Repeats the paper's experiment, checks its claims and writes a page with its figures
    Reproduce(reproduce::Options),
    /// Lists the motors of the library
    Motors(motors::Options),
    /// Lists the boards of the library, and which motors fit each
    Boards(boards::Options),
    /// Writes a commented motor file, from values of a data sheet or from questions
    New(new::Options),
    /// Says within a second whether and how well a drive will work
    Check(check::Options),
    /// Tries all controllers on a motor and its board, and recommends one with the reason
    Advise(advise::Options),
    /// Explains a code of an error or warning: cause, example, remedy
    Explain(explain::Options),
    /// Prints a script that completes the command line in a shell
    Completions(completions::Options),
}

impl Command {
    /// Whether the result is one JSON object.
    pub fn is_json(&self) -> bool {
        match self {
            Self::Report(options) => options.output.json,
            Self::Generate(options) => options.json,
            Self::Simulate(options) => options.run.json,
            Self::Limit(options) => options.run.json,
            Self::Faults(options) => options.run.json,
            Self::Replay(options) => options.json,
            Self::Halls(options) => options.json,
            Self::Verify(options) => options.json,
            Self::Prove(options) => options.json,
            Self::Compare(options) => options.json,
            Self::Reproduce(options) => options.json,
            Self::Motors(options) => options.json,
            Self::Boards(options) => options.json,
            Self::New(options) => options.json,
            Self::Check(options) => options.json,
            Self::Advise(options) => options.json,
            Self::Explain(options) => options.json,
            Self::Completions(_) => false,
        }
    }
}

/// A motor, its board and a controller.
#[derive(Args, Clone, Debug)]
pub struct DriveArguments {
    /// Motor file, or name of a library motor
    #[arg(value_name = "MOTOR")]
    pub motor: String,
    /// Board, a name of the library or a file [default: the motor file's]
    #[arg(long, value_name = "BOARD")]
    pub board: Option<String>,
    /// Controller variant [default: the motor file's]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]")]
    pub controller: Option<String>,
}

impl DriveArguments {
    /// The motor on its board.
    ///
    /// # Errors
    /// Diagnostics, or a name that is not in the library.
    pub fn select(&self) -> Result<SelectedMotor, LabError> {
        SelectedMotor::find(&self.motor, &PlantOptions::on_board(self.board.as_deref()))
    }

    /// The drive.
    ///
    /// # Errors
    /// As [`Self::select`].
    pub fn prepare(&self) -> Result<Prepared, LabError> {
        self.select()?.prepare(self.controller.as_deref())
    }
}

/// What `generate` prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Emit {
    /// The Rust module
    Rust,
    /// Header and source in C99, into a folder, for toolchains without Rust
    C99,
    /// The intermediate form, as text
    Ir,
    /// The data sheet, in Markdown
    Datasheet,
    /// Gappa scripts, one implication each, into a folder
    Gappa,
}

impl Emit {
    /// Ending of the file.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Rust => "rs",
            Self::C99 => "c",
            Self::Ir => "ir",
            Self::Datasheet => "md",
            Self::Gappa => "g",
        }
    }
}

/// A controller, or all of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Selection {
    /// Every kind of controller in its default variant.
    All,
    /// One variant.
    One(String),
}

impl FromStr for Selection {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text {
            "all" => Self::All,
            variant => Self::One(variant.to_owned()),
        })
    }
}

impl Selection {
    /// The variants that are selected.
    pub fn variants(&self) -> Vec<String> {
        match self {
            Self::All => KINDS.map(|kind| kind.name.to_owned()).to_vec(),
            Self::One(variant) => vec![variant.clone()],
        }
    }
}

/// Options that change the simulated plant.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Plant")]
pub struct PlantArguments {
    /// Board of controller and plant, a name of the library or a file [default: the motor file's]
    #[arg(long, value_name = "BOARD")]
    pub board: Option<String>,
    /// Dead time of the inverter's legs [default: the motor file's]
    #[arg(long, value_name = "TIME", value_parser = quantity::time, allow_hyphen_values = true)]
    pub dead_time: Option<f64>,
    /// Bits of the current ADCs, in the plant and in the controller's specification
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub adc_bits: Option<u32>,
    /// Range of the current ADCs, in the plant and in the controller's specification
    #[arg(long, value_name = "CURRENT", value_parser = quantity::current_text, allow_hyphen_values = true)]
    pub adc_range: Option<String>,
    /// Offset error of the current ADCs, unknown to the controller: one current for all sensed
    /// phases, or one of each
    #[arg(long, value_name = "CURRENT", value_parser = quantity::adc_offset, allow_hyphen_values = true)]
    pub adc_offset: Option<PerSensor>,
    /// True current per ADC count as a multiple of the stated one, unknown to the controller: one
    /// factor for all sensed phases, or one of each
    #[arg(long, value_name = "X", value_parser = quantity::adc_scale, allow_hyphen_values = true)]
    pub scale_adc: Option<PerSensor>,
    /// Gaussian noise of the current ADCs in counts rms, the same in every run
    #[arg(long, value_name = "COUNTS", value_parser = quantity::counts, allow_hyphen_values = true)]
    pub adc_noise: Option<f64>,
    /// Time from the sample of a sensed phase to that of the next [default: the motor
    /// file's, 0 with sensors in the phases]
    #[arg(long, value_name = "TIME", value_parser = quantity::time, allow_hyphen_values = true)]
    pub conversion_time: Option<f64>,
    /// True bus voltage; the controller uses the motor file's or the measured one
    #[arg(long, value_name = "VOLTAGE", value_parser = quantity::voltage, allow_hyphen_values = true)]
    pub v_bus: Option<f64>,
    /// True resistance as a multiple of the stated one
    #[arg(long, value_name = "X", value_parser = quantity::factor, allow_hyphen_values = true)]
    pub scale_r: Option<f64>,
    /// True inductance as a multiple of the stated one
    #[arg(long, value_name = "X", value_parser = quantity::factor, allow_hyphen_values = true)]
    pub scale_l: Option<f64>,
    /// True EMF constant as a multiple of the stated one
    #[arg(long, value_name = "X", value_parser = quantity::factor, allow_hyphen_values = true)]
    pub scale_kb: Option<f64>,
    /// True shape of the EMF, at the same peak between two terminals: `sinusoidal`,
    /// `trapezoidal:100` (flat top in degrees), or `harmonics:5=4,7=-2@20` (order, percent of the
    /// fundamental, and phase in degrees)
    #[arg(long, value_name = "SHAPE", value_parser = quantity::emf_shape)]
    pub emf_shape: Option<EmfShape>,
    /// Placement error of the Hall sensors in electrical degrees: one angle for all three, or
    /// three for Ha, Hb and Hc; positive is late in forward rotation
    #[arg(long, value_name = "ANGLE", value_parser = quantity::hall_error, allow_hyphen_values = true)]
    pub hall_error: Option<[f64; 3]>,
    /// Inertia of rotor and load as `"120 g cm2"`: a free shaft that starts at the given speed
    #[arg(long, value_name = "INERTIA", value_parser = quantity::inertia, allow_hyphen_values = true)]
    pub inertia: Option<f64>,
    /// Load torque as `0.5Nm`, which opposes the motion as friction does: it does not drive the shaft, as a slope would
    #[arg(long, value_name = "TORQUE", value_parser = quantity::torque, allow_hyphen_values = true)]
    pub load: Option<f64>,
    /// Initial electrical angle as `30deg`: one run instead of three [default: 0.1, 0.117, 0.134 rad]
    #[arg(long, value_name = "ANGLE", value_parser = quantity::radians, allow_hyphen_values = true)]
    pub start_angle: Option<f64>,
}

impl PlantArguments {
    /// The options as the laboratory takes them.
    pub fn options(&self) -> PlantOptions {
        PlantOptions {
            board: self.board.clone(),
            dead_time: self.dead_time,
            adc_bits: self.adc_bits,
            adc_range: self.adc_range.clone(),
            adc_offset: self.adc_offset.clone(),
            scale_adc: self.scale_adc.clone(),
            adc_noise: self.adc_noise,
            conversion_time: self.conversion_time,
            v_bus: self.v_bus,
            scale_r: self.scale_r,
            scale_l: self.scale_l,
            scale_kb: self.scale_kb,
            emf_shape: self.emf_shape,
            hall_error: self.hall_error,
            inertia: self.inertia,
            load: self.load,
            start_angle: self.start_angle,
        }
    }

    /// The plant of a drive.
    ///
    /// # Errors
    /// An option out of range.
    pub fn plant(&self, drive: &Prepared) -> Result<PlantParams, Failure> {
        if let Some(load) = self.load.filter(|load| *load < 0.0) {
            return Err(Failure::Argument(format!(
                "--load {load}: it opposes the motion as friction does, so give it without a sign; a load that drives the shaft, as a slope does, is not simulated"
            )));
        }
        if self.load.is_some() && self.inertia.is_none() {
            return Err(Failure::Argument(
                "--load: the shaft is free, and needs --inertia of rotor and load".to_owned(),
            ));
        }
        let plant = self.options().plant(drive);
        plant.map_err(|error| self.blame(error.into()))
    }

    /// The failure of an error of the laboratory, named after the option that caused it, if any.
    pub fn blame(&self, error: LabError) -> Failure {
        let Some(option) = self.option_of(&error) else {
            return error.into();
        };
        let text = error.to_string();
        Failure::Argument(text.replacen("error: ", &format!("{option}: "), 1))
    }

    fn option_of(&self, error: &LabError) -> Option<&'static str> {
        let name = match error {
            LabError::FreeShaft => "inertia",
            LabError::Plant(PlantError::Range { name, .. } | PlantError::Sensors { name, .. }) => {
                name
            }
            _ => return None,
        };
        Some(match name {
            "dead_time" if self.dead_time.is_some() => "--dead-time",
            "v_bus" if self.v_bus.is_some() => "--v-bus",
            "resistance" if self.scale_r.is_some() => "--scale-r",
            "inductance" if self.scale_l.is_some() => "--scale-l",
            "k_phase" if self.scale_kb.is_some() => "--scale-kb",
            "adc offset" if self.adc_offset.is_some() => "--adc-offset",
            "adc scale" if self.scale_adc.is_some() => "--scale-adc",
            "adc noise" if self.adc_noise.is_some() => "--adc-noise",
            "adc instant" if self.conversion_time.is_some() => "--conversion-time",
            "hall_error_deg" if self.hall_error.is_some() => "--hall-error",
            "inertia" => "--inertia",
            "opposing_torque" => "--load",
            _ => return None,
        })
    }

    /// The drive's set-point for a torque, Nm; warns when it exceeds the drive's limit.
    pub fn set_point(&self, drive: &Prepared, torque: f64) -> SetPoint {
        let set_point = self.options().set_point(drive, torque);
        let (current, max) = (set_point.current, drive.spec.inverter.max_current);
        if current.abs() > max * (1.0 + 1e-9) {
            warn(&format!(
                "{torque} Nm need {current:.2} A; the drive limits its set-point to its max_current of {}",
                engineering(max, "A"),
            ));
        }
        set_point
    }
}

/// A model of a controller, as the command line names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum ModelName {
    /// The generated fixed-point program
    #[default]
    Fixed,
    /// The bit-true reference: f64 with a quantiser at every rounding
    BitTrue,
    /// The ideal reference: f64 without rounding
    Ideal,
}

impl From<ModelName> for Model {
    fn from(name: ModelName) -> Self {
        match name {
            ModelName::Fixed => Self::Fixed,
            ModelName::BitTrue => Self::BitTrue,
            ModelName::Ideal => Self::Ideal,
        }
    }
}

/// Motor, controller and model of a run.
#[derive(Args, Clone, Debug)]
pub struct RunArguments {
    /// Motor file, or name of a library motor
    #[arg(value_name = "MOTOR")]
    pub motor: String,
    /// Controller variant [default: the motor file's]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]")]
    pub controller: Option<String>,
    /// Model of the controller
    #[arg(long, value_enum, default_value_t)]
    pub model: ModelName,
    /// Torque demand as `3.3Nm`, negative for braking [default: rated torque, limited by max_current]
    #[arg(long, value_name = "TORQUE", value_parser = quantity::torque, allow_hyphen_values = true)]
    pub torque: Option<f64>,
    /// Changes of the plant
    #[command(flatten)]
    pub plant: PlantArguments,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

impl RunArguments {
    /// Reads the motor and takes the controller through the generator.
    ///
    /// # Errors
    /// All diagnostics.
    pub fn prepare(&self) -> Result<Prepared, Failure> {
        let motor = SelectedMotor::find(&self.motor, &self.plant.options())?;
        let drive = motor.prepare(self.controller.as_deref())?;
        tell_warnings(&drive);
        Ok(drive)
    }

    /// As [`Self::prepare`], for commands that measure a given torque.
    ///
    /// # Errors
    /// All diagnostics, or a drive with a speed loop.
    pub fn prepare_for_torque(&self) -> Result<Prepared, Failure> {
        let motor = SelectedMotor::find(&self.motor, &self.plant.options())?;
        let drive = motor.prepare_for_torque(self.controller.as_deref())?;
        tell_warnings(&drive);
        Ok(drive)
    }

    /// The model that runs.
    pub fn model(&self) -> Model {
        self.model.into()
    }

    /// The torque demand, Nm: as given, else the rated torque, limited by the drive's set-point.
    pub fn torque(&self, drive: &Prepared) -> f64 {
        self.torque.unwrap_or_else(|| drive.demand())
    }
}

/// Revolutions per minute of a text; other units of speed are converted.
///
/// # Errors
/// Why the text is not a speed.
pub fn parse_rpm(text: &str) -> Result<f64, String> {
    quantity::rpm(text)
}

/// Revolutions per minute of a speed with its unit.
///
/// # Errors
/// Why the text is not a speed.
pub fn parse_speed(text: &str) -> Result<f64, String> {
    quantity::speed(text)
}

/// Newton metres of a torque with its unit.
///
/// # Errors
/// Why the text is not a torque.
pub fn parse_torque(text: &str) -> Result<f64, String> {
    quantity::torque(text)
}
