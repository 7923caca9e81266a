//! Which controller suits a motor on its board: variants are tried on the simulated motor, and one is
//! recommended, with the reason.
//!
//! A variant is the kind of controller with its defaults but for the options that it names: those of the
//! motor file do not count. The motor file's own controller is tried beside them, where it has options.
//!
//! The rule takes what must not fail first, then what costs: no trip, torque, ripple, both again with
//! deviations of motor and bus, the speed up to which the torque is held, and the cycles of the longest
//! step. Of those that are alike in all the motor file's own comes first, then the default.

use crate::closed_loop::{LimitOptions, RunOptions, speed_limit};
use crate::engine::{Model, PlantOptions, Prepared, SelectedMotor, plant_of, run_of};
use crate::envelope::envelope_on;
use crate::judgement::Judgement;
use crate::plant::PlantParams;
use crate::robustness::measured;
use crate::times::longer_in_c;
use crate::{LabError, Progress};
use hexagen_codegen::diagnostics::{Code, engineering};
use hexagen_codegen::spec::ast::{Number, Value};
use hexagen_codegen::spec::{BusSource, Field, OF_CORE, apply_variant};
use hexagen_codegen::timing::StepTime;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// The default drive: what is generated where a file says nothing of the controller.
pub const DEFAULT: &str = "pdcc";

/// Variants that are tried, the default first.
pub const VARIANTS: [&str; 17] = [
    DEFAULT,
    "pdcc:saturation=torque_priority",
    "pdcc:saturation=keep_angle",
    "pdcc:common_mode=clamped_low",
    "pdcc:emf=model",
    "pdcc:reference=quasi_square",
    "pdcc:modulation=pair",
    "pdcc:word=16",
    "pdcc:field_weakening=on",
    "pi-pwm",
    "pi-pwm:reference=quasi_square",
    "p-pwm",
    "fcs-mpc",
    "fcs-mpc:candidates=three_phase",
    "fcs-mpc:modulated=on",
    "phcc",
    "phcc:candidates=three_phase",
];

/// Electrical angle at the start of a run, radian.
const START: f64 = 0.1;

/// Speeds of the runs, percent of the rated one.
pub const SPEEDS: [u32; 3] = [25, 60, 100];

/// The motor file's own controller in the list of variants.
pub const OWN: &str = "(the motor file's)";

/// Speed of the runs with a deviation, percent of the rated one.
pub const DEVIATING_AT: u32 = 60;

/// Torque that two variants may differ by and count as alike, percent of the rated one.
pub const TORQUE_ALIKE: f64 = 1.0;

/// Ripple that two variants may differ by and count as alike, percent of the mean torque.
pub const RIPPLE_ALIKE: f64 = 2.0;

/// Speed up to which the torque is held that two variants may differ by and count as alike, percent of
/// the rated one.
pub const LIMIT_ALIKE: f64 = 2.0;

/// Cycles over the fewest that count as alike: estimates err by about as much (`hexagen_codegen::timing`).
const CYCLES_ALIKE: f64 = 1.12;

/// A change of the plant, of which the nominal bus voltage is known.
type Deviate = fn(&mut PlantOptions, f64);

/// Deviations of motor and bus, each alone.
const DEVIATIONS: [(&str, Deviate); 5] = [
    ("R x 1.4", |plant, _| plant.scale_r = Some(1.4)),
    ("L x 0.75", |plant, _| plant.scale_l = Some(0.75)),
    ("L x 1.3", |plant, _| plant.scale_l = Some(1.3)),
    ("k_b x 1.1", |plant, _| plant.scale_kb = Some(1.1)),
    ("bus 15 % low", |plant, bus| plant.v_bus = Some(0.85 * bus)),
];

/// The lowest bus of a run over `bus_min`, at which counts may round the wrong way.
const ABOVE_LEAST: f64 = 1.01;

/// A run.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Speed, percent of the rated one.
    pub speed_pct: u32,
    /// What deviates, if anything.
    pub deviation: Option<&'static str>,
    /// Mean torque, percent of what is demanded with the true EMF constant, or of what a stated limit of the bus current
    /// leaves of that at this speed; none for a drive that trips.
    pub torque_pct: Option<f64>,
    /// Peak-to-peak ripple, percent of the mean.
    pub ripple_pct: Option<f64>,
    /// Copper loss, watt.
    pub copper_w: Option<f64>,
    /// Turn-ons per switch and second, mean of the six, hertz.
    pub switching_hz: Option<f64>,
}

/// A variant that was tried.
#[derive(Clone, Debug, Serialize)]
pub struct Tried {
    /// The variant.
    pub variant: &'static str,
    /// Why the generator refuses it, if it does.
    pub refused: Option<String>,
    /// Code of the first diagnostic that says so.
    pub refused_by: Option<String>,
    /// Runs on the stated motor, at each of [`SPEEDS`].
    pub nominal: Vec<Point>,
    /// Runs with each deviation.
    pub deviating: Vec<Point>,
    /// Cycles of the longest step on the core that is named or assumed, an estimate with its error.
    pub cycles: Option<u32>,
    /// Whether that is more than the control period has, on a core that is named.
    pub overruns: bool,
    /// Speed up to which it holds its torque, percent of the rated one; of those alone that are alike else.
    pub limit_pct: Option<f64>,
    /// Why it is not the recommended one.
    pub why_not: Option<String>,
    /// Whether it is the controller that shows how to add one, and is no choice for a drive.
    #[serde(skip)]
    pub is_example: bool,
}

impl Tried {
    fn new(variant: &'static str) -> Self {
        Self {
            variant,
            refused: None,
            refused_by: None,
            nominal: Vec::new(),
            deviating: Vec::new(),
            cycles: None,
            overruns: false,
            limit_pct: None,
            why_not: None,
            is_example: false,
        }
    }
}

/// The controller that shows how to add one.
const EXAMPLE: &str = "p-pwm";

/// All variants, and the recommended one.
#[derive(Clone, Debug, Serialize)]
pub struct Advice {
    /// Name of the motor.
    pub motor: String,
    /// Rated torque, Nm, of which the percentages are.
    pub rated_torque_nm: f64,
    /// The variants.
    pub tried: Vec<Tried>,
    /// Place of the recommended one; none if all trip or are refused.
    pub recommended: Option<usize>,
    /// PWM periods in a control period with which all were tried, where the motor's file states fewer.
    pub pwm_per_control: Option<u32>,
    /// Why that one.
    pub reason: String,
    /// Ripple of that one, in the words of `check`, where `check` tells it.
    pub ripples: Option<String>,
    /// Why variants ripple far more, or make far less torque, where some do and the reason is known.
    pub far_off: Vec<String>,
    /// Options of the motor's file that stay whatever the controller, with their values.
    pub kept: Vec<(String, String)>,
    /// Options of the motor's file that the other variants do without.
    pub left_out: Vec<String>,
}

/// Torque and ripple of the worst run of several.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// Least torque, percent, less what a run makes too much: more than the demand is as wrong as less.
    pub torque_pct: f64,
    /// Greatest ripple, percent.
    pub ripple_pct: f64,
}

impl Worst {
    /// Of runs; none if one of them tripped, or there are none.
    pub fn of(points: &[Point]) -> Option<Self> {
        let worst = Self {
            torque_pct: 100.0,
            ripple_pct: 0.0,
        };
        let worse = |worst: Self, point: &Point| {
            Some(Self {
                torque_pct: worst
                    .torque_pct
                    .min(100.0 - (point.torque_pct? - 100.0).abs()),
                ripple_pct: worst.ripple_pct.max(point.ripple_pct?),
            })
        };
        let (first, rest) = points.split_first()?;
        rest.iter().try_fold(worse(worst, first)?, worse)
    }
}

/// What the default drive lacks of the best of all variants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Regret {
    /// Torque, percent of the rated one.
    pub torque_pct: f64,
    /// Ripple, percent of the mean torque, beside those variants that hold as much torque.
    pub ripple_pct: f64,
}

/// Most PWM periods in a control period that are tried on a core that is too slow for one each.
const MOST_PER_CONTROL: u32 = 4;

/// Tries all variants of a motor and recommends one. Where no variant that fits the control period suits the motor, and
/// the default drive takes longer than that, all are tried with more PWM periods in a control period.
///
/// # Errors
/// A plant parameter out of range; a motor of which no variant is generated.
pub fn advise(motor: &SelectedMotor, progress: &dyn Progress) -> Result<Advice, LabError> {
    let advice = advise_as_stated(motor, progress)?;
    let overruns = advice.tried.first().is_some_and(|default| default.overruns);
    if advice.suits() || !overruns {
        return Ok(advice);
    }
    let Some(per_control) = periods_needed(motor) else {
        return Ok(advice);
    };
    let slower = with_periods(motor, per_control);
    let with_more = advise_as_stated(&slower, progress)?;
    if !with_more.suits() {
        return Ok(advice);
    }
    Ok(Advice {
        pwm_per_control: Some(per_control),
        ..with_more
    })
}

/// The motor with so many PWM periods in a control period.
fn with_periods(motor: &SelectedMotor, per_control: u32) -> SelectedMotor {
    const FIELD: &str = "pwm_per_control";
    let mut motor = motor.clone();
    let at = motor.ast.name.location.clone();
    let section = &mut motor.ast.inverter;
    section.fields.retain(|field| field.name != FIELD);
    section.fields.push(Field {
        name: FIELD.to_owned(),
        name_location: at.clone(),
        value: Value::Number(Number {
            digits: per_control.to_string(),
            value: per_control.into(),
            unit: None,
            basis: vec![],
        }),
        location: at,
        assumed: None,
    });
    motor
}

/// PWM periods in a control period that give a step of the default drive the time; none where they would be too many.
fn periods_needed(motor: &SelectedMotor) -> Option<u32> {
    (2..=MOST_PER_CONTROL).find(|&periods| {
        let drive = prepare_variant(&with_periods(motor, periods), DEFAULT);
        let time = drive
            .as_ref()
            .ok()
            .and_then(|drive| drive.generated.interface.times.first());
        time.is_some_and(|time| !time.is_too_long())
    })
}

/// The same with the control period that the motor's file states.
fn advise_as_stated(motor: &SelectedMotor, progress: &dyn Progress) -> Result<Advice, LabError> {
    let prepared = prepare(motor)?;
    let mut generated = prepared.iter().filter_map(|(_, drive)| drive.as_ref().ok());
    let first = generated.next();
    let mut advice = Advice {
        motor: motor.source.name.clone(),
        rated_torque_nm: first.map_or(0.0, Prepared::rated_torque),
        tried: try_all(&prepared, progress)?,
        recommended: None,
        pwm_per_control: None,
        reason: String::new(),
        ripples: None,
        far_off: Vec::new(),
        kept: kept(motor)
            .map(|field| (field.name.clone(), field.value.to_string()))
            .collect(),
        left_out: left_out(motor),
    };
    let mut left = advice.alike();
    let limits = left.par_iter().map(|&k| {
        let drive = prepared[k].1.as_ref();
        drive.map_or(Ok(None), limit_of)
    });
    let limits: Vec<Option<f64>> = limits.collect::<Result<_, LabError>>()?;
    for (&k, limit) in left.iter().zip(limits) {
        advice.tried[k].limit_pct = limit;
    }
    advice.recommend(&mut left);
    let reasons = [
        whole_vectors(&prepared, &advice.tried),
        without_integral(&advice.tried),
    ];
    advice.far_off = reasons.into_iter().flatten().collect();
    if let Some(Ok(drive)) = advice.recommended.map(|k| prepared[k].1.as_ref()) {
        advice.ripples = Judgement::of(drive)?.ripples(&drive.spec);
        if let Some(text) = longer_in_c(&drive.generated.interface.times) {
            let _ = write!(advice.reason, "; {text}");
        }
    }
    if advice.tried.first().is_some_and(|default| default.overruns) {
        advice.reason.push_str(
            "; a step of the default drive may take longer than the control period: a longer one, by a lower `f_pwm`, more PWM periods in \
             it (`pwm_per_control`) or a longer `sampling_time`, gives it the time",
        );
    }
    if advice.recommended.is_none()
        && let Some(long) = first.and_then(|drive| drive.spec.long_period())
    {
        let _ = write!(advice.reason, "; {long}");
    }
    Ok(advice)
}

/// Ripple of a variant of whole vectors from which on its reason is told, percent.
const ROUGH: f64 = 20.0;

/// Why the variants that hold one vector in a control period ripple; none where none does much.
fn whole_vectors(drives: &[Drive], tried: &[Tried]) -> Option<String> {
    let of_drive = |(_, drive): &Drive| {
        let spec = &drive.as_ref().ok()?.spec;
        (!spec.controller.modulates()).then(|| (spec.vector_stride(), spec.motor.rated_current))
    };
    let is_rough =
        |tried: &Tried| Worst::of(&tried.nominal).is_some_and(|worst| worst.ripple_pct >= ROUGH);
    let rough = drives
        .iter()
        .zip(tried)
        .filter(|(_, tried)| is_rough(tried));
    let rough: Vec<(&str, (f64, f64))> = rough
        .filter_map(|(drive, tried)| Some((tried.variant, of_drive(drive)?)))
        .collect();
    let (_, (stride, rated)) = *rough.first()?;
    let names: Vec<&str> = rough.iter().map(|(name, _)| *name).collect();
    Some(format!(
        "Held for a control period, one vector changes a current by up to {} at standstill, {:.0} % of the rated one, and by more where the EMF adds to it. So {} ripple, and their \
         mean torque may be off by a part of that step; control at a higher frequency lessens both.",
        engineering(stride, "A"),
        100.0 * stride / rated,
        names.join(", "),
    ))
}

/// Points of torque below the default drive's from which on the reason is told.
const FAR_OFF: f64 = 10.0;

/// Least torque of the runs on the motor as stated, percent; none where one trips.
fn least_torque(tried: &Tried) -> Option<f64> {
    let torques = tried.nominal.iter().map(|point| point.torque_pct);
    let torques: Option<Vec<f64>> = torques.collect();
    torques?.into_iter().reduce(f64::min)
}

/// Why the controller without an integral makes less torque, where that is much.
fn without_integral(tried: &[Tried]) -> Option<String> {
    let example = tried.iter().find(|tried| tried.is_example)?;
    let [example_least, least] = [example, tried.first()?].map(least_torque);
    (example_least? < least? - FAR_OFF).then(|| {
        format!(
            "{} has no integral: its current stays below the reference by the resistive drop over the gain.",
            example.variant
        )
    })
}

/// What the default drive of a motor lacks of the best variant; none where it trips.
///
/// # Errors
/// As [`advise`].
pub fn regret(motor: &SelectedMotor) -> Result<Option<Regret>, LabError> {
    Ok(Regret::of(&try_all(&prepare(motor)?, &())?))
}

/// A variant, taken through the generator.
type Drive = (&'static str, Result<Prepared, LabError>);

/// Options that say nothing of a controller's merits: those of the core, and what sets the current.
const KEPT: [&str; 4] = [
    "speed_loop",
    "speed_bandwidth",
    "acceleration_limit",
    "slew_rate",
];

/// Fields of a motor's file that stay whatever the controller.
fn kept(motor: &SelectedMotor) -> impl Iterator<Item = &Field> {
    let fields = motor.ast.controller.fields.iter();
    fields.filter(|field| OF_CORE.iter().chain(&KEPT).any(|name| field.name == *name))
}

/// Options of a motor's file that neither stay nor are tried.
fn left_out(motor: &SelectedMotor) -> Vec<String> {
    let kept: Vec<&str> = kept(motor).map(|field| field.name.as_str()).collect();
    let is_tried = |name: &str| VARIANTS.iter().any(|one| one.contains(&format!("{name}=")));
    let fields = motor.ast.controller.fields.iter();
    let names = fields.map(|field| field.name.as_str());
    let names = names.filter(|name| *name != "kind" && !kept.contains(name) && !is_tried(name));
    names.map(str::to_owned).collect()
}

/// A variant of a motor, without the options of its file but for those that stay.
fn prepare_variant(motor: &SelectedMotor, variant: &str) -> Result<Prepared, LabError> {
    let mut drive = motor.clone();
    drive.ast.controller.fields.clear();
    apply_variant(&mut drive.ast, variant)?;
    // A controller of another kind would replace these, too.
    drive.ast.controller.fields.extend(kept(motor).cloned());
    drive.prepare_for_torque(None)
}

/// All variants of a motor.
///
/// # Errors
/// If none is generated: the reason of the default.
fn prepare(motor: &SelectedMotor) -> Result<Vec<Drive>, LabError> {
    let mut drives = Vec::from(VARIANTS.map(|variant| (variant, prepare_variant(motor, variant))));
    let controller = &motor.ast.controller;
    if controller.fields.iter().any(|field| field.name != "kind") {
        drives.push((OWN, motor.prepare_for_torque(None)));
    }
    if drives.iter().all(|(_, drive)| drive.is_err()) {
        drives.swap_remove(0).1?;
    }
    Ok(drives)
}

fn try_all(drives: &[Drive], progress: &dyn Progress) -> Result<Vec<Tried>, LabError> {
    progress.begin("trying variants", drives.len() as u64);
    let tried = drives.par_iter().map(|(variant, drive)| {
        let tried = match drive {
            Ok(drive) => try_drive(variant, drive),
            Err(reason) => Ok(Tried {
                refused: Some(reason.to_string()),
                refused_by: code_of(reason).map(|code| code.to_string()),
                ..Tried::new(variant)
            }),
        };
        progress.advance(1);
        tried
    });
    tried.collect()
}

/// Speed up to which a drive holds its torque, percent of the rated one.
fn limit_of(drive: &Prepared) -> Result<Option<f64>, LabError> {
    let torque = drive.demand();
    let run = RunOptions {
        starts: vec![START],
        ..run_of(&drive.spec, 0.0, torque)
    };
    let scan = LimitOptions::new(drive.rated_rpm(), torque);
    let maker = drive.maker(Model::Fixed, drive.set_point(torque));
    let limit = speed_limit(&plant_of(&drive.spec), &run, &scan, maker)?;
    Ok(limit.limit_pct)
}

fn try_drive(variant: &'static str, drive: &Prepared) -> Result<Tried, LabError> {
    let time = drive.generated.interface.times.first();
    let mut tried = Tried {
        cycles: time.map(|time| time.most_cycles() as u32),
        overruns: time.is_some_and(StepTime::is_too_long),
        is_example: drive.spec.controller.kind() == EXAMPLE,
        ..Tried::new(variant)
    };
    for speed in SPEEDS {
        let point = run(drive, &PlantOptions::default(), (speed, None))?;
        tried.nominal.push(point);
    }
    for (name, deviate) in DEVIATIONS {
        let mut plant = PlantOptions::default();
        deviate(&mut plant, drive.spec.inverter.v_bus);
        // Below `bus_min` a drive trips, and in its fade it makes less, as it should.
        if let BusSource::Measured { min, motoring, .. } = drive.spec.inverter.bus {
            let least = motoring.map_or(min, |fade| fade.full);
            plant.v_bus = plant.v_bus.map(|bus| bus.max(ABOVE_LEAST * least));
        }
        tried
            .deviating
            .push(run(drive, &plant, (DEVIATING_AT, Some(name)))?);
    }
    Ok(tried)
}

/// One run at rated torque.
fn run(
    drive: &Prepared,
    plant: &PlantOptions,
    (speed_pct, deviation): (u32, Option<&'static str>),
) -> Result<Point, LabError> {
    // The stated motor from every start of a measurement: some trip from one of them alone.
    let plant = PlantOptions {
        start_angle: deviation.map(|_| START),
        ..plant.clone()
    };
    let rpm = drive.rated_rpm() * f64::from(speed_pct) / 100.0;
    let torque = drive.demand();
    let demanded = drive.rated_torque() * plant.scale_kb.unwrap_or(1.0);
    let params = plant.plant(drive)?;
    let left = left_by_limit(drive, &params, rpm).filter(|left| *left < demanded);
    let expected = left.unwrap_or(demanded);
    let found = measured(
        drive,
        &params,
        &plant.run(drive, rpm, torque),
        plant.set_point(drive, torque),
        expected,
    )?;
    let figures = found.figures;
    let mean = figures.mean_torque_nm.filter(|_| found.tripped.is_none());
    Ok(Point {
        speed_pct,
        deviation,
        // More than a limit leaves is an overshoot of the limit, and no merit.
        torque_pct: mean.map(|mean| {
            let percent = 100.0 * mean / expected;
            left.map_or(percent, |_| percent.min(100.0))
        }),
        ripple_pct: figures.ripple_pp_pct,
        copper_w: figures
            .current_rms_a
            .map(|rms| 3.0 * drive.spec.motor.resistance * rms * rms),
        switching_hz: figures.switching_hz,
    })
}

/// Torque that a stated limit of the bus current leaves at a speed, Nm; none where it does not act.
fn left_by_limit(drive: &Prepared, plant: &PlantParams, rpm: f64) -> Option<f64> {
    let limited = envelope_on(&drive.spec, plant);
    limited.bus_current?;
    let free = limited.without_bus_limit();
    let omega_m = rpm * TAU / 60.0;
    let left = limited.torque(omega_m);
    (left < free.torque(omega_m)).then_some(left)
}

impl Advice {
    /// Whether the recommended variant suits the motor as stated.
    fn suits(&self) -> bool {
        let recommended = self.recommended.map(|place| &self.tried[place].nominal);
        let worst = recommended.and_then(|runs| Worst::of(runs));
        worst.is_some_and(|worst| worst.torque_pct > 100.0 - FAR_OFF && worst.ripple_pct < ROUGH)
    }

    /// The variants that are alike in torque and ripple, with and without deviations, as good as any. Each
    /// rule leaves some of the others over, and says what it has against the rest.
    fn alike(&mut self) -> Vec<usize> {
        type Runs = fn(&Tried) -> &[Point];
        let many = self.tried.len();
        let mut left: Vec<usize> = (0..many).collect();
        self.keep(&mut left, &works);
        self.reason = format!(
            "{} of {many} variants run without a trip and within the period",
            left.len()
        );
        self.keep(&mut left, &|tried| {
            tried
                .is_example
                .then(|| "an example of a controller, not for a drive".to_owned())
        });
        let rules: [(&str, Runs); 2] = [
            ("on the stated motor", |tried| &tried.nominal),
            ("with deviations", |tried| &tried.deviating),
        ];
        for (when, points) in rules {
            let worst = |tried: &Tried| Worst::of(points(tried));
            let torque = |tried: &Tried| worst(tried).map_or(0.0, |worst| worst.torque_pct);
            let ripple =
                |tried: &Tried| worst(tried).map_or(f64::INFINITY, |worst| worst.ripple_pct);
            let most = self.most(&left, &torque);
            self.keep(&mut left, &|tried| {
                let lacks = torque(tried) < most - TORQUE_ALIKE;
                lacks.then(|| format!("{:.1} % of the torque {when}", torque(tried)))
            });
            let least = -self.most(&left, &|tried| -ripple(tried));
            self.keep(&mut left, &|tried| {
                let ripples = ripple(tried) > least + RIPPLE_ALIKE;
                ripples.then(|| format!("{:.1} % of ripple {when}", ripple(tried)))
            });
            let _ = write!(
                self.reason,
                "; {when} {} of them are within {TORQUE_ALIKE} point of the most torque, {most:.1} %, and {RIPPLE_ALIKE} points of the least ripple, {least:.1} %",
                left.len(),
            );
        }
        left
    }

    /// Recommends one of those that are alike, by the speed up to which they hold the torque and by the time of
    /// their longest step.
    fn recommend(&mut self, left: &mut Vec<usize>) {
        let limit = |tried: &Tried| tried.limit_pct.unwrap_or(0.0);
        let farthest = self.most(left, &limit);
        // A torque that is not held at the first speed of the scan has no limit.
        let has_limit = farthest > 0.0;
        self.keep(left, &|tried| {
            let ends = limit(tried) < farthest - LIMIT_ALIKE;
            ends.then(|| {
                format!(
                    "holds the torque up to {:.0} % of rated speed",
                    limit(tried)
                )
            })
        });
        let cycles = |k: &usize| self.tried[*k].cycles.unwrap_or(u32::MAX);
        let fewest = left.iter().map(cycles).min().unwrap_or(u32::MAX);
        let is_alike = |k: &&usize| f64::from(cycles(k)) <= f64::from(fewest) * CYCLES_ALIKE;
        let is_own = |k: &&usize| self.tried[**k].variant == OWN;
        let own = left.iter().filter(is_alike).find(is_own);
        let first = own.or_else(|| left.iter().find(is_alike));
        self.recommended = first.copied();
        let Some(recommended) = self.recommended else {
            "no variant runs without a trip and within the control period"
                .clone_into(&mut self.reason);
            return;
        };
        let count = cycles(&recommended);
        let alike = left.iter().filter(is_alike).count();
        if has_limit {
            let _ = write!(
                self.reason,
                "; {} of them hold it up to {farthest:.0} % of rated speed, within {LIMIT_ALIKE} points",
                left.len(),
            );
        }
        let _ = write!(
            self.reason,
            "; its longest step takes at most {count} cycles"
        );
        if left.len() > 1 {
            let _ = write!(
                self.reason,
                ", at most {:.0} % more than the fewest ({fewest}), as those of {alike} of them, of which the motor file's own comes first, then the default",
                100.0 * (CYCLES_ALIKE - 1.0)
            );
        }
        left.retain(|&k| k != recommended);
        self.keep(left, &|tried| {
            let cycles = tried.cycles.unwrap_or(u32::MAX);
            let is_alike = f64::from(cycles) <= f64::from(fewest) * CYCLES_ALIKE;
            Some(
                if is_alike {
                    "as good"
                } else {
                    "as good, but slower"
                }
                .to_owned(),
            )
        });
    }

    /// Keeps those that a rule has nothing against, and notes what it has against the others.
    fn keep(&mut self, left: &mut Vec<usize>, against: &dyn Fn(&Tried) -> Option<String>) {
        left.retain(|&k| {
            let tried = &mut self.tried[k];
            tried.why_not = against(tried);
            tried.why_not.is_none()
        });
    }

    fn most(&self, left: &[usize], of: &dyn Fn(&Tried) -> f64) -> f64 {
        let values = left.iter().map(|&k| of(&self.tried[k]));
        values.fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Regret {
    /// Of the default drive, the first of those that were tried, on the stated motor.
    fn of(tried: &[Tried]) -> Option<Self> {
        let worst = tried.iter().map(|tried| Worst::of(&tried.nominal));
        let worst: Vec<Option<Worst>> = worst.collect();
        let default = worst.first().copied().flatten()?;
        let all = worst.iter().flatten();
        let most = all
            .clone()
            .fold(0.0, |most: f64, worst| most.max(worst.torque_pct));
        let alike = all.filter(|worst| worst.torque_pct >= most - TORQUE_ALIKE);
        let least = alike.fold(f64::INFINITY, |least, worst| least.min(worst.ripple_pct));
        Some(Self {
            torque_pct: most - default.torque_pct,
            ripple_pct: default.ripple_pct - least,
        })
    }
}

/// Code of the first diagnostic of an error.
fn code_of(error: &LabError) -> Option<Code> {
    match error {
        LabError::Diagnostics { code, .. } => *code,
        _ => None,
    }
}

/// What is against a variant that is refused, trips or takes longer than the period.
fn works(tried: &Tried) -> Option<String> {
    if tried.refused.is_some() {
        let code = tried.refused_by.as_ref();
        return Some(code.map_or("not as the file stands".to_owned(), |code| {
            format!("not as the file stands: {code}")
        }));
    }
    if tried.overruns {
        return Some("a step may take longer than the control period".to_owned());
    }
    let mut points = tried.nominal.iter().chain(&tried.deviating);
    let fails = points.find(|point| point.torque_pct.is_none() || point.ripple_pct.is_none())?;
    let what = match fails.torque_pct {
        None => "trips",
        Some(_) => "makes next to no torque",
    };
    Some(match fails.deviation {
        Some(name) => format!("{what} with {name}"),
        None => format!("{what} at {} % of rated speed", fails.speed_pct),
    })
}

#[cfg(test)]
mod tests {
    use super::{Advice, Point, Regret, Tried};

    fn tried(variant: &'static str, figures: [f64; 2], deviating: [f64; 2], cost: u32) -> Tried {
        let point = |[torque, ripple]: [f64; 2]| Point {
            speed_pct: 60,
            deviation: None,
            torque_pct: torque.is_finite().then_some(torque),
            ripple_pct: Some(ripple),
            copper_w: None,
            switching_hz: None,
        };
        Tried {
            nominal: vec![point(figures)],
            deviating: vec![point(deviating)],
            cycles: Some(cost),
            ..Tried::new(variant)
        }
    }

    #[test]
    fn trips_torque_ripple_and_deviations_count_before_cycles() {
        let mut advice = Advice {
            motor: String::new(),
            rated_torque_nm: 1.0,
            tried: vec![
                tried("default", [99.9, 1.0], [99.0, 3.0], 400),
                tried("trips", [f64::NAN, 0.1], [100.0, 0.1], 10),
                tried("weak", [97.0, 0.5], [97.0, 0.5], 20),
                tried("rough", [100.0, 9.0], [100.0, 9.0], 30),
                tried("touchy", [100.0, 1.0], [100.0, 6.0], 40),
                tried("lean", [99.5, 2.5], [99.0, 3.5], 300),
                Tried {
                    is_example: true,
                    ..tried("p-pwm", [100.0, 1.0], [100.0, 1.0], 5)
                },
            ],
            recommended: None,
            pwm_per_control: None,
            reason: String::new(),
            ripples: None,
            far_off: Vec::new(),
            kept: Vec::new(),
            left_out: Vec::new(),
        };
        let mut left = advice.alike();
        assert_eq!(left, [0, 5], "{advice:#?}");
        advice.recommend(&mut left);
        assert_eq!(advice.recommended, Some(5), "{advice:#?}");
        let against = [
            "as good, but slower",
            "trips",
            "97.0 %",
            "9.0 %",
            "6.0 % of ripple with deviations",
            "",
            "an example",
        ];
        for (tried, told) in advice.tried.iter().zip(against) {
            let why_not = tried.why_not.as_deref().unwrap_or_default();
            assert!(why_not.contains(told), "{}: {why_not}", tried.variant);
        }
        let regret = Regret::of(&advice.tried).expect("the default runs");
        assert!((regret.torque_pct - 0.1).abs() < 1e-9, "{regret:?}");
        assert!((regret.ripple_pct - 0.0).abs() < 1e-9, "{regret:?}");
    }
}
