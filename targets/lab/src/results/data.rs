//! Contents of a report as plain data. Units are in names or comments; speeds are mechanical.
//!
//! [`Results`] comes from the checked specification, measured runs and emitted texts. The page
//! computes only plots, harmonics and differences; empty parts are left out of the page.

use super::expected::Expected;
use super::links::FieldLinks;
use crate::closed_loop::{FiguresOfMerit, Held, SpeedLimit, Trace, Trip};
use crate::engine::Model;
use crate::envelope::TorqueBounds;
use crate::judgement::Judgement;
use crate::robustness::Robustness;
use crate::stability::Stability;
use hexagen_codegen::interface::FormatEntry;
use hexagen_codegen::spec::{InverterSpec, MotorSpec, Reference};
use hexagen_codegen::timing::StepTime;

/// Contents of one page.
#[derive(Clone, Debug)]
pub struct Results {
    /// Program and version: "hexagen 0.1.0".
    pub generator: String,
    /// Name of the motor's type, `UpperCamelCase`.
    pub name: String,
    /// The motor file's name, without extension, and that of a board in place of its own; names the
    /// page's file.
    pub file: String,
    /// The motor.
    pub motor: MotorSpec,
    /// Name or file of the board, if there is one.
    pub board: Option<String>,
    /// Inverter, timer and sensors.
    pub inverter: InverterSpec,
    /// Source of the motor's data, one paragraph.
    pub source: Option<String>,
    /// Demanded torque in newton metres.
    pub torque: f64,
    /// Amplitude in amperes of the quasi-square reference that gives this torque.
    pub current: f64,
    /// Criterion for a mean torque that is held, for the speed limits.
    pub held: Held,
    /// Speeds in rpm of the table's columns and of the plots, ascending.
    pub speeds_rpm: Vec<f64>,
    /// Result of the bit-for-bit check.
    pub verification: Option<Verification>,
    /// Greatest torques over speed with the own controller's reference.
    pub bounds: TorqueBounds,
    /// The variants in the table's order.
    pub variants: Vec<Variant>,
    /// The motor file's own controller; none where the table alone is wanted.
    pub own: Option<Own>,
    /// What of the own controller's code follows from each field of the specification.
    pub links: Vec<FieldLinks>,
    /// Errors of single steps of the default controllers, per word length, in the plots' order.
    pub errors: Vec<ErrorsSeen>,
    /// The default controllers on plants that differ from the motor file.
    pub robustness: Option<Robustness>,
    /// Marks along the speed axis of the torque-speed plot (the paper's claims, the bound).
    pub marks: Vec<SpeedMark>,
    /// Paragraphs below the result table: known differences and their reasons.
    pub notes: Vec<String>,
}

/// The motor file's own controller, of which the verdict is.
#[derive(Clone, Debug, PartialEq)]
pub struct Own {
    /// Place among the variants.
    pub variant: usize,
    /// Whether and how well it works.
    pub judgement: Judgement,
    /// Time of a step, by chip.
    pub times: Vec<StepTime>,
}

/// Result of the bit-for-bit check of emitted against bit-true code.
#[derive(Clone, Debug, PartialEq)]
pub struct Verification {
    /// Engine: "compiled" or "interpreted".
    pub engine: String,
    /// Steps compared, all variants together.
    pub steps: u64,
    /// Controllers of which a step differed in any output or state bit.
    pub mismatches: u64,
}

impl Results {
    /// The motor file's own controller; none on a page without it.
    pub fn own_variant(&self) -> Option<&Variant> {
        self.variants.get(self.own.as_ref()?.variant)
    }

    /// The torque that a variant is asked for, newton metres: its set-point limit may be below the rated one.
    pub fn demand(&self, of: &Variant) -> f64 {
        of.reach.unwrap_or(self.torque)
    }
}

/// One controller variant: its runs, records, formats and texts.
#[derive(Clone, Debug)]
pub struct Variant {
    /// Short name for legends: "PDCC three_phase, nearest".
    pub label: String,
    /// The variant text that selects it: "pdcc:saturation=nearest,emf=model".
    pub variant: String,
    /// Whether it applies one of a few whole vectors in each period, instead of modulating.
    pub chooses_vectors: bool,
    /// Measured runs: one row each in the result table, best known first.
    pub runs: Vec<Run>,
    /// Records of the first run, one per speed of [`Results::speeds_rpm`] without a trip; empty for
    /// a variant that is not plotted.
    pub records: Vec<Record>,
    /// Torque-speed curve of the first run: rpm and mean torque in newton metres, ascending.
    pub torque_speed: Vec<(f64, f64)>,
    /// Torque of the measurement in newton metres, if the set-point limit is below the demand.
    pub reach: Option<f64>,
    /// Shape of the current reference.
    pub reference: Reference,
    /// Set-point of the measurement, ampere: the amplitude of a quasi-square reference.
    pub set_point: f64,
    /// Fixed point beside the ideal model on the same ADC and Hall words.
    pub same_words: Vec<SameWords>,
    /// Largest and RMS error of fixed-point signals against ideal ones.
    pub signal_errors: Vec<SignalError>,
    /// Range of the true parameters in which the loop is stable.
    pub stability: Option<Stability>,
    /// Formats and emitted texts, where they are to be shown.
    pub generated: Option<GeneratedTexts>,
}

/// What tells the rotor's position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Capture {
    /// Hall edges seen at sampling instants.
    Sampled,
    /// Hall edges captured by a timer.
    Timer,
    /// An angle sensor.
    Angle,
}

/// One row of the result table.
#[derive(Clone, Debug)]
pub struct Run {
    /// Model of the controller.
    pub model: Model,
    /// Hall capture.
    pub capture: Capture,
    /// Figures of merit at each speed of [`Results::speeds_rpm`], in that order.
    pub points: Vec<RunPoint>,
    /// Constant-torque speed limit, where it was searched.
    pub limit: Option<SpeedLimit>,
    /// Expected figures of the design document.
    pub expected: Option<Expected>,
}

/// Figures of merit at one speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunPoint {
    /// Speed in rpm.
    pub rpm: f64,
    /// What was measured.
    pub figures: FiguresOfMerit,
    /// Trip of the drive, which then has no figures of merit.
    pub tripped: Option<Trip>,
}

/// Figures of merit of the fixed-point code at one speed, and of the ideal model from the same
/// start, with the same ADC counts and Hall codes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SameWords {
    /// Hall capture.
    pub capture: Capture,
    /// Speed in rpm.
    pub rpm: f64,
    /// Of the fixed-point code.
    pub fixed: FiguresOfMerit,
    /// Of the ideal model.
    pub ideal: FiguresOfMerit,
}

/// The record of a measured window, whole electrical periods.
#[derive(Clone, Debug)]
pub struct Record {
    /// Speed in rpm.
    pub rpm: f64,
    /// The record.
    pub trace: Trace,
}

/// Error of a fixed-point signal against the ideal model's, from the same state and samples.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalError {
    /// Signal as named in the format table.
    pub signal: String,
    /// Unit of the two numbers: "A", "V", "counts".
    pub unit: String,
    /// Largest magnitude.
    pub largest: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Proven bound, if any.
    pub bound: Option<f64>,
}

/// Errors of single steps of one controller at one word length, from the same state as the ideal
/// model's.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorsSeen {
    /// The variant, without its word length.
    pub controller: String,
    /// Word length in bits.
    pub word: u32,
    /// Signal over error, decibel.
    pub snr_db: f64,
    /// Largest error, volt.
    pub largest_v: f64,
    /// Proven bound, volt.
    pub bound_v: f64,
    /// Share of steps with the same decisions, percent.
    pub decisions_equal_pct: f64,
    /// Histogram of errors over equal parts of the range from the negative to the positive bound.
    pub counts: Vec<u64>,
}

/// A mark on the speed axis.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedMark {
    /// Its text, a few words: "PI-PWM (paper)".
    pub label: String,
    /// Position in percent of rated speed.
    pub percent: f64,
}

impl SpeedMark {
    /// A mark at a percentage of rated speed.
    pub fn new(label: &str, percent: f64) -> Self {
        Self {
            label: label.to_owned(),
            percent,
        }
    }

    /// Speed limits of the paper's controllers, as claimed.
    pub fn of_paper() -> [Self; 3] {
        [
            Self::new("PI-PWM (paper)", 67.0),
            Self::new("predictive (paper)", 85.0),
            Self::new("PDCC (paper)", 87.0),
        ]
    }
}

/// Formats and texts of one emitted controller.
#[derive(Clone, Debug, PartialEq)]
pub struct GeneratedTexts {
    /// Format of every signal and coefficient.
    pub formats: Vec<FormatEntry>,
    /// The emitted Rust module.
    pub rust: String,
    /// The data sheet.
    pub data_sheet: String,
    /// The normalised specification, TOML.
    pub spec_toml: String,
}
