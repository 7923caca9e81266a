//! `hexagen check`: whether and how well a drive will work, in fifteen lines and within a second.
//!
//! The drive is designed and verified as for generation, and runs on the simulated motor at two
//! speeds from one start each; `report` compares, measures and plots.

use crate::cli::{DriveArguments, Failure, print_json, print_text, shortened, tell_warnings};
use clap::Args;
use hexagen_codegen::design::Envelope;
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::{CurrentSensing, Reference, RotorSensing, Spec};
use hexagen_codegen::timing::StepTime;
use hexagen_lab::closed_loop::{Held, Trip};
use hexagen_lab::engine::Prepared;
use hexagen_lab::text::significant;
use hexagen_lab::times::{Time, sentence};
use serde::Serialize;

/// Options of `check`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// What is checked.
    #[command(flatten)]
    pub drive: DriveArguments,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Speeds of the runs over the rated one.
const SPEEDS: [f64; 2] = [0.2, 1.0];

/// Ripple that is worth a word, peak to peak in percent of the mean: more than a default drive has at
/// up to 15 electrical degrees in a period.
const RIPPLE: f64 = 7.0;

/// Least torque at rated speed of a drive that works, percent.
const LEAST_TORQUE: f64 = 50.0;

/// Fewest ADC counts of the rated current for a smooth current.
const COUNTS: f64 = 200.0;

/// A run at one speed.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// Mean torque over the demanded one, percent; none for a drive that trips.
    pub torque_pct: Option<f64>,
    /// Ripple of the torque, peak to peak in percent of its mean.
    pub ripple_pp_pct: Option<f64>,
    /// Turn-ons per switch and second, mean of the six, hertz.
    pub switching_hz: Option<f64>,
    /// Trip.
    pub tripped: Option<Trip>,
}

/// An option that a rule chose.
#[derive(Clone, Debug, Serialize)]
pub struct Chosen {
    /// Option.
    pub option: &'static str,
    /// Value.
    pub value: String,
    /// Why.
    pub reason: &'static str,
}

/// What was found.
#[derive(Clone, Debug, Serialize)]
pub struct Checked {
    /// Name of the motor.
    pub motor: String,
    /// Controller variant.
    pub controller: String,
    /// Whether it neither trips nor falls short of its torque at rated speed.
    pub works: bool,
    /// The verdict in words.
    pub verdict: String,
    /// Demanded torque, Nm.
    pub torque_nm: f64,
    /// Greatest voltage between two legs that the demanded torque takes at rated speed, volt.
    pub rating_v: f64,
    /// Speed up to which the bus drives the whole current of the demanded torque, rpm.
    pub envelope_rpm: f64,
    /// ADC counts of the rated current.
    pub rated_counts: f64,
    /// Greatest current drawn from the bus, ampere, where it is limited.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bus_current_limit_a: Option<f64>,
    /// Greatest current returned to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub return_current_limit_a: Option<f64>,
    /// Options that nobody stated, with the value that a rule chose; not those of any number.
    pub chosen: Vec<Chosen>,
    /// Runs, slow and at rated speed.
    pub points: Vec<Point>,
    /// Time of a step, by chip.
    pub step: Vec<Time>,
    /// Whether a step may take longer than the control period on the core that is named; the runs leave
    /// its time out.
    pub overruns: bool,
    /// Warnings of the generator.
    pub warnings: Vec<String>,
}

/// Runs the command.
///
/// # Errors
/// All diagnostics; a drive that does not work.
pub fn run(options: &Options) -> Result<(), Failure> {
    let asked = &options.drive;
    let drive = asked
        .select()?
        .prepare_for_torque(asked.controller.as_deref())?;
    let checked = Checked::of(&drive)?;
    if options.json {
        print_json(&checked)?;
    } else {
        tell_warnings(&drive);
        print_text(&checked.lines(&drive, &next(asked)).join("\n"))?;
    }
    if checked.works {
        Ok(())
    } else {
        Err(Failure::Check(format!("error: {}", checked.verdict)))
    }
}

/// The command that says more of the same drive.
fn next(asked: &DriveArguments) -> String {
    let motor = &asked.motor;
    let board = asked.board.iter().map(|board| format!(" --board {board}"));
    let board: String = board.collect();
    match &asked.controller {
        Some(controller) => format!("hexagen limit {motor}{board} --controller \"{controller}\""),
        None => format!("hexagen report {motor}{board}"),
    }
}

impl Checked {
    fn of(drive: &Prepared) -> Result<Self, Failure> {
        let (motor, inverter) = (&drive.spec.motor, &drive.spec.inverter);
        let points = SPEEDS
            .iter()
            .map(|share| at_speed(drive, share * motor.rated_speed))
            .collect::<Result<Vec<_>, Failure>>()?;
        let envelope = Envelope::of(&drive.spec);
        let torque = drive.demand();
        let set_point = torque / envelope.torque_constant();
        let taken = envelope.bus_voltage(motor.rated_speed, set_point);
        let lasts = envelope.speed(torque).unwrap_or(0.0);
        let times = &drive.generated.interface.times;
        let mut checked = Self {
            motor: drive.motor.clone(),
            controller: drive.variant.clone(),
            works: true,
            verdict: String::new(),
            torque_nm: torque,
            rating_v: taken * envelope.reach,
            envelope_rpm: lasts * 30.0 / std::f64::consts::PI,
            rated_counts: motor.rated_current / inverter.adc_gain.abs(),
            bus_current_limit_a: inverter.bus_currents.drawn,
            return_current_limit_a: inverter.bus_currents.returned,
            chosen: chosen(drive),
            points,
            step: drive
                .generated
                .interface
                .times
                .iter()
                .map(Time::from)
                .collect(),
            overruns: times.iter().any(StepTime::is_too_long),
            warnings: drive.warnings.clone(),
        };
        let (works, verdict) = checked.judge();
        (checked.works, checked.verdict) = (works, verdict);
        Ok(checked)
    }

    fn judge(&self) -> (bool, String) {
        if let Some(trip) = self.points.iter().find_map(|point| point.tripped) {
            return (false, format!("does not work: {trip}"));
        }
        let lost = |point: &Point| {
            let torque = point.torque_pct.unwrap_or(0.0);
            Held::AtLeast.lost(torque, 100.0).is_some()
        };
        let [slow, rated] = self.points.as_slice() else {
            return (false, "does not work: it was not run".to_owned());
        };
        if lost(slow) {
            let left = self.left(slow);
            return (
                false,
                format!("does not work: even at {:.0} rpm {left}", slow.rpm),
            );
        }
        let left = format!("at rated speed {}", self.left(rated));
        if rated.torque_pct.unwrap_or(0.0) < LEAST_TORQUE {
            return (false, format!("does not work: {left}"));
        }
        let mut buts = Vec::new();
        if lost(rated) {
            buts.push(left);
        }
        buts.extend(self.rippling());
        if self.rated_counts < COUNTS {
            let counts = significant(self.rated_counts, 3);
            buts.push(format!("rated current is {counts} ADC counts only"));
        }
        if self.overruns {
            buts.push("a step may take longer than the period".to_owned());
        }
        if !self.warnings.is_empty() {
            buts.push("see the warnings".to_owned());
        }
        let verdict = if buts.is_empty() {
            "works: it holds its torque at rated speed".to_owned()
        } else {
            format!("works, but {}", buts.join("; "))
        };
        (true, verdict)
    }

    /// The greatest ripple, if it is worth a word.
    fn rippling(&self) -> Option<String> {
        let ripples = self
            .points
            .iter()
            .filter_map(|point| Some((point.rpm, point.ripple_pp_pct?)));
        let (rpm, ripple) = ripples.max_by(|(_, one), (_, other)| one.total_cmp(other))?;
        let text = format!(
            "the torque ripples by {} % at {rpm:.0} rpm",
            significant(ripple, 2)
        );
        (ripple > RIPPLE).then_some(text)
    }

    /// What is left of the torque at a speed, and what takes the rest.
    fn left(&self, point: &Point) -> String {
        let torque = significant(point.torque_pct.unwrap_or(0.0), 3);
        let what = if point.rpm < self.envelope_rpm {
            // The bus drives the whole current of the reference between its commutations.
            return format!("{torque} % of the torque, though the bus has room");
        } else if self.bus_current_limit_a.is_some() {
            "the bus and its current limit leave"
        } else {
            "the bus leaves"
        };
        format!("{what} {torque} % of the torque")
    }

    /// At most fifteen lines of at most 100 columns.
    fn lines(&self, drive: &Prepared, next: &str) -> Vec<String> {
        let (motor, inverter) = (&drive.spec.motor, &drive.spec.inverter);
        let common = drive.spec.controller.common();
        let current = match common.reference {
            Reference::Proportional => "proportional",
            Reference::QuasiSquare => "quasi-square",
        };
        let edges = match inverter.rotor_sensing {
            RotorSensing::SampledHalls => "edges seen at samples (a timer is finer)",
            RotorSensing::TimedHalls { .. } => "edges by a capture timer",
            RotorSensing::Angle(_) => "an angle sensor",
        };
        let mut lines = vec![
            format!("{}: {}", self.motor, self.verdict),
            format!(
                "motor       {} pole pairs, {}, {} per phase; {}, {}",
                motor.pole_pairs,
                engineering(motor.resistance, "ohm"),
                engineering(motor.inductance, "H"),
                engineering(motor.rated_torque_constant(), "Nm/A"),
                motor
                    .inertia
                    .map_or("inertia unknown".to_owned(), |inertia| format!(
                        "{} kg m2",
                        significant(inertia, 3)
                    )),
            ),
            format!(
                "controller  {}, {}-bit words, {current} current, {edges}",
                self.controller, common.word
            ),
            format!(
                "sensing     {}, {} bits to {}: {} a count, {} at rating; trip {}",
                match inverter.current_sensing {
                    CurrentSensing::InPhase => "in the phases",
                    CurrentSensing::LowSide(_) => "in the low legs",
                },
                inverter.adc_bits,
                engineering(inverter.shown_current(), "A"),
                engineering(inverter.adc_gain.abs(), "A"),
                significant(self.rated_counts, 3),
                engineering(inverter.trip_current, "A"),
            ),
            format!(
                "bus         the rating takes {}{} of {}; whole current to {:.0} rpm",
                engineering(self.rating_v, "V"),
                reached(&drive.spec),
                engineering(inverter.v_bus, "V"),
                self.envelope_rpm,
            ),
        ];
        lines.extend(self.limits_of_bus());
        let times = &drive.generated.interface.times;
        lines.push(format!("step        {}", sentence(times)));
        let mut heading = "by rule";
        for Chosen {
            option,
            value,
            reason,
        } in &self.chosen
        {
            lines.push(format!("{heading:<12}{option} {value}: {reason}"));
            heading = "";
        }
        lines.extend(self.points.iter().map(|point| self.line(point)));
        lines.push(format!("next        {next}"));
        lines.iter().map(|line| shortened(line)).collect()
    }

    /// The limits of the bus current, where there are any.
    fn limits_of_bus(&self) -> Option<String> {
        let limits = [
            (self.bus_current_limit_a, "drawn from the bus"),
            (self.return_current_limit_a, "returned to it"),
        ];
        let limits = limits.into_iter().filter_map(|(most, way)| {
            let most = engineering(most?, "A");
            Some(format!("{most} {way}"))
        });
        let limits: Vec<String> = limits.collect();
        (!limits.is_empty()).then(|| format!("limits      at most {}", limits.join(", ")))
    }

    fn line(&self, point: &Point) -> String {
        let head = format!("{:>6.0} rpm ", point.rpm);
        let demand = engineering(self.torque_nm, "Nm");
        match (point.torque_pct, point.tripped) {
            (_, Some(trip)) => format!("{head} trips: {trip}"),
            (Some(torque), None) => format!(
                "{head} {} % of {demand}, ripple {} % peak to peak, switches at {} kHz",
                significant(torque, 3),
                significant(point.ripple_pp_pct, 2),
                significant(point.switching_hz.map(|hertz| 1e-3 * hertz), 3),
            ),
            (None, None) => format!("{head} no torque"),
        }
    }
}

fn chosen(drive: &Prepared) -> Vec<Chosen> {
    let options = drive.generated.interface.options.iter();
    let chosen = options.filter(|option| option.is_choice).map(|option| {
        Some(Chosen {
            option: option.name,
            value: option.value.replace('"', ""),
            reason: option.reason?,
        })
    });
    chosen.flatten().collect()
}

/// What the legs reach of the bus, where they must be low for a while.
fn reached(spec: &Spec) -> String {
    let share = spec.reach_share();
    if share >= 1.0 {
        return String::new();
    }
    let reach = engineering(spec.inverter.v_bus * share, "V");
    format!("; legs reach {reach}")
}

/// The fixed-point program at a speed, in rad/s, with the demanded torque.
fn at_speed(drive: &Prepared, omega_m: f64) -> Result<Point, Failure> {
    let demand = drive.demand();
    let measured = drive.measure_once(omega_m, demand)?;
    let figures = measured.figures;
    let torque_pct = figures.mean_torque_nm.map(|torque| 100.0 * torque / demand);
    Ok(Point {
        rpm: omega_m * 30.0 / std::f64::consts::PI,
        torque_pct: torque_pct.filter(|_| measured.tripped.is_none()),
        ripple_pp_pct: figures.ripple_pp_pct,
        switching_hz: figures.switching_hz,
        tripped: measured.tripped,
    })
}
