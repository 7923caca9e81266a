//! The paper's experiment: both readings of each controller are generated drives in closed loop on
//! the paper's motor.

use super::{
    BothReadings, Improved, Method, Point, Reading, Reproduction, Run, SwitchingTables,
    distance_rms,
};
use crate::closed_loop::{
    Delay, Held, LimitOptions, RunOptions, STARTS, mean_torque, measure, speed_limit_knowing,
};
use crate::counted::{Counted, Figures as StepCost};
use crate::engine::{Model, PlantOptions, Prepared, SelectedMotor, SetPoint, plant_of, run_of};
use crate::plant::PlantParams;
use crate::results::PAPER_MOTOR;
use crate::{IMPROVEMENTS, LabError, Progress, READINGS};
use hexagen_codegen::interface::PublicValue;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The two speeds in rpm.
const SPEEDS: [f64; 2] = [400.0, 1500.0];

/// The demanded torque in newton metres.
const TORQUE: f64 = 3.3;

/// Extent of the experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    /// Electrical start angles in radians.
    pub starts: Vec<f64>,
    /// Speeds of the torque-speed curves in rpm, ascending.
    pub curve_rpm: Vec<f64>,
    /// First speed and step of the search for the limit in rpm.
    pub limit_rpm: (f64, f64),
}

impl Effort {
    /// All three starts, curves from 10 to 130 % of rated speed, limits in steps of 20 rpm.
    pub fn full() -> Self {
        Self {
            starts: STARTS.to_vec(),
            curve_rpm: (2..=26).map(|k| 100.0 * f64::from(k)).collect(),
            limit_rpm: (400.0, 20.0),
        }
    }
}

/// Symbol of the step function that `cargo xtask cost` counts for each reading of each method and for
/// each improvement, and its variant; in the order of [`READINGS`], literal before corrected, then of
/// [`IMPROVEMENTS`].
pub fn counted_drives() -> impl Iterator<Item = (String, &'static str)> {
    let methods = Method::ALL.into_iter().zip(READINGS);
    let of_readings = methods.flat_map(|(method, readings)| {
        let controller = method.name().to_lowercase().replace('-', "_");
        Reading::ALL.map(|reading| {
            let variant = match reading {
                Reading::Literal => readings.literal,
                Reading::Corrected => readings.corrected,
            };
            let symbol = format!("step_trivedi_keshri_660w_{controller}_{}", reading.name());
            (symbol, variant)
        })
    });
    let improvements = IMPROVEMENTS
        .iter()
        .map(|improvement| (improvement.symbol.to_owned(), improvement.variant));
    of_readings.chain(improvements)
}

/// Runs everything.
///
/// # Errors
/// Diagnostics of a drive, a plant parameter out of range, or a step without a count.
pub fn reproduce(effort: &Effort, progress: &dyn Progress) -> Result<Reproduction, LabError> {
    let motor = SelectedMotor::find(PAPER_MOTOR, &PlantOptions::default())?;
    let drives = counted_drives()
        .map(|(_, variant)| motor.prepare(Some(variant)))
        .collect::<Result<Vec<_>, _>>()?;
    let per_drive = SPEEDS.len() + effort.curve_rpm.len() + 1;
    progress.begin("simulating", (per_drive * drives.len()) as u64);
    let counted = Counted::on_cortex_m4()?;
    let costs = counted_drives()
        .map(|(symbol, _)| counted.of_step(&symbol))
        .collect::<Result<Vec<_>, _>>()?;
    let runs = drives
        .par_iter()
        .zip(costs)
        .map(|(drive, cost)| Bench::of(drive, effort, cost).run(progress))
        .collect::<Result<Vec<_>, LabError>>();
    let mut runs = runs?.into_iter();
    // The readings come first.
    let [Some(fcs_mpc), Some(pdcc), Some(phcc), Some(pi_pwm)] = [(); 4].map(|()| {
        Some(BothReadings {
            literal: runs.next()?,
            corrected: runs.next()?,
        })
    }) else {
        return Err(LabError::Argument("a reading is missing".to_owned()));
    };
    let improvements = IMPROVEMENTS
        .iter()
        .zip(runs)
        .map(|(improvement, run)| Improved {
            about: improvement.about,
            run,
        });
    let improvements = improvements.collect();
    let phcc_drives = &drives[2 * Method::Phcc.index()..];
    let spec = &drives[0].spec;
    Ok(Reproduction {
        generator: format!("hexagen {}", env!("CARGO_PKG_VERSION")),
        motor: spec.motor.clone(),
        inverter: spec.inverter.clone(),
        torque: TORQUE,
        current: TORQUE / spec.torque_constant(),
        speeds_rpm: SPEEDS,
        methods: [fcs_mpc, pdcc, phcc, pi_pwm],
        improvements,
        tables: SwitchingTables {
            printed: forward_rows(&phcc_drives[0]),
            derived: forward_rows(&phcc_drives[1]),
        },
    })
}

/// The forward motoring rows of a drive's switching table; zeros for a drive without one.
fn forward_rows(drive: &Prepared) -> [[u8; 8]; 6] {
    let constants = &drive.generated.interface.constants;
    let table = constants.iter().find_map(|constant| match &constant.value {
        PublicValue::Integers { values, .. } if constant.name == "SWITCHING_TABLE" => Some(values),
        _ => None,
    });
    // Eight entries per sector; the first eight are for an unknown sector.
    std::array::from_fn(|k| {
        std::array::from_fn(|entry| {
            let value = table.and_then(|table| table.get(8 * (k + 1) + entry));
            value.map_or(0, |&value| value as u8)
        })
    })
}

/// A drive on its plant.
struct Bench<'p> {
    drive: &'p Prepared,
    effort: &'p Effort,
    plant: PlantParams,
    set_point: SetPoint,
    cost: StepCost,
}

impl<'p> Bench<'p> {
    fn of(drive: &'p Prepared, effort: &'p Effort, cost: StepCost) -> Self {
        Self {
            drive,
            effort,
            plant: plant_of(&drive.spec),
            set_point: drive.set_point(TORQUE),
            cost,
        }
    }

    /// The loop has a delay of one period, whatever the drive assumes.
    fn at(&self, rpm: f64) -> RunOptions {
        RunOptions {
            delay: Delay::OnePeriod,
            starts: self.effort.starts.clone(),
            ..run_of(&self.drive.spec, rpm * TAU / 60.0, TORQUE)
        }
    }

    fn run(&self, progress: &dyn Progress) -> Result<Run, LabError> {
        let (drive, effort) = (self.drive, self.effort);
        let [low, high] = SPEEDS.map(|rpm| {
            let point = self.point(rpm);
            progress.advance(1);
            point
        });
        let points = [low?, high?];
        let maker = || drive.maker(Model::Fixed, self.set_point);
        let known = |rpm: f64| points.iter().find(|point| point.rpm == rpm);
        let curve = effort
            .curve_rpm
            .par_iter()
            .map(|&rpm| {
                let torque = match known(rpm) {
                    Some(point) => point.figures.mean_torque_nm,
                    None => mean_torque(&self.plant, &self.at(rpm), &maker())?.ok(),
                };
                progress.advance(1);
                Ok(torque.map(|torque| (rpm, torque)))
            })
            .collect::<Result<Vec<_>, LabError>>()?;
        // A tripped drive has no torque there.
        let mut curve: Vec<(f64, f64)> = curve.into_iter().flatten().collect();
        let (from_rpm, step_rpm) = effort.limit_rpm;
        // The paper's criterion is a falling torque: more than the demand counts as held.
        let scan = LimitOptions {
            held: Held::AtLeast,
            from_rpm,
            step_rpm,
            ..LimitOptions::new(drive.rated_rpm(), TORQUE)
        };
        let limit = speed_limit_knowing(&self.plant, &self.at(1.0), &scan, &curve, maker())?;
        progress.advance(1);
        // The search has a finer grid: with it the limit lies on the curve.
        curve.extend_from_slice(&limit.curve);
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        curve.dedup_by(|a, b| (a.0 - b.0).abs() < 1e-6);
        Ok(Run {
            variant: drive.variant.clone(),
            engine: drive.engine_kind().name(),
            points,
            curve,
            limit,
            cost: self.cost,
        })
    }

    fn point(&self, rpm: f64) -> Result<Point, LabError> {
        let run = self.at(rpm);
        let maker = self.drive.maker(Model::Fixed, self.set_point);
        let measured = measure(&self.plant, &run, maker)?;
        let distances = measured.traces.iter();
        let distance: f64 = distances
            .map(|trace| distance_rms(trace, run.current))
            .sum();
        let hexagon_rms_a = distance / measured.traces.len() as f64;
        let Some(trace) = measured.traces.into_iter().next() else {
            return Err(LabError::Argument("a run needs a start".to_owned()));
        };
        Ok(Point {
            rpm,
            figures: measured.figures,
            hexagon_rms_a,
            trace,
            trip: measured.tripped,
        })
    }
}
