//! The motor library, and how well each motor's default drive does.

use crate::closed_loop::{ClosedLoop, Measurement, Trip};
use crate::engine::{Model, PlantOptions, Prepared, SelectedMotor, plant_of, run_of};
use crate::plant::{Mechanics, Plant};
use crate::{LabError, Progress};
use hexagen_codegen::spec::{Envelope, MOST_RIPPLE, Spec};
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::TAU;

/// The controller, with all options at their defaults.
const CONTROLLER: &str = "pdcc";

/// Speeds, percent of the rated one.
pub const SPEEDS: [u32; 4] = [5, 25, 60, 100];

/// Both directions, motoring and braking: the signs of the speed and of the power.
pub const QUADRANTS: [(i32, i32); 4] = [(1, 1), (1, -1), (-1, 1), (-1, -1)];

/// Greatest distance of the mean torque from the demand, percent.
pub const TORQUE: f64 = 1.0;

/// Greatest ripple, percent: up to [`COARSE`] electrical degrees per control period at rated speed,
/// and above.
pub const RIPPLE: [f64; 2] = [100.0 * MOST_RIPPLE, 7.0];

/// Electrical degrees per control period.
pub const COARSE: f64 = 8.0;

/// Share of periods at the edge of the hexagon above which the bus voltage limits a drive, percent.
const SATURATED: f64 = 0.5;

/// One motor of the library; per phase of the star, SI units, speeds in rpm.
#[derive(Clone, Debug, Serialize)]
pub struct LibraryMotor {
    /// Name.
    pub name: String,
    /// One line of description.
    pub description: Option<String>,
    /// Pole pairs.
    pub pole_pairs: Option<u32>,
    /// Ohm.
    pub resistance_ohm: Option<f64>,
    /// Henry.
    pub inductance_h: Option<f64>,
    /// Peak phase EMF, V s/rad.
    pub emf_constant_v_s: Option<f64>,
    /// Bus voltage, volt.
    pub v_bus_v: Option<f64>,
    /// Rated current, ampere.
    pub rated_current_a: Option<f64>,
    /// Rated torque, Nm.
    pub rated_torque_nm: Option<f64>,
    /// Rated speed, rpm.
    pub rated_rpm: Option<f64>,
    /// Control period, second.
    pub t_s: Option<f64>,
    /// Turn of the rotor in a control period at rated speed, electrical degrees.
    pub degrees_per_period: Option<f64>,
    /// Speed up to which the bus drives the whole current of the demand, percent of the rated one.
    pub envelope_pct: Option<f64>,
    /// Torque that the bus allows at rated speed, up to the greatest set-point, Nm.
    pub envelope_torque_nm: Option<f64>,
    /// Starts of the default drive on a free shaft, and those of them that reach rated speed ([`FreeStart::all`]).
    pub starts: Option<[usize; 2]>,
    /// Ripple at rated speed if Hall edges were seen at samples only, the generator's estimate, percent; none without
    /// Hall sensors, or where the file's controller does not follow the angle.
    pub sampled_ripple_pct: Option<f64>,
    /// Whether the controller of its file can be generated.
    pub generates: bool,
    /// Why not.
    pub reason: Option<String>,
    /// The default drive at each of [`SPEEDS`], the worst of both directions, motoring and braking.
    pub points: Vec<RatedPoint>,
    /// Whether it is right at all of them: torque within [`TORQUE`], ripple at most [`RIPPLE`]; and starts.
    pub is_right: bool,
    /// What it is not right for.
    pub limit: Option<Limit>,
}

/// The default drive at rated torque and one speed.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct RatedPoint {
    /// Speed, percent of the rated one.
    pub speed_pct: u32,
    /// Mean torque, percent of the demand; `None` for a drive that trips.
    pub torque_pct: Option<f64>,
    /// Peak-to-peak ripple, percent of the mean.
    pub ripple_pct: Option<f64>,
    /// Share of periods at the edge of the hexagon, percent.
    pub saturated_pct: Option<f64>,
    /// Trip.
    pub tripped: Option<Trip>,
}

/// What limits a drive that is not right at a speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// The bus voltage.
    BusVoltage,
    /// The trip level.
    Trip,
    /// The angle that passes in a control period, or what the current changes in one.
    ControlPeriod,
    /// A start that does not reach rated speed.
    Start,
}

impl RatedPoint {
    /// Runs a drive at `speed_pct` of its rated speed, negative for backward, with `sign` times its
    /// demanded torque.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn measure(drive: &Prepared, speed_pct: i32, sign: f64) -> Result<Self, LabError> {
        let torque = sign * drive.demand();
        let omega = f64::from(speed_pct) / 100.0 * drive.spec.motor.rated_speed;
        let Measurement {
            figures, tripped, ..
        } = drive.measure_at(omega, torque)?;
        let mean = figures.mean_torque_nm.filter(|_| tripped.is_none());
        Ok(Self {
            speed_pct: speed_pct.unsigned_abs(),
            torque_pct: mean.map(|mean| 100.0 * mean / torque),
            ripple_pct: figures.ripple_pp_pct,
            saturated_pct: figures.saturated_pct,
            tripped,
        })
    }

    /// Runs a drive at each of [`SPEEDS`] in both directions, motoring and braking; each point with its
    /// speed in percent, negative backward, and 1 for motoring, -1 for braking.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn of_quadrants(drive: &Prepared) -> Result<Vec<(Self, i32, i32)>, LabError> {
        let places = SPEEDS.iter().flat_map(|speed| {
            let at = |(turn, mode): (i32, i32)| (turn * speed.cast_signed(), turn * mode, mode);
            QUADRANTS.map(at)
        });
        let run = |(speed, sign, mode)| {
            let point = Self::measure(drive, speed, f64::from(sign))?;
            Ok((point, speed, mode))
        };
        places.map(run).collect()
    }

    /// The worst of this and another point at the same speed: a trip, else the torque further from the demand and the
    /// greater ripple.
    fn worst(self, other: Self) -> Self {
        if self.tripped.is_some() {
            return self;
        }
        if other.tripped.is_some() {
            return other;
        }
        let greater = |one: Option<f64>, other: Option<f64>| Some(one?.max(other?));
        Self {
            torque_pct: self.torque_pct.zip(other.torque_pct).map(further),
            ripple_pct: greater(self.ripple_pct, other.ripple_pct),
            saturated_pct: greater(self.saturated_pct, other.saturated_pct),
            ..self
        }
    }

    /// Whether torque and ripple are right; `most`: greatest ripple, percent.
    pub fn is_right(&self, most: f64) -> bool {
        let holds = |torque: f64| off(torque) <= TORQUE;
        self.torque_pct.is_some_and(holds) && self.ripple_pct.is_some_and(|ripple| ripple <= most)
    }

    /// What limits a drive that is not right here.
    pub fn limit(&self) -> Limit {
        if self.tripped.is_some() {
            Limit::Trip
        } else if self.saturated_pct.is_some_and(|share| share > SATURATED) {
            Limit::BusVoltage
        } else {
            Limit::ControlPeriod
        }
    }
}

/// Distance of a torque from the demand, both in percent of it.
fn off(torque: f64) -> f64 {
    (torque - 100.0).abs()
}

/// That of two torques which is further from the demand, percent.
pub fn further((one, other): (f64, f64)) -> f64 {
    if off(other) > off(one) { other } else { one }
}

/// A start on a free shaft.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct FreeStart {
    /// Seconds from rest to the rated speed; `None` for a drive that trips, or needs more than three
    /// times as long as with the demanded torque.
    pub seconds: Option<f64>,
    /// Trip.
    pub tripped: Option<Trip>,
}

/// Longest start, over that at the demanded torque.
const PATIENCE: f64 = 3.0;

/// Inertia of a loaded shaft: the demanded torque takes it to rated speed in so many seconds.
const LOADED: f64 = 0.25;

/// Start angles, every other one backward.
const ANGLES: u32 = 12;

impl FreeStart {
    /// Starts of the bare rotor, where its inertia is known, and with a load, from twelve angles each: inertia in kg m2,
    /// angle in radian, and sign.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn all(drive: &Prepared) -> Result<Vec<(Self, [f64; 3])>, LabError> {
        let motor = &drive.spec.motor;
        let load = LOADED * drive.demand() / motor.rated_speed;
        let shafts = motor.inertia.into_iter().chain([load]);
        let starts = shafts.flat_map(|inertia| (0..ANGLES).map(move |number| (inertia, number)));
        let run = |(inertia, number): (f64, u32)| {
            let angle = f64::from(number) * TAU / f64::from(ANGLES);
            let sign = if number.is_multiple_of(2) { 1.0 } else { -1.0 };
            let start = Self::measure(drive, inertia, angle, sign)?;
            Ok((start, [inertia, angle, sign]))
        };
        starts.map(run).collect()
    }

    /// Runs a drive from rest to its rated speed with its demanded torque, from an electrical angle in
    /// radians; `sign`: -1 for backward. The shaft has an inertia in kg m2 and no load.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn measure(
        drive: &Prepared,
        inertia: f64,
        angle: f64,
        sign: f64,
    ) -> Result<Self, LabError> {
        let torque = sign * drive.demand();
        let (rated, t_s) = (drive.spec.motor.rated_speed, drive.spec.inverter.t_s);
        let mut params = plant_of(&drive.spec);
        params.mechanics = Some(Mechanics {
            inertia,
            opposing_torque: 0.0,
            external_torque: 0.0,
            viscous: 0.0,
        });
        let run = run_of(&drive.spec, 0.0, torque);
        let plant = Plant::new(params, angle, 0.0)?;
        let engine = drive.engine(Model::Fixed, drive.set_point(torque));
        let mut closed = ClosedLoop::new(plant, engine, run.delay);
        let longest = run.wait + PATIENCE * inertia * rated / torque.abs();
        let mut periods = 0;
        let mut is_there = false;
        while !is_there && closed.tripped().is_none() && f64::from(periods) * t_s < longest {
            closed.run(1, &mut ());
            periods += 1;
            is_there = sign * closed.plant().truth().omega_m >= rated;
        }
        let tripped = closed.tripped();
        Ok(Self {
            seconds: (is_there && tripped.is_none()).then(|| f64::from(periods) * t_s),
            tripped,
        })
    }
}

/// Greatest ripple of a drive that is right, percent.
pub fn greatest_ripple(spec: &Spec) -> f64 {
    let [fine, coarse] = RIPPLE;
    if spec.degrees_per_period() <= COARSE {
        fine
    } else {
        coarse
    }
}

/// The library, by name.
///
/// # Errors
/// If a file of the library cannot be read.
pub fn library_at_rating(progress: &dyn Progress) -> Result<Vec<LibraryMotor>, LabError> {
    let motors = SelectedMotor::library(&PlantOptions::default())?;
    // A motor without this controller has no points.
    let drives: Vec<Option<Prepared>> = motors
        .iter()
        .map(|motor| motor.prepare(Some(CONTROLLER)).ok())
        .collect();
    progress.begin("running at the rating", motors.len() as u64);
    let runs = drives.par_iter().map(|drive| {
        let run = |drive| Ok((points(drive)?, Some(starts(drive)?)));
        let runs = drive.as_ref().map_or(Ok((Vec::new(), None)), run);
        progress.advance(1);
        runs
    });
    let runs = runs.collect::<Result<Vec<_>, LabError>>()?;
    let entries = motors.iter().zip(runs);
    let entries = entries.map(|(motor, (points, starts))| {
        let entry = entry(motor, &points);
        let fails = starts.is_some_and(|[all, reached]| entry.generates && reached < all);
        LibraryMotor {
            starts,
            sampled_ripple_pct: sampled_ripple(motor),
            is_right: entry.is_right && !fails,
            limit: entry.limit.or(fails.then_some(Limit::Start)),
            ..entry
        }
    });
    Ok(entries.collect())
}

/// Starts of a drive, and those that reach rated speed.
fn starts(drive: &Prepared) -> Result<[usize; 2], LabError> {
    let all = FreeStart::all(drive)?;
    let reached = all.iter().filter(|(start, _)| start.seconds.is_some());
    Ok([all.len(), reached.count()])
}

/// Ripple that the generator tells of the default drive with Hall edges seen at samples only, percent.
fn sampled_ripple(motor: &SelectedMotor) -> Option<f64> {
    let variant = format!("{CONTROLLER}:hall_capture=sampled");
    let drive = motor.prepare(Some(&variant)).ok()?;
    drive.spec.sampled_ripple().map(|ripple| 100.0 * ripple)
}

fn points(drive: &Prepared) -> Result<Vec<RatedPoint>, LabError> {
    let of_quadrants = RatedPoint::of_quadrants(drive)?.into_iter();
    Ok(of_quadrants.map(|(point, ..)| point).collect())
}

fn entry(motor: &SelectedMotor, points: &[RatedPoint]) -> LibraryMotor {
    let none = LibraryMotor {
        name: motor.source.name.clone(),
        description: None,
        pole_pairs: None,
        resistance_ohm: None,
        inductance_h: None,
        emf_constant_v_s: None,
        v_bus_v: None,
        rated_current_a: None,
        rated_torque_nm: None,
        rated_rpm: None,
        t_s: None,
        degrees_per_period: None,
        envelope_pct: None,
        envelope_torque_nm: None,
        starts: None,
        sampled_ripple_pct: None,
        generates: false,
        reason: None,
        points: Vec::new(),
        is_right: false,
        limit: None,
    };
    let drive = match motor.prepare(None) {
        Ok(drive) => drive,
        Err(error) => {
            return LibraryMotor {
                reason: Some(error.to_string()),
                ..none
            };
        }
    };
    let (spec, inverter) = (&drive.spec.motor, &drive.spec.inverter);
    let most = greatest_ripple(&drive.spec);
    let wrong = points.iter().find(|point| !point.is_right(most));
    let of_speed = |points: &[RatedPoint]| points.iter().copied().reduce(RatedPoint::worst);
    LibraryMotor {
        description: Some(spec.description.clone()),
        pole_pairs: Some(spec.pole_pairs),
        resistance_ohm: Some(spec.resistance),
        inductance_h: Some(spec.inductance),
        emf_constant_v_s: Some(spec.emf_constant),
        v_bus_v: Some(inverter.v_bus),
        rated_current_a: Some(spec.rated_current),
        rated_torque_nm: Some(drive.rated_torque()),
        rated_rpm: Some(drive.rated_rpm()),
        t_s: Some(inverter.t_s),
        degrees_per_period: Some(drive.spec.degrees_per_period()),
        envelope_pct: Envelope::of(&drive.spec)
            .speed(drive.demand())
            .map(|lasts| 100.0 * lasts / spec.rated_speed),
        envelope_torque_nm: Some(Envelope::of(&drive.spec).torque(spec.rated_speed)),
        generates: true,
        is_right: !points.is_empty() && wrong.is_none(),
        limit: wrong.map(RatedPoint::limit),
        points: points
            .chunks(QUADRANTS.len())
            .filter_map(of_speed)
            .collect(),
        ..none
    }
}
