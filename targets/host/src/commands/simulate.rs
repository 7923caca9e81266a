//! `hexagen simulate`: one controller on the simulated motor.

use super::cut::{beyond_followed, beyond_limit, cut_by, least_held};
use super::ran::Ran;
use crate::cli::{
    self, Failure, PlantArguments, RunArguments, note, paragraph, parse_rpm, parse_speed,
    parse_torque, print_json, print_text, spinner, warn, write_file,
};
use clap::Args;
use hexagen_codegen::diagnostics::{at_most, engineering};
use hexagen_codegen::spec::{RotorSensing, SpeedLoop};
use hexagen_lab::closed_loop::{
    Aim, FiguresOfMerit, LoadResponse, LoadStep, MOST_RECORDED, Measurement, RunOptions, SETTLED,
    Speed, Trip, measure,
};
use hexagen_lab::engine::{Prepared, run_of};
use hexagen_lab::envelope::envelope_on;
use hexagen_lab::plant::PlantParams;
use hexagen_lab::report::Table;
use hexagen_lab::text::{BEYOND, demanded, significant};
use serde::Serialize;
use std::f64::consts::TAU;
use std::path::PathBuf;

/// The two ways to say a speed.
const USAGE: &str = "hexagen simulate [OPTIONS] --rpm <RPM> <MOTOR>\n       \
    hexagen simulate [OPTIONS] --speed-set <SPEED> <MOTOR>";

/// Options of `simulate`.
#[derive(Args, Clone, Debug)]
#[command(override_usage = USAGE)]
pub struct Options {
    /// Motor, controller and plant.
    #[command(flatten)]
    pub run: RunArguments,
    /// Mechanical speed in rpm; negative is backward
    #[arg(long, value_name = "RPM", value_parser = parse_rpm, allow_hyphen_values = true, required_unless_present = "speed_set")]
    pub rpm: Option<f64>,
    /// Speed set-point as `1500rpm`, with `speed_loop=on`: the run starts at --rpm or from rest, --torque is
    /// the limit of the speed loop, which is made for the motor file's `inertia`; the shaft has that or
    /// --inertia, and the measurement begins after the run-up; warns if the speed has not settled within 2 % of set-point
    /// or start, whichever is faster. Without it a speed loop is left out
    #[arg(long, value_name = "SPEED", value_parser = parse_speed, allow_hyphen_values = true)]
    pub speed_set: Option<f64>,
    /// Step of the load torque in the middle of the measurement, on top of --load: prints the dip of the speed, its
    /// overshoot and the time until it is back within 2 %. A torque that changes has no figures of merit
    #[arg(long, value_name = "TORQUE", value_parser = parse_torque, allow_hyphen_values = true, requires = "speed_set")]
    pub load_step: Option<f64>,
    /// Write the measurement of the first run, one row per period
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

impl Options {
    /// Speed at the start, rpm.
    fn start_rpm(&self) -> f64 {
        self.rpm.unwrap_or(0.0)
    }

    /// What deviates of the plant: to reach a speed the shaft is free, by default with the motor's inertia.
    fn plant(&self, drive: &Prepared) -> PlantArguments {
        let mut plant = self.run.plant.clone();
        if self.speed_set.is_some() {
            plant.inertia = plant.inertia.or(drive.spec.motor.inertia);
        }
        plant
    }

    /// Speed to which the tolerance of a settled one refers where the set-point is slower, rpm.
    fn least_rpm(&self, drive: &Prepared) -> f64 {
        let least = drive.minimum_rpm();
        least.max(self.start_rpm().abs())
    }
}

/// A run and its figures of merit.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Motor, controller and model.
    #[serde(flatten)]
    pub ran: Ran,
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// Torque demand, Nm.
    pub torque_nm: f64,
    /// Trip of the drive, if any. A drive that tripped has no figures of merit.
    pub tripped: Option<Trip>,
    /// Speed reached by a free shaft.
    #[serde(flatten)]
    pub speed: Option<Speed>,
    /// What a load step does to it.
    #[serde(flatten)]
    pub response: Option<LoadResponse>,
    /// Figures of merit; null where one does not exist.
    #[serde(flatten)]
    pub figures: FiguresOfMerit,
}

/// Runs and measures.
///
/// # Errors
/// Diagnostics, or a plant option out of range.
pub fn collect(options: &Options) -> Result<(Prepared, RunOptions, Measurement), Failure> {
    let arguments = &options.run;
    let drive = match options.speed_set {
        Some(_) => arguments.prepare()?,
        None => arguments.prepare_for_torque()?,
    };
    let torque = arguments.torque(&drive);
    let deviations = options.plant(&drive);
    let plant = deviations.plant(&drive)?;
    let mut run = deviations
        .options()
        .run(&drive, options.start_rpm(), torque);
    run.aim = aim(options, &drive, &plant, torque)?;
    run.load_step = load_step(options, &drive)?;
    check_duration(&run, &plant, options)?;
    let mut set_point = deviations.set_point(&drive, torque);
    set_point.rpm = options.speed_set;
    let progress = spinner("simulating");
    let measured = measure(&plant, &run, drive.maker(arguments.model(), set_point));
    progress.finish_and_clear();
    let mut measured = measured?;
    if run.load_step.is_some() {
        measured.figures = FiguresOfMerit::default();
    } else if let (Some(_), Some(mean)) = (run.aim, measured.figures.mean_torque_nm) {
        // The reference is the speed loop's current, not its limit.
        run.current = run_of(&drive.spec, run.omega_m, mean).current;
        measured = Measurement::of(measured.traces, measured.tripped, &run);
    }
    Ok((drive, run, measured))
}

/// The speed set-point and the time until it is reached: settling of the integral to the load,
/// run-up at the remaining torque, settling of the loop.
fn aim(
    options: &Options,
    drive: &Prepared,
    plant: &PlantParams,
    torque: f64,
) -> Result<Option<Aim>, Failure> {
    let Some(rpm) = options.speed_set else {
        return Ok(None);
    };
    let speed = drive.spec.controller.common().speed;
    let (Some(speed), Some(mechanics)) = (speed, plant.mechanics) else {
        return Err(Failure::Argument(
            "--speed-set: the drive has no speed loop; set `speed_loop=on` in --controller"
                .to_owned(),
        ));
    };
    let most = drive.maximum_rpm();
    if rpm.abs() > most {
        warn(&format!(
            "--speed-set {rpm}: the drive limits its speed to maximum_speed = {most:.0} rpm"
        ));
    }
    let speeds = (options.start_rpm() * TAU / 60.0, rpm * TAU / 60.0);
    Ok(Some(Aim::of(&speed, &mechanics, torque, speeds)))
}

/// The step of the load, on top of what opposes the motion before.
fn load_step(options: &Options, drive: &Prepared) -> Result<Option<LoadStep>, Failure> {
    let (Some(step), Some(speed)) = (options.load_step, drive.spec.controller.common().speed)
    else {
        return Ok(None);
    };
    if step <= 0.0 {
        return Err(Failure::Argument(format!(
            "--load-step {step}: it opposes the motion as --load does, so give it above 0"
        )));
    }
    if options.speed_set == Some(0.0) {
        let text =
            "--load-step: a load does not move a rotor at rest; give another --speed-set than 0";
        return Err(Failure::Argument(text.to_owned()));
    }
    let load = options.run.plant.load.unwrap_or(0.0) + step;
    Ok(Some(LoadStep::to(load, &speed)))
}

/// Most control periods of a run, with settling: minutes of computing time.
const MOST_PERIODS: usize = 2_000_000;

/// Fewest control periods per electrical turn: one per sector.
const LEAST_PERIODS_PER_TURN: f64 = 6.0;

/// Checks that the run's electrical turns fit into its record.
fn check_duration(run: &RunOptions, plant: &PlantParams, options: &Options) -> Result<(), Failure> {
    let (name, rpm) = match options.speed_set {
        Some(set) => ("--speed-set", set),
        None => ("--rpm", options.start_rpm()),
    };
    let pole_pairs = f64::from(plant.pole_pairs);
    let most = 60.0 / (LEAST_PERIODS_PER_TURN * plant.t_s * pole_pairs);
    // The limit in the message is accepted in spite of its rounding.
    if rpm.abs() > most * (1.0 + 1e-9) {
        return Err(Failure::Argument(format!(
            "{name} {rpm:e}: an electrical turn takes less than {LEAST_PERIODS_PER_TURN} control periods, too few for angle and speed; give at most {} rpm",
            (most * (1.0 + 1e-9)).floor()
        )));
    }
    let (settling, measured) = run.periods(plant);
    let periods = settling.saturating_add(measured);
    if periods <= MOST_PERIODS && measured <= MOST_RECORDED {
        return Ok(());
    }
    if let Some(aim) = run
        .aim
        .filter(|aim| aim.within > periods as f64 * plant.t_s / 2.0)
    {
        return Err(Failure::Argument(format!(
            "{name} {rpm}: the run-up takes {:.0} s; give a smaller --inertia or --load, a higher --torque, or an --rpm closer to it",
            aim.within
        )));
    }
    if measured <= MOST_RECORDED {
        return Err(Failure::Argument(format!(
            "`slew_rate`: the set-point takes effect in {:.0} s, too long for a run; state a higher rate or a smaller --torque",
            run.ramp
        )));
    }
    let least = rpm.abs() * measured as f64 / MOST_RECORDED as f64;
    Err(Failure::Argument(format!(
        "{name} {rpm}: an electrical turn takes {:.0} s, longer than the {:.1} s of a record; give 0 or at least {} rpm",
        measured as f64 * plant.t_s,
        MOST_RECORDED as f64 * plant.t_s,
        significant(least * 1.01, 3)
    )))
}

/// Runs the command.
///
/// # Errors
/// As [`collect`], a file that cannot be written, or a drive that tripped.
pub fn run(options: &Options) -> Result<(), Failure> {
    let (drive, run, measured) = collect(options)?;
    if let Some(path) = &options.csv {
        let mut csv = Vec::new();
        let trace = measured.traces.first();
        if let Some(trace) = trace {
            trace
                .write_csv(&mut csv, run.current, run.commutation_threshold)
                .map_err(|error| Failure::Write {
                    path: path.clone(),
                    reason: error.to_string(),
                })?;
        }
        write_file(path, &csv)?;
    }
    let deviations = options.plant(&drive);
    let outcome = Outcome {
        ran: Ran::of(&drive, options.run.model()),
        rpm: options.start_rpm(),
        torque_nm: options.run.torque(&drive),
        tripped: measured.tripped,
        speed: deviations.inertia.map(|_| {
            let least_rpm = options.least_rpm(&drive);
            Speed::of(&measured, &run, options.speed_set, least_rpm)
        }),
        response: options
            .speed_set
            .and_then(|set| LoadResponse::of(&measured, &run, set, options.least_rpm(&drive))),
        figures: measured.figures,
    };
    if let Some(text) = not_reached(&outcome, &drive) {
        warn(&text);
    }
    if options.speed_set == Some(0.0) && options.run.plant.load.is_some() {
        note(
            "--load opposes the motion and does not drive the shaft: that the speed stays 0 says nothing of a slope",
        );
    }
    let bus_current = outcome.figures.bus_current_a;
    if let Some(text) = bus_current.and_then(|current| beyond_limit(&drive.spec.inverter, current))
    {
        note(&text);
    }
    let plant = deviations.plant(&drive)?;
    if let Some(text) = braked(&drive, &plant, &run, options, &outcome)? {
        warn(&text);
    } else if let Some(text) = beyond_drive(&drive, &plant, options, &outcome) {
        warn(&text);
    }
    if options.run.json {
        print_json(&outcome)?;
    } else {
        print_table(&outcome, &drive)?;
    }
    Failure::of_trip(outcome.tripped)
}

/// What is told of a speed that has not settled, or not come back after a load step.
fn not_reached(outcome: &Outcome, drive: &Prepared) -> Option<String> {
    let speed = outcome.speed?;
    let (set, last) = (speed.set_rpm?, speed.final_rpm?);
    let remedy = of_speed(set, outcome, drive);
    if speed.settled == Some(false) {
        return Some(format!(
            "--speed-set {set}: the speed has not settled within {:.0} % of that, or of the start's if it is faster; it is {} rpm at the end{remedy}",
            100.0 * SETTLED,
            significant(last, 4)
        ));
    }
    outcome.response?.recovery_ms.is_none().then(|| {
        format!(
            "--load-step: the speed has not come back to {set} rpm; it is {} rpm at the end{remedy}",
            significant(last, 4)
        )
    })
}

/// What to do for a set speed that is not reached or held, a clause.
fn of_speed(set: f64, outcome: &Outcome, drive: &Prepared) -> String {
    let spec = &drive.spec;
    let speed = spec.controller.common().speed;
    let least = speed.and_then(|speed| least_held(spec, speed));
    if let Some(least) = least.filter(|least| set.abs() < *least && set != 0.0) {
        return format!(
            "; below {least:.0} rpm the delay of the measured speed makes it oscillate: lower `speed_bandwidth` to {}, or take `rotor = \"angle\"`",
            engineering(
                at_most(SpeedLoop::bandwidth_for(
                    set * TAU / 60.0,
                    spec.motor.pole_pairs
                )),
                "Hz"
            )
        );
    }
    let is_whole = outcome.torque_nm.abs() >= drive.reach() * (1.0 - 1e-9);
    let more = if is_whole {
        "raise `max_current`"
    } else {
        "raise --torque, up to what `max_current` allows,"
    };
    format!("; if the bus and `maximum_speed` allow that speed, {more} or lower the load")
}

/// Torque against the demand that counts as braking, over the rated one.
const BRAKES: f64 = 0.01;

/// Share of a demand below which a torque that a limit may have cut is told.
const CUT: f64 = 0.97;

/// What is told of an EMF that exceeds the bus and brakes; none with a speed loop.
fn braked(
    drive: &Prepared,
    plant: &PlantParams,
    run: &RunOptions,
    options: &Options,
    outcome: &Outcome,
) -> Result<Option<String>, Failure> {
    let omega_m = run.omega_m;
    let demand = outcome.torque_nm;
    // Between two terminals at most, of any shape.
    let emf = 2.0 * plant.k_phase.into_iter().fold(0.0, f64::max) * omega_m.abs();
    let brakes = |made: &f64| made * omega_m.signum() < -BRAKES * drive.rated_torque();
    let braking = outcome.figures.mean_torque_nm.filter(brakes);
    let is_within = omega_m.abs() <= drive.spec.inverter.maximum_speed * (1.0 + 1e-9);
    let Some(braking) = braking.filter(|_| {
        options.speed_set.is_none() && is_within && demand * omega_m >= 0.0 && emf > plant.v_bus
    }) else {
        return Ok(None);
    };
    let most = drive.reach().copysign(omega_m);
    let run = RunOptions {
        current: run_of(&drive.spec, omega_m, most).current,
        ..run.clone()
    };
    let set_point = options.run.plant.options().set_point(drive, most);
    let at_most = measure(plant, &run, drive.maker(options.run.model(), set_point))?;
    let at_most = at_most.figures.mean_torque_nm;
    let way = match at_most.filter(|made| made * omega_m > 0.0) {
        Some(made) => format!(
            " at this set-point; the greatest, {} Nm, makes {} Nm",
            significant(most, 4),
            significant(made, 4)
        ),
        None => ", whatever is asked, and no limit holds what it returns; `coast` or stay slower"
            .to_owned(),
    };
    Ok(Some(format!(
        "{} Nm at {} rpm: the EMF exceeds the bus of {} and brakes with {} Nm{way}",
        significant(demand, 4),
        options.start_rpm(),
        engineering(plant.v_bus, "V"),
        significant(braking.abs(), 4)
    )))
}

/// What a speed or torque beyond the drive's means; none within, and none with a speed loop.
fn beyond_drive(
    drive: &Prepared,
    plant: &PlantParams,
    options: &Options,
    outcome: &Outcome,
) -> Option<String> {
    if options.speed_set.is_some() {
        return None;
    }
    let rpm = options.start_rpm();
    let beyond = beyond_followed(drive, rpm);
    if beyond.is_some() {
        return beyond;
    }
    let least = drive.minimum_rpm();
    let has_halls = !matches!(drive.spec.inverter.rotor_sensing, RotorSensing::Angle(_));
    if has_halls && rpm != 0.0 && rpm.abs() < least {
        return Some(format!(
            "--rpm {rpm}: below minimum_speed = {} rpm the angle is the middle of the sector, and the torque varies; state a lower one",
            significant(least, 3)
        ));
    }
    let envelope = envelope_on(&drive.spec, plant);
    let omega_m = rpm * TAU / 60.0;
    let greatest = envelope.max_current * envelope.torque_constant();
    let demand = outcome.torque_nm.clamp(-greatest, greatest);
    let within = envelope.torque(omega_m.abs());
    let is_motoring = demand * omega_m > 0.0;
    let made = outcome.figures.mean_torque_nm;
    if demand == 0.0 {
        return None;
    }
    if let Some(made) = made.filter(|made| made / demand < CUT)
        && let Some(cut) = cut_by(
            &drive.spec.inverter,
            is_motoring,
            plant.v_bus,
            outcome.figures.bus_current_a,
        )
    {
        return Some(format!(
            "{} Nm at {rpm} rpm: the drive makes {} Nm, with {cut}",
            significant(demand, 4),
            significant(made, 4)
        ));
    }
    // Against the field a trapezoid makes more than the bus drives whole.
    let is_held = envelope.weakening.is_some() && made.is_some_and(|made| made / demand >= CUT);
    (is_motoring && !is_held && demand.abs() > within * BEYOND).then(|| {
        format!(
            "{} Nm at {rpm} rpm: the bus of {} drives the whole current only up to {} Nm there, beyond which it is cut; `hexagen limit {}` prints up to which speed the torque lasts",
            significant(demand, 4),
            engineering(envelope.v_bus, "V"),
            significant(within, 4),
            options.run.motor
        )
    })
}

fn print_table(outcome: &Outcome, drive: &Prepared) -> Result<(), Failure> {
    let engine = outcome
        .ran
        .engine
        .map_or(String::new(), |engine| format!(", {}", engine.name()));
    let torque = significant(outcome.torque_nm, 4);
    // With a set speed the torque is no demand.
    let asked = if outcome.speed.is_some_and(|speed| speed.set_rpm.is_some()) {
        format!("from {} rpm with at most {torque} Nm", outcome.rpm)
    } else {
        let shown = |torque| format!("{} Nm", significant(torque, 4));
        let asked = demanded(outcome.torque_nm, drive.reach(), shown);
        format!("{asked} at {} rpm", outcome.rpm)
    };
    print_text(&paragraph(&format!(
        "{}, {} ({}{engine}): {asked}",
        outcome.ran.motor,
        outcome.ran.controller,
        outcome.ran.model.text(),
    )))?;
    if outcome.tripped.is_some() {
        return print_text("It tripped, so that it has no figures of merit.");
    }
    if let Some(speed) = outcome.speed {
        let of = speed.set_rpm.map_or("free shaft".to_owned(), |set_rpm| {
            format!("speed set to {set_rpm} rpm")
        });
        let settled = match speed.settled {
            None => "",
            Some(true) => ", settled",
            Some(false) => ", NOT settled",
        };
        let [mean, last] = [speed.mean_rpm, speed.final_rpm].map(|rpm| significant(rpm, 5));
        let speeds = if outcome.response.is_some() {
            format!("{mean} rpm on average{settled} before the load step, {last} rpm at the end")
        } else {
            format!("{mean} rpm on average, {last} rpm at the end{settled}")
        };
        print_text(&paragraph(&format!("{of}: {speeds}")))?;
    }
    if let Some(response) = outcome.response {
        return print_text(&paragraph(&of_load_step(&response)));
    }
    let mut table = Table::listed(["figure of merit"], ["value", "unit"]);
    let figures = &outcome.figures;
    for (name, value, unit) in figures.rows_of(drive.spec.controller.common().reference) {
        table.row([name.to_owned(), significant(value, 4), unit.to_owned()]);
    }
    cli::print_table(&table)
}

fn of_load_step(response: &LoadResponse) -> String {
    let percent = 100.0 * SETTLED;
    let recovery = match response.recovery_ms {
        None => format!("NOT back within {percent:.0} %"),
        Some(0.0) => format!("always within {percent:.0} %"),
        Some(time) => format!(
            "back within {percent:.0} % after {} ms",
            significant(time, 3)
        ),
    };
    format!(
        "load step: {} rpm below the set-point at most, then {} rpm above it; {recovery}",
        significant(response.dip_rpm, 3),
        significant(response.overshoot_rpm, 3)
    )
}
